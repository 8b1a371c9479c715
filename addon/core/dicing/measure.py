"""How long edges are, in units of the wanted length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .eye import Eye

SAMPLES = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
UNEVEN = 30.0
"""An edge of more times its wanted length is looked at in several places."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """Edges of `length` pixels, or of so many units of the mesh's own measure without an eye;
    `levels`: how often an edge may be halved.
    """

    length: float
    levels: int
    eye: Eye | None


class Measure:
    """Of a mesh that stands by `matrix`, whose vertices are added as they are made."""

    def __init__(self, wanted: Wanted, matrix: NDArray[np.float64]) -> None:
        self._eye, self._length = wanted.eye, wanted.length
        self._matrix = np.eye(4) if wanted.eye is None else matrix
        self._axes: list[NDArray[np.float64]] = [np.zeros(0)] * 3
        self._sizes = np.zeros(0)

    def add(self, positions: NDArray[np.float64]) -> None:
        """The next vertices (N, 3)."""
        x, y, z = positions.T
        m = self._matrix
        places = [m[i, 0] * x + m[i, 1] * y + m[i, 2] * z + m[i, 3] for i in range(3)]
        if self._eye is None:
            sizes = np.full(len(positions), self._length)
        else:
            sizes = self._length * self._eye.pixel_sizes(np.stack(places, axis=1))
        self._axes = [np.append(a, b) for a, b in zip(self._axes, places, strict=True)]
        self._sizes = np.append(self._sizes, np.maximum(sizes, 1e-30))

    def lengths(self, starts: NDArray, ends: NDArray) -> NDArray[np.float64]:
        """(N,) of edges between vertices; 1: as wanted."""
        squares = np.zeros(len(starts))
        for axis in self._axes:
            squares += np.square(np.take(axis, ends) - np.take(axis, starts))
        metres = np.sqrt(squares)
        sizes = 0.5 * (np.take(self._sizes, starts) + np.take(self._sizes, ends))
        long = np.flatnonzero(metres > UNEVEN * sizes) if self._eye is not None else ()
        if self._eye is not None and len(long):
            # Where a pixel is not the same all along the smallest one counts.
            a, b = (
                np.stack([axis[which[long]] for axis in self._axes], axis=1)
                for which in (starts, ends)
            )
            places = a[:, None] + SAMPLES[:, None] * (b - a)[:, None]
            found = self._eye.pixel_sizes(places.reshape(-1, 3)).reshape(-1, len(SAMPLES))
            sizes[long] = np.maximum(self._length * found.min(axis=1), 1e-30)
        return metres / sizes


def lengths_between(
    wanted: Wanted,
    matrix: NDArray[np.float64],
    starts: NDArray[np.float64],
    ends: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(N,) of edges between positions (N, 3)."""
    measure, order = Measure(wanted, matrix), np.arange(len(starts))
    measure.add(np.concatenate([starts, ends]))
    return measure.lengths(order, order + len(starts))
