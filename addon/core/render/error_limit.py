"""Ends a render by its estimated error: when the error is estimated, and what of it counts."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

FEWEST_PASSES_TO_STOP = 8
"""Fewest passes before a render may end by its error: the estimate is too rough before."""
OUTLIERS = 0.01
"""Share of the pixels, those of the greatest error, that do not keep a render going which is to be
denoised: single paths of strong light, which the denoiser takes away. In kitchen they are two
thirds of the error after 16 passes.
"""


def next_estimate(passes: int) -> int:
    """The pass after which the error is estimated again. It depends on the number of passes alone,
    so that a render can be repeated.
    """
    return passes + max(1, passes // 4)


def share_of_most(error: NDArray[np.float32]) -> float:
    """RMS of all errors but the greatest, OUTLIERS of them, over that of all."""
    squares = np.square(error.ravel(), dtype=np.float64)
    most = max(1, round(squares.size * (1.0 - OUTLIERS)))
    whole = float(squares.mean())
    kept = float(np.partition(squares, most - 1)[:most].mean())
    return math.sqrt(kept / whole) if whole > 0.0 else 1.0
