"""Volume grids: values in space, in bricks, of which those that hold nothing are left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SIDE = 8
"""Voxels along each side of a brick."""
MOST_VALUES = 1 << 28
"""That many numbers (1 GiB) a grid may hold."""
MOST_BRICKS = 1 << 24
"""As many places for bricks it may have, empty ones included."""
READ_AT_ONCE = 1 << 24  # numbers

Index = tuple[int, int, int]
Read = Callable[[Index, Index], NDArray[np.float32]]


class TooLarge(ValueError):
    """A grid has more values than memory is to be given to."""


@dataclass(slots=True)
class Grid:
    """A grid of C components (1, 3 or 4).

    to_index    (4, 4) from the object's coordinates to voxels
    lower       (3,) voxel where the first brick begins
    table       (X, Y, Z) int32, the brick at each place, -1: none
    values      (B, 512, C) float32 of the bricks' voxels, z fastest; finite
    background  (C,) float32, where there is no brick
    """

    to_index: NDArray[np.float64]
    lower: NDArray[np.int64]
    table: NDArray[np.int32]
    values: NDArray[np.float32]
    background: NDArray[np.float32]


@dataclass(slots=True)
class MeshGrid:
    """A grid that programs of the medium within a mesh read by the id of an attribute."""

    id: int
    grid: Grid


def make_grid(
    read: Read,
    lower: Index,
    upper: Index,
    to_index: NDArray[np.float64],
    background: NDArray[np.float32],
) -> tuple[Grid, int]:
    """A grid of the voxels from `lower` to `upper` (the last ones), and how many numbers were not
    finite and became 0. `read` gives the values (X, Y, Z, C) of X, Y, Z voxels from one on.

    Raises TooLarge.
    """
    first = np.array(lower, np.int64) // SIDE * SIDE
    counts = -(-(np.array(upper, np.int64) + 1 - first) // SIDE)
    width = len(background)
    if np.prod(counts.astype(np.float64)) > MOST_BRICKS:
        raise TooLarge
    table = np.full(tuple(counts.tolist()), -1, np.int32)
    found: list[NDArray[np.float32]] = []
    total = bad = 0
    step = max(1, int(READ_AT_ONCE // (SIDE**3 * width * counts[2])))
    for x in range(counts[0]):
        for y in range(0, int(counts[1]), step):
            rows = min(step, int(counts[1]) - y)
            corner = first + np.array((x, y, 0)) * SIDE
            part = read(
                (int(corner[0]), int(corner[1]), int(corner[2])),
                (SIDE, rows * SIDE, int(counts[2]) * SIDE),
            )
            blocks = (
                part.reshape(SIDE, rows, SIDE, counts[2], SIDE, width)
                .transpose(1, 3, 0, 2, 4, 5)
                .reshape(rows * int(counts[2]), SIDE**3, width)
            )
            kept = (blocks != background).any(axis=(1, 2))
            number = total + np.cumsum(kept) - 1
            table[x, y : y + rows] = np.where(kept, number, -1).reshape(rows, counts[2])
            own = np.ascontiguousarray(blocks[kept], np.float32)
            finite = np.isfinite(own)
            if not finite.all():
                bad += int(np.count_nonzero(~finite))
                own[~finite] = 0.0
            found.append(own)
            total += len(own)
            if total * SIDE**3 * width > MOST_VALUES:
                raise TooLarge
    values = np.concatenate(found) if found else np.zeros((0, SIDE**3, width), np.float32)
    return Grid(to_index, first, table, values, background.astype(np.float32)), bad


def held(grid: Grid, above: float) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """The first and the last voxel (3,) of the box around all that some component of is further
    than `above` from 0; None: none is.
    """
    places = np.argwhere(grid.table >= 0)
    if not len(places):
        return None
    order = grid.table[tuple(places.T)]
    lower, upper = np.full(3, np.iinfo(np.int64).max), np.full(3, np.iinfo(np.int64).min)
    some = False
    for begin in range(0, len(places), 4096):
        part = slice(begin, begin + 4096)
        large = (np.abs(grid.values[order[part]]) > above).any(axis=2)
        cube = large.reshape(-1, SIDE, SIDE, SIDE)
        for axis in range(3):
            others = tuple(k for k in (1, 2, 3) if k != axis + 1)
            brick, voxel = np.nonzero(cube.any(axis=others))
            if len(brick):
                some = True
                at = grid.lower[axis] + places[part][brick, axis] * SIDE + voxel
                lower[axis] = min(lower[axis], int(at.min()))
                upper[axis] = max(upper[axis], int(at.max()))
    return (lower, upper) if some else None


def box(
    corner: NDArray, opposite: NDArray, to_object: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Positions (8, 3) and triangles (12, 3) of a closed box between two corners, moved by a matrix
    (4, 4), front outwards.
    """
    ends = np.stack([corner, opposite]).astype(np.float64)
    corners = np.array([[ends[k & 1, 0], ends[k >> 1 & 1, 1], ends[k >> 2, 2]] for k in range(8)])
    positions = corners @ to_object[:3, :3].T + to_object[:3, 3]
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.uint32)
    if np.linalg.det(to_object[:3, :3]) < 0.0:
        triangles = triangles[:, ::-1]
    return positions.astype(np.float32), np.ascontiguousarray(triangles)
