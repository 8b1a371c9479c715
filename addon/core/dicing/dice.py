"""A mesh -> the same surface in triangles of a wanted size."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..native.library import load
from ..scene import Mesh
from ..scene.displacement import Normals
from .values import Faces, of_triangles, with_values
from .wanted import Wanted

if TYPE_CHECKING:
    import photon_splat_native

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
    complete = pieces.halve(wanted.native(matrix), levels, limit, go_on)
    go_on()
    positions, triangles = pieces.take_mesh()
    fine = with_values(mesh, faces, pieces, positions, triangles)
    smooth = None if faces.smooth is None else of_triangles(faces, pieces)
    normals = (
        _between(mesh, pieces)
        if faces.surface is None
        else load().normals_by_area(positions, triangles)
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
) -> tuple[photon_splat_native.Pieces, int]:
    """The triangles before any is halved, and how often an edge may still be."""
    pieces_of = load().Pieces
    if faces.surface is None:
        count = len(mesh.triangles)
        corners = np.array([(0, 0), (1, 0), (0, 1)], np.float32)
        pieces = pieces_of(
            mesh.positions.astype(np.float64),
            np.ascontiguousarray(mesh.triangles, np.uint32),
            np.arange(count, dtype=np.uint32),
            np.repeat(corners[None], count, axis=0),
        )
        return pieces, wanted.levels
    surface = faces.surface.refined()
    unit = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
    places = np.repeat(unit[None], len(surface.corners) // 4, axis=0)
    source = np.arange(len(places), dtype=np.uint32)
    ends, left, measure = surface.limits(), max(wanted.levels - 1, 0), wanted.native(matrix)
    while left and 4 * len(places) <= min(MAX_CONTROL_FACES, limit // 2):
        go_on()
        a, b = ends[surface.ends[:, 0]], ends[surface.ends[:, 1]]
        if not (measure.lengths(a, b) > 1.0).any():
            break
        finer = surface.refined()
        then, count = finer.limits(), len(ends)
        missed = measure.lengths(0.5 * (a + b), then[count : count + len(a)])
        if not (missed > FLATNESS).any() and not surface.half_sharp:
            break
        surface, ends, left = finer, then, left - 1
        places, source = _finer_places(places), np.repeat(source, 4)
    quads = surface.corners.reshape(-1, 4)
    halves = np.array([(0, 1, 2), (0, 2, 3)])
    pieces = pieces_of(
        ends,
        quads[:, halves].reshape(-1, 3).astype(np.uint32),
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


def _between(mesh: Mesh, pieces: photon_splat_native.Pieces) -> NDArray[np.float32]:
    """Unit normals of the pieces' vertices, between those of the mesh's own vertices."""
    own = mesh.vertex_normals
    if own is None:
        own = load().normals_by_area(mesh.positions, np.ascontiguousarray(mesh.triangles))
    return pieces.mixed(np.ascontiguousarray(own[mesh.triangles], np.float32), True, True)


def _face_normals(positions: NDArray[np.float32], triangles: NDArray) -> NDArray[np.float64]:
    a, b, c = (positions[triangles[:, i]].astype(np.float64) for i in range(3))
    return np.cross(b - a, c - a)
