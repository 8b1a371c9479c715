"""A sheet of one closure under one lamp, both placed at random. Runs inside Blender.

One bounce alone: what a picture is wrong by, the closure or the lamp is wrong by.
"""

from __future__ import annotations

import math
import random
from typing import Any

from tests.support import stage

SIZE = (16, 16)
SHADERS = (
    "BsdfPrincipled",
    "BsdfGlass",
    "BsdfRefraction",
    "BsdfAnisotropic",
    "BsdfMetallic",
    "BsdfSheen",
    "BsdfToon",
    "BsdfTranslucent",
    "BsdfDiffuse",
)
THROUGH = ("BsdfPrincipled", "BsdfGlass", "BsdfRefraction", "BsdfTranslucent")
DISTANCE = 6.0


def build(chance: random.Random) -> Any:
    """A scene of its own on an emptied file; returns it."""
    import bpy
    from mathutils import Vector

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    made = stage.scene()
    stage.resize(*SIZE)
    stage.world(0.0)
    kind = chance.choice(SHADERS)
    sheet = stage.plane(half=10.0)
    sheet.rotation_euler = (math.pi if chance.random() < 0.4 else 0.0, 0.0, 0.0)
    sheet.data.materials[0] = _material(chance, kind)

    angle = chance.choice([0.1, 0.6, 1.0, 1.3, chance.uniform(0.0, 1.5)])
    towards = Vector((math.sin(angle), 0.0, math.cos(angle)))
    camera = stage.camera(towards * DISTANCE)
    camera.rotation_euler = (0.0, angle, 0.0)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 0.3

    side = -1.0 if chance.random() < (0.7 if kind in THROUGH else 0.1) else 1.0
    slant, turn = chance.choice([0.1, 1.2, chance.uniform(0.0, 1.5)]), chance.uniform(0.0, 6.28)
    way = Vector(
        (
            math.sin(slant) * math.cos(turn),
            math.sin(slant) * math.sin(turn),
            side * math.cos(slant),
        )
    )
    if chance.random() < 0.4:  # where most of the light goes
        way = -towards if side < 0 else Vector((-towards.x, 0.0, towards.z))
    _lamp(chance, way)
    if chance.random() < 0.25:
        _extremes(chance, sheet.data.materials[0])
    return made


def _lamp(chance: random.Random, way: Any) -> None:
    kind, size = (
        chance.choice(["AREA", "AREA", "POINT", "SUN"]),
        chance.choice([0.1, 0.5, 2.0, 3.0]),
    )
    lamp = stage.lamp(kind, 5.0 if kind == "SUN" else 100.0, way * DISTANCE)
    lamp.rotation_euler = way.to_track_quat("Z", "Y").to_euler()
    if kind == "AREA":
        lamp.data.size = size
    elif kind == "SUN":
        lamp.data.angle = 0.2 * size
    else:
        lamp.data.shadow_soft_size = 0.5 * size


def _material(chance: random.Random, kind: str) -> Any:
    made, tree = stage.empty_material(kind)
    shader = tree.nodes.new(f"ShaderNode{kind}")
    if hasattr(shader, "distribution"):
        kinds = shader.bl_rna.properties["distribution"].enum_items
        shader.distribution = chance.choice([item.identifier for item in kinds])
    for name in ("Color", "Base Color", "Specular Tint", "Coat Tint", "Sheen Tint", "Edge Tint"):
        _put(shader, name, (*(chance.uniform(0.05, 1.0) for _ in range(3)), 1.0))
    one = chance.random  # from 0 to 1
    _put(shader, "Roughness", chance.choice([0.5, 0.9, 1.0, chance.uniform(0.1, 1.0)]))
    _put(shader, "IOR", chance.choice([1.01, 1.1, 1.33, 1.5, 2.4, chance.uniform(1.0, 3.0)]))
    _put(shader, "Anisotropy", chance.choice([0.0, one()]))
    _put(shader, "Size", one())
    _put(shader, "Smooth", one())
    if kind == "BsdfPrincipled":
        clear = chance.random() < 0.5
        _put(shader, "Transmission Weight", chance.choice([1.0, one()]) if clear else 0.0)
        _put(shader, "Thin Wall", clear and chance.random() < 0.3)
        _put(shader, "Metallic", 0.0 if clear else chance.choice([0.0, 0.0, 1.0, one()]))
        for name in ("Coat Weight", "Sheen Weight", "Anisotropic", "Diffuse Roughness"):
            _put(shader, name, chance.choice([0.0, 0.0, one()]))
        for name in ("Coat Roughness", "Sheen Roughness", "Specular IOR Level"):
            _put(shader, name, one())
    if chance.random() < 0.3:
        _tilt(chance, tree, shader)
    stage.surface(tree, shader)
    return made


def _extremes(chance: random.Random, made: Any) -> None:
    """Values at which formulas end, and films."""
    tree = made.node_tree
    shader = next(node for node in tree.nodes if node.type.startswith("BSDF"))
    _put(shader, "IOR", chance.choice([0.7, 0.999, 1.0, 1.0, 1.001, 1.5, 5.0]))
    _put(shader, "Specular IOR Level", chance.choice([0.0, 0.0, 0.5, 1.0]))
    _put(shader, "Thin Film Thickness", chance.choice([0.0, 20.0, 450.0, 1500.0]))
    _put(shader, "Thin Film IOR", chance.choice([1.0, 1.33, 2.0]))
    for name in ("Specular Tint", "Base Color", "Edge Tint"):
        if chance.random() < 0.3:
            _put(shader, name, chance.choice([(0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)]))
    for name in ("Coat IOR", "Subsurface IOR"):
        _put(shader, name, chance.choice([1.0, 1.5, 3.0]))


def _tilt(chance: random.Random, tree: Any, shader: Any) -> None:
    """A normal of its own."""
    normal = tree.nodes.new("ShaderNodeCombineXYZ")
    for socket, value in zip(
        normal.inputs, (chance.uniform(-0.5, 0.5), chance.uniform(-0.5, 0.5), 1.0), strict=True
    ):
        socket.default_value = value
    tree.links.new(normal.outputs[0], shader.inputs["Normal"])


def _put(shader: Any, name: str, value: Any) -> None:
    """Where the shader has such an input: not all versions of Blender do."""
    if name in shader.inputs:
        shader.inputs[name].default_value = value
