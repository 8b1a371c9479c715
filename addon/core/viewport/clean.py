"""Denoises the pictures of a viewport that rests."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..render.denoise import DenoiserMissing, Quality, denoise
from ..render.denoise_result import has_noisy_features
from ..scene import Scene

if TYPE_CHECKING:
    from photon_splat_native import Renderer

FEATURES = ("albedo", "feature_normal")
WAIT = 2.0
"""Least time between two pictures, in times that denoising takes: a third of all time at most."""


class Cleaner:
    """Knows how long denoising takes. missing: why it cannot be done, or nothing."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self.missing = ""

    @property
    def wait(self) -> float:
        """Seconds of rendering that are due between two denoised pictures."""
        return WAIT * self.seconds

    def clean(
        self,
        renderer: Renderer,
        scene: Scene,
        samples: int,
        *,
        last: bool,
        threads: int,
        on_card: bool,
        should_cancel: Callable[[], bool],
    ) -> NDArray[np.float32]:
        """renderer.picture() without its noise, or as it is where there is no denoiser. samples: of
        the camera per pixel. last: no better one follows; others are denoised in a quarter of the
        time, or less.
        """
        pixels = renderer.picture()
        if self.missing:
            return pixels
        began = time.monotonic()
        features = renderer.film(FEATURES)
        try:
            pixels[..., :3] = denoise(
                pixels[..., :3],
                features["albedo"],
                features["feature_normal"],
                noisy_features=has_noisy_features(samples, scene),
                quality=Quality.BEST if last else Quality.FAST,
                threads=threads,
                on_card=on_card,
                should_cancel=should_cancel,
            )
        except (DenoiserMissing, RuntimeError) as error:
            self.missing = str(error)
        else:
            if not last:
                self.seconds = time.monotonic() - began
        return pixels
