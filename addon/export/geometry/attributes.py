"""What shader programs read from meshes and instances beyond the geometry: only what some tree asks
for.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.scene.shading import GENERATED, Domain, GeneratedSpace, MeshAttribute, MeshShading
from ..arrays import read, read_copy
from ..nodes.node import Want
from ..nodes.random_numbers import number_random
from ..report import Report
from .attribute_values import at_vertices, bytes_of, numbers_of
from .curvature import pointiness
from .mesh import Triangles, sound_triangles
from .tangents import mesh_tangents


def mesh_shading(
    mesh: Any,
    name: str,
    wants: dict[int, Want],
    left: NDArray[np.bool_] | None,
    deforms: bool,
) -> MeshShading:
    """What `wants` (by id) of a bpy.types.Mesh; what it does not have is left out. `left`:
    triangles of the rendered ones that count; `deforms`: something may have moved its vertices.
    """
    shading = MeshShading()

    @cache
    def triangles() -> Triangles:  # not every attribute needs them
        found = sound_triangles(mesh, name, Report())
        if found is None:
            raise ValueError(
                f"The mesh '{name}' has lost its triangles while it was exported. Please render "
                "again."
            )
        if left is not None:
            found.corners, found.vertices = found.corners[left], found.vertices[left]
        return found

    for number, want in wants.items():
        found: tuple[Domain, NDArray] | None = None
        if number == GENERATED:
            shading.generated, found = _generated(mesh, deforms)
        elif want.kind == "tangent":
            tangents = mesh_tangents(mesh, want.name, triangles)
            found = None if tangents is None else (Domain.CORNER, tangents)
        elif want.kind == "island":
            found = Domain.FACE, island_randoms(mesh)[triangles().vertices[:, 0], None]
        elif want.kind == "pointiness":
            found = Domain.POINT, pointiness(mesh)[:, None]
        elif want.kind == "color":
            found = _values(mesh, _color_attribute(mesh, want.name), triangles, left)
            if found is None:  # a colour of no alpha; other attributes that are missing have one
                found = Domain.POINT, np.zeros((len(mesh.vertices), 4), np.uint8)
        else:
            found = _values(mesh, mesh.attributes.get(want.name), triangles, left)
        if found is not None:
            shading.attributes.append(MeshAttribute(number, *found))
    return shading


def _generated(mesh: Any, deforms: bool) -> tuple[GeneratedSpace, tuple[Domain, NDArray] | None]:
    """Linear in the position, and a value per vertex where a deformation has moved it from where it
    was.
    """
    location, size = (
        np.array(mesh.texspace_location, np.float64),
        np.array(mesh.texspace_size, np.float64),
    )
    scale = 0.5 / np.where(size != 0.0, size, 1.0)
    offset = 0.5 - location * scale
    space = GeneratedSpace(tuple(scale.tolist()), tuple(offset.tolist()))
    if not deforms:
        return space, None
    now = read(mesh.vertices, "co", np.float32, 3)
    before = read_copy(mesh.vertices, "undeformed_co", np.float32, 3)
    if np.array_equal(now, before):
        return space, None
    return space, (Domain.POINT, (before * scale + offset).astype(np.float32))


def _color_attribute(mesh: Any, name: str) -> Any:
    if name:
        return mesh.attributes.get(name)
    index = mesh.color_attributes.render_color_index
    return mesh.color_attributes[index] if 0 <= index < len(mesh.color_attributes) else None


def _values(
    mesh: Any, attribute: Any, triangles: Callable[[], Triangles], left: NDArray[np.bool_] | None
) -> tuple[Domain, NDArray] | None:
    """A layer's values as the renderer has them, or None for what holds no numbers."""
    if attribute is None or len(attribute.data) == 0:
        return None
    kind = attribute.data_type
    values: NDArray | None = bytes_of(attribute) if kind == "BYTE_COLOR" else numbers_of(attribute)
    if values is None:
        return None
    if attribute.domain == "POINT":
        return Domain.POINT, values
    if attribute.domain == "CORNER":
        return Domain.CORNER, values[triangles().corners.ravel()]
    if attribute.domain == "FACE":
        faces = read(mesh.loop_triangle_polygons, "value", np.int32)
        faces = faces if triangles().kept is None else faces[triangles().kept]
        return Domain.FACE, values[faces if left is None else faces[left]]
    if attribute.domain == "EDGE":
        return Domain.POINT, at_vertices(mesh, values, kind)
    return None


def island_randoms(mesh: Any) -> NDArray[np.float32]:
    """A random number for each vertex, the same within what edges join: that of the vertex which
    stands for the island.

    Which one that is follows Cycles: sets are joined edge by edge, the one of lower rank to the
    other (union by rank).
    """
    count = len(mesh.vertices)
    parents, ranks = list(range(count)), [0] * count

    def root(vertex: int) -> int:
        while parents[vertex] != vertex:
            parents[vertex] = vertex = parents[parents[vertex]]
        return vertex

    for first, second in read_copy(mesh.edges, "vertices", np.int32, 2).tolist():
        a, b = root(first), root(second)
        if a == b:
            continue
        if ranks[a] < ranks[b]:
            a, b = b, a
        parents[b] = a
        ranks[a] += ranks[a] == ranks[b]
    roots = np.array([root(vertex) for vertex in range(count)], np.int64)
    standing = np.unique(roots)
    values = np.zeros(count, np.float32)
    values[standing] = [number_random(int(vertex), 1) for vertex in standing]
    return values[roots]
