"""Tangents along a UV map at the corners of triangles, as Cycles has them (MikkTSpace)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..arrays import gathered, read, read_copy
from .mesh import Triangles

MOST_CORNERS = 4
"""Of a face of which Blender makes tangents itself."""
NO_DIRECTION = (1.0, 0.0, 0.0, -1.0)
"""Of corners about which the UV map has no area."""


def mesh_tangents(
    mesh: Any, layer: str, triangles: Callable[[], Triangles]
) -> NDArray[np.float32] | None:
    """(3 T, 4): tangents of corners, in the mesh's coordinates, and the sign of the bitangent.

    layer: the UV map ("": the render-active one). A mesh without any has the coordinates that
    Cycles takes then: those of its points seen from its origin, on a sphere. None: it has no such
    map.
    """
    layer = layer or next((one.name for one in mesh.uv_layers if one.active_render), "")
    if layer not in mesh.uv_layers:
        if layer or len(mesh.uv_layers) > 0:
            return None
        uv = on_sphere(_places(mesh))
        return _corner_tangents(
            mesh, uv[triangles().vertices], triangles(), bpy.app.version >= (5, 0, 0)
        )
    if read(mesh.polygons, "loop_total", np.int32).max(initial=0) > MOST_CORNERS:
        uv = gathered(read(mesh.uv_layers[layer].uv, "vector", np.float32, 2), triangles().corners)
        return _corner_tangents(mesh, uv, triangles())
    mesh.calc_tangents(uvmap=layer)
    values = np.empty((len(mesh.loops), 4), np.float32)
    values[:, :3] = read_copy(mesh.loops, "tangent", np.float32, 3)
    values[:, 3] = read_copy(mesh.loops, "bitangent_sign", np.float32)
    mesh.free_tangents()
    return values[triangles().corners.ravel()]


def _places(mesh: Any) -> NDArray[np.float32]:
    """(V, 3): what Cycles takes the coordinates on the sphere of. Blender 5: where vertices are;
    before: where they were before deformation, as rounded as generated coordinates.
    """
    if bpy.app.version >= (5, 0, 0):
        return read_copy(mesh.vertices, "co", np.float32, 3)
    location = np.array(mesh.texspace_location, np.float32)
    size = np.array(mesh.texspace_size, np.float32)
    scale = np.float32(0.5) / np.where(size != 0.0, size, np.float32(1.0))
    offset = location * scale - np.float32(0.5)
    generated = read_copy(mesh.vertices, "undeformed_co", np.float32, 3) * scale - offset
    return ((generated + offset) * (np.float32(1.0) / scale)).astype(np.float32)


def on_sphere(places: NDArray) -> NDArray[np.float32]:
    """(n, 2): longitude from -Y on and latitude of (n, 3), each from 0 to 1."""
    x, y, z = np.moveaxis(places.astype(np.float64), 1, 0)
    distance = np.sqrt(x * x + y * y + z * z)
    with np.errstate(all="ignore"):
        u = np.where((x == 0.0) & (y == 0.0), 0.0, 0.5 - np.arctan2(x, y) / (2.0 * np.pi))
        v = 1.0 - np.arccos(np.clip(z / distance, -1.0, 1.0)) / np.pi
    return np.where((distance > 0.0)[:, None], np.stack([u, v], axis=1), 0.0).astype(np.float32)


def _corner_tangents(
    mesh: Any, uv: NDArray[np.float32], triangles: Triangles, closed: bool = False
) -> NDArray[np.float32]:
    corners = triangles.positions[triangles.vertices]
    normals = gathered(read(mesh.corner_normals, "vector", np.float32, 3), triangles.corners)
    faces = read(mesh.loop_triangle_polygons, "value", np.int32)
    faces = faces if triangles.kept is None else faces[triangles.kept]
    flat = ~read(mesh.polygons, "use_smooth", np.bool_)[faces]
    own = np.cross(corners[flat, 1] - corners[flat, 0], corners[flat, 2] - corners[flat, 0])
    normals[flat] = _unit(own)[:, None]
    return corner_tangents(corners, normals, uv, closed)


def corner_tangents(
    places: NDArray[np.float32],
    normals: NDArray[np.float32],
    uv: NDArray[np.float32],
    closed: bool = False,
) -> NDArray[np.float32]:
    """(3 T, 4): tangents of the corners of triangles and signs of their bitangents.

    places, normals (T, 3, 3), uv (T, 3, 2): of corners. closed: u of 1 is u of 0. Corners of the
    same place, normal and UV, in triangles with edges in common, share the mean of their directions
    of growing u, in the plane of the normal, by the angle at the corner; mirrored triangles apart.
    Method: Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008.
    """
    p, n, t = (values.astype(np.float64) for values in (places, normals, uv))
    (du1, dv1), (du2, dv2) = np.moveaxis(t[:, 1:] - t[:, :1], 0, 2)
    if closed:
        du1, du2 = du1 - np.round(du1), du2 - np.round(du2)
    area = du1 * dv2 - dv1 * du2
    flat, mirrored = ~(np.abs(area) > 0.0), area < 0.0
    along = dv2[:, None] * (p[:, 1] - p[:, 0]) - dv1[:, None] * (p[:, 2] - p[:, 0])
    along = _unit(np.where(mirrored[:, None], -along, along))
    along[flat] = 0.0

    directions = _unit(_in_plane(np.broadcast_to(along[:, None], p.shape), n))
    ahead, behind = (_unit(_in_plane(np.roll(p, by, axis=1) - p, n)) for by in (-1, 1))
    angles = np.arccos(np.clip((ahead * behind).sum(axis=-1), -1.0, 1.0))

    rows = np.concatenate([places, normals, uv], axis=-1).reshape(-1, 8) + np.float32(0.0)
    keys = np.ascontiguousarray(rows).view(np.dtype((np.void, 32))).ravel()
    shared = np.unique(keys, return_inverse=True)[1].reshape(-1, 3)
    groups, mirrored = _fans(shared, mirrored, flat)
    sums = np.zeros((len(keys), 3))
    np.add.at(sums, groups, (directions * angles[..., None]).reshape(-1, 3))
    tangents = np.empty((len(keys), 4), np.float32)
    tangents[:, :3] = _unit(sums[groups])
    tangents[:, 3] = np.where(np.repeat(mirrored, 3), -1.0, 1.0)
    tangents[(tangents[:, :3] == 0.0).all(axis=1)] = NO_DIRECTION
    return tangents


def _fans(shared: NDArray[np.intp], mirrored: NDArray[np.bool_], flat: NDArray[np.bool_]) -> Any:
    """(3 T,): a number for the corners of each fan of triangles about a vertex, which have edges in
    common and are all mirrored or all not; and (T,) mirrored, where flat triangles, without an area
    in the UV map, are what their neighbours are. shared (T, 3): numbers of vertices.
    """
    starts = np.arange(shared.size)
    ends = np.roll(starts.reshape(-1, 3), -1, axis=1).ravel()
    first, last = shared.ravel()[starts].astype(np.int64), shared.ravel()[ends].astype(np.int64)
    count = np.max(first, initial=0) + 1
    edges, opposites = first * count + last, last * count + first
    order = np.argsort(edges, kind="stable")
    other = order[np.minimum(np.searchsorted(edges[order], opposites), len(order) - 1)]
    edge = np.nonzero(edges[other] == opposites)[0]
    other = other[edge]

    kinds = np.where(flat, -1, mirrored)
    while True:
        told = (kinds[edge // 3] < 0) & (kinds[other // 3] >= 0)
        if not told.any():
            break
        kinds[edge[told] // 3] = kinds[other[told] // 3]

    alike = kinds[edge // 3] == kinds[other // 3]
    edge, other = edge[alike], other[alike]
    a, b = np.concatenate([starts[edge], ends[edge]]), np.concatenate([ends[other], starts[other]])
    groups = starts
    while True:
        before = groups.copy()
        np.minimum.at(groups, a, before[b])
        np.minimum.at(groups, b, before[a])
        groups = groups[groups]
        if np.array_equal(groups, before):
            return groups, kinds == 1


def _in_plane(vectors: NDArray, normals: NDArray) -> NDArray:
    return vectors - normals * (normals * vectors).sum(axis=-1, keepdims=True)


def _unit(vectors: NDArray) -> NDArray:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros(vectors.shape), where=lengths > 0.0)
