"""Curves and points that are rendered as such, without triangles."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

SUBDIVISIONS = 4


class StrandShape(StrEnum):
    """`RIBBON`s are flat and face whoever looks at them; `LINEAR` ones are round, and straight from
    key to key.
    """

    RIBBON = "ribbon"
    THICK = "thick"
    LINEAR = "linear"
    POINT = "point"


@dataclass(slots=True)
class Strands:
    """What a mesh has in place of triangles.

    keys          (K, 4) float32 positions and radii, curve after curve
    first         (C + 1,) uint32 the first key of each curve, which has two at the least, and K;
                  None: points
    subdivisions  of a ribbon between two keys
    uv            (C, 2) float32 or None
    slots         (C,) uint16 material slots, or None: all 0
    motion        (S, K, 4) keys at steps of the shutter, or None

    No NaN, no infinity, no radius below 0. Attributes on points have a value for each key, those on
    faces for each curve.
    """

    keys: NDArray[np.float32]
    first: NDArray[np.uint32] | None
    shape: StrandShape
    subdivisions: int = SUBDIVISIONS
    uv: NDArray[np.float32] | None = None
    slots: NDArray[np.uint16] | None = None
    motion: NDArray[np.float32] | None = None

    @property
    def count(self) -> int:
        return len(self.keys) if self.first is None else len(self.first) - 1
