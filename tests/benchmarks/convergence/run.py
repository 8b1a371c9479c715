"""How the error falls with photons: `python -m tests.benchmarks.convergence.run [SCENE ...]` prints
slopes and writes convergence.md and .png.

Per scene the mean squared error of the whole picture (bounced and direct light) at pass 8, 16, ...
512, against two path-traced halves (`--truth` makes them anew) and thus free of their noise; the
slope of a straight line through them, log against log; and the same with all discs of one fixed
radius, for a sweep of radii: at each number of photons the product is held against the best of
these.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.plan import make_plan
from photon_splat.core.render.result import passes_from_film
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import Integrator, RenderSettings
from photon_splat.core.scene import LightKind, Scene

from tests.reference.stability.cases import box_on_floor, caustic_rim
from tests.support import corescene as c
from tests.support.compare import LUMINANCE

HERE = Path(__file__).parent
TRUTH = HERE / "truth.npz"
PIXELS = 40
PHOTONS = 20_000
"""Paths in a pass."""
COUNTS = tuple(8 << k for k in range(7))
"""Passes, over a 64-fold range."""
SEEDS = 3
RADII = tuple(float(r) for r in np.geomspace(0.03, 0.48, 7))
MOST = 1.2


def corner() -> Scene:
    """Where walls, floor and a step meet in a room under a lamp: many surface edges, no step in
    irradiance.
    """
    room = c.box((-1, -1, 0), (1, 1, 2), inwards=True)
    lamp = c.lamp(LightKind.AREA, 40.0, (0.0, 0.0, 1.95), size=(1.2, 1.2))
    return c.scene(
        c.perspective((-0.7, -0.8, 1.1), (0.8, 0.9, 0.5), PIXELS, PIXELS, 1.3),
        [(room, c.lambert(0.7))],
        [lamp],
    )


def table() -> Scene:
    """A table's free edges before a bright wall."""
    top = c.mesh([(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)], [(0, 1, 2, 3)])
    wall = c.mesh([(-1, 0.7, -0.2), (1, 0.7, -0.2), (1, 0.7, 1.2), (-1, 0.7, 1.2)], [(0, 1, 2, 3)])
    lamp = c.lamp(
        LightKind.SPOT, 100.0, (0.0, -0.5, 1.2), (0.0, 0.7, 0.5), spot_size=0.7, spot_blend=1.0
    )
    return c.scene(
        c.ortho_down(2.0, 1.1, PIXELS), [(top, c.lambert(0.7)), (wall, c.lambert(0.8))], [lamp]
    )


@dataclass(frozen=True)
class Case:
    make: Callable[[], Scene]
    slope: float
    samples: int  # of each half of the truth


def _fine(make: Callable[[], Scene]) -> Callable[[], Scene]:
    def made() -> Scene:
        scene = make()
        return replace(scene, frame=replace(scene.frame, width=PIXELS, height=PIXELS))

    return made


CASES = {
    "corner": Case(corner, -0.6, 8_000),
    "table": Case(table, -0.6, 60_000),
    "box on floor": Case(_fine(box_on_floor), -0.45, 8_000),
    "caustic rim": Case(_fine(caustic_rim), -0.45, 40_000),
}
"""slope: what is promised; the first two have no steps in irradiance, the others contact shadows
and a caustic's rim.
"""


ALL_AT_ONCE = 1 << 40


def errors(scene: Scene, halves: np.ndarray, seed: int, radius: float = 0.0) -> list[float]:
    """Mean squared error of the luminance after each of COUNTS passes, over the squared mean.
    radius: fixed, metres; 0 = the product's.
    """
    settings = RenderSettings(
        photons_per_pass=PHOTONS, max_bounces=64, seed=seed, adaptive_radius=radius == 0
    )
    settings = make_plan(scene, settings).applied_to(settings)
    renderer = load().Renderer(0)
    fill_renderer(renderer, scene, settings)
    renderer.options.fixed_radius = radius
    renderer.build()
    out = []
    for number in range(COUNTS[-1]):
        renderer.render_pass(number, paths_per_batch=ALL_AT_ONCE)
        if number + 1 in COUNTS:
            picture = passes_from_film(renderer.film())["Combined"][..., :3] @ LUMINANCE
            out.append(
                float(((picture - halves[0]) * (picture - halves[1])).mean() / halves.mean() ** 2)
            )
    return out


def slope(values: np.ndarray) -> float:
    """Of log error on log photons."""
    return float(np.polyfit(np.log(COUNTS), np.log(values), 1)[0])


def make_truth(names: list[str]) -> None:
    kept = dict(np.load(TRUTH)) if TRUTH.exists() else {}
    for name in names or CASES:
        settings = [
            RenderSettings(
                passes=CASES[name].samples,
                max_bounces=64,
                seed=seed,
                integrator=Integrator.REFERENCE,
            )
            for seed in (71, 72)
        ]
        scene = CASES[name].make()
        halves = [
            render(scene, half, started=time.monotonic()).passes["Combined"][..., :3] @ LUMINANCE
            for half in settings
        ]
        kept[name] = np.stack(halves).astype(np.float32)
        print(
            name,
            "path tracer's own relative error "
            f"{np.sqrt(((halves[0] - halves[1]) ** 2).mean() / 2) / np.mean(halves):.4f}",
            flush=True,
        )
        np.savez_compressed(TRUTH, **kept)


@cache
def truth_of(name: str) -> np.ndarray:
    with np.load(TRUTH) as file:
        return file[name].astype(np.float64)


@dataclass(frozen=True)
class Measured:
    """product: (counts,); fixed: (radii, counts); mean squared errors over the squared mean."""

    product: np.ndarray
    fixed: np.ndarray

    @property
    def best(self) -> np.ndarray:
        return self.fixed.min(axis=0)


def measure(name: str) -> Measured:
    scene, halves = CASES[name].make(), truth_of(name)
    product = np.mean([errors(scene, halves, seed) for seed in range(SEEDS)], axis=0)
    fixed = [errors(scene, halves, 0, radius) for radius in RADII]
    return Measured(product, np.maximum(np.array(fixed), 1e-12))


def table_of(rows: dict[str, Measured]) -> str:
    lines = [
        "# Error against photons",
        "",
        f"Mean squared error over the squared mean, {PIXELS}x{PIXELS}, {PHOTONS:,} paths a pass, "
        f"{SEEDS} seeds. In brackets: over that of",
        f"the best of {len(RADII)} fixed radii at that number of photons. Made by `make "
        "convergence`.",
        "",
        "| scene | slope | promised | "
        + " | ".join(f"{n * PHOTONS / 1e6:.2g} M" for n in COUNTS)
        + " |",
        "|---|---|---|" + "---|" * len(COUNTS),
    ]
    for name, m in rows.items():
        cells = " | ".join(
            f"{e:.2e} ({e / best:.2f})" for e, best in zip(m.product, m.best, strict=True)
        )
        lines.append(f"| {name} | {slope(m.product):.2f} | {CASES[name].slope:g} | {cells} |")
    return "\n".join(lines) + "\n"


def chart(rows: dict[str, Measured], path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    photons = np.array(COUNTS) * PHOTONS
    figure, axes = plt.subplots(1, len(rows), figsize=(3.3 * len(rows), 3.3), squeeze=False)
    for axis, (name, m) in zip(axes[0], rows.items(), strict=True):
        for values in m.fixed:
            axis.plot(photons, values, color="#bbb", lw=0.8)
        axis.plot([], [], color="#bbb", label="fixed radii")
        axis.plot(
            photons,
            m.product,
            "o-",
            color="#204080",
            ms=4,
            label=f"Photon Splat: slope {slope(m.product):.2f}",
        )
        axis.plot(
            photons,
            m.product[0] * (photons / photons[0]) ** (-2 / 3),
            ":",
            color="#c07030",
            label="-2/3",
        )
        axis.set(
            xscale="log",
            yscale="log",
            title=name,
            xlabel="photon paths",
            ylim=(m.product.min() / 3, m.product.max() * 10),
        )
        axis.legend(fontsize=7)
    axes[0][0].set_ylabel("MSE / mean²")
    figure.tight_layout()
    figure.savefig(path, dpi=100)


def main(arguments: list[str]) -> int:
    names = [a for a in arguments if not a.startswith("--")]
    unknown = [name for name in names if name not in CASES]
    if unknown:
        print(f"no such scene: {', '.join(unknown)}; there are {', '.join(CASES)}", file=sys.stderr)
        return 2
    if "--truth" in arguments:
        make_truth(names)
        return 0
    with np.load(TRUTH) as file:
        missing = [name for name in names or CASES if name not in file.files]
    if missing:
        print(
            f"no truth yet for {', '.join(missing)}: python -m tests.benchmarks.convergence.run "
            "--truth NAME "
            "makes it",
            file=sys.stderr,
        )
    rows = {}
    for name in (name for name in names or CASES if name not in missing):
        rows[name] = measure(name)
        best = [RADII[i] for i in rows[name].fixed.argmin(axis=0)]
        print(
            f"{name}: best fixed radii {', '.join(f'{r:.3f}' for r in best)} m",
            file=sys.stderr,
            flush=True,
        )
    print(table_of(rows))
    if not names:
        (HERE / "convergence.md").write_text(table_of(rows))
        chart(rows, HERE / "convergence.png")
    kept = [
        slope(m.product) <= CASES[name].slope and (m.product <= MOST * m.best).all()
        for name, m in rows.items()
    ]
    return 0 if all(kept) and not missing else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
