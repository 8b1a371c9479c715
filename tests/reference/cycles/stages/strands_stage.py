"""Scenes for strands.py: curves, hair and points on the stage. See stage.py."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import motion_stage, stage
from tests.reference.cycles.stages.gallery_stage import build_material

PLACE = (0.0, -0.25, 0.0)
KEYS = 6


def strands(
    kind: str = "tuft",
    material: dict[str, Any] | None = None,
    shape: str = "RIBBONS",
    lamp: str = "area",
    skin: dict[str, Any] | None = None,
    subdivisions: int = 2,
    moves: str = "",
    **options: Any,
) -> None:
    """Strands on the stage.

    kind      tuft (curves on a slab), lawn (short ones on the floor), points, hair (of particles
              on a ball), children, or instances (of one tuft, turned and stretched)
    material  of the strands, as gallery.py writes them; skin: of what they grow on
    shape     Cycles' setting
    moves     slide (the object), velocity (an attribute) or bend (what hair grows on)
    lamp      area, point, sun, world or back (behind them)
    options   of the kind
    """
    stage._stage(things=False)
    scene = bpy.context.scene
    scene.camera.data.lens = 66.0
    scene.cycles_curves.shape, scene.cycles_curves.subdivisions = shape, subdivisions
    _lights(lamp)
    made = build_material("Strands", material) if material else m.diffuse("Hair", (0.6, 0.35, 0.2))
    own = build_material("Skin", skin) if skin else m.diffuse("Skin", (0.7, 0.5, 0.4))
    {
        "tuft": _tuft,
        "lawn": _lawn,
        "points": _points,
        "hair": _hair,
        "instances": _instances,
        "generated": _generated,
    }[kind](made, own, **options)
    if moves:
        _move(moves)


def _lights(kind: str) -> None:
    if kind == "area":
        stage._lamp("AREA", 60.0, (1.0, -1.2, 2.2), (0.0, 0.0, 0.3), size=0.8)
    elif kind == "point":
        stage._lamp("POINT", 60.0, (0.9, -1.5, 1.6), shadow_soft_size=0.0)
    elif kind == "sun":
        stage._lamp("SUN", 3.0, aim=(0.9, -0.8, 1.4), angle=0.02)
    elif kind == "back":
        stage._lamp("AREA", 60.0, (-0.4, 1.2, 1.6), (0.0, -0.2, 0.4), size=0.6)
    else:
        m.set_world((0.6, 0.7, 0.9))


def _move(how: str) -> None:
    motion_stage._shutter()
    name = next(n for n in ("Tuft", "Ball", "Points") if n in bpy.data.objects)
    ob = bpy.data.objects[name]
    if how == "slide":
        x, y, z = ob.location
        motion_stage.keyed(ob, "location", (x - 0.5, y, z), (x + 0.5, y, z))
    elif how == "velocity":
        velocity = ob.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
        velocity.data.foreach_set("vector", [6.0, 0.0, 3.0] * len(velocity.data))
    else:
        ob.shape_key_add(name="Basis")
        bent = ob.shape_key_add(name="Bent")
        for point in bent.data:
            point.co.x += 0.8 * (point.co.z + 0.4)
        motion_stage.keyed(bent, "value", 0.0, 1.0)
    bpy.context.scene.frame_set(1)


def _random() -> np.random.Generator:
    return np.random.default_rng(7)


def _roots(count: int, half: float) -> np.ndarray:
    return np.random.default_rng(3).uniform(-half, half, (count, 2))


def curls(count: int, half: float, height: float, curl: float = 0.06) -> np.ndarray:
    """(C, K, 3): strands that stand on a square and curl."""
    random, roots = _random(), _roots(count, half)
    lean, phase = random.normal(0, 0.2, (count, 2)), random.uniform(0, 2 * pi, count)
    tall = height * random.uniform(0.7, 1.0, count)
    keys = np.empty((count, KEYS, 3))
    for k in range(KEYS):
        t = k / (KEYS - 1)
        for axis, turn in enumerate((np.cos, np.sin)):
            keys[:, k, axis] = (
                roots[:, axis]
                + lean[:, axis] * tall * t * t
                + curl * t * turn(phase + 2 * pi * t)
                - curl * t * turn(phase)
            )
        keys[:, k, 2] = tall * t
    return keys


def add_curves(
    name: str,
    keys: np.ndarray,
    radii: np.ndarray,
    material: bpy.types.Material,
    attributes: bool = False,
) -> bpy.types.Object:
    """keys (C, K, 3), radii (C, K). attributes: a colour of each curve, a number of each key and
    a place on a map.
    """
    data = bpy.data.hair_curves.new(name)
    data.add_curves([keys.shape[1]] * len(keys))
    data.position_data.foreach_set("vector", keys.astype(np.float32).ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", radii.astype(np.float32).ravel())
    if attributes:
        random = _random()
        color = data.attributes.new("tint", "FLOAT_COLOR", "CURVE")
        color.data.foreach_set("color", random.uniform(0.1, 0.9, (len(keys), 4)).ravel())
        along = data.attributes.new("along", "FLOAT", "POINT")
        along.data.foreach_set("value", np.tile(np.linspace(0, 1, keys.shape[1]), len(keys)))
        place = data.attributes.new("map", "FLOAT2", "CURVE")
        place.data.foreach_set("vector", random.uniform(0, 1, (len(keys), 2)).ravel())
    data.materials.append(material)
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def _tuft(
    material: bpy.types.Material,
    skin: bpy.types.Material,
    count: int = 90,
    height: float = 0.9,
    root: float = 0.022,
    tip: float = 0.004,
    attributes: bool = False,
    turned: bool = False,
    stretched: bool = False,
) -> bpy.types.Object:
    keys = curls(count, 0.4, height)
    radii = np.broadcast_to(np.linspace(root, tip, KEYS), keys.shape[:2])
    m.add_boxes("Slab", [((-0.5, -0.5, 0.0), (0.5, 0.5, 0.15))], skin, PLACE, 0.0)
    ob = add_curves("Tuft", keys, radii, material, attributes)
    ob.location = (PLACE[0], PLACE[1], 0.13)
    if turned:
        ob.rotation_euler, ob.scale = (0.4, 0.2, 0.8), (0.8, 0.8, 0.8)
    if stretched:
        ob.scale = (1.2, 0.7, 0.9)
    return ob


def _lawn(material: bpy.types.Material, skin: bpy.types.Material, count: int = 500) -> None:
    """Blades on the floor, and a block that hovers among them."""
    keys = curls(count, 1.2, 0.3, 0.03)
    radii = np.broadcast_to(np.linspace(0.02, 0.003, KEYS), keys.shape[:2])
    add_curves("Lawn", keys, radii, material)
    m.add_boxes("Block", [((-0.3, -0.3, 0.12), (0.3, 0.3, 0.7))], skin, PLACE, 0.4)


def _points(
    material: bpy.types.Material,
    skin: bpy.types.Material,
    count: int = 60,
    stretched: bool = False,
    attributes: bool = False,
) -> None:
    random = _random()
    data = bpy.data.pointclouds.new("Points")
    data.resize(count)
    places = random.uniform((-0.7, -0.6, 0.1), (0.7, 0.5, 1.1), (count, 3))
    data.attributes["position"].data.foreach_set("vector", places.astype(np.float32).ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", random.uniform(0.03, 0.14, count))
    if attributes:
        color = data.attributes.new("tint", "FLOAT_COLOR", "POINT")
        color.data.foreach_set("color", random.uniform(0.1, 0.9, (count, 4)).ravel())
    data.materials.append(material)
    ob = bpy.data.objects.new("Points", data)
    ob.location = PLACE
    if stretched:
        ob.rotation_euler, ob.scale = (0.2, 0.3, 0.5), (1.3, 0.7, 0.9)
    bpy.context.scene.collection.objects.link(ob)


def _ball(material: bpy.types.Material, skin: bpy.types.Material) -> bpy.types.Object:
    rings, segments, radius = 12, 24, 0.4
    angles = [
        (pi * (0.02 + 0.96 * i / rings), 2 * pi * k / segments)
        for i in range(rings + 1)
        for k in range(segments + 1)
    ]
    places = [
        (radius * sin(a) * cos(b), radius * sin(a) * sin(b), radius * cos(a)) for a, b in angles
    ]
    row = segments + 1
    faces = [
        (i * row + k, (i + 1) * row + k, (i + 1) * row + k + 1, i * row + k + 1)
        for i in range(rings)
        for k in range(segments)
    ]
    ball = m.add_mesh("Ball", places, faces, skin)
    ball.location = (PLACE[0], PLACE[1], 0.55)
    layer = ball.data.uv_layers.new(name="UVMap")
    for loop, to in zip(ball.data.loops, layer.data, strict=True):
        a, b = angles[loop.vertex_index]
        to.uv = (b / (2 * pi), 1 - a / pi)
    colors = ball.data.color_attributes.new("paint", "BYTE_COLOR", "CORNER")
    corners = np.array([loop.vertex_index for loop in ball.data.loops])
    heights = np.array([vertex.co.z for vertex in ball.data.vertices])[corners] / 0.8 + 0.5
    painted = np.stack((heights, 1 - heights, 0.3 + 0 * heights, 1 + 0 * heights), axis=1)
    colors.data.foreach_set("color", painted.astype(np.float32).ravel())
    ball.data.materials.append(material)
    return ball


def _hair(
    material: bpy.types.Material,
    skin: bpy.types.Material,
    children: str = "NONE",
    hide_emitter: bool = False,
    turned: bool = False,
    shape_of_radius: float = 0.0,
    **settings: Any,
) -> bpy.types.Object:
    ball = _ball(material, skin)
    if turned:
        ball.rotation_euler, ball.scale = (0.3, 0.4, 0.9), (0.9, 0.9, 0.9)
    # All is set before Blender grows it: what comes later may find it grown
    hair = bpy.data.particles.new("Hair")
    given = {
        "type": "HAIR",
        "count": 250,
        "hair_length": 0.35,
        "material": 2,
        "root_radius": 4.0,
        "tip_radius": 0.5,
        "factor_random": 0.03,
        "child_type": children,
        "rendered_child_count": 6,
        "shape": shape_of_radius,
    }
    for name, value in (given | settings).items():
        setattr(hair, name, value)
    modifier = ball.modifiers.new("Hair", "PARTICLE_SYSTEM")
    modifier.particle_system.settings = hair
    modifier.particle_system.seed = 1
    if hide_emitter:
        ball.show_instancer_for_render = False
    bpy.context.view_layer.update()
    return ball


def _instances(material: bpy.types.Material, skin: bpy.types.Material, of: str = "tuft") -> None:
    if of == "tuft":
        first = _tuft(material, skin, count=40, height=0.6)
        first.location = (-0.75, -0.2, 0.0)
        bpy.data.objects.remove(bpy.data.objects["Slab"])
    else:
        first = _hair(material, skin, count=120)
        first.location, first.scale = (-0.8, -0.2, 0.45), (0.6, 0.6, 0.6)
    for x, scale, turn in ((0.05, (0.8, 0.8, 0.8), 0.5), (0.8, (-0.6, 0.9, 0.7), -0.4)):
        other = first.copy()
        other.location = (x, -0.35, first.location.z)
        other.scale, other.rotation_euler = (
            tuple(a * b for a, b in zip(scale, first.scale, strict=True)),
            (0.2, 0.1, turn),
        )
        bpy.context.scene.collection.objects.link(other)


def _generated(material: bpy.types.Material, skin: bpy.types.Material) -> None:
    """Curves and points that geometry nodes make of a mesh, the curves as instances."""
    tree = bpy.data.node_groups.new("Grow", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    names = ("NodeGroupInput", "NodeGroupOutput")
    source, sink = (tree.nodes.new(name) for name in names)
    spread, line, place, together, radius, size, own, points = (
        tree.nodes.new(f"GeometryNode{name}")
        for name in (
            "MeshToPoints",
            "CurvePrimitiveLine",
            "InstanceOnPoints",
            "JoinGeometry",
            "SetCurveRadius",
            "SetPointRadius",
            "SetMaterial",
            "MeshToPoints",
        )
    )
    line.inputs["End"].default_value = (0.1, 0.05, 0.5)
    radius.inputs["Radius"].default_value = 0.03
    size.inputs["Radius"].default_value = 0.09
    own.inputs["Material"].default_value = material
    link = tree.links.new
    link(source.outputs[0], spread.inputs[0])
    link(source.outputs[0], points.inputs[0])
    link(spread.outputs[0], place.inputs["Points"])
    link(line.outputs[0], radius.inputs[0])
    link(radius.outputs[0], place.inputs["Instance"])
    link(points.outputs[0], size.inputs[0])
    link(place.outputs[0], together.inputs[0])
    link(size.outputs[0], together.inputs[0])
    link(together.outputs[0], own.inputs[0])
    link(own.outputs[0], sink.inputs[0])
    corners = [(0.5 * cos(k), 0.5 * sin(k), 0.15 + 0.05 * k) for k in range(7)]
    ob = m.add_mesh("Seeds", corners, [(0, 1, 2), (2, 3, 4), (4, 5, 6)], skin, location=PLACE)
    ob.modifiers.new("Grow", "NODES").node_group = tree
