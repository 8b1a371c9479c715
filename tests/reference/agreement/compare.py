"""Whether two estimators of a picture agree, each known by two independent halves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
BLOCK = 8
SIGNIFICANT = 4.0
"""Standard errors."""
FIREFLY = 5.0
LEAST = 0.03
"""Of a block's light: less is nothing to be seen."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """mean: ratio to the reference; mean_error: its standard error. off: share of blocks that
    differ. told_over_true: of the RMSE, None where the reference is too noisy to tell it. error:
    the true RMSE over the mean, 0 where noise hides it.
    """

    mean: float
    mean_error: float
    off: float
    told_over_true: float | None
    error: float

    @property
    def mean_agrees(self) -> bool:
        return abs(self.mean - 1.0) < 0.01 + 3.0 * self.mean_error


def blocks(picture: NDArray[np.float64]) -> NDArray[np.float64]:
    """Means of blocks of a picture (height, width, ...)."""
    height, width = (n // BLOCK for n in picture.shape[:2])
    whole = picture[: height * BLOCK, : width * BLOCK]
    return whole.reshape(height, BLOCK, width, BLOCK, *picture.shape[2:]).mean((1, 3))


def agreement(
    splat: tuple[NDArray, NDArray],
    told: NDArray,
    lamps: NDArray,
    reference: tuple[NDArray, NDArray],
) -> Agreement:
    """Pictures are (height, width, 3), of independent seeds. told: the error that the first one
    tells, (height, width). lamps: pixels that see one, (height, width), which are left out: single
    ones at their rims would decide on the error. A firefly counts as `FIREFLY` times the brightest
    thousandth of the reference.
    """
    counted = ~binary_dilation(lamps, iterations=3)
    light = [picture @ LUMINANCE * counted for picture in (*splat, *reference)]
    cap = FIREFLY * float(np.percentile(light[2] + light[3], 99.9)) / 2.0
    clipped = [np.minimum(picture, cap) for picture in light]
    a, b, r, s = (blocks(picture) for picture in clipped)
    ours, reference = (a + b) / 2.0, (r + s) / 2.0
    # Noise of a block: its own two pairs of halves, and those of the whole picture as far as light
    # goes.
    own = ((a - b) ** 2 + (r - s) ** 2) / 4.0
    scale = np.maximum(reference, 0.05 * reference.mean())
    usual = float((own / scale**2).mean())
    noise = np.sqrt(0.5 * own + 0.5 * usual * scale**2)
    off = np.abs(ours - reference) > SIGNIFICANT * noise + LEAST * (
        reference + 0.1 * reference.mean()
    )
    level = reference.mean()
    mean_error = float(np.sqrt(own.mean() / own.size) / level)
    squared = ((light[0] - light[2]) * (light[0] - light[3]))[counted]
    true, known = float(squared.mean()), 3.0 * float(squared.std()) / np.sqrt(squared.size)
    ratio = float(np.sqrt((told[counted] ** 2).mean() / true)) if true > known else None
    error = float(np.sqrt(max(true, 0.0)) / (light[2] + light[3])[counted].mean() * 2.0)
    return Agreement(float(ours.mean() / level), mean_error, float(off.mean()), ratio, error)
