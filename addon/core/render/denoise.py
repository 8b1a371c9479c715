"""Denoising by Open Image Denoise (oidn.py), on a graphics card or on the processor."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from .oidn import (
    QUALITY_BALANCED,
    QUALITY_FAST,
    DenoiserMissing,
    Device,
    DeviceFailed,
    graphics_card,
    library,
    processor,
)

LUMINANCE = (0.2126, 0.7152, 0.0722)
MEDIUM_GREY = 0.18


class Quality(IntEnum):
    """How much work a picture is worth: see denoising_runs()."""

    FAST = 0
    QUICK = 1
    BEST = 2


OF_LIBRARY = {Quality.FAST: QUALITY_FAST, Quality.QUICK: QUALITY_BALANCED, Quality.BEST: None}
OF_FILTER = {Quality.FAST: 0.5, Quality.QUICK: 1.0, Quality.BEST: 2.2}
"""Work of one filter, in filters of Quality.QUICK."""
OF_FEATURES = 2.1
"""The same of denoising albedo and normal first."""


def denoising_runs(quality: Quality, *, apart: bool, noisy_features: bool) -> float:
    """Work of denoise(), in filters of Quality.QUICK on the whole picture."""
    prefilters = noisy_features and quality is Quality.BEST
    return OF_FILTER[quality] * (1 + apart) + OF_FEATURES * prefilters


def has_denoiser() -> bool:
    """Whether this Blender has Open Image Denoise."""
    try:
        library()
    except DenoiserMissing:
        return False
    return True


def device_name(on_card: bool) -> str:
    """What denoises: a graphics card's name, or CPU; empty where there is no denoiser."""
    if not has_denoiser():
        return ""
    card = graphics_card() if on_card else None
    return card.card if card else "CPU"


def denoise(
    color: NDArray[np.float32],
    albedo: NDArray[np.float32],
    normal: NDArray[np.float32],
    *,
    apart: NDArray[np.float32] | None = None,
    noisy_features: bool = False,
    quality: Quality = Quality.BEST,
    threads: int = 0,
    on_card: bool = False,
    should_cancel: Callable[[], bool] | None = None,
    warn: Callable[[str], None] | None = None,
) -> NDArray[np.float32]:
    """Returns `color` (height, width, 3), linear, without its noise; the features have its shape.

    apart: a part of `color` with noise and edges of its own, such as direct light. It and the rest
    are denoised separately.

    noisy_features: albedo and normal come from few samples, and their own noise would show in the
    picture: they are denoised first, or below Quality.BEST count less.

    threads: of the processor; 0 = all. on_card: on the graphics card, if there is one that can. One
    that fails leaves the work to the processor, and `warn` is told.

    A cancelled run returns `color` unchanged. Raises DenoiserMissing, or DeviceFailed with the
    library's message.
    """
    images = [np.ascontiguousarray(a, np.float32) for a in (color, np.clip(albedo, 0, 1), normal)]
    job = _Job(images, apart, noisy_features, quality, should_cancel)
    card = graphics_card() if on_card else None
    if card is not None:
        try:
            return job.run(card)
        except DeviceFailed as failure:
            if warn is not None:
                warn(
                    f"The graphics card has not denoised the picture: {failure}. The processor has."
                )
    with processor(threads) as device:
        return job.run(device)


def _exposure(color: NDArray[np.float32]) -> float:
    """The factor that brings the picture's mean luminance to a medium grey. All parts of a picture
    share it: a part that is mostly black, as direct light may be, would otherwise be brightened
    until its highlights clip. A pixel counts up to 64 times the geometric mean.
    """
    light = np.maximum(color @ np.asarray(LUMINANCE, np.float32), 1e-8)
    mean = float(np.minimum(light, 64.0 * np.exp(np.log(light).mean())).mean())
    return MEDIUM_GREY / mean


class _Job:
    """One picture to denoise; after a cancelled filter no other one runs."""

    def __init__(
        self,
        images: list[NDArray[np.float32]],
        apart: NDArray[np.float32] | None,
        noisy_features: bool,
        quality: Quality,
        should_cancel: Callable[[], bool] | None,
    ) -> None:
        self.color, self.albedo, self.normal = images
        self.apart = None if apart is None else np.ascontiguousarray(apart, np.float32)
        self.noisy_features, self.quality = noisy_features, quality
        self.should_cancel = should_cancel
        self.cancelled = False

    def run(self, device: Device) -> NDArray[np.float32]:
        albedo, normal = self.albedo, self.normal
        prefilters = self.noisy_features and self.quality is Quality.BEST
        if prefilters:
            albedo, normal = (
                self._filter(device, {name: image}, prefilter=True)
                for name, image in ((b"albedo", albedo), (b"normal", normal))
            )
        parts, exposure = [self.color], None
        if self.apart is not None:
            parts = [self.apart, np.maximum(self.color - self.apart, 0.0)]
            exposure = _exposure(self.color)
        filtered = [
            self._filter(
                device,
                {b"color": part, b"albedo": albedo, b"normal": normal},
                clean_features=prefilters or not self.noisy_features,
                exposure=exposure,
            )
            if part.any()
            else part  # not every network leaves black as it is
            for part in parts
        ]
        if self.cancelled:
            return self.color
        return np.sum(filtered, axis=0, dtype=np.float32)

    def _goes_on(self) -> bool:
        self.cancelled = self.cancelled or (self.should_cancel is not None and self.should_cancel())
        return not self.cancelled

    def _filter(
        self,
        device: Device,
        images: dict[bytes, NDArray[np.float32]],
        *,
        prefilter: bool = False,
        clean_features: bool = True,
        exposure: float | None = None,
    ) -> NDArray[np.float32]:
        """Returns the first image without its noise; the others are its features. prefilter: the
        image is a feature itself. clean_features: they have no noise. exposure: the factor that
        the denoiser multiplies the image by (None: it chooses).
        """
        first = next(iter(images.values()))
        if self.cancelled:
            return first
        output = np.empty_like(first)
        with device.filter() as it:
            for name, image in images.items():
                it.set_image(name, image)
            quality = QUALITY_BALANCED if prefilter else OF_LIBRARY[self.quality]
            if quality:
                it.set(b"quality", quality)
            if not prefilter:
                it.set(b"hdr", True)
                it.set(b"cleanAux", clean_features)
                if exposure is not None:
                    it.set(b"inputScale", exposure)
            it.run(output, self._goes_on)
        try:
            device.check()
        except DeviceFailed:
            if not self.cancelled:  # being cancelled counts as an error there
                raise
        return output
