"""Planar pieces with UVs in metres, and copies of a thing on many small faces."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import cos, pi, sin

import bpy
import numpy as np
from mathutils import Vector

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import parts as p

Point = Sequence[float]


def sheet(
    name: str,
    polygons: Iterable[Sequence[Point]],
    materials: bpy.types.Material | Sequence[bpy.types.Material],
    slots: Sequence[int] | None = None,
    **more: object,
) -> bpy.types.Object:
    """Flat polygons, counter-clockwise from the front: u runs in metres along the first side."""
    points: list[Point] = []
    faces: list[list[int]] = []
    uvs: list[tuple[float, float]] = []
    for polygon in polygons:
        corners = [Vector(point) for point in polygon]
        along = (corners[1] - corners[0]).normalized()
        up = (corners[1] - corners[0]).cross(corners[-1] - corners[0]).normalized().cross(along)
        faces.append([*range(len(points), len(points) + len(corners))])
        points += corners
        uvs += [((c - corners[0]) @ along, (c - corners[0]) @ up) for c in corners]
    thing = m.add_mesh(name, points, faces, materials, slots, **more)  # type: ignore[arg-type]
    thing.data.uv_layers.new(name="UVMap").data.foreach_set("uv", np.array(uvs, np.float32).ravel())
    return thing


def scattered(
    name: str, thing: bpy.types.Object, places: Iterable[tuple[Point, Point, float]]
) -> bpy.types.Object:
    """Copies of `thing` on small triangles. places: point, what its Z axis points to, scale."""
    rng = np.random.default_rng(len(name))
    points: list[Vector] = []
    for at, normal, scale in places:
        up = Vector(normal).normalized()
        side = up.cross(Vector(rng.normal(size=3))).normalized()
        other = up.cross(side)
        # An instance's scale is the square root of its face's area.
        reach = scale * (4.0 / (3.0 * 3.0**0.5)) ** 0.5
        turns = [2 * pi * k / 3 for k in range(3)]
        points += [Vector(at) + (side * cos(t) + other * sin(t)) * reach for t in turns]
    faces = [(k, k + 1, k + 2) for k in range(0, len(points), 3)]
    cloud = m.add_mesh(name, points, faces, [])
    cloud.instance_type, cloud.use_instance_faces_scale = "FACES", True
    cloud.show_instancer_for_render = False
    thing.parent = cloud
    return cloud


def collected(name: str, things: Iterable[bpy.types.Object]) -> bpy.types.Collection:
    """The things moved into a collection that is seen only where it is placed."""
    made = bpy.data.collections.new(name)
    for thing in things:
        for owner in list(thing.users_collection):
            owner.objects.unlink(thing)
        made.objects.link(thing)
    return made


def placed(
    made: bpy.types.Collection, at: Point, turn: float = 0.0, scale: float = 1.0
) -> bpy.types.Object:
    thing = m.add_object(made.name, None, at, turn)
    thing.instance_type, thing.instance_collection = "COLLECTION", made
    thing.scale = (scale, scale, scale * (0.92 + 0.16 * (turn % 1.0)))
    return thing


def tree(
    name: str, height: float, spread: float, bark: bpy.types.Material, leaf: bpy.types.Material,
    seed: int, size: float = 0.17,
) -> bpy.types.Collection:  # fmt: skip
    """A trunk with branches, each with a ball of twigs of leaves."""
    rng = np.random.default_rng(seed)
    things = []
    trunk = [
        (0.0, 0.0, 0.0),
        (0.06, 0.03, 0.3 * height),
        (-0.05, 0.05, 0.6 * height),
        (0.0, 0.0, 0.9 * height),
    ]
    stem = p.tube(f"{name} trunk", trunk, 0.026 * height, bark, sides=4)
    for point, radius in zip(stem.data.splines[0].points, (1.35, 0.9, 0.6, 0.2), strict=True):
        point.radius = radius
    things.append(stem)
    places = []
    count = 13
    for k in range(count):
        s = 0.34 + 0.64 * (k + 0.5) / count
        turn = 2.4 * k + rng.normal(0.0, 0.3)
        reach = spread * (0.9 * sin(pi * min(1.05 - s * 0.82, 1.0)) + 0.1) * rng.uniform(0.75, 1.05)
        end = Vector((reach * cos(turn), reach * sin(turn), height * (s + 0.06)))
        foot = Vector((0.0, 0.0, height * (s - 0.14)))
        middle = foot.lerp(end, 0.5) + Vector((0.0, 0.0, -0.03 * height))
        branch = p.tube(f"{name} branch", [foot, middle, end], 0.008 * height, bark, sides=3)
        things.append(branch)
        ball = spread * rng.uniform(0.34, 0.46)
        for _ in range(44):
            out = Vector(rng.normal(size=3)).normalized()
            at = end.lerp(foot, 0.15) + out * ball * rng.uniform(0.35, 1.0) ** 0.6
            at.z = end.z + (at.z - end.z) * 0.8
            lean = out + Vector((0.0, 0.0, 0.5)) + Vector(rng.normal(size=3)) * 0.4
            places.append((at, lean, rng.uniform(0.8, 1.25)))
    twig = p.leaves(
        f"{name} twig", p.bush(26, 0.36, 0.34, size, seed + 1, 0.3), leaf, 0.55, 0.25, 2
    )
    crown = scattered(f"{name} crown", twig, places)
    return collected(name, [*things, crown, twig])
