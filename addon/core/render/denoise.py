"""Denoising by Open Image Denoise (oidn.py), on a graphics card or on the processor."""

from __future__ import annotations

from collections.abc import Callable

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
WINDOW = 2
"""Half the side, in pixels, of the square over which noise and blur are averaged."""
MEDIUM_GREY = 0.18
CAUTION = 8.0
DOUBT = 2.0
"""Factor on the estimated variance, which may be half of the true one: an estimate that is too low
would take noise for blur and mix it back in.
"""


def device_name(on_card: bool) -> str:
    """What denoises: a graphics card's name, or CPU; empty where there is no denoiser."""
    try:
        library()
        card = graphics_card() if on_card else None
    except DenoiserMissing:
        return ""
    return card.card if card else "CPU"


def blend(
    noisy: NDArray[np.float32],
    denoised: NDArray[np.float32],
    variance: NDArray[np.float32],
    passes: int,
) -> NDArray[np.float32]:
    """The mixture of both pictures (height, width, 3) of the least expected squared error: a
    denoiser blurs what it takes for noise, and what it blurs stays wrong however long one renders.
    Where the two differ by more than the noise of the one explains, (noisy - denoised)^2 = variance
    + blur^2 (as in Stein's estimate), the noisy one has the share blur^2 / (blur^2 + variance).

    A pixel that differs alone, without two like it around it, is a speck of noise: it gets nothing,
    and tells nothing of the blur around it.

    variance: of the noisy picture's luminance, (height, width), as estimated after `passes` passes;
    few passes are trusted less.
    """
    difference = (noisy - denoised) @ np.asarray(LUMINANCE, np.float32)
    square = difference**2
    alone = _alone(square)
    known = np.maximum(_window_mean((~alone).astype(np.float32)), 1e-6)
    square, noise = (
        _window_mean(np.where(alone, 0.0, square)) / known,
        _window_mean(np.where(alone, 0.0, variance)) / known * DOUBT * (1.0 + CAUTION / passes),
    )
    blur = np.maximum(square - noise, 0.0)
    share = np.divide(blur, blur + noise, out=np.zeros_like(blur), where=(blur > 0) & ~alone)
    share = share[..., None]
    return denoised + share * (noisy - denoised)


def _alone(square: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Whether a pixel differs by itself: fewer than two of its neighbours have a tenth of its
    squared difference.
    """
    height, width = square.shape
    around = np.pad(square, 1, mode="edge")
    alike = sum(
        (around[y : y + height, x : x + width] > 0.1 * square).astype(np.int8)
        for y in range(3)
        for x in range(3)
        if (y, x) != (1, 1)
    )
    return np.asarray(alike < 2)


def _window_mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Mean over (2 WINDOW + 1)^2 pixels; pixels at the border are repeated outwards."""
    size = 2 * WINDOW + 1
    padded = np.pad(
        values.astype(np.float64), ((WINDOW + 1, WINDOW), (WINDOW + 1, WINDOW)), mode="edge"
    )
    padded[0, :] = padded[:, 0] = 0.0
    sums = padded.cumsum(0).cumsum(1)
    boxes = sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
    return np.asarray(np.maximum(boxes, 0.0) / size**2, np.float32)


def denoise(
    color: NDArray[np.float32],
    albedo: NDArray[np.float32],
    normal: NDArray[np.float32],
    *,
    apart: NDArray[np.float32] | None = None,
    noisy_features: bool = False,
    fast: bool = False,
    threads: int = 0,
    on_card: bool = False,
    should_cancel: Callable[[], bool] | None = None,
    warn: Callable[[str], None] | None = None,
) -> NDArray[np.float32]:
    """Returns `color` (height, width, 3), linear, without its noise; the features have its shape.

    apart: a part of `color` with noise and edges of its own, such as direct light. It and the rest
    are denoised separately.

    noisy_features: albedo and normal come from few samples and are denoised first, or their own
    noise would show in the picture.

    fast: a quarter of the time, or with noisy features, which then count less, an eighth; for a
    picture that a better one follows.

    threads: of the processor; 0 = all. on_card: on the graphics card, if there is one that can. One
    that fails leaves the work to the processor, and `warn` is told.

    A cancelled run returns `color` unchanged. Raises DenoiserMissing, or DeviceFailed with the
    library's message.
    """
    images = [np.ascontiguousarray(a, np.float32) for a in (color, np.clip(albedo, 0, 1), normal)]
    job = _Job(images, apart, noisy_features, fast, should_cancel)
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
        fast: bool,
        should_cancel: Callable[[], bool] | None,
    ) -> None:
        self.color, self.albedo, self.normal = images
        self.apart = None if apart is None else np.ascontiguousarray(apart, np.float32)
        self.noisy_features, self.fast = noisy_features, fast
        self.should_cancel = should_cancel
        self.cancelled = False

    def run(self, device: Device) -> NDArray[np.float32]:
        albedo, normal = self.albedo, self.normal
        if self.noisy_features and not self.fast:
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
                clean_features=not (self.noisy_features and self.fast),
                exposure=exposure,
            )
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
            if self.fast or prefilter:
                it.set(b"quality", QUALITY_FAST if self.fast else QUALITY_BALANCED)
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
