"""Figures of renders against the reference, and what follows from them: slopes, and how much faster
equal errors are reached.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from statistics import median

import numpy as np

from tests.support.compare import rel_mse, rmse_two_halves

EPSILON = 0.01
"""Of relMSE = mean(error^2 / (reference^2 + EPSILON))."""
Array = np.ndarray


@dataclass(frozen=True)
class Point:
    """One budget of one method: medians over seeds, and the 10 to 90 % band of the RMSE. flip: NaN
    without the package.
    """

    budget: float
    seconds: float
    rmse: float
    low: float
    high: float
    rel_mse: float
    flip: float
    mean_ratio: float
    renders: int


def flip(picture: Array, reference: Array) -> float:
    """Mean HDR-FLIP (Andersson et al. 2021), by its authors' package `flip_evaluator` if that is
    installed; else NaN.
    """
    try:
        import flip_evaluator
    except ImportError:
        return float("nan")
    pictures = [np.ascontiguousarray(np.clip(p, 0, None), np.float32) for p in (reference, picture)]
    return float(flip_evaluator.evaluate(*pictures, "HDR", applyMagma=False)[1])


def point(
    budget: float,
    pictures: list[Array],
    seconds: list[float],
    halves: tuple[Array, Array],
    window: int = 1,
) -> Point:
    """window: that of rel_mse()."""
    reference = (halves[0] + halves[1]) / 2
    wide = [picture.astype(np.float64) for picture in pictures]
    errors = [rmse_two_halves(picture, *halves) for picture in wide]
    return Point(
        budget,
        median(seconds),
        median(errors),
        float(np.quantile(errors, 0.1)),
        float(np.quantile(errors, 0.9)),
        median(max(rel_mse(picture, *halves, EPSILON, window), 0.0) for picture in wide),
        flip(pictures[0], reference),
        median(float(picture.mean() / reference.mean()) for picture in wide),
        len(pictures),
    )


def slope(points: list[Point]) -> float:
    """Of log RMSE against log seconds."""
    if len(points) < 2:
        return float("nan")
    return float(
        np.polyfit(np.log([p.seconds for p in points]), np.log([p.rmse for p in points]), 1)[0]
    )


def seconds_to(points: list[Point], error: float) -> float:
    """When a method reaches an RMSE, from the lines between its points in the log-log chart; beyond
    the last along error ~ t^(-1/2), before the first NaN, since start-up is no power law.
    """
    if not points or error > points[0].rmse:
        return float("nan")
    for before, after in pairwise(points):
        if after.rmse <= error <= before.rmse and after.rmse < before.rmse:
            share = np.log(before.rmse / error) / np.log(before.rmse / after.rmse)
            return float(before.seconds * (after.seconds / before.seconds) ** share)
    return float(points[-1].seconds * (points[-1].rmse / error) ** 2)


def rel_mse_at(points: list[Point], seconds: float) -> float:
    """From the lines between a method's points; before the first one infinite, after the last one
    as that.
    """
    if seconds < points[0].seconds:
        return float("inf")
    return float(
        np.exp(
            np.interp(
                np.log(seconds),
                np.log([p.seconds for p in points]),
                np.log([max(p.rel_mse, 1e-12) for p in points]),
            )
        )
    )
