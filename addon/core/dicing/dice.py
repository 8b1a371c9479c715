"""A mesh -> the same surface in triangles of a wanted size."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..scene import Mesh
from ..scene.displacement import Normals
from .measure import Measure, Wanted, lengths_between
from .split import Pieces, halved
from .values import Faces, mixed_at, of_triangles, with_values

MAX_TRIANGLES = 32_000_000
FLATNESS = 0.15
"""Of a wanted edge: by so much a face of a smooth surface may miss it."""
MAX_CONTROL_FACES = 2_000_000


def diced(
    mesh: Mesh,
    faces: Faces,
    wanted: Wanted,
    matrix: NDArray[np.float64],
    limit: int = MAX_TRIANGLES,
    go_on: Callable[[], None] = lambda: None,
) -> tuple[Mesh, Normals, bool]:
    """`mesh`, where it stands by `matrix`, in triangles of the wanted size; the normals along which
    it is displaced; and whether it is not as fine as wanted, as it would have more than `limit`
    triangles.
    """
    pieces, levels = _whole(mesh, faces, wanted, matrix, limit, go_on)
    quads = faces.surface is not None
    pieces, complete = halved(pieces, Measure(wanted, matrix), levels, limit, go_on)
    go_on()
    pieces, corners = _in_order_of_use(pieces)
    fine = with_values(mesh, faces, pieces, corners, quads)
    smooth = None if faces.smooth is None else of_triangles(faces, pieces, quads)
    normals = (
        _between(mesh, pieces, corners)
        if faces.surface is None
        else _vertex_normals(fine.positions, fine.triangles)
    )
    if smooth is None or smooth.all():
        fine.vertex_normals, smooth = normals, None
    elif smooth.any():
        flat = _face_normals(fine.positions, fine.triangles)
        flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-30)
        fine.corner_normals = np.where(
            smooth[:, None, None], normals[fine.triangles], flat[:, None]
        ).astype(np.float32)
    return fine, Normals(None, normals, smooth), not complete


def _whole(
    mesh: Mesh,
    faces: Faces,
    wanted: Wanted,
    matrix: NDArray[np.float64],
    limit: int,
    go_on: Callable[[], None],
) -> tuple[Pieces, int]:
    """The triangles before any is halved, and how often an edge may still be."""
    if faces.surface is None:
        count = len(mesh.triangles)
        corners = np.array([(0, 0), (1, 0), (0, 1)], np.float32)
        pieces = Pieces(
            mesh.positions.astype(np.float64),
            mesh.triangles.astype(np.int32),
            np.arange(count, dtype=np.int32),
            np.repeat(corners[None], count, axis=0),
        )
        return pieces, wanted.levels
    surface = faces.surface.refined()
    unit = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
    places = np.repeat(unit[None], len(surface.corners) // 4, axis=0)
    source = np.arange(len(places), dtype=np.int32)
    ends, left = surface.limits(), max(wanted.levels - 1, 0)
    while left and 4 * len(places) <= min(MAX_CONTROL_FACES, limit // 2):
        go_on()
        a, b = ends[surface.ends[:, 0]], ends[surface.ends[:, 1]]
        if not (lengths_between(wanted, matrix, a, b) > 1.0).any():
            break
        finer = surface.refined()
        then, count = finer.limits(), len(ends)
        missed = lengths_between(wanted, matrix, 0.5 * (a + b), then[count : count + len(a)])
        if not (missed > FLATNESS).any() and not surface.half_sharp:
            break
        surface, ends, left = finer, then, left - 1
        places, source = _finer_places(places), np.repeat(source, 4)
    quads = surface.corners.reshape(-1, 4)
    halves = np.array([(0, 1, 2), (0, 2, 3)])
    pieces = Pieces(
        ends,
        quads[:, halves].reshape(-1, 3).astype(np.int32),
        np.repeat(source, 2),
        places[:, halves].reshape(-1, 3, 2),
    )
    return pieces, left


def _finer_places(places: NDArray[np.float32]) -> NDArray[np.float32]:
    """(4 F, 4, 2) of the faces that Surface.refined() makes of quads (F, 4, 2)."""
    after = 0.5 * (places + np.roll(places, -1, axis=1))
    before = np.roll(after, 1, axis=1)
    centre = np.repeat(places.mean(axis=1, keepdims=True), 4, axis=1)
    return np.stack([places, after, centre, before], axis=2).reshape(-1, 4, 2)


def _in_order_of_use(pieces: Pieces) -> tuple[Pieces, NDArray[np.int64]]:
    """With vertices in the order in which triangles name them, so that what is near in space is so
    in memory; and the first corner (of 3 T) that each vertex is at.
    """
    flat = pieces.triangles.ravel()
    first = np.full(len(pieces.positions), -1, np.int64)
    first[flat[::-1]] = np.arange(len(flat) - 1, -1, -1)
    order = np.argsort(first)
    order = order[np.searchsorted(first, 0, sorter=order) :]  # without those that no triangle has
    number = np.zeros(len(first), np.int32)
    number[order] = np.arange(len(order), dtype=np.int32)
    triangles = np.take(number, pieces.triangles)
    moved = Pieces(pieces.positions[order], triangles, pieces.source, pieces.places)
    return moved, first[order]


def _between(mesh: Mesh, pieces: Pieces, first: NDArray[np.int64]) -> NDArray[np.float32]:
    """Unit normals of the pieces' vertices, between those of the mesh's own vertices."""
    own = mesh.vertex_normals
    if own is None:
        own = _vertex_normals(mesh.positions, mesh.triangles)
    faces = Faces(None, np.zeros((0, 3), np.int32), None)
    normals = mixed_at(faces, pieces, False, own[mesh.triangles.ravel()], first)
    size = np.sqrt(np.einsum("ij,ij->i", normals, normals))[:, None]
    return np.where(size > 0, normals / np.maximum(size, 1e-30), (0, 0, 1)).astype(np.float32)


def _face_normals(positions: NDArray[np.float32], triangles: NDArray) -> NDArray[np.float64]:
    a, b, c = (positions[triangles[:, i]].astype(np.float64) for i in range(3))
    return np.cross(b - a, c - a)


def _vertex_normals(positions: NDArray[np.float32], triangles: NDArray) -> NDArray[np.float32]:
    """Unit, weighted by area."""
    count, normals = len(positions), _face_normals(positions, triangles)
    sums = np.stack(
        [
            sum(np.bincount(triangles[:, k], normals[:, i], count) for k in range(3))
            for i in range(3)
        ],
        axis=1,
    )
    size = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(size > 0, sums / np.maximum(size, 1e-300), (0, 0, 1)).astype(np.float32)
