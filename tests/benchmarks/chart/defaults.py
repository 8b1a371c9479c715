"""What a click on Render gives, beside Cycles with its own defaults: `python -m
tests.benchmarks.chart.defaults [--scale X] [SCENE ...]` (`make defaults`). Writes defaults.csv.

Seconds of the render call, relMSE and FLIP (figures.py) of a picture of `scale` times the chart's
width. Measure on a machine that does nothing else.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
from pathlib import Path

from tests.benchmarks.chart import figures, runs
from tests.benchmarks.chart.plan import CASES, Case, Method

TABLE = Path(__file__).resolve().parent / "defaults.csv"
METHODS = (Method.SPLAT_DEFAULT, Method.CYCLES_DEFAULT)


def smaller(case: Case, scale: float) -> Case:
    """Its reference takes as much less time as it has fewer pixels."""
    return dataclasses.replace(
        case,
        width=round(case.width * scale),
        height=round(case.height * scale),
        reference_seconds=max(case.reference_seconds * scale * scale, 20.0),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    options = parser.parse_args()
    rows = []
    for case in CASES:
        if options.scenes and case.scene not in options.scenes:
            continue
        case = smaller(case, options.scale)
        halves = runs.reference(case)
        for method in METHODS:
            shot = runs.shot(case, method, 0.0, 1)
            point = figures.point(0.0, [shot.picture], [shot.seconds], halves)
            rows.append([case.scene, method.value, point.seconds, point.rel_mse, point.flip])
            print(
                f"{case.scene:14} {method:24} {point.seconds:7.1f} s  relMSE {point.rel_mse:.6f}  "
                f"FLIP {point.flip:.4f}  mean {point.mean_ratio:.4f}",
                flush=True,
            )
    if not options.scenes:
        with TABLE.open("w", newline="") as file:
            csv.writer(file).writerows([("scene", "method", "seconds", "relMSE", "FLIP"), *rows])


if __name__ == "__main__":
    main()
