"""Takes out single pixels that a few paths of strong light have made far too bright: a denoiser
takes them for highlights as soon as the picture around them has little noise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .denoise import LUMINANCE

WINDOW = 2
"""Half the side, in pixels, of the square that a pixel is compared with, and over which the
estimate of the variance has been averaged.
"""
BRIGHTER = 2.0
"""Times the third brightest of the eight neighbours."""
APART = 8.0
"""Deviations by which a speck exceeds that neighbour, as the pixels of the square deviate."""
CAUTION = 12.0
FEWEST_SAMPLES = 2.0
DOUBT = 2.0
"""Factor on the estimated variance: of a single path of strong light the variance equals the square
of what it adds, of two such paths half of that.
"""
COMPANY = 4
"""Half the side, in pixels, of the square in which a speck has company or not."""
ALONE = 1.5
"""Equal specks there that still count as one: a speck brightens its neighbours too."""
OF_MEDIAN = 1.4826
"""Standard deviation of normal numbers over their median absolute deviation."""


def without_specks(
    color: NDArray[np.float32], variance: NDArray[np.float32], samples: float
) -> NDArray[np.float32]:
    """`color` (height, width, 3), linear, where pixels that stand out lose as much of their excess
    as noise explains: of the excess d over the third brightest neighbour max(0, 1 - variance / d^2)
    is left. What is as bright after many paths as after few stays. So does what many specks bring
    together, as that is how much light there is: of what n equal specks around would lose ALONE / n
    goes.

    variance: of the luminance, (height, width), a mean over the square around each pixel, as
    estimated after so many camera samples per pixel. After few of them most pixels stand out
    somewhat, and those that are taken out have to do so by more; after one they are most of the
    light.
    """
    if samples < FEWEST_SAMPLES:
        return color
    picture = color @ np.asarray(LUMINANCE, np.float32)
    third = _third_brightest_neighbour(picture)
    places = np.nonzero((picture > 0.0) & (picture > BRIGHTER * third))
    # Doubles: squares of what fits into a float may not
    light, third = picture[places].astype(np.float64), np.maximum(third[places], 0.0)
    around = _square_around(picture, places)
    deviation = OF_MEDIAN * np.median(np.abs(around - np.median(around, axis=0)), axis=0)
    excess = light - third
    apart = excess > APART * (1.0 + CAUTION / samples) * deviation
    pixels = (2 * WINDOW + 1) ** 2  # all variance of the square may be this one's
    noise = DOUBT * pixels * np.maximum(variance[places].astype(np.float64), 0.0)
    share = np.where(apart, np.maximum(1.0 - noise / np.maximum(excess**2, 1e-300), 0.0), 1.0)
    lost = np.zeros(picture.shape)
    lost[places] = (1.0 - share) * excess
    kept = light - lost[places] * _loneliness(lost)[places]
    result = color.copy()
    result[places] *= (kept / light)[:, None].astype(np.float32)
    return result


def share_taken(color: NDArray[np.float32], calm: NDArray[np.float32]) -> float:
    """Of the light of a picture (height, width, 3), what is not in `calm` any more."""
    weights = np.asarray(LUMINANCE, np.float64)
    before, after = (float(one.sum((0, 1), np.float64) @ weights) for one in (color, calm))
    return (before - after) / before if before > 0.0 else 0.0


def _loneliness(lost: NDArray[np.float64]) -> NDArray[np.float32]:
    """ALONE over the number of equal specks that would say as much as those around each pixel, at
    most 1.
    """
    most = float(np.max(lost, initial=0.0))
    if not most > 0.0:
        return np.ones(lost.shape, np.float32)
    part = (lost / most).astype(np.float32)  # of pictures of many millions of pixels
    total, squares = _sum_around(part), _sum_around(part**2)
    lonely = np.divide(ALONE * squares, total**2, out=np.ones_like(part), where=total**2 > 0.0)
    return np.asarray(np.minimum(lonely, 1.0))


def _sum_around(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Over (2 COMPANY + 1)^2 pixels. No differences: a huge number beside small ones hides none."""
    side = 2 * COMPANY + 1
    height, width = values.shape
    padded = np.pad(values, COMPANY)
    rows = np.zeros((height, padded.shape[1]), np.float32)
    square = np.zeros((height, width), np.float32)
    for k in range(side):
        rows += padded[k : k + height]
    for k in range(side):
        square += rows[:, k : k + width]
    return square


def _third_brightest_neighbour(light: NDArray[np.float32]) -> NDArray[np.float32]:
    """Of the eight around each pixel; pixels at the border are repeated outwards."""
    height, width = light.shape
    padded = np.pad(light, 1, mode="edge")
    best = [np.full_like(light, -np.inf) for _ in range(3)]
    for y in range(3):
        for x in range(3):
            if (y, x) == (1, 1):
                continue
            value = padded[y : y + height, x : x + width]
            for rank, kept in enumerate(best):
                best[rank], value = np.maximum(kept, value), np.minimum(kept, value)
    return best[2]


def _square_around(
    light: NDArray[np.float32], places: tuple[NDArray[np.intp], ...]
) -> NDArray[np.float32]:
    """(pixels of the square but the middle one, places)."""
    padded = np.pad(light, WINDOW, mode="edge")
    rows, columns = places
    side = range(2 * WINDOW + 1)
    return np.stack(
        [padded[rows + y, columns + x] for y in side for x in side if (y, x) != (WINDOW, WINDOW)]
    )
