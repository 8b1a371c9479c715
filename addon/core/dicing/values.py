"""What a mesh has at its corners, vertices and triangles, at those of its parts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..scene import Mesh
from ..scene.shading import Domain, MeshAttribute
from .catmull_clark import Surface
from .split import Pieces


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


def with_values(
    mesh: Mesh, faces: Faces, pieces: Pieces, first: NDArray[np.int64], quads: bool
) -> Mesh:
    """What `mesh` has at its corners and triangles, taken over by the pieces; `first`: a corner of
    each of their vertices.
    """

    def part(attribute: MeshAttribute) -> MeshAttribute:
        values = attribute.values
        if attribute.domain == Domain.FACE:
            return replace(attribute, values=of_triangles(faces, pieces, quads, values))
        if attribute.domain == Domain.CORNER:
            return replace(attribute, values=mixed_at(faces, pieces, quads, values))
        known = values[mesh.triangles.ravel()]
        return replace(attribute, values=mixed_at(faces, pieces, quads, known, first))

    shading = replace(mesh.shading, attributes=[part(one) for one in mesh.shading.attributes])
    uv = None
    if mesh.uv is not None:
        uv = mixed_at(faces, pieces, quads, mesh.uv.reshape(-1, 2)).reshape(-1, 3, 2)
    slots = None
    if mesh.slots is not None:
        slots = of_triangles(faces, pieces, quads, mesh.slots[:, None])[:, 0]
    return replace(
        mesh,
        positions=pieces.positions.astype(np.float32),
        triangles=pieces.triangles.astype(np.uint32),
        corner_normals=None,
        vertex_normals=None,
        uv=uv,
        slots=slots,
        shading=shading,
        motion=None,
    )


def mixed_at(
    faces: Faces,
    pieces: Pieces,
    quads: bool,
    values: NDArray,
    corners: NDArray[np.int64] | None = None,
) -> NDArray:
    """(N, K) at `corners` of the pieces, or at all, of `values` at the corners of the mesh's
    triangles (3 T, K).
    """
    places, source = pieces.places.reshape(-1, 2), np.repeat(pieces.source, 3)
    if corners is not None:
        places, source = places[corners], source[corners]
    x, y = places.T
    weights = ((1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y) if quads else (1 - x - y, x, y)
    known = _quad_values(faces, values) if quads else values.reshape(-1, 3, values.shape[-1])
    mixed = np.zeros((len(x), values.shape[-1]), np.float32)
    for i, weight in enumerate(weights):
        for k in range(mixed.shape[1]):
            mixed[:, k] += weight * np.take(np.ascontiguousarray(known[:, i, k]), source)
    if values.dtype == np.uint8:
        return np.clip(np.rint(mixed), 0, 255).astype(np.uint8)
    return np.asarray(mixed, values.dtype)


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


def of_triangles(
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
