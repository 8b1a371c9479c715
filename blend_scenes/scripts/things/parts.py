"""Shapes that the textured scenes share: rounded boxes, tubes, turned things, plants."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin

import bpy
import numpy as np
from mathutils import Matrix, Vector

from blend_scenes.scripts import modelling as m

Point = Sequence[float]


def rounded(thing: bpy.types.Object, width: float, segments: int = 2) -> bpy.types.Object:
    """Round its edges; smooth shading with flat sides."""
    bevel = thing.modifiers.new("Round", "BEVEL")
    bevel.width, bevel.segments, bevel.limit_method, bevel.harden_normals = (
        width,
        segments,
        "ANGLE",
        True,
    )
    thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))
    return thing


def box(
    name: str,
    low: Point,
    high: Point,
    material: bpy.types.Material,
    round_by: float = 0.0,
    location: Point = (0.0, 0.0, 0.0),
    turn: float = 0.0,
) -> bpy.types.Object:
    thing = m.add_boxes(name, [(low, high)], material, location, turn)
    return rounded(thing, round_by) if round_by > 0.0 else thing


def boxes(
    name: str,
    parts: Sequence[tuple[Point, Point]],
    material: bpy.types.Material,
    round_by: float = 0.0,
    location: Point = (0.0, 0.0, 0.0),
    turn: float = 0.0,
) -> bpy.types.Object:
    thing = m.add_boxes(name, parts, material, location, turn)
    return rounded(thing, round_by) if round_by > 0.0 else thing


def tube(
    name: str,
    points: Sequence[Point],
    radius: float,
    material: bpy.types.Material,
    location: Point = (0.0, 0.0, 0.0),
    closed: bool = False,
    sides: int = 3,
) -> bpy.types.Object:
    """A round bar along a smooth curve through about `points` (a polygon where sides < 0)."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions, data.bevel_depth, data.bevel_resolution, data.resolution_u = (
        "3D",
        radius,
        abs(sides),
        6,
    )
    data.use_fill_caps = not closed
    spline = data.splines.new("POLY" if sides < 0 else "NURBS")
    spline.points.add(len(points) - 1)
    for place, point in zip(spline.points, points, strict=True):
        place.co = (*point, 1.0)
    if sides > 0:
        spline.order_u, spline.use_endpoint_u = min(4, len(points)), True
    spline.use_cyclic_u, spline.use_smooth = closed, True
    data.materials.append(material)
    return m.add_object(name, data, location)


def circle(radius: float, height: float = 0.0, count: int = 24) -> list[tuple[float, float, float]]:
    return [
        (radius * cos(2 * pi * k / count), radius * sin(2 * pi * k / count), height)
        for k in range(count)
    ]


def vessel(
    profile: Sequence[tuple[float, float]], wall: float, bottom: float
) -> list[tuple[float, float]]:
    """An open vessel's profile for add_lathe from its outside (radius, height, from the foot to the
    rim): the inside is `wall` less.
    """
    outer = [(0.0, profile[0][1]), *profile]
    rim = profile[-1]
    inner = [
        (max(r - wall, 0.002), h) for r, h in reversed(profile[1:-1]) if h > profile[0][1] + bottom
    ]
    floor = profile[0][1] + bottom
    widest = inner[-1][0] if inner else rim[0] - wall
    return [
        *outer,
        (rim[0] - wall * 0.3, rim[1] + wall * 0.35),
        (rim[0] - wall, rim[1]),
        *inner,
        (widest * 0.92, floor + 0.3 * bottom),
        (0.0, floor),
    ]


def turned(
    name: str,
    profile: Sequence[tuple[float, float]],
    material: bpy.types.Material,
    location: Point,
    segments: int = 32,
    smooth: int = 1,
) -> bpy.types.Object:
    """A lathe with a subdivision surface over it."""
    thing = m.add_lathe(name, profile, material, location, segments)
    if smooth:
        modifier = thing.modifiers.new("Smooth", "SUBSURF")
        modifier.levels = modifier.render_levels = smooth
    return thing


def leaves(
    name: str,
    places: Sequence[tuple[Point, Point, float]],
    material: bpy.types.Material,
    width: float = 0.4,
    bend: float = 0.25,
    steps: int = 3,
    location: Point = (0.0, 0.0, 0.0),
) -> bpy.types.Object:
    """Bent leaves with UVs, v along the midrib. places: (foot, direction, length) each."""
    vertices: list[Point] = []
    faces: list[tuple[int, ...]] = []
    uvs: list[tuple[float, float]] = []
    for foot, direction, size in places:
        along = Vector(direction).normalized()
        side = along.cross(Vector((0.0, 0.0, 1.0)))
        side = side.normalized() if side.length > 1e-3 else Vector((1.0, 0.0, 0.0))
        up = side.cross(along)
        first = len(vertices)
        for step in range(steps + 1):
            s = step / steps
            middle = Vector(foot) + along * (size * s) - Vector((0.0, 0.0, bend * size * s * s))
            half = 0.5 * width * size * sin(pi * min(s * 0.9 + 0.08, 1.0)) ** 0.8
            vertices += [
                tuple(middle + side * (k * half) + up * (0.22 * abs(k) * half)) for k in (-1, 0, 1)
            ]
        for step in range(steps):
            for k in (0, 1):
                corner = first + 3 * step + k
                faces.append((corner, corner + 1, corner + 4, corner + 3))
                for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    uvs.append(((k + du) / 2, (step + dv) / steps))
    thing = m.add_mesh(name, vertices, faces, material, smooth=True, location=location)
    thing.data.uv_layers.new(name="UVMap").data.foreach_set("uv", np.array(uvs, np.float32).ravel())
    return thing


def bush(
    count: int, radius: float, height: float, size: float, seed: int, rise: float = 0.5
) -> list[tuple[Point, Point, float]]:
    """Places for `leaves` that fill a dome of the radius and height."""
    rng = np.random.default_rng(seed)
    places = []
    for _ in range(count):
        turn, out = rng.uniform(0.0, 2 * pi), rng.uniform(0.0, 1.0) ** 0.6
        level = rng.uniform(0.15, 1.0)
        reach = radius * out * np.sqrt(max(1.0 - level**2 * 0.8, 0.05))
        foot = (reach * cos(turn), reach * sin(turn), height * level)
        swing = turn + rng.normal(0.0, 0.5)
        places.append(
            (
                foot,
                (cos(swing), sin(swing), rise * rng.uniform(0.3, 1.6)),
                size * rng.uniform(0.7, 1.2),
            )
        )
    return places


def text(
    name: str,
    body: str,
    size: float,
    material: bpy.types.Material,
    matrix: Matrix,
    depth: float = 0.0,
    align: str = "CENTER",
) -> bpy.types.Object:
    """Letters in the x, y plane of `matrix`."""
    data = bpy.data.curves.new(name, "FONT")
    data.body, data.size, data.extrude, data.align_x, data.resolution_u = (
        body,
        size,
        depth,
        align,
        3,
    )
    data.materials.append(material)
    thing = m.add_object(name, data)
    thing.matrix_world = matrix
    return thing
