"""What a mesh has at its corners, vertices and triangles, at those of its parts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..scene import Mesh
from ..scene.shading import Domain, MeshAttribute
from .catmull_clark import Surface

if TYPE_CHECKING:
    import photon_splat_native


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
    mesh: Mesh,
    faces: Faces,
    pieces: photon_splat_native.Pieces,
    positions: NDArray[np.float32],
    triangles: NDArray[np.uint32],
) -> Mesh:
    """What `mesh` has at its corners and triangles, on the mesh of the pieces."""

    def part(attribute: MeshAttribute) -> MeshAttribute:
        values = attribute.values
        if attribute.domain == Domain.FACE:
            return replace(attribute, values=of_triangles(faces, pieces, values))
        if attribute.domain == Domain.CORNER:
            return replace(attribute, values=mixed_at(faces, pieces, values))
        known = values[mesh.triangles.ravel()]
        return replace(attribute, values=mixed_at(faces, pieces, known, of_vertices=True))

    shading = replace(mesh.shading, attributes=[part(one) for one in mesh.shading.attributes])
    uv = None
    if mesh.uv is not None:
        uv = mixed_at(faces, pieces, mesh.uv.reshape(-1, 2)).reshape(-1, 3, 2)
    slots = None
    if mesh.slots is not None:
        slots = of_triangles(faces, pieces, mesh.slots[:, None])[:, 0]
    return replace(
        mesh,
        positions=positions,
        triangles=triangles,
        corner_normals=None,
        vertex_normals=None,
        uv=uv,
        slots=slots,
        shading=shading,
        motion=None,
    )


def mixed_at(
    faces: Faces, pieces: photon_splat_native.Pieces, values: NDArray, of_vertices: bool = False
) -> NDArray:
    """(N, K) at all corners of the pieces, or at their vertices, of `values` at the corners of the
    mesh's triangles (3 T, K).
    """
    width = values.shape[-1]
    known = values.reshape(-1, 3, width) if faces.surface is None else _quad_values(faces, values)
    mixed = pieces.mixed(np.ascontiguousarray(known, np.float32), of_vertices)
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
    faces: Faces, pieces: photon_splat_native.Pieces, values: NDArray | None = None
) -> NDArray:
    """Of each piece what its triangle has: `values` (T, K), or whether it is smooth."""
    values = faces.smooth if values is None else values
    assert values is not None
    surface = faces.surface
    if surface is None:
        return values[pieces.source]
    of_faces = np.zeros((len(surface.starts) - 1, *values.shape[1:]), values.dtype)
    of_faces[surface.face_of[faces.corners[:, 0]]] = values
    return of_faces[surface.face_of[pieces.source]]
