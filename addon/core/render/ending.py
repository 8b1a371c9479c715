"""Predicts the time between the last pass and the result: error estimate, film arrays, denoising. A
time limit includes all of it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from .denoise import DenoiserMissing, denoise

SMALL_SIDE, LARGE_SIDE = 32, 128
"""Sides, in pixels, of the two squares that are denoised as a trial. The difference between their
times gives the time per pixel. The larger one is a multiple of the other, as the library fills
sides up. Of tiny pictures the small one is half as wide.
"""
TRIAL_SHARE = 1 / 6
"""Largest share of the picture's pixels that the large square may have."""
OF_SECOND_PART = 1.1
"""Extra work of denoising direct light separately, in runs of the denoiser."""
OF_FEATURES = 1.0
"""Extra work of denoising albedo and normal first, in runs of the denoiser."""
CAUTION = 1.1
BLEND_SECONDS = 2e-7
"""Seconds per pixel for mixing the noisy picture in again."""


def denoising_runs(*, apart: bool, noisy_features: bool) -> float:
    """Work of denoise(), in runs of one filter on one picture."""
    return 1.0 + OF_SECOND_PART * apart + OF_FEATURES * noisy_features


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
        """Seconds from the last of `passes` passes to the result, with `runs` runs of the
        denoiser.
        """
        denoising = runs * (self._denoise_once + self._denoise_pixels) if runs else 0.0
        return CAUTION * (
            self._estimate * passes.bit_length() / self._levels + self._film + denoising
        )


def _denoise_seconds(side: int, threads: int, on_card: bool) -> float:
    noise = np.random.default_rng(0).random((3, side, side, 3), np.float32)
    began = time.monotonic()
    denoise(*noise, threads=threads, on_card=on_card)
    return time.monotonic() - began
