"""One evaluated Blender mesh -> core.scene.Mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.native.library import load
from ...core.scene import Mesh
from ..arrays import gathered, read
from ..report import Report

MAX_SLOT = np.iinfo(np.uint16).max


@dataclass(slots=True)
class Triangles:
    """The triangles of a Blender mesh that are rendered. They may be views of Blender's memory.

    positions (V, 3); corners (T, 3) indices of loops; vertices (T, 3), never a view; kept: mask of
    the mesh's own triangles, None: all.
    """

    positions: NDArray[np.float32]
    corners: NDArray[np.int32]
    vertices: NDArray[np.int32]
    kept: NDArray[np.bool_] | None


def sound_triangles(mesh: Any, name: str, report: Report) -> Triangles | None:
    """The triangles of a bpy.types.Mesh that have an area, or None if there are none. `name` is the
    object that warnings name.
    """
    if len(mesh.polygons) == 0:
        return None
    mesh.calc_loop_triangles()
    positions = read(mesh.vertices, "co", np.float32, 3)
    corners = read(mesh.loop_triangles, "loops", np.int32, 3)
    vertices = gathered(read(mesh.loops, "vertex_index", np.int32), corners)
    kept = sound_part(positions, vertices, name, report)
    if kept is not None:
        if not kept.any():
            return None
        positions = np.where(np.isfinite(positions), positions, np.float32(0.0))
        corners, vertices = corners[kept], vertices[kept]
    return Triangles(positions, corners, vertices, kept)


def export_mesh(
    mesh: Any, name: str, report: Report
) -> tuple[Mesh, NDArray[np.bool_] | None] | None:
    """The triangles of a bpy.types.Mesh without their UV coordinates, and which of its own they are
    (None: all), or None if it has none. `name` is the object that warnings name.
    """
    found = sound_triangles(mesh, name, report)
    if found is None:
        return None
    by_corner, by_vertex = _normals(mesh, found.positions, found.corners, found.vertices)
    exported = Mesh(
        name=mesh.name,
        positions=np.array(found.positions, np.float32),
        triangles=found.vertices.view(np.uint32),
        corner_normals=by_corner,
        vertex_normals=by_vertex,
        slots=_slots(mesh, found.kept),
    )
    return exported, found.kept


def flattened(
    mesh: Mesh, matrix: NDArray[np.float64], name: str, report: Report
) -> tuple[Mesh, NDArray[np.bool_] | None] | None:
    """`mesh` in world space under a `matrix` that squeezes it into a plane, and which triangles are
    left; None if none has an area.
    """
    positions = (mesh.positions @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
    kept = sound_part(positions, mesh.triangles, name, report)
    selection: Any = slice(None) if kept is None else kept
    if kept is not None and not kept.any():
        return None
    flat = Mesh(
        name=mesh.name,
        positions=positions,
        triangles=mesh.triangles[selection],
        uv=None if mesh.uv is None else mesh.uv[selection],
        slots=None if mesh.slots is None else mesh.slots[selection],
    )
    return flat, kept


def sound_part(
    positions: NDArray, vertices: NDArray, name: str, report: Report
) -> NDArray[np.bool_] | None:
    """Mask (T,) of the triangles that have finite corners and an area, or None if all have."""
    if load().all_have_area(
        np.ascontiguousarray(positions, np.float32),
        np.ascontiguousarray(vertices).view(np.uint32),
    ):
        return None
    with np.errstate(all="ignore"):
        normals = scaled_normals(positions, vertices)
        areas = np.abs(normals[0])
        np.maximum(areas, np.abs(normals[1]), out=areas)
        np.maximum(areas, np.abs(normals[2]), out=areas)
        sound = areas > 0.0
        if sound.all() and np.isfinite(areas.max(initial=0.0)):
            return None
    finite = np.isfinite(positions).all(axis=1)[vertices].all(axis=1)
    # The cross product of a huge triangle may overflow: such a triangle is finite and has an area.
    with np.errstate(all="ignore"):
        sound |= ~np.isfinite(areas)
    sound &= finite
    dropped = []
    if count := int(len(finite) - np.count_nonzero(finite)):
        dropped.append(f"{count} with a vertex that is not a finite number")
    if count := int(np.count_nonzero(finite & ~sound)):
        dropped.append(f"{count} without area")
    if dropped:
        report.warn(f"Object {{}}: triangles left out: {', '.join(dropped)}", name)
    return None if sound.all() else sound


def scaled_normals(positions: NDArray, vertices: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """x, y and z (T,) of the triangles' normals, as long as twice their areas."""
    a, b, c = (np.ascontiguousarray(vertices[:, corner], np.intp) for corner in range(3))
    edges = []
    for axis in range(3):
        values = np.ascontiguousarray(positions[:, axis])
        origin = np.take(values, a)
        edges.append((np.take(values, b) - origin, np.take(values, c) - origin))
    (ux, vx), (uy, vy), (uz, vz) = edges
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


def _normals(
    mesh: Any, positions: NDArray, corners: NDArray, vertices: NDArray
) -> tuple[NDArray[np.float32] | None, NDArray[np.float32] | None]:
    """Shading normals of corners (T, 3, 3), or of vertices (V, 3), or neither where Blender shades
    all faces flat.
    """
    domain = mesh.normals_domain
    if domain == "FACE":
        return None, None
    by_vertex = domain == "POINT"
    all_normals = read(
        mesh.vertex_normals if by_vertex else mesh.corner_normals, "vector", np.float32, 3
    )
    sound = not _far_from_unit(all_normals).any()
    if sound and by_vertex:
        return None, np.array(all_normals)
    normals = gathered(all_normals, vertices if by_vertex else corners)
    if sound:
        return normals, None
    bad = _far_from_unit(normals)
    if bad.any():
        normals[bad] = _unit_normals(positions, vertices[bad.any(axis=1)])[
            np.cumsum(bad.any(axis=1))[np.nonzero(bad)[0]] - 1
        ]
    return normals, None


def _far_from_unit(normals: NDArray) -> NDArray[np.bool_]:
    """Of normals (..., 3); those that are not finite are."""
    squares = np.einsum("...i,...i->...", normals, normals)
    return ~((squares > 0.5) & (squares < 2.0))


def _unit_normals(positions: NDArray, vertices: NDArray) -> NDArray[np.float32]:
    normals = np.stack(scaled_normals(positions.astype(np.float64), vertices), axis=1)
    return (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)


def active_uv(mesh: Any, kept: NDArray[np.bool_] | None) -> NDArray[np.float32] | None:
    """The render-active UV map (T, 3, 2) of a bpy.types.Mesh at those of its triangles that are
    `kept` (None: all); coordinates that are not finite become 0.
    """
    layer = next((layer for layer in mesh.uv_layers if layer.active_render), None)
    if layer is None or len(layer.uv) == 0:
        return None
    mesh.calc_loop_triangles()
    corners = read(mesh.loop_triangles, "loops", np.int32, 3)
    if kept is not None:
        corners = corners[kept]
    uv = gathered(read(layer.uv, "vector", np.float32, 2), corners)
    return uv if np.isfinite(uv.sum()) else np.nan_to_num(uv, nan=0.0, posinf=0.0, neginf=0.0)


def _slots(mesh: Any, kept: NDArray | None) -> NDArray[np.uint16] | None:
    attribute = mesh.attributes.get("material_index")
    if attribute is None or attribute.domain != "FACE" or attribute.data_type != "INT":
        return None
    per_face = read(attribute.data, "value", np.int32)
    if not per_face.any():
        return None
    slots = np.clip(
        gathered(per_face, read(mesh.loop_triangle_polygons, "value", np.int32)), 0, MAX_SLOT
    ).astype(np.uint16)
    return slots if kept is None else slots[kept]
