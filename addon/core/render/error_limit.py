"""Ends a render by its estimated error: when the error is estimated, and what of it counts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .denoise import LUMINANCE
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
DARKEST = 0.05
"""Luminance, of 1 for white, below which errors look no larger than there."""
OF_MEAN = 0.5
"""DARKEST is at most this part of the mean luminance: some pictures are made brighter later."""


class ErrorLimit:
    """Of one render. error: as it was estimated last, what the threshold is compared with."""

    def __init__(self, settings: RenderSettings, part: Part) -> None:
        self.error = 0.0
        self._threshold, self._denoise = settings.error_threshold, settings.denoise
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
            film = renderer.film(["error", "combined"])
            luminance = film["combined"][..., :3] @ np.asarray(LUMINANCE, np.float32)
            self.error *= error_seen(film["error"][..., 0], luminance) / own["relative_rmse"]
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
    return passes + max(1, passes // 8)


def error_seen(error: NDArray[np.float32], luminance: NDArray[np.float32]) -> float:
    """What the threshold of a render is compared with that is to be denoised: the RMS of all errors
    but the greatest, OUTLIERS of them, each relative to the luminance of its own pixel (both
    (height, width)). Relative to the picture's mean, as a raw picture's error is, a bright sky
    would hide the noise under it.
    """
    mean = float(luminance.mean(dtype=np.float64))
    if not mean > 0.0:
        return 0.0
    relative = error / np.maximum(luminance, min(DARKEST, OF_MEAN * mean))
    squares = np.square(relative.ravel(), dtype=np.float64)
    most = max(1, round(squares.size * (1.0 - OUTLIERS)))
    return math.sqrt(float(np.partition(squares, most - 1)[:most].mean()))
