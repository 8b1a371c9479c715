"""Scenes for cases.py: bodies that light goes into. See stage.py."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import Any

import bpy

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage

PLACE = (0.0, -0.2, 0.5)
WAX = (0.8, 0.5, 0.35)


def body(
    shape: str = "ball",
    node: str = "principled",
    method: str = "RANDOM_WALK",
    lamp: str = "area",
    scale: Sequence[float] = (1.0, 1.0, 1.0),
    texture: str = "",
    share: float = 1.0,
    bump: bool = False,
    **inputs: Any,
) -> None:
    """A body on the stage.

    shape    ball, box, slab (thin), sheet (open), shell (around a lamp) or monkey
    node     principled (Subsurface Weight 1) or subsurface
    lamp     area, sun, world, back (behind the body), away (all light comes by bounces) or inside
    texture  the input that a noise sets, if any
    share    of the node; the rest is diffuse and green
    inputs   of the node, with _ for blanks
    """
    stage._stage(things=False)
    _lights(lamp)
    material = wax(node, method, texture, share, bump, **inputs)
    thing = _shape(shape, material)
    thing.location, thing.scale = PLACE, scale
    bpy.context.scene.camera.data.lens = 80.0


def bodies(**inputs: Any) -> None:
    """One mesh in three places, turned and stretched."""
    stage._stage(things=False)
    _lights("area")
    thing = _shape("box", wax("principled", "RANDOM_WALK", "", 1.0, False, **inputs))
    thing.location, thing.scale = (-0.7, -0.2, 0.35), (0.7, 0.7, 0.7)
    for place, scale, turn in (
        ((0.05, -0.4, 0.3), (0.3, 0.9, 0.6), 0.5),
        ((0.75, -0.1, 0.4), (-0.7, 0.5, 0.8), -0.4),
    ):
        other = thing.copy()
        other.location, other.scale, other.rotation_euler = place, scale, (0.2, 0.1, turn)
        bpy.context.scene.collection.objects.link(other)
    bpy.context.scene.camera.data.lens = 60.0


def wax(
    node: str, method: str, texture: str, share: float, bump: bool, **inputs: Any
) -> bpy.types.Material:
    material, tree, output = m._node_material("Wax")
    if node == "principled":
        shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
        shader.subsurface_method = method
        given = {"Base_Color": WAX, "Subsurface_Weight": 1.0, "Subsurface_Scale": 0.1}
    else:
        shader = tree.nodes.new("ShaderNodeSubsurfaceScattering")
        shader.falloff = method
        given = {"Color": WAX, "Scale": 0.1}
    for name, value in (given | inputs).items():
        socket = shader.inputs[name.replace("_", " ")]
        if hasattr(socket.default_value, "__len__"):
            value = (*value, 1.0)[: len(socket.default_value)]
        socket.default_value = value
    if texture or bump:
        place, noise = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "TexNoise"))
        noise.inputs["Scale"].default_value = 3.0
        tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    if texture:
        tree.links.new(noise.outputs["Color"], shader.inputs[texture])
    if bump:
        bend = tree.nodes.new("ShaderNodeBump")
        bend.inputs["Distance"].default_value = 0.15
        tree.links.new(noise.outputs[0], bend.inputs["Height"])
        tree.links.new(bend.outputs[0], shader.inputs["Normal"])
    last = shader
    if share < 1.0:
        other, last = (tree.nodes.new(f"ShaderNode{name}") for name in ("BsdfDiffuse", "MixShader"))
        other.inputs["Color"].default_value = (0.2, 0.6, 0.3, 1.0)
        last.inputs[0].default_value = share
        tree.links.new(other.outputs[0], last.inputs[1])
        tree.links.new(shader.outputs[0], last.inputs[2])
    tree.links.new(last.outputs[0], output.inputs["Surface"])
    return material


def _lights(lamp: str) -> None:
    if lamp == "world":
        m.set_world((0.6, 0.7, 0.9))
    elif lamp == "sun":
        stage._lamp("SUN", 3.0, aim=(0.9, -0.3, 1.0), angle=radians(6.0))
    elif lamp == "back":
        stage._lamp("AREA", 25.0, (-0.5, 1.3, 1.1), PLACE, size=0.4)
    elif lamp == "away":
        stage._lamp("AREA", 40.0, (0.6, -0.6, 1.6), (1.0, 1.5, 1.4), size=0.3, spread=radians(60.0))
        grey = m.diffuse("Grey", (0.4, 0.4, 0.4))
        m.add_boxes("Screen", [((0.2, -1.0, 1.0), (0.95, 0.3, 1.04))], grey)
    elif lamp == "inside":
        stage._lamp("POINT", 30.0, PLACE, shadow_soft_size=0.05)
    else:
        stage._lamp("AREA", 25.0, (1.0, -1.1, 1.5), PLACE, size=0.4)


def _shape(shape: str, material: bpy.types.Material) -> bpy.types.Object:
    if shape == "ball":
        return m.add_sphere("Body", 0.45, material, PLACE)
    if shape == "box":
        return m.add_boxes("Body", [((-0.4, -0.4, -0.4), (0.4, 0.4, 0.4))], material, turn=0.6)
    if shape == "slab":
        return m.add_boxes("Body", [((-0.6, -0.02, -0.45), (0.6, 0.02, 0.45))], material)
    if shape == "sheet":
        corners = [(-0.6, -0.3, -0.4), (0.6, -0.3, -0.4), (0.6, 0.3, 0.4), (-0.6, 0.3, 0.4)]
        return m.add_mesh("Body", corners, [(0, 1, 2, 3)], material)
    if shape == "shell":
        low, high = (-0.4, -0.4, -0.4), (0.4, 0.4, 0.4)
        outer, faces = m.box_data(low, high)
        inner = [(0.85 * x, 0.85 * y, 0.85 * z) for x, y, z in outer]
        hollow = [tuple(len(outer) + i for i in reversed(face)) for face in faces]
        return m.add_mesh("Body", [*outer, *inner], [*faces, *hollow], material)
    if shape == "monkey":
        bpy.ops.mesh.primitive_monkey_add(size=0.9)
        thing = bpy.context.object
        thing.shadow_terminator_geometry_offset = 0.0  # a trick of Cycles' for coarse meshes
        thing.data.materials.append(material)
        for face in thing.data.polygons:
            face.use_smooth = True
        return thing
    raise ValueError(f"no body is called {shape!r}")
