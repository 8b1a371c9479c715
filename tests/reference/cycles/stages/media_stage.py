"""Scenes with participating media, for cases.py: fog around the stage, in boxes, in glass."""

from __future__ import annotations

from typing import Any

import bpy

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage

WHOLE = [((-1.55, -1.55, 0.01), (1.55, 1.45, 2.6))]
CLOUD = [((-0.6, -1.0, 0.3), (0.6, 0.2, 1.1))]
NODES = {
    "scatter": "ShaderNodeVolumeScatter",
    "absorption": "ShaderNodeVolumeAbsorption",
    "principled": "ShaderNodeVolumePrincipled",
    "coefficients": "ShaderNodeVolumeCoefficients",
    "emission": "ShaderNodeEmission",
}


def medium(node: str, surface: str = "", varies: bool = False, **inputs: Any) -> Any:
    """A material with a volume of one node, and of a noise in its density if it `varies`. `phase`
    sets the node's phase function; other names are those of inputs, with _ for blanks.
    """
    material, tree, output = m._node_material(f"Medium {node}")
    volume = tree.nodes.new(NODES[node])
    _fill(volume, inputs)
    tree.links.new(volume.outputs[0], output.inputs["Volume"])
    if varies:
        place, noise = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "TexNoise"))
        ramp = tree.nodes.new("ShaderNodeMapRange")
        noise.inputs["Scale"].default_value = 3.0
        for name, value in {"From Min": 0.4, "From Max": 0.7, "To Max": inputs["Density"]}.items():
            ramp.inputs[name].default_value = value
        tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
        tree.links.new(noise.outputs[0], ramp.inputs["Value"])
        tree.links.new(ramp.outputs[0], volume.inputs["Density"])
    if surface == "glass":
        glass = tree.nodes.new("ShaderNodeBsdfRefraction")
        glass.inputs["Roughness"].default_value = 0.0
        glass.inputs["IOR"].default_value = 1.3
        tree.links.new(glass.outputs[0], output.inputs["Surface"])
    return material


def _fill(node: Any, inputs: dict[str, Any]) -> None:
    if "phase" in inputs:
        node.phase = inputs.pop("phase")
    for name, value in list(inputs.items()):
        socket = node.inputs[name.replace("_", " ")]
        if hasattr(socket.default_value, "__len__"):
            value = (*value, 1.0)[: len(socket.default_value)]
        socket.default_value = value


def _lights(lamp: str) -> None:
    """Lamps by light samples alone: where scattered rays find them as well, Cycles loses some of
    what media scatter twice (4 % by a spherical lamp in fog of 0.5/m, against itself without).
    """
    if lamp == "world":
        m.set_world((0.6, 0.7, 0.9))
        bpy.context.scene.world.cycles.sampling_method = "NONE"
        return
    if lamp == "point":
        light = stage._lamp("POINT", 60.0, stage.HIGH, shadow_soft_size=0.25)
    elif lamp == "spot":
        light = stage._lamp("SPOT", 150.0, (0.9, -0.9, 2.2), (0.0, 0.0, 0.4), shadow_soft_size=0.1)
    elif lamp == "area":
        light = stage._lamp("AREA", 60.0, (0.3, -0.9, 2.2), (0.0, 0.0, 0.0), size=0.6)
    else:
        light = stage._lamp("SUN", 3.0, (0.9, -0.5, 2.0), (0.0, 0.0, 0.0), angle=0.1)
    light.data.cycles.use_multiple_importance_sampling = False


def fog(
    node: str = "scatter",
    box: str = "whole",
    lamp: str = "point",
    surface: str = "",
    unseen: tuple[str, ...] = (),
    **inputs: Any,
) -> None:
    """The stage in a box of fog, or with one in its middle; `unseen`: rays that it hides from."""
    stage._stage()
    boxes = WHOLE if box == "whole" else CLOUD
    made = m.add_boxes("Fog", boxes, medium(node, surface, **inputs))
    for kind in unseen:
        setattr(made, f"visible_{kind}", False)
    _lights(lamp)


def fog_camera_inside(**inputs: Any) -> None:
    """A box that holds the stage and the camera."""
    stage._stage()
    m.add_boxes("Fog", [((-8.0, -8.0, -1.0), (8.0, 8.0, 8.0))], medium("scatter", **inputs))
    _lights("point")


def fog_world(lamp: str = "point", **inputs: Any) -> None:
    """Fog that fills the world."""
    stage._stage()
    _lights(lamp)
    world = bpy.context.scene.world
    world.use_nodes = True
    tree = world.node_tree
    volume = tree.nodes.new(NODES["scatter"])
    _fill(volume, inputs)
    output = next(n for n in tree.nodes if n.type == "OUTPUT_WORLD")
    tree.links.new(volume.outputs[0], output.inputs["Volume"])


def fog_overlapping() -> None:
    """Two boxes of different fogs that share a part of their space. They are grey: of mixed phase
    functions Cycles takes the same share in every channel.
    """
    stage._stage()
    m.add_boxes(
        "Near",
        [((-0.8, -1.0, 0.2), (0.3, 0.2, 1.0))],
        medium("scatter", Color=(0.5, 0.5, 0.5), Density=1.5),
    )
    m.add_boxes(
        "Far",
        [((-0.2, -0.7, 0.4), (0.9, 0.4, 1.3))],
        medium("principled", Color=(0.8, 0.8, 0.8), Density=2.0, Anisotropy=0.4),
    )
    _lights("area")


def fog_in_instances() -> None:
    """One mesh of fog, placed twice, once turned and stretched."""
    stage._stage()
    box = m.add_boxes(
        "Fog", [((-0.3, -0.3, -0.3), (0.3, 0.3, 0.3))], medium("scatter", varies=True, Density=6.0)
    )
    box.location = (-0.5, -0.5, 0.8)
    other = box.copy()
    other.location, other.scale = (0.5, -0.4, 0.6), (1.0, 0.6, 1.6)
    other.rotation_euler = (0.3, 0.2, 0.5)
    bpy.context.scene.collection.objects.link(other)
    _lights("area")
