"""A mesh -> the same surface in triangles of a wanted size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..scene import Mesh
from ..scene.displacement import Normals
from ..scene.shading import Domain, MeshAttribute
from .catmull_clark import Surface
from .measure import Measure, Wanted, lengths_between
from .split import Pieces, halved

MAX_TRIANGLES = 32_000_000
FLATNESS = 0.15
"""Of a wanted edge: by so much a face of a smooth surface may miss it."""
MAX_CONTROL_FACES = 2_000_000


@dataclass(slots=True)
class Faces:
    """What the triangles of a mesh were before.

    surface   the control mesh, if the surface is smooth; its corners are those of `corners`
    corners   (T, 3) corner of each triangle's corner
    smooth    (T,) bool, triangles that are not shaded flat; None: all
    """

    surface: Surface | None
    corners: NDArray[np.int32]
    smooth: NDArray[np.bool_] | None


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
    fine = _with_values(mesh, faces, pieces, quads)
    smooth = None if faces.smooth is None else _of_triangles(faces, pieces, quads)
    normals = (
        _between(mesh, pieces)
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


def _with_values(mesh: Mesh, faces: Faces, pieces: Pieces, quads: bool) -> Mesh:
    """What `mesh` has at its corners and triangles, taken over by the pieces."""
    triangles = pieces.triangles
    x, y = pieces.places[..., 0], pieces.places[..., 1]
    weights = ((1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y) if quads else (1 - x - y, x, y)

    def at_corners(values: NDArray) -> NDArray:
        """(3 T, K) of values at the corners of the mesh's triangles (3 T, K)."""
        known = _quad_values(faces, values) if quads else values.reshape(-1, 3, values.shape[-1])
        parts = (w[..., None] * known[pieces.source, None, i] for i, w in enumerate(weights))
        mixed = sum(parts, np.float32(0.0)).reshape(-1, values.shape[-1])
        if values.dtype == np.uint8:
            return np.clip(np.rint(mixed), 0, 255).astype(np.uint8)
        return np.asarray(mixed, values.dtype)

    def part(attribute: MeshAttribute) -> MeshAttribute:
        values = attribute.values
        if attribute.domain == Domain.FACE:
            return replace(attribute, values=_of_triangles(faces, pieces, quads, values))
        if attribute.domain == Domain.CORNER:
            return replace(attribute, values=at_corners(values))
        corners = at_corners(values[mesh.triangles.ravel()])
        of_vertices = np.zeros((len(pieces.positions), values.shape[1]), values.dtype)
        of_vertices[triangles.ravel()] = corners
        return replace(attribute, values=of_vertices)

    shading = replace(mesh.shading, attributes=[part(one) for one in mesh.shading.attributes])
    return replace(
        mesh,
        positions=pieces.positions.astype(np.float32),
        triangles=triangles.astype(np.uint32),
        corner_normals=None,
        vertex_normals=None,
        uv=None if mesh.uv is None else at_corners(mesh.uv.reshape(-1, 2)).reshape(-1, 3, 2),
        slots=None
        if mesh.slots is None
        else _of_triangles(faces, pieces, quads, mesh.slots[:, None])[:, 0],
        shading=shading,
        motion=None,
    )


def _quad_values(faces: Faces, values: NDArray) -> NDArray:
    """(L, 4, K) at the corners of the first quads, of values at those of triangles (3 T, K)."""
    surface = faces.surface
    assert surface is not None
    own = np.zeros((len(surface.corners), values.shape[-1]), np.float32)
    own[faces.corners.ravel()] = values
    after = 0.5 * (own + own[surface.next])
    sizes = np.diff(surface.starts)[:, None]
    centre = (np.add.reduceat(own, surface.starts[:-1]) / sizes)[surface.face_of]
    return np.stack([own, after, centre, after[surface.previous]], axis=1)


def _of_triangles(
    faces: Faces, pieces: Pieces, quads: bool, values: NDArray | None = None
) -> NDArray:
    """Of each piece what its triangle has: `values` (T, K), or whether it is smooth."""
    values = faces.smooth if values is None else values
    assert values is not None
    if not quads:
        return values[pieces.source]
    surface = faces.surface
    assert surface is not None
    of_faces = np.zeros((len(surface.starts) - 1, *values.shape[1:]), values.dtype)
    of_faces[surface.face_of[faces.corners[:, 0]]] = values
    return of_faces[surface.face_of[pieces.source]]


def _face_normals(positions: NDArray[np.float32], triangles: NDArray) -> NDArray[np.float64]:
    a, b, c = (positions[triangles[:, i]].astype(np.float64) for i in range(3))
    return np.cross(b - a, c - a)


def _between(mesh: Mesh, pieces: Pieces) -> NDArray[np.float32]:
    """Unit normals of the pieces' vertices, between those of the mesh's own vertices."""
    own = mesh.vertex_normals
    if own is None:
        own = _vertex_normals(mesh.positions, mesh.triangles)
    x, y = pieces.places[..., 0], pieces.places[..., 1]
    corners = mesh.triangles[pieces.source]
    normals = np.empty((len(pieces.positions), 3), np.float32)
    parts = (w[..., None] * own[corners[:, None, i]] for i, w in enumerate((1 - x - y, x, y)))
    normals[pieces.triangles.ravel()] = sum(parts, np.float32(0.0)).reshape(-1, 3)
    size = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(size > 0, normals / np.maximum(size, 1e-30), (0, 0, 1)).astype(np.float32)


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
