"""Scenes for motion.py: things that move while the shutter is open. See stage.py.

Frame 1 is rendered. What moves does so from frame 0 to frame 2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import bpy
from mathutils import Vector

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage

PLACE = (0.0, -0.35, 0.45)
FIRST, LAST = 0, 2


def keyed(thing: Any, path: str, first: Any, last: Any) -> None:
    """Animates a property from `first` to `last`; numbers or vectors."""
    for frame, value in ((FIRST, first), (LAST, last)):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)


def _shutter(
    length: float = 1.0,
    position: str = "CENTER",
    curve: str = "",
    rolling: float | None = None,
) -> None:
    """curve: opening or flash, else the shutter opens and closes at once."""
    scene = bpy.context.scene
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = length
    scene.render.motion_blur_position = position
    points = scene.render.motion_blur_shutter_curve.curves[0].points
    ends = {"": (1.0, 1.0), "opening": (0.0, 1.0), "closing": (1.0, 0.0)}[curve]
    while len(points) > 2:
        points.remove(points[1])
    for point, x, y in zip(points, (0.0, 1.0), ends, strict=True):
        point.location, point.handle_type = (x, y), "VECTOR"
    scene.render.motion_blur_shutter_curve.update()
    if rolling is not None:
        scene.cycles.rolling_shutter_type = "TOP"
        scene.cycles.rolling_shutter_duration = rolling


def _signs(vector: str) -> Any:
    """A material whose colours tell turns and places apart."""
    material, tree, output = m._node_material("Signs")
    shader, place, checks = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("BsdfDiffuse", "TexCoord", "TexChecker")
    )
    checks.inputs["Scale"].default_value = 5.0
    checks.inputs["Color1"].default_value = (0.9, 0.3, 0.1, 1.0)
    checks.inputs["Color2"].default_value = (0.1, 0.3, 0.8, 1.0)
    tree.links.new(place.outputs[vector], checks.inputs["Vector"])
    tree.links.new(checks.outputs["Color"], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def _bumpy() -> Any:
    material = m.diffuse("Bumpy", (0.7, 0.6, 0.5))
    tree = material.node_tree
    place, noise, bump = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "TexNoise", "Bump")
    )
    noise.inputs["Scale"].default_value = 4.0
    bump.inputs["Distance"].default_value = 0.2
    shader = next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE")
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], shader.inputs["Normal"])
    return material


def _fog() -> Any:
    from tests.reference.cycles.stages import media_stage

    return media_stage.medium("scatter", Density=4.0, Color=(0.5, 0.7, 0.9))


MATERIALS: dict[str, Callable[[], Any]] = {
    "plain": lambda: m.diffuse("Mover", (0.8, 0.45, 0.2)),
    "mirror": lambda: m.polished_metal("Mover", (0.9, 0.8, 0.6)),
    "glass": lambda: m.glass("Mover", 1.45),
    "shining": lambda: m.emission("Mover", (1.0, 0.7, 0.4), 6.0),
    "object": lambda: _signs("Object"),
    "generated": lambda: _signs("Generated"),
    "bumpy": _bumpy,
    "fog": _fog,
}


def _thing(shape: str, material: Any) -> bpy.types.Object:
    if shape == "ball":
        return m.add_sphere("Mover", 0.3, material, PLACE, 24)
    if shape == "plate":
        corners = [(-0.3, -0.3, 0.0), (0.3, -0.3, 0.0), (0.3, 0.3, 0.0), (-0.3, 0.3, 0.0)]
        return m.add_mesh("Mover", corners, [(0, 1, 2, 3)], material, location=PLACE)
    if shape == "standing":
        box = ((-0.22, -0.22, 0.0), (0.22, 0.22, 0.6))
        return m.add_boxes("Mover", [box], material, (0.1, -0.7, 0.0), 0.4)
    if shape == "tray":
        corners, faces = m.box_data((-0.45, -0.45, 0.0), (0.45, 0.45, 0.3))
        return m.add_mesh(
            "Mover", corners, faces[:1] + faces[2:], material, location=(0.1, -0.7, 0.2)
        )
    return m.add_boxes("Mover", [((-0.22, -0.22, -0.22), (0.22, 0.22, 0.22))], material, PLACE, 0.4)


def _slide(thing: bpy.types.Object, by: Sequence[float] = (0.8, 0.3, 0.2)) -> None:
    place = Vector(thing.location)
    keyed(thing, "location", place - Vector(by), place + Vector(by))


def _turn(thing: bpy.types.Object, first: Sequence[float], last: Sequence[float]) -> None:
    keyed(thing, "rotation_euler", first, last)


def _grow(thing: bpy.types.Object) -> None:
    keyed(thing, "scale", (0.4, 1.2, 0.7), (1.6, 0.8, 1.5))


def _mirrored(thing: bpy.types.Object) -> None:
    thing.scale = (-1.0, 0.8, 1.2)
    _slide(thing)
    _turn(thing, (0.0, 0.0, -0.5), (0.4, 0.0, 1.0))


def _shape_key(thing: bpy.types.Object) -> None:
    thing.shape_key_add(name="Basis")
    bent = thing.shape_key_add(name="Bent")
    for point in bent.data:
        point.co = (
            point.co.x * (1.6 + point.co.z),
            point.co.y * 0.7,
            point.co.z * 1.3 + 0.5 * point.co.x,
        )
    keyed(bent, "value", 0.0, 1.0)


def _shape_key_late(thing: bpy.types.Object) -> None:
    """As it was at the frame itself, other at the end: three keys."""
    _shape_key(thing)
    bent = thing.data.shape_keys.key_blocks["Bent"]
    bent.value = 0.0
    bent.keyframe_insert("value", frame=1)


def _twisted(thing: bpy.types.Object) -> None:
    modifier = thing.modifiers.new("Twist", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis = "TWIST", "Z"
    keyed(modifier, "angle", -1.0, 1.6)


def _velocity(thing: bpy.types.Object) -> None:
    """Nothing is animated: the vertices say how fast they are."""
    found = thing.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    for point, own in zip(thing.data.vertices, found.data, strict=True):
        own.vector = (30.0 * (point.co.z + 0.3), 10.0, 20.0 * point.co.x)


def _parented(thing: bpy.types.Object) -> None:
    stand = m.add_object("Stand", None, (0.2, 0.3, 0.0))
    thing.parent = stand
    _turn(stand, (0.0, 0.0, -0.9), (0.0, 0.0, 0.7))


MOVES: dict[str, Callable[[bpy.types.Object], None]] = {
    "slide": _slide,
    "turn": lambda thing: _turn(thing, (0.0, 0.0, -0.8), (0.0, 0.0, 1.2)),
    "glide": lambda thing: _slide(thing, (0.8, 0.3, 0.0)),
    "tumble": lambda thing: _turn(thing, (-2.0, 0.3, -1.5), (2.4, -0.5, 2.2)),
    "grow": _grow,
    "mirrored": _mirrored,
    "shape": _shape_key,
    "shape_late": _shape_key_late,
    "twist": _twisted,
    "velocity": _velocity,
    "parent": _parented,
    "none": lambda thing: None,
}


def moving(
    move: str = "slide",
    shape: str = "box",
    material: str = "plain",
    light: str = "AREA",
    steps: int = 1,
    blurred: bool = True,
    deform: bool = True,
    seen: bool = True,
    film: bool = False,
    **shutter: Any,
) -> None:
    """A thing that moves over the stage. seen: by the camera; film: transparent."""
    stage._stage()
    if material != "shining":
        _light(light)
    thing = _thing(shape, MATERIALS[material]())
    MOVES[move](thing)
    if move == "shape" and material == "plain":
        _slide(thing, (0.3, 0.0, 0.0))
    thing.cycles.use_motion_blur, thing.cycles.motion_steps = blurred, steps
    thing.cycles.use_deform_motion = deform
    thing.visible_camera = seen
    bpy.context.scene.render.film_transparent = film
    _shutter(**shutter)


def _light(kind: str) -> bpy.types.Object | None:
    if kind == "world":
        m.set_world((0.6, 0.7, 0.9))
        return None
    if kind == "SUN":
        return stage._lamp("SUN", 3.0, aim=(0.6, -0.9, 1.4), angle=0.05)
    if kind == "POINT":
        return stage._lamp("POINT", 60.0, (0.3, -0.7, 1.9), shadow_soft_size=0.02)
    return stage._lamp("AREA", 40.0, (0.3, -0.7, 1.9), (0.0, 0.0, 0.2), size=0.4)


def moving_camera(
    move: str = "slide",
    kind: str = "PERSP",
    fstop: float = 0.0,
    blurred: bool = True,
    thing: bool = False,
    **shutter: Any,
) -> None:
    """The stage from a camera that slides, turns or zooms. thing: one slides with it."""
    stage._stage()
    _light("AREA")
    if thing:
        _slide(_thing("box", MATERIALS["object"]()))
    camera = bpy.context.scene.camera
    data = camera.data
    data.type, data.ortho_scale = kind, 3.2
    if kind == "PANO":
        data.panorama_type = "EQUIRECTANGULAR"
        stage._look((0.1, -1.1, 0.8), (-0.1, 0.3, 0.5))
    if move == "slide":
        _slide(camera, (0.5, 0.2, 0.1))
    elif move == "turn":
        turn = Vector(camera.rotation_euler)
        _turn(camera, turn - Vector((0.1, 0.1, 0.15)), turn + Vector((0.05, 0.3, 0.1)))
    else:
        data.shift_x = 0.1
        keyed(data, "lens", 30.0, 60.0)
    if fstop:
        data.dof.use_dof, data.dof.aperture_fstop, data.dof.focus_distance = True, fstop, 4.5
    camera.cycles.use_motion_blur = blurred
    _shutter(**shutter)


def moving_lamp(position: str = "CENTER") -> None:
    stage._stage()
    lamp = _light("POINT")
    assert lamp is not None
    _slide(lamp)
    _shutter(position=position)


def moving_group(kind: str = "collection") -> None:
    """Instances of things that move: a collection's, or a mesh's at the corners of another."""
    stage._stage()
    _light("AREA")
    small = m.add_boxes(
        "Small", [((-0.12, -0.12, -0.12), (0.12, 0.12, 0.12))], MATERIALS["object"]()
    )
    if kind == "collection":
        group = bpy.data.collections.new("Group")
        bpy.context.scene.collection.objects.unlink(small)
        group.objects.link(small)
        _turn(small, (0.0, 0.0, -0.5), (0.0, 0.9, 0.5))
        for place, by in (
            ((-0.5, -0.6, 0.4), (0.5, 0.0, 0.2)),
            ((0.5, -0.5, 0.5), (0.0, 0.3, 0.4)),
        ):
            stand = m.add_object("Stand", None, place)
            stand.instance_type, stand.instance_collection = "COLLECTION", group
            _slide(stand, by)
    else:
        corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
        base = m.add_mesh(
            "Base", corners, [(0, 1, 2, 3)], m.diffuse("Base", (0.5, 0.5, 0.5)), location=PLACE
        )
        base.instance_type, base.show_instancer_for_render = "VERTS", False
        small.parent = base
        _turn(base, (0.0, 0.3, -0.6), (0.0, -0.3, 0.8))
    _shutter()


def moving_particles() -> None:
    """Balls that an emitter throws, some of which are born or die while the shutter is open."""
    stage._stage()
    _light("AREA")
    ball = m.add_sphere("Ball", 0.07, MATERIALS["plain"](), (9.0, 9.0, 9.0), 12)
    corners = [(-0.5, -0.3, 0.0), (0.5, -0.3, 0.0), (0.5, 0.3, 0.0), (-0.5, 0.3, 0.0)]
    base = m.add_mesh(
        "Base", corners, [(0, 1, 2, 3)], m.diffuse("Base", (0.5, 0.5, 0.5)), location=PLACE
    )
    base.show_instancer_for_render = False
    settings = base.modifiers.new("Fountain", "PARTICLE_SYSTEM").particle_system.settings
    settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 24, -9.0, 3.0, 9.0
    settings.render_type, settings.instance_object = "OBJECT", ball
    settings.particle_size, settings.size_random = 1.0, 0.3
    settings.normal_factor, settings.factor_random = 2.0, 1.5
    scene = bpy.context.scene
    scene.frame_start = -10
    _shutter()
    for frame in range(-10, 2):
        scene.frame_set(frame)
    scene.frame_set(1)


def moving_displaced(move: str = "slide") -> None:
    """A thing that its material displaces slides or changes its shape."""
    from tests.reference.cycles.stages import displacement_stage

    displacement_stage.displaced(shape="box", height="object")
    MOVES[move](bpy.data.objects["Thing"])
    _shutter()
