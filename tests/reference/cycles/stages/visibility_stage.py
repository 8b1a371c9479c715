"""Scenes for cases.py: things that some kinds of ray do not see, and lamps that not everything
shadows. See stage.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import Any

import bpy

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage


def ray_visibility(
    on: str,
    off: Sequence[str],
    transparent: bool = False,
    translucent: bool = False,
    asked: bool = False,
    plastic: bool = False,
) -> None:
    """A mirror, rough metal, a pane of glass and a box on the stage; `on` is not seen by the rays
    `off`.

    on: box, instance (of a collection with the box), instanced (the box of which there is an
    instance), emitter (the only light), lamp, world or sky (the only light; a sky is brighter on
    one side), or collection, whose flags are `indirect_only` and `holdout`; an object's flag may be
    `holdout`, too. translucent: a sheet hangs before the box. asked: the world is another one to
    the camera. plastic: the box is, which scatters in diffuse and glossy lobes at once.
    """
    stage._stage(things=False)
    m.add_sphere(
        "Mirror", 0.3, m.polished_metal("Mirror", (0.9, 0.9, 0.9)), (-0.75, -0.3, 0.32), 48
    )
    metal = _metal("Metal", (0.8, 0.7, 0.5), 0.35)
    m.add_mesh(
        "Plate",
        [(0.5, 0.9, 0.02), (1.4, 0.4, 0.02), (1.4, 0.6, 1.2), (0.5, 1.1, 1.2)],
        [(0, 1, 2, 3)],
        metal,
    )
    pane = [((-0.05, -1.02, 0.03), (0.75, -0.98, 0.6))]
    m.add_boxes("Pane", pane, m.glass("Pane", 1.45))
    box = m.add_boxes(
        "Box",
        [((-0.3, -0.3, 0.0), (0.3, 0.3, 0.8))],
        (_plastic if plastic else m.diffuse)("Red", (0.7, 0.2, 0.15)),
        (0.1, 0.35, 0.05),
        0.4,
    )
    thing: Any = box
    if on in {"instance", "collection"}:
        thing = _in_collection(box, instanced=on == "instance")
    elif on == "instanced":
        _in_collection(box, instanced=True).location = (0.0, 0.75, 0.0)
        bpy.context.scene.collection.objects.link(box)
    if translucent:
        sheet = [(-0.7, -0.75, 0.02), (0.3, -0.75, 0.02), (0.3, -0.65, 0.9), (-0.7, -0.65, 0.9)]
        m.add_mesh("Sheet", sheet, [(0, 1, 2, 3)], _cloth("Sheet", (0.6, 0.8, 0.5)))
    if on == "emitter":
        sheet = [(-0.6, -0.6, 0.0), (0.6, -0.6, 0.0), (0.6, 0.6, 0.0), (-0.6, 0.6, 0.0)]
        thing = m.add_mesh(
            "Sheet",
            sheet,
            [(0, 1, 2, 3)],
            m.emission("Sheet", (1.0, 0.8, 0.6), 4.0),
            location=(-0.2, 0.2, 1.5),
        )
    elif on in {"world", "sky"}:
        m.set_world((0.5, 0.6, 0.8))
        if on == "sky":
            _shade_world()
        if asked:
            _ask_world()
        thing = bpy.context.scene.world.cycles_visibility
    else:
        # Large: what glass and metal make of it, path tracers find by chance.
        lamp = stage._lamp("AREA", 40.0, (-0.4, -0.5, 1.9), (0.0, 0.2, 0.0), size=1.6)
        if on == "lamp":
            thing = lamp
    for flag in off:
        if on == "collection":
            setattr(thing, flag, True)
        elif flag == "holdout":
            thing.is_holdout = True
        else:
            setattr(thing, flag if on in {"world", "sky"} else f"visible_{flag}", False)
    bpy.context.scene.render.film_transparent = transparent


def _plastic(name: str, color: Sequence[float]) -> bpy.types.Material:
    material, tree, output = m._node_material(name)
    node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    node.inputs["Base Color"].default_value = (*color, 1.0)
    node.inputs["Roughness"].default_value = 0.4
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def _cloth(name: str, color: Sequence[float]) -> bpy.types.Material:
    material, tree, output = m._node_material(name)
    node = tree.nodes.new("ShaderNodeBsdfTranslucent")
    node.inputs["Color"].default_value = (*color, 1.0)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def _shade_world() -> None:
    tree = bpy.context.scene.world.node_tree
    (background,) = (node for node in tree.nodes if node.bl_idname == "ShaderNodeBackground")
    gradient = tree.nodes.new("ShaderNodeTexGradient")
    tree.links.new(gradient.outputs["Color"], background.inputs["Color"])
    background.inputs["Strength"].default_value = 2.0


def _ask_world() -> None:
    tree = bpy.context.scene.world.node_tree
    (output,) = (node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputWorld")
    mix, path, other = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("MixShader", "LightPath", "Background")
    )
    other.inputs["Color"].default_value = (0.9, 0.3, 0.1, 1.0)
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(output.inputs["Surface"].links[0].from_socket, mix.inputs[1])
    tree.links.new(other.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def _metal(name: str, color: Sequence[float], roughness: float) -> bpy.types.Material:
    material, tree, output = m._node_material(name)
    node = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Roughness"].default_value = roughness
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def _in_collection(box: bpy.types.Object, instanced: bool) -> Any:
    """The object that makes an instance of the box, or its collection in the view layer."""
    group = bpy.data.collections.new("Group")
    scene = bpy.context.scene.collection
    scene.objects.unlink(box)
    group.objects.link(box)
    if not instanced:
        scene.children.link(group)
        return bpy.context.view_layer.layer_collection.children[group.name]
    stand = m.add_object("Stand", None)
    stand.instance_type, stand.instance_collection = "COLLECTION", group
    stand.location = (0.1, 0.1, 0.0)
    return stand


def lamp_without_shadow(kind: str, energy: float, **options: Any) -> None:
    """A ceiling between the lamp and the stage, a glass ball and a mirror in its light."""
    stage._stage()
    lamp = stage._lamp(kind, energy, **options)
    lamp.data.use_shadow = False
    ceiling = [(-1.0, -1.0, 1.3), (1.0, -1.0, 1.3), (1.0, 1.0, 1.3), (-1.0, 1.0, 1.3)]
    m.add_mesh(
        "Ceiling", ceiling, [(0, 1, 2, 3)], m.diffuse("Ceiling", (0.5, 0.3, 0.6))
    ).visible_camera = False
    m.add_sphere("Mirror", 0.25, m.polished_metal("Mirror", (0.9, 0.9, 0.9)), (0.0, -0.8, 0.25), 48)


def lamp_of_few_bounces(most: int) -> None:
    stage._stage()
    stage._lamp(
        "AREA", 30.0, (0.3, -0.9, 1.7), (0.0, 0.0, 0.0), size=0.4
    ).data.cycles.max_bounces = most


def lamp_without_mis() -> None:
    """A large lamp over a mirror, a rough plate and the stage: light samples alone find it."""
    stage._stage()
    m.add_sphere("Mirror", 0.3, m.polished_metal("Mirror", (0.9, 0.9, 0.9)), (0.0, -0.8, 0.3), 48)
    lamp = stage._lamp(
        "AREA", 30.0, (0.3, -0.6, 1.8), (0.0, 0.0, 0.0), size=0.8, visible_camera=True
    )
    lamp.data.cycles.use_multiple_importance_sampling = False


def shade_in_lamp(radius: float = 0.3, opening: float = 100.0) -> None:
    """A spot of soft falloff inside whose sphere stand a shade and, before it, a small plate."""
    stage._stage()
    stage._lamp(
        "SPOT",
        60.0,
        (0.1, -0.2, 1.5),
        (0.0, 0.0, 0.0),
        spot_size=radians(opening),
        spot_blend=0.4,
        shadow_soft_size=radius,
    )
    grey = m.diffuse("Shade", (0.5, 0.5, 0.5))
    sides = [(-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)]
    corners = [(x, y, z) for z in (-0.12, 0.18) for x, y in sides]
    m.add_mesh(
        "Shade",
        corners,
        [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)],
        grey,
        location=(0.1, -0.2, 1.5),
    )
    plate = [(-0.08, -0.08, 0.0), (0.08, -0.08, 0.0), (0.08, 0.08, 0.0), (-0.08, 0.08, 0.0)]
    m.add_mesh("Plate", plate, [(0, 1, 2, 3)], grey, location=(0.1, -0.2, 1.36))
