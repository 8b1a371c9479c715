"""Predicts the time between the last pass and the result: error estimate, film arrays, denoising. A
time limit includes all of it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from .denoise import DenoiserMissing, Quality, denoise

SMALL_SIDE, LARGE_SIDE = 32, 128
"""Sides, in pixels, of the two squares that are denoised as a trial. The difference between their
times gives the time per pixel. The larger one is a multiple of the other, as the library fills
sides up. Of tiny pictures the small one is half as wide.
"""
TRIAL_SHARE = 1 / 6
"""Largest share of the picture's pixels that the large square may have."""
CAUTION = 1.1
WORTH = 0.125
"""Share of the time that the next better quality of the denoiser may take. It brings 5 to 12 % of
relMSE (classroom, staircase, village; 3 and 14 samples per pixel), as so much more time would.
"""
BLEND_SECONDS = 2e-7
"""Seconds per pixel for mixing the noisy picture in again."""


class Ending:
    """Predicts seconds from what has been measured so far; what has not been measured counts 0."""

    def __init__(self, width: int, height: int) -> None:
        self.pixels = width * height
        self._estimate, self._levels = 0.0, 1
        self._film = 0.0
        self._denoise_once, self._denoise_pixels = 0.0, 0.0

    def estimate(self, make: Callable[[], None], passes: int) -> None:
        """Calls `make` and measures it. `make` estimates the error after `passes` passes, from
        blocks of 1, 2, 4, ... passes, so its work grows with the logarithm of `passes`.
        """
        began = time.monotonic()
        make()
        self._estimate, self._levels = time.monotonic() - began, passes.bit_length()

    def try_film(self, renderer: Any, channels: int) -> None:
        """Measures how long the film's arrays take. channels: of all arrays that the result
        needs.
        """
        began = time.monotonic()
        renderer.film(["combined"])
        self._film = (time.monotonic() - began) * channels / 4

    def try_denoiser(self, threads: int, on_card: bool) -> None:
        large = int(min(LARGE_SIDE, (TRIAL_SHARE * self.pixels) ** 0.5))
        side = SMALL_SIDE if large >= 2 * SMALL_SIDE else SMALL_SIDE // 2
        large = max(large // side, 2) * side
        try:
            _denoise_seconds(side, threads, on_card)  # loads the library
            small = _denoise_seconds(side, threads, on_card)
            # The lesser of two: what holds up one of them would count many times over
            seconds = min(_denoise_seconds(large, threads, on_card) for _ in range(2))
        except (DenoiserMissing, RuntimeError):  # denoise() itself tells the user
            return
        area = large**2 - side**2
        self._denoise_once, self._denoise_pixels = (
            small,
            max(seconds - small, 0.0) / area * self.pixels + BLEND_SECONDS * self.pixels,
        )

    def seconds(self, passes: int, runs: float) -> float:
        """Seconds from the last of `passes` passes to the result; `runs` of the denoiser, in the
        unit of denoising_runs().
        """
        return CAUTION * (
            self._estimate * passes.bit_length() / self._levels + self._film
        ) + self.denoising_seconds(runs)

    def denoising_seconds(self, runs: float) -> float:
        return CAUTION * runs * (self._denoise_once + self._denoise_pixels)

    def worth(self, seconds: float, runs: Callable[[Quality], float]) -> Quality:
        """The quality for a picture whose passes and denoising have `seconds`. runs: what it
        takes.
        """
        quality = Quality.FAST
        for better in (Quality.QUICK, Quality.BEST):
            more = self.denoising_seconds(runs(better)) - self.denoising_seconds(runs(quality))
            if more > WORTH * seconds:
                break
            quality = better
        return quality

    def best_within(
        self, seconds: float, runs: Callable[[Quality], float], reserved: Quality
    ) -> Quality:
        """The best quality that takes no longer; the fastest where none does. reserved: time has
        been kept for that one, caution and all.
        """
        for quality in reversed(Quality):
            given = CAUTION * seconds if quality <= reserved else seconds
            if self.denoising_seconds(runs(quality)) <= given:
                return quality
        return Quality.FAST


def _denoise_seconds(side: int, threads: int, on_card: bool) -> float:
    noise = np.random.default_rng(0).random((3, side, side, 3), np.float32)
    began = time.monotonic()
    denoise(*noise, quality=Quality.QUICK, threads=threads, on_card=on_card)
    return time.monotonic() - began
