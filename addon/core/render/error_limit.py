"""Ends a render by its estimated error: when the error is estimated, and what of it counts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .denoise import LUMINANCE, has_denoiser
from .ending import Ending
from .parts import Part
from .settings import RenderSettings

FEWEST_PASSES_TO_STOP = 8
"""Fewest passes before a render may end by its error: the estimate is too rough before."""
OUTLIERS = 0.01
"""Share of the pixels, those of the greatest error, that do not keep a render going which is to be
denoised: single paths of strong light, which are taken away then. In kitchen they are two thirds of
the error after 16 passes.
"""
LEFT_OF_EVEN, LEFT_BY_DETAIL, LEFT_AT_MOST = 0.1, 2.5, 0.5
"""Errors of denoised pixels over those of noisy ones, by detail(): measured in kitchen, classroom,
street, village, car and staircase after 6 to 50 s. From .0 to .2 where features are even, from .33
to .75 where they differ most.
"""
DARKEST = 0.05
"""Luminance, of 1 for white, below which errors look no larger than there."""
OF_MEAN = 0.5
"""DARKEST is at most this part of the mean luminance: some pictures are made brighter later."""


class ErrorLimit:
    """Of one render. error: as it was estimated last, what the threshold is compared with."""

    def __init__(self, settings: RenderSettings, part: Part) -> None:
        self.error = 0.0
        self._threshold = settings.error_threshold
        self._denoise = settings.denoise and has_denoiser()
        self._part = part
        self._next = 1

    def after_pass(self, renderer: Any, ending: Ending, passes: int) -> bool:
        """Estimates the error now and then, and tells `ending` what that takes. Returns whether it
        is small enough to end the render.
        """
        if passes < self._next:
            return False
        # Without a threshold the estimate is only shown, and few are enough.
        self._next = next_estimate(passes) if self._threshold > 0 else 2 * passes
        ending.estimate(renderer.make_error_estimate, passes)
        own = renderer.statistics()["error"]
        self.error = self._part.error_of_whole(own, passes)
        if self._threshold <= 0:
            return False
        if self._denoise and own["relative_rmse"] > 0:
            self.error *= error_left(renderer) / own["relative_rmse"]
        return passes >= FEWEST_PASSES_TO_STOP and self.error <= self._threshold

    @property
    def fraction(self) -> float:
        """How much of the render is done, 0..1."""
        if not (self._threshold and self.error):
            return 0.0
        return min((self._threshold / self.error) ** 2, 1.0)


def next_estimate(passes: int) -> int:
    """The pass after which the error is estimated again. It depends on the number of passes alone,
    so that a render can be repeated.
    """
    return 2 * passes if passes < FEWEST_PASSES_TO_STOP else passes + passes // 8


def error_left(source: Any) -> float:
    """The error of a film's picture when it is denoised, about: what the threshold is compared with
    then. `source`: a renderer, or what else has film(names), after its error has been estimated.

    It is the RMS of all errors but the greatest, OUTLIERS of them, each relative to the luminance
    of its own pixel, and as large as the denoiser leaves it. Relative to the picture's mean, as a
    raw picture's error is, a bright sky would hide the noise under it; and of the noise on an even
    wall little is left, of that in foliage half.
    """
    film = source.film(["error", "combined", "albedo", "feature_normal"])
    luminance = film["combined"][..., :3] @ np.asarray(LUMINANCE, np.float32)
    mean = float(luminance.mean(dtype=np.float64))
    if not mean > 0.0:
        return 0.0
    features = detail(film["albedo"], film["feature_normal"])
    left = np.minimum(LEFT_OF_EVEN + LEFT_BY_DETAIL * features, LEFT_AT_MOST)
    darkest = min(DARKEST, OF_MEAN * mean)
    relative = left * film["error"][..., 0] / np.maximum(luminance, darkest)
    squares = np.square(relative.ravel(), dtype=np.float64)
    most = max(1, round(squares.size * (1.0 - OUTLIERS)))
    return math.sqrt(float(np.partition(squares, most - 1)[:most].mean()))


def detail(albedo: NDArray[np.float32], normal: NDArray[np.float32]) -> NDArray[np.float32]:
    """(height, width): by how much a pixel's albedo, or half its normal, differs at most from those
    of the four pixels beside it.
    """
    features = np.concatenate([albedo, 0.5 * normal], axis=-1)
    found = np.zeros(features.shape[:2], np.float32)
    for axis in (0, 1):
        step = np.abs(np.diff(features, axis=axis)).max(axis=-1)
        before: tuple[slice, ...] = (slice(None),) * axis + (slice(None, -1),)
        after: tuple[slice, ...] = (slice(None),) * axis + (slice(1, None),)
        found[before] = np.maximum(found[before], step)
        found[after] = np.maximum(found[after], step)
    return found
