"""Scenes for passes.py. See stage.py."""

from __future__ import annotations

from typing import Any

import bpy

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import media_stage, motion_stage, stage, strands_stage


def switch_on(name: str) -> None:
    """A pass of Cycles, in the present view layer."""
    view_layer = bpy.context.view_layer
    switch = f"use_pass_{name.lower().replace(' ', '_')}"
    for owner in (getattr(view_layer, "cycles", None), view_layer):
        if hasattr(owner, switch):
            setattr(owner, switch, True)
            return


def aovs(kind: str = "COLOR", twice: bool = False, pane: bool = False) -> None:
    """Outputs in a group within a group, both of them with inputs of their own, used twice. What
    they give is read from the place and the outer group's inputs. `twice`: one more in the tree;
    `pane`: behind a pane that lets most of the light through.
    """
    stage._stage()
    aov = bpy.context.view_layer.aovs.add()
    aov.name, aov.type = "Shown", kind
    outer = _outer_group(_inner_group())
    for name, factor in (("Block", 0.5), ("Wedge", 2.0)):
        tree = bpy.data.objects[name].data.materials[0].node_tree
        group = tree.nodes.new("ShaderNodeGroup")
        group.node_tree, group.inputs[0].default_value = outer, factor
    tree = bpy.data.objects["Wedge"].data.materials[0].node_tree
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree, group.mute = outer, True
    if twice:
        own = tree.nodes.new("ShaderNodeOutputAOV")
        own.aov_name, own.inputs["Color"].default_value = "Shown", (0.2, 0.4, 0.1, 1.0)
    if pane:
        _pane(0.95)
    stage._lamp("AREA", 40.0, stage.HIGH, (0.0, 0.0, 0.0), size=0.5)


def _inner_group() -> Any:
    """Gives the pass a colour of its place, as bright as its input says, and that input."""
    tree = _group("Inner")
    given, place, scale, out = (
        tree.nodes.new(name)
        for name in (
            "NodeGroupInput",
            "ShaderNodeNewGeometry",
            "ShaderNodeVectorMath",
            "ShaderNodeOutputAOV",
        )
    )
    scale.operation, out.aov_name = "SCALE", "Shown"
    tree.links.new(place.outputs["Position"], scale.inputs[0])
    tree.links.new(given.outputs[0], scale.inputs["Scale"])
    absolute = tree.nodes.new("ShaderNodeVectorMath")
    absolute.operation = "ABSOLUTE"
    tree.links.new(scale.outputs[0], absolute.inputs[0])
    tree.links.new(absolute.outputs[0], out.inputs["Color"])
    tree.links.new(given.outputs[0], out.inputs["Value"])
    return tree


def _outer_group(inner: Any) -> Any:
    """Twice the inner one would count twice, so that one of them is muted."""
    tree = _group("Outer")
    given, double = tree.nodes.new("NodeGroupInput"), tree.nodes.new("ShaderNodeMath")
    double.operation, double.inputs[1].default_value = "MULTIPLY", 0.7
    tree.links.new(given.outputs[0], double.inputs[0])
    for mute in (False, True):
        group = tree.nodes.new("ShaderNodeGroup")
        group.node_tree, group.mute = inner, mute
        tree.links.new(double.outputs[0], group.inputs[0])
    return tree


def _group(name: str) -> Any:
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    tree.interface.new_socket("Factor", in_out="INPUT", socket_type="NodeSocketFloat")
    return tree


def vectors(of: str, pane: bool = False, panorama: str = "", **options: Any) -> None:
    """A scene of motion_stage.py, or strands, without motion blur. pane: seen through one that lets
    most of the light through; panorama: the camera's kind.
    """
    strands_stage.strands(**options) if of == "strands" else getattr(motion_stage, of)(**options)
    bpy.context.scene.render.use_motion_blur = False
    if pane:
        _pane(0.95)
    if panorama:
        data = bpy.context.scene.camera.data
        data.panorama_type, data.sensor_width = panorama, 24.0
        data.fisheye_fov, data.fisheye_lens = 2.6, 15.0


def ambient(distance: float = 10.0, things: str = "") -> None:
    """The stage and what stands there: materials of many kinds, a pane, bumps, or fog."""
    stage._stage()
    m.set_world((0.2, 0.2, 0.2))
    bpy.context.scene.world.light_settings.distance = distance
    if things == "materials":
        made = {
            "Glass": m.glass("Glass", 1.45),
            "Metal": m.polished_metal("Metal", (0.9, 0.8, 0.6)),
            "Shining": m.emission("Shining", (1.0, 0.7, 0.4), 2.0),
            "Soft": _mixed("BsdfTranslucent", "BsdfGlossy", 0.5),
        }
        for i, (name, material) in enumerate(made.items()):
            m.add_sphere(name, 0.28, material, (-0.9 + 0.6 * i, -0.9, 0.3), 32)
    elif things == "pane":
        _pane()
    elif things == "bumps":
        m.add_sphere("Bumpy", 0.45, motion_stage.MATERIALS["bumpy"](), (0.0, -0.8, 0.45), 48)
    elif things == "fog":
        m.add_boxes("Fog", media_stage.CLOUD, media_stage.medium("scatter", Density=1.5))
    elif things == "no_world":
        bpy.context.scene.world = None


def _pane(clear: float = 0.4) -> None:
    corners = [(-0.7, -0.9, 0.05), (0.5, -0.9, 0.05), (0.5, -1.1, 1.1), (-0.7, -1.1, 1.1)]
    m.add_mesh("Pane", corners, [(0, 1, 2, 3)], _mixed("BsdfDiffuse", "BsdfTransparent", clear))


def _mixed(first: str, second: str, share: float) -> Any:
    material, tree, output = m._node_material(f"{first} {second}")
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = share
    for i, name in enumerate((first, second), start=1):
        shader = tree.nodes.new(f"ShaderNode{name}")
        if name == "BsdfTransparent":
            shader.inputs[0].default_value = (0.9, 0.6, 0.3, 1.0)
        tree.links.new(shader.outputs[0], mix.inputs[i])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return material
