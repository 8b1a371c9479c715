"""The charts as PNG: error against time, and pictures of equal time with maps of their signed
errors.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np

from tests.benchmarks.chart import runs
from tests.benchmarks.chart.figures import Point, slope
from tests.benchmarks.chart.plan import RIVALS, Case, Method

mpl.use("Agg")
from matplotlib import pyplot as plt

STYLE = {
    Method.SPLAT: ("#d95f02", "-", "o"),
    Method.SPLAT_DENOISED: ("#d95f02", "--", "s"),
    Method.CYCLES: ("#4477aa", "-", "o"),
    Method.CYCLES_DENOISED: ("#4477aa", "--", "s"),
    Method.MITSUBA: ("#228833", "-", "^"),
    Method.MITSUBA_PARTICLES: ("#228833", ":", "v"),
    Method.LUXCORE: ("#aa3377", "-", "^"),
    Method.LUXCORE_BIDIRECTIONAL: ("#aa3377", "-.", "<"),
    Method.LUXCORE_PHOTONS: ("#aa3377", ":", "v"),
}
SHOWN = (Method.SPLAT, Method.SPLAT_DENOISED, Method.CYCLES, Method.CYCLES_DENOISED)


def chart(case: Case, found: dict[Method, list[Point]], path: Path) -> None:
    """RMSE and relMSE, log-log, with bands."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2))
    for method, points in found.items():
        color, line, mark = STYLE[method]
        times = [p.seconds for p in points]
        thin = {"lw": 0.8, "ms": 3} if method in RIVALS else {"lw": 1.6, "ms": 4}
        axes[0].loglog(
            times,
            [p.rmse for p in points],
            line,
            marker=mark,
            color=color,
            label=f"{method} ({slope(points):.2f})",
            **thin,
        )
        if method not in RIVALS:
            axes[0].fill_between(
                times,
                [p.low for p in points],
                [p.high for p in points],
                color=color,
                alpha=0.15,
                lw=0,
            )
        axes[1].loglog(
            times,
            [max(p.rel_mse, 1e-9) for p in points],
            line,
            marker=mark,
            color=color,
            label=str(method),
            **thin,
        )
    for axis, name in zip(axes, ("RMSE", "relMSE"), strict=True):
        axis.set(xlabel="seconds of the render call", ylabel=name)
        axis.grid(which="both", alpha=0.25)
    axes[0].legend(fontsize=7 if len(found) > 4 else 8, title="(slope)", title_fontsize=8)
    figure.suptitle(f"{case.scene}, {case.width}x{case.height}: {case.kind}")
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    plt.close(figure)


def _tone(picture: np.ndarray, white: float) -> np.ndarray:
    x = np.clip(picture[::-1] / white, 0, 1)
    return np.where(x < 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def equal_time(
    case: Case, budgets: list[float], halves: tuple[np.ndarray, np.ndarray], path: Path
) -> None:
    """Pictures after the second budget, and below them what is too bright (red) and too dark
    (blue).
    """
    budget = budgets[min(1, len(budgets) - 1)]
    reference = (halves[0] + halves[1]) / 2
    white = float(np.quantile(reference, 0.98))
    figure, axes = plt.subplots(2, 5, figsize=(15, 6.4 * case.height / case.width + 0.6))
    pictures: list[tuple[str, Any]] = [
        (str(m), runs.shot(case, m, budget, 1).picture) for m in SHOWN
    ]
    for column, (name, picture) in enumerate([*pictures, ("reference", reference)]):
        axes[0, column].imshow(_tone(picture, white))
        axes[0, column].set_title(name, fontsize=9)
        error = np.asarray(picture - reference).mean(-1)[::-1] / white
        axes[1, column].imshow(error, cmap="RdBu_r", vmin=-0.1, vmax=0.1)
    for axis in axes.flat:
        axis.axis("off")
    figure.suptitle(
        f"{case.scene} after {budget:g} s; error from -10 % (blue) to +10 % of white (red)",
        fontsize=10,
    )
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    plt.close(figure)
