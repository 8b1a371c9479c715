"""The bodywork of `car`: sections along its length, subdivided; wheel arches cut out; panes parted.

Metres, the front at +X, the ground at z = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bmesh
import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import parts as p

PAINT, PANE, BLACK = range(3)
AXLES, TRACK, WHEEL = (1.36, -1.36), 0.76, 0.345

# x; heights of bottom, waist, belt, foot of the panes, lower and upper rail, crown; half widths of
# sill, waist, belt, foot of the panes, lower and upper rail.
SECTIONS = (
    (2.16, 0.27, 0.43, 0.55, 0.60, 0.615, 0.62, 0.63, 0.58, 0.66, 0.62, 0.48, 0.36, 0.30),
    (2.02, 0.20, 0.42, 0.60, 0.67, 0.69, 0.70, 0.71, 0.74, 0.82, 0.79, 0.62, 0.48, 0.40),
    (1.72, 0.18, 0.45, 0.68, 0.76, 0.78, 0.79, 0.80, 0.80, 0.89, 0.86, 0.70, 0.52, 0.44),
    (1.36, 0.18, 0.48, 0.74, 0.82, 0.845, 0.855, 0.87, 0.82, 0.92, 0.89, 0.73, 0.54, 0.47),
    (1.00, 0.18, 0.48, 0.79, 0.86, 0.89, 0.90, 0.92, 0.82, 0.90, 0.87, 0.76, 0.60, 0.52),
    (0.78, 0.18, 0.48, 0.82, 0.885, 0.91, 0.925, 0.96, 0.82, 0.89, 0.86, 0.78, 0.71, 0.62),
    (0.70, 0.18, 0.48, 0.83, 0.89, 0.94, 0.96, 1.00, 0.82, 0.89, 0.86, 0.78, 0.705, 0.62),
    (0.10, 0.18, 0.48, 0.85, 0.91, 1.20, 1.24, 1.28, 0.82, 0.885, 0.86, 0.78, 0.62, 0.56),
    (0.00, 0.18, 0.48, 0.86, 0.91, 1.23, 1.27, 1.315, 0.82, 0.885, 0.86, 0.78, 0.61, 0.55),
    (-0.36, 0.18, 0.48, 0.87, 0.92, 1.265, 1.305, 1.355, 0.82, 0.885, 0.865, 0.78, 0.60, 0.54),
    (-0.44, 0.18, 0.48, 0.87, 0.92, 1.265, 1.305, 1.355, 0.82, 0.885, 0.865, 0.78, 0.60, 0.54),
    (-0.95, 0.18, 0.49, 0.89, 0.94, 1.21, 1.255, 1.305, 0.82, 0.90, 0.88, 0.78, 0.60, 0.53),
    (-1.05, 0.18, 0.50, 0.895, 0.95, 1.17, 1.225, 1.275, 0.82, 0.91, 0.89, 0.77, 0.60, 0.53),
    (-1.60, 0.19, 0.52, 0.90, 0.97, 1.00, 1.03, 1.06, 0.81, 0.92, 0.89, 0.74, 0.63, 0.56),
    (-1.70, 0.20, 0.52, 0.90, 0.96, 0.98, 0.99, 1.01, 0.80, 0.91, 0.88, 0.72, 0.60, 0.52),
    (-2.02, 0.25, 0.55, 0.88, 0.94, 0.96, 0.965, 0.975, 0.75, 0.85, 0.82, 0.66, 0.52, 0.44),
    (-2.16, 0.34, 0.58, 0.82, 0.87, 0.885, 0.89, 0.895, 0.64, 0.72, 0.69, 0.54, 0.42, 0.36),
)


def _half(section: Sequence[float]) -> list[tuple[float, float]]:
    """(y, z) from the middle of the bottom to the crown."""
    _, low, z1, z2, z3, z4, z5, top, sill, y1, y2, y3, y4, y5 = section
    return [
        (0.0, low), (sill - 0.12, low), (sill, low + 0.06), (sill + 0.02, low + 0.14), (y1, z1),
        (y2, z2), (y3, z3), (y4, z4), (y5, z5), (0.5 * y5, 0.35 * z5 + 0.65 * top), (0.0, top),
    ]  # fmt: skip


def _stuff(station: int, row: int) -> int:
    """What lies between two sections, in the row from the bottom."""
    if row < 3:
        return BLACK
    side = row == 6 and 6 <= station < 12
    if side:
        return BLACK if station == 9 else PANE
    return PANE if row in (8, 9) and station in (6, 12) else PAINT


def _cage(materials: Sequence[bpy.types.Material]) -> bpy.types.Object:
    rings = []
    for section in SECTIONS:
        half = _half(section)
        ring = [(section[0], y, z) for y, z in half]
        ring += [(section[0], -y, z) for y, z in reversed(half[1:-1])]
        rings.append(ring)
    count, rows = len(rings[0]), len(_half(SECTIONS[0])) - 1
    faces: list[list[int]] = []
    slots: list[int] = []
    for station in range(len(rings) - 1):
        for k in range(count):
            a, b = station * count + k, station * count + (k + 1) % count
            faces.append([a, a + count, b + count, b])
            slots.append(_stuff(station, k if k < rows else count - 1 - k))
    last = (len(rings) - 1) * count
    faces += [[*range(count)], [*reversed(range(last, last + count))]]
    slots += [PAINT, PAINT]
    cage = m.add_mesh("Body", [v for ring in rings for v in ring], faces, materials, slots)
    modifier = cage.modifiers.new("Smooth", "SUBSURF")
    modifier.levels = modifier.render_levels = 3
    return cage


def _applied(thing: bpy.types.Object) -> None:
    """The mesh as its modifiers leave it."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(thing.evaluated_get(depsgraph), depsgraph=depsgraph)
    thing.modifiers.clear()
    thing.data = mesh


def _arches(body: bpy.types.Object, black: bpy.types.Material) -> None:
    for x in AXLES:
        for side in (-1, 1):
            radius = WHEEL + 0.045
            disc = [(0.0, 0.0), (radius, 0.0), (radius, 0.5), (0.0, 0.5)]
            cutter = m.add_lathe("Cutter", disc, black, (x, side * 0.75 + 0.25, WHEEL + 0.015), 64)
            cutter.rotation_euler[0] = np.pi / 2
            cut = body.modifiers.new("Arch", "BOOLEAN")
            cut.operation, cut.object, cut.solver = "DIFFERENCE", cutter, "EXACT"
            if hasattr(cut, "material_mode"):
                cut.material_mode = "TRANSFER"
            bpy.context.view_layer.update()
            _applied(body)
            bpy.data.objects.remove(cutter)


def _part(body: bpy.types.Object, slot: int, name: str) -> bpy.types.Object:
    """The faces of one slot as an object of their own."""
    other = body.copy()
    other.data = body.data.copy()
    other.name = other.data.name = name
    bpy.context.scene.collection.objects.link(other)
    for thing, kept in ((body, False), (other, True)):
        edit = bmesh.new()
        edit.from_mesh(thing.data)
        gone = [face for face in edit.faces if (face.material_index == slot) != kept]
        bmesh.ops.delete(edit, geom=gone, context="FACES")
        edit.to_mesh(thing.data)
        edit.free()
    return other


def _seals(panes: bpy.types.Object, rubber: bpy.types.Material) -> None:
    """A strip of rubber around every pane."""
    edit = bmesh.new()
    edit.from_mesh(panes.data)
    open_edges = {edge for edge in edit.edges if edge.is_boundary}
    while open_edges:
        edge = open_edges.pop()
        line, at = [edge.verts[0]], edge.verts[1]
        while at is not line[0]:
            line.append(at)
            following = next((e for e in at.link_edges if e in open_edges), None)
            if following is None:
                break
            open_edges.remove(following)
            at = following.other_vert(at)
        p.tube("Seal", [v.co[:] for v in line], 0.009, rubber, closed=True, sides=-2)
    edit.free()


def make(
    paint: bpy.types.Material,
    pane: bpy.types.Material,
    black: bpy.types.Material,
    rubber: bpy.types.Material,
) -> Callable[..., Vector]:
    """The body; returns drape(from, direction, offset): the point of it that a ray meets."""
    body = _cage((paint, pane, black))
    bpy.context.view_layer.update()
    _applied(body)
    tree = BVHTree.FromPolygons([v.co for v in body.data.vertices],
                                [f.vertices for f in body.data.polygons])  # fmt: skip
    _arches(body, black)
    panes = _part(body, PANE, "Panes")
    for thing in (body, panes):
        thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))
    split = body.modifiers.new("Edges", "EDGE_SPLIT")
    split.split_angle = 0.7
    thick = panes.modifiers.new("Thick", "SOLIDIFY")
    thick.thickness, thick.offset = 0.005, -1.0
    _seals(panes, rubber)

    def drape(start: Sequence[float], direction: Sequence[float], offset: float = 0.0) -> Vector:
        place, normal, _, _ = tree.ray_cast(Vector(start), Vector(direction))
        if place is None:
            raise ValueError(f"the body is not met from {tuple(start)}")
        return place + normal * offset

    return drape
