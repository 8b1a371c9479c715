"""How long a render goes on after its last pass: estimate of the error, arrays of the film,
denoising. A time limit holds for all of it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from .denoise import DenoiserMissing, denoise

SMALL_SIDE, LARGE_SIDE = 24, 128
"""Of squares that are denoised to learn how long it takes: what goes with their area is of
interest.
"""
TRIAL_SHARE = 1 / 16
"""Of the picture, at most, that the large one has."""
OF_SECOND_PART = 1.1
"""Work of denoising two parts of a picture one by one, over that of one."""
OF_FEATURES = 1.0
"""Work of filtering albedo and normal first, likewise."""
CAUTION = 1.1
BLEND_SECONDS = 2e-7
"""A pixel: mixing the noisy picture in again."""


def denoising_runs(*, apart: bool, noisy_features: bool) -> float:
    """How much work denoise() has, over that of one filter on one picture."""
    return 1.0 + OF_SECOND_PART * apart + OF_FEATURES * noisy_features


class Ending:
    """Predicts the seconds from what it has measured so far; 0 for what it has not."""

    def __init__(self, width: int, height: int) -> None:
        self.pixels = width * height
        self._estimate, self._levels = 0.0, 1
        self._film = 0.0
        self._denoise_once, self._denoise_pixels = 0.0, 0.0

    def estimate(self, make: Callable[[], None], passes: int) -> None:
        """Calls `make`, which estimates the error after `passes` passes: it looks at blocks of 1,
        2, 4, ... of them.
        """
        began = time.monotonic()
        make()
        self._estimate, self._levels = time.monotonic() - began, passes.bit_length()

    def try_film(self, renderer: Any, channels: int) -> None:
        """`channels`: of all arrays that the film will give in the end."""
        began = time.monotonic()
        renderer.film(["combined"])
        self._film = (time.monotonic() - began) * channels / 4

    def try_denoiser(self, threads: int) -> None:
        large = int(min(LARGE_SIDE, (TRIAL_SHARE * self.pixels) ** 0.5))
        if large < 2 * SMALL_SIDE:
            large = 2 * SMALL_SIDE
        try:
            _denoise_seconds(SMALL_SIDE, threads)  # loads the library
            small = _denoise_seconds(SMALL_SIDE, threads)
            seconds = _denoise_seconds(large, threads)
        except (DenoiserMissing, RuntimeError):  # which is said when the picture is to be denoised
            return
        area = large**2 - SMALL_SIDE**2
        self._denoise_once, self._denoise_pixels = (
            small,
            max(seconds - small, 0.0) / area * self.pixels + BLEND_SECONDS * self.pixels,
        )

    def seconds(self, passes: int, runs: float) -> float:
        """After `passes` passes, with `runs` of the denoiser (0: none)."""
        denoising = runs * (self._denoise_once + self._denoise_pixels) if runs else 0.0
        return CAUTION * (
            self._estimate * passes.bit_length() / self._levels + self._film + denoising
        )


def _denoise_seconds(side: int, threads: int) -> float:
    noise = np.random.default_rng(0).random((3, side, side, 3), np.float32)
    began = time.monotonic()
    denoise(*noise, threads=threads)
    return time.monotonic() - began
