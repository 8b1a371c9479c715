"""Error against time on cornell_box at 512x512, both integrators: `python -m tests.bench.chart` writes out/error.png.

Each picture is a render of its own with that time limit; RMSE is free of the reference's noise (two halves, kept in build/).
"""

from __future__ import annotations

import sys
import time

import matplotlib as mpl
import numpy as np
from photon_splat.core.session import render
from photon_splat.core.settings import Integrator, RenderSettings

from tests.bench.run import reference_halves
from tests.bench.scenes import ROOT, from_blend
from tests.compare import rmse_two_halves

SECONDS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


def main() -> int:
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    half_1, half_2 = reference_halves()
    scene = from_blend("cornell_box", 512, 512)
    figure, axes = plt.subplots(figsize=(6, 4.5))
    for integrator in (Integrator.SPLAT, Integrator.REFERENCE):
        points = []
        for seconds in SECONDS:
            started = time.monotonic()
            result = render(scene, RenderSettings(passes=1_000_000, time_limit=seconds, integrator=integrator), started=started)
            took = time.monotonic() - started
            picture = result.passes["Combined"][..., :3].astype(np.float64)
            points.append((took, rmse_two_halves(picture, half_1, half_2)))
            print(f"{integrator} {took:6.2f} s  RMSE {points[-1][1]:.5f}", flush=True)
        times, errors = np.array(points).T
        slope = np.polyfit(np.log(times), np.log(errors), 1)[0]
        axes.loglog(times, errors, "o-", label=f"{integrator} (slope {slope:.2f})")
    axes.set(xlabel="seconds", ylabel="RMSE", title="cornell_box, 512x512")
    axes.grid(which="both", alpha=0.3)
    axes.legend()
    output = ROOT / "out" / "error.png"
    output.parent.mkdir(exist_ok=True)
    figure.savefig(output, dpi=120, bbox_inches="tight")
    print(f"{output.relative_to(ROOT)} written")
    return 0


if __name__ == "__main__":
    sys.exit(main())
