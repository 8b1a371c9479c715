"""Scenes with volume grids, for cases.py: clouds and fire over the stage."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import media_stage, stage
from tests.support import vdb

SIZE = 1.2  # m, of a cloud
MIDDLE = (0.0, -0.4, 0.8)


def _volume(path: str, material: Any = None, **placed: Any) -> Any:
    data = bpy.data.volumes.new("Cloud")
    data.filepath = path
    thing = m.add_object("Cloud", data, MIDDLE)
    for name, value in placed.items():
        setattr(thing, name, value)
    if material is not None:
        data.materials.append(material)
    return thing


def _file(count: int = 24, **more: np.ndarray) -> str:
    """A cloud around the origin, with more grids of the same size; _ stands for a blank."""
    voxel = SIZE / (count - 1)
    corner = (-0.5 * SIZE,) * 3
    grids = [vdb.grid("density", vdb.blob(count), voxel, corner)]
    grids += [vdb.grid(name, values, voxel, corner) for name, values in more.items()]
    return vdb.write(vdb.folder() / "cloud.vdb", *grids)


def _material(interpolation: str = "LINEAR", **inputs: Any) -> Any:
    named = {name: inputs.pop(name) for name in list(inputs) if name.endswith("_Attribute")}
    material = media_stage.medium("principled", **inputs)
    node = next(n for n in material.node_tree.nodes if n.type == "PRINCIPLED_VOLUME")
    for name, value in named.items():
        node.inputs[name.replace("_", " ")].default_value = value
    material.cycles.volume_interpolation = interpolation
    return material


def grid_cloud(
    lamp: str = "area",
    space: str = "OBJECT",
    interpolation: str = "LINEAR",
    count: int = 24,
    clipping: float = 0.001,
    placed: dict[str, Any] | None = None,
    **inputs: Any,
) -> None:
    """A cloud from a file. placed: of the object; the rest are inputs of Principled Volume."""
    stage._stage()
    cloud = _volume(
        _file(count),
        _material(interpolation, **({"Density": 6.0, "Color": (0.9, 0.8, 0.6)} | inputs)),
        **(placed or {}),
    )
    cloud.data.render.space, cloud.data.render.clipping = space, clipping
    media_stage._lights(lamp)


def grid_color() -> None:
    """Colours from a grid, some of them above 1."""
    stage._stage()
    x, y, z = vdb.lattice()
    color = np.stack([0.75 + 0.45 * x, 0.5 + 0.5 * y, 0.4 - 0.4 * z], axis=-1)
    material = _material(Density=5.0, Color=(1.0, 0.9, 0.8), Color_Attribute="color")
    _volume(_file(color=color.astype(np.float32)), material)
    media_stage._lights("area")


def grid_fire(count: int = 12) -> None:
    """A black body whose temperature is a grid, within thin smoke."""
    stage._stage()
    heat = vdb.sphere_of(lambda x, y, z: np.exp(-3.0 * (x * x + y * y + 0.3 * z * z)), count)
    material = _material(
        Density=1.0, Color=(0.5, 0.5, 0.5), Blackbody_Intensity=0.4, Temperature=2200.0
    )
    _volume(_file(count, temperature=heat), material)
    media_stage._lights("area")


def _tree(volume: str) -> tuple[Any, Any, Any]:
    """A material with one volume node: its tree and that node."""
    material = media_stage.medium(volume)
    node = next(n for n in material.node_tree.nodes if n.type != "OUTPUT_MATERIAL")
    return material, material.node_tree, node


def grid_attribute(shader: str = "scatter") -> None:
    """Density by an Attribute node and a ramp, light by another one."""
    stage._stage()
    material, tree, node = _tree(shader)
    density, flame = (tree.nodes.new("ShaderNodeAttribute") for _ in range(2))
    density.attribute_name, flame.attribute_name = "density", "flame"
    ramp = tree.nodes.new("ShaderNodeMapRange")
    for name, value in {"From Min": 0.2, "From Max": 0.6, "To Max": 5.0}.items():
        ramp.inputs[name].default_value = value
    tree.links.new(density.outputs["Fac"], ramp.inputs["Value"])
    tree.links.new(ramp.outputs[0], node.inputs["Density"])
    glow, both = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeAddShader")
    glow.inputs["Strength"].default_value = 2.0
    tree.links.new(flame.outputs["Color"], glow.inputs["Color"])
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    for k, one in enumerate((node, glow)):
        tree.links.new(one.outputs[0], both.inputs[k])
    tree.links.new(both.outputs[0], output.inputs["Volume"])
    flames = vdb.sphere_of(
        lambda x, y, z: np.clip(1.0 - 4.0 * ((x - 0.3) ** 2 + y * y + z * z), 0, 1)
    )
    _volume(_file(flame=flames), material)
    media_stage._lights("area")


def grid_info() -> None:
    """Volume Info's outputs, and coordinates of the object and its bounds."""
    stage._stage()
    material, tree, node = _tree("scatter")
    info, place, times = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("VolumeInfo", "TexCoord", "Math")
    )
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    times.operation, times.use_clamp = "MULTIPLY", False
    tree.links.new(place.outputs["Generated"], split.inputs[0])
    tree.links.new(split.outputs[2], times.inputs[0])
    tree.links.new(info.outputs["Density"], times.inputs[1])
    more = tree.nodes.new("ShaderNodeMath")
    more.operation = "MULTIPLY"
    more.inputs[1].default_value = 10.0
    tree.links.new(times.outputs[0], more.inputs[0])
    tree.links.new(more.outputs[0], node.inputs["Density"])
    tree.links.new(info.outputs["Color"], node.inputs["Color"])
    x, y, z = vdb.lattice()
    color = np.stack([0.6 + 0.3 * x, 0.6 - 0.3 * y, 0.5 + 0.0 * z], axis=-1)
    _volume(_file(color=color.astype(np.float32)), material)
    media_stage._lights("area")


def grid_bounds(turn: float = 0.4) -> None:
    """A medium that fills the box around what a grid holds, whatever it holds there."""
    stage._stage()
    material, tree, node = _tree("scatter")
    density = tree.nodes.new("ShaderNodeAttribute")
    density.attribute_name = "density"
    add = tree.nodes.new("ShaderNodeMath")
    add.inputs[1].default_value = 1.5
    tree.links.new(density.outputs["Fac"], add.inputs[0])
    tree.links.new(add.outputs[0], node.inputs["Density"])
    count = 9  # coarse: a voxel of padding shows
    voxel, corner = SIZE / (count - 1), (-0.5 * SIZE,) * 3
    values = vdb.blob(count)
    values[:4] = 0.0005  # below the clipping
    grid = vdb.grid("density", values, voxel, corner, (2, 3, 5))
    path = vdb.write(vdb.folder() / "box.vdb", grid)
    _volume(path, material, rotation_euler=(0.0, 0.0, turn))
    media_stage._lights("area")


def grid_camera_inside() -> None:
    stage._stage()
    _volume(
        _file(),
        _material(Density=0.25, Color=(0.9, 0.9, 0.9)),
        scale=(10.0, 10.0, 10.0),
    ).data.render.space = "WORLD"
    media_stage._lights("point")


def grid_instances() -> None:
    """One file, three objects, one of them mirrored."""
    stage._stage()
    first = _volume(_file(), _material(Density=8.0), location=(-0.7, -0.5, 0.9), scale=(0.6,) * 3)
    for location, scale in (((0.2, -0.2, 0.5), (-0.4, 0.6, 0.5)), ((0.8, -0.8, 1.0), (0.4,) * 3)):
        other = first.copy()
        other.location, other.scale, other.rotation_euler = location, scale, (0.3, 0.5, 0.2)
        bpy.context.scene.collection.objects.link(other)
    media_stage._lights("area")


def grid_in_fog() -> None:
    """A cloud in a box of fog."""
    stage._stage()
    m.add_boxes("Fog", media_stage.WHOLE, media_stage.medium("scatter", Density=0.3))
    _volume(_file(), _material(Density=6.0))
    media_stage._lights("point")


def grid_mesh_to_volume() -> None:
    """A volume object that a modifier fills from a mesh."""
    stage._stage()
    ball = m.add_sphere("Ball", 0.5, m.diffuse("Ball", (0.5, 0.5, 0.5)), MIDDLE, 32)
    ball.hide_render = True
    data = bpy.data.volumes.new("Filled")
    data.materials.append(_material(Density=5.0))
    thing = m.add_object("Filled", data, MIDDLE)
    modifier = thing.modifiers.new("Fill", "MESH_TO_VOLUME")
    modifier.object, modifier.density = ball, 1.0
    modifier.resolution_mode, modifier.voxel_amount = "VOXEL_AMOUNT", 24
    media_stage._lights("area")


def grid_volume_cube() -> None:
    """A volume that geometry nodes of a mesh object make, with a field in it."""
    stage._stage()
    group = bpy.data.node_groups.new("Cube", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    nodes, link = group.nodes, group.links.new
    cube, place, length, ramp = (
        nodes.new(kind)
        for kind in (
            "GeometryNodeVolumeCube",
            "GeometryNodeInputPosition",
            "ShaderNodeVectorMath",
            "ShaderNodeMapRange",
        )
    )
    length.operation = "LENGTH"
    for name, value in {"From Min": 0.7, "From Max": 0.1, "To Max": 4.0}.items():
        ramp.inputs[name].default_value = value
    for name in ("Min", "Max"):
        cube.inputs[name].default_value = ((-0.6,) if name == "Min" else (0.6,)) * 3
    for name in ("Resolution X", "Resolution Y", "Resolution Z"):
        cube.inputs[name].default_value = 20
    link(place.outputs[0], length.inputs[0])
    link(length.outputs["Value"], ramp.inputs["Value"])
    link(ramp.outputs[0], cube.inputs["Density"])
    fill = nodes.new("GeometryNodeSetMaterial")
    fill.inputs["Material"].default_value = _material(Density=2.0)
    link(cube.outputs[0], fill.inputs[0])
    link(fill.outputs[0], nodes.new("NodeGroupOutput").inputs[0])
    base = m.add_mesh(
        "Base", [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)], [(0, 1, 2)], [], location=MIDDLE
    )
    base.modifiers.new("Nodes", "NODES").node_group = group
    media_stage._lights("area")
