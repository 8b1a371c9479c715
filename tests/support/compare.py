"""Comparing noisy pictures: error measures free of reference noise, and z-tests on block means.

A picture is a *stack* (K, height, width, channels) of K independent renders of the same thing. Two
kinds are told apart: a path tracer's pixels are independent of each other, so that the variance of
a block's mean follows from its pixels; photons spread over many pixels, so that only the K block
means themselves tell their variance.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, stats

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear RGB with Rec. 709 primaries."""

Array = NDArray[np.float64]


def mse_two_halves(picture: Array, half_1: Array, half_2: Array) -> float:
    """Mean squared error of `picture` against the reference of which the halves are two independent
    estimates.
    """
    return float(np.mean((picture - half_1) * (picture - half_2)))


def rmse_two_halves(picture: Array, half_1: Array, half_2: Array) -> float:
    """Square root of `mse_two_halves`; 0 where noise makes that negative."""
    return max(mse_two_halves(picture, half_1, half_2), 0.0) ** 0.5


def rel_mse(
    picture: Array, half_1: Array, half_2: Array, epsilon: float = 0.01, window: int = 1
) -> float:
    """Mean of squared error / (reference^2 + epsilon), the numerator free of reference noise.

    window: pixels, along each side, that the reference of the denominator is the mean of. With 1
    the noise of a pixel is in both: a noisy reference adds to every picture's error.
    """
    reference = (half_1 + half_2) / 2
    if window > 1:
        reference = ndimage.uniform_filter(reference, (window, window, 1), mode="nearest")
    return float(np.mean((picture - half_1) * (picture - half_2) / (reference**2 + epsilon)))


def block_means(picture: Array, block: int) -> Array:
    """(..., H, W, C) to (..., ceil(H/block), ceil(W/block), C); blocks at the upper and right
    border may be smaller.
    """
    height, width = picture.shape[-3:-1]
    rows, columns = range(0, height, block), range(0, width, block)
    summed = np.add.reduceat(np.add.reduceat(picture, rows, axis=-3), columns, axis=-2)
    counts = np.diff([*rows, height])[:, None] * np.diff([*columns, width])[None, :]
    return summed / counts[:, :, None]


@dataclass
class Blocks:
    """Block means of a stack: mean, variance of that mean, and the degrees of freedom of that
    variance.
    """

    mean: Array
    variance: Array
    freedom: Array

    @classmethod
    def of(cls, stack: Array, block: int = 8, *, independent_pixels: bool) -> Blocks:
        runs = len(stack)
        if runs < 2:
            raise ValueError(f"a stack of {runs} renders tells nothing of its variance")
        mean = block_means(stack.mean(0), block)
        if independent_pixels:
            counts = block_means(np.ones(stack.shape[1:]), block) * _pixel_counts(
                stack.shape[1:3], block
            )
            of_pixels = stack.var(0, ddof=1) / runs
            variance = block_means(of_pixels, block) / counts
            # Welch and Satterthwaite: unequal variances of the pixels leave fewer degrees of
            # freedom than pixels. The square of an estimated variance is on average (K + 1)/(K - 1)
            # times the square of the true one.
            fourth = block_means(of_pixels**2, block) * counts * (runs - 1) / (runs + 1)
            freedom = (
                (runs - 1)
                * (block_means(of_pixels, block) * counts) ** 2
                / np.maximum(fourth, 1e-300)
            )
        else:
            variance = block_means(stack, block).var(0, ddof=1) / runs
            freedom = np.full(mean.shape, runs - 1.0)
        return cls(mean, variance, np.maximum(freedom, 1.0))


def _pixel_counts(shape: tuple[int, ...], block: int) -> Array:
    height, width = shape
    rows, columns = (
        np.diff([*range(0, height, block), height]),
        np.diff([*range(0, width, block), width]),
    )
    return (rows[:, None] * columns[None, :])[:, :, None].astype(float)


@dataclass
class BlockTest:
    """Result of `block_test`. `difference` and `sigma` are per block and channel."""

    difference: Array
    sigma: Array
    p_values: Array
    allowed: Array
    level: float

    @property
    def passed(self) -> bool:
        return bool(self.p_values.min() >= self.level)

    def __str__(self) -> str:
        row, column, channel = np.unravel_index(np.argmin(self.p_values), self.p_values.shape)
        at = (row, column, channel)
        return (
            f"{int((self.p_values < self.level).sum())} of {self.p_values.size} block channels "
            f"differ; worst: row {row}, column {column}, "
            f"channel {channel}: difference {self.difference[at]:+.4g}, sigma "
            f"{self.sigma[at]:.2g}, allowed bias {self.allowed[at]:.2g}, "
            f"p {self.p_values[at]:.1e} (level {self.level:.1e})"
        )


KNOWN_BIAS_SHARE, KNOWN_BIAS_SIZE = 0.012, 0.25


def within_known_bias(result: BlockTest, reference: Blocks) -> bool:
    """Whether the blocks that differ are few and differ by little enough to be the splat's known
    bias.

    Where a thing stands on a surface or leans against it, the disc reaches under it, where no
    photon lands, and the kernel mass does not know it: dark by up to a fifth within a disc's
    radius. Indirect light that changes within a radius is blurred. Both vanish with the radius, and
    both stay in a few blocks: at most 1.2 % of them, by at most a quarter.
    """
    differing = result.p_values < result.level
    size = np.abs(result.difference) / np.maximum(
        np.abs(reference.mean), float(np.abs(reference.mean).mean())
    )
    return float(differing.mean()) <= KNOWN_BIAS_SHARE and bool(
        (size[differing] <= KNOWN_BIAS_SIZE).all()
    )


def block_test(
    ours: Blocks,
    reference: Blocks,
    *,
    relative: float = 0.0,
    absolute: float | Array = 0.0,
    family_level: float = 0.01,
) -> BlockTest:
    """Welch's t-test on every block mean, Bonferroni-corrected to `family_level` for the picture.

    A bias of up to relative * reference + absolute is allowed: it is taken off the difference
    before the test. `absolute` may be an array per block and channel.
    """
    difference = ours.mean - reference.mean
    allowed = relative * np.abs(reference.mean) + absolute
    variance = ours.variance + reference.variance
    parts = ours.variance**2 / ours.freedom + reference.variance**2 / reference.freedom
    # Two float32 renderers differ by rounding where nothing is random.
    variance = variance + (1e-5 * np.abs(reference.mean) + 1e-9) ** 2
    freedom = np.maximum(variance**2 / np.maximum(parts, 1e-300), 1.0)
    excess = np.maximum(np.abs(difference) - allowed, 0.0)
    sigma = np.sqrt(variance)
    p_values = 2.0 * stats.t.sf(excess / sigma, np.minimum(freedom, 1e6))
    return BlockTest(difference, sigma, p_values, allowed, family_level / p_values.size)


def mean_ratio(ours: Array, reference: Array) -> tuple[float, float]:
    """Ratio of the means of two stacks over all pixels and channels, and its standard error (from
    the runs of each).
    """
    a, b = ours.mean((1, 2, 3)), reference.mean((1, 2, 3))
    ratio = a.mean() / b.mean()
    relative = a.var(ddof=1) / len(a) / a.mean() ** 2 + b.var(ddof=1) / len(b) / b.mean() ** 2
    return float(ratio), float(abs(ratio) * relative**0.5)


def save_pictures(folder: Path, name: str, ours: Array, reference: Array) -> None:
    """Write ours, the reference and their signed difference (red: ours is brighter, blue: darker)
    as PNG, row 0 at the bottom.
    """
    from PIL import Image

    folder.mkdir(parents=True, exist_ok=True)
    scale = max(float(np.percentile(reference, 99)), 1e-9)
    difference = (ours - reference).mean(-1) / scale * 5.0
    signed = np.stack(
        [np.clip(difference, 0, 1), np.zeros_like(difference), np.clip(-difference, 0, 1)], -1
    )
    for kind, picture in (("ours", ours / scale), ("reference", reference / scale)):
        _to_png(Image, np.clip(picture, 0, 1) ** (1 / 2.2)).save(folder / f"{name}.{kind}.png")
    _to_png(Image, signed).save(folder / f"{name}.difference.png")


def _to_png(image_module: object, picture: Array) -> object:
    colors = np.broadcast_to(picture[::-1, :, :3], (*picture.shape[:2], 3))
    pixels = (np.nan_to_num(colors) * 255 + 0.5).astype(np.uint8)
    image = image_module.fromarray(pixels)  # type: ignore[attr-defined]
    factor = max(1, 256 // max(pixels.shape[:2]))
    return image.resize((image.width * factor, image.height * factor), 0)
