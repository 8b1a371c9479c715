"""Mixes the noisy picture into the denoised one where the denoiser has blurred it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .denoise import LUMINANCE

WINDOW = 2
"""Half the side, in pixels, of the square over which noise and blur are averaged."""
CAUTION = 8.0
DOUBT = 2.0
"""Factor on the estimated variance, which may be half of the true one: an estimate that is too low
would take noise for blur and mix it back in.
"""


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
