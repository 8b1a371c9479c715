"""Builds the cases of gallery.py in Blender's current file. Needs bpy.

A diffuse floor and wall, a smooth ball and a second thing, a large area lamp, a dim world.
"""

from __future__ import annotations

from math import radians
from typing import Any

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m

BALL, RADIUS = (-0.52, 0.0, 0.47), 0.46
WATER = {
    "kind": "BsdfGlass",
    "output": 0,
    "modes": {"distribution": "GGX"},
    "inputs": {"IOR": 1.33},
}
GLASS = WATER | {"inputs": {"IOR": 1.5}}
AIR_IN_GLASS = WATER | {"inputs": {"IOR": 1.0 / 1.5}}


def material_case(material: dict[str, Any], second: str, segments: int) -> None:
    """material: a tree of gallery.node. second: a key of SECOND; segments of the ball."""
    m.new_scene(48, 48)
    subject = build_material("Subject", material)
    ground = subject if second == "floor" else m.diffuse("Floor", (0.62, 0.58, 0.5))
    _quad("Floor", [(-2.2, -2.2, 0), (2.2, -2.2, 0), (2.2, 1.3, 0), (-2.2, 1.3, 0)], ground)
    _quad(
        "Wall",
        [(-2.2, 1.3, 0), (2.2, 1.3, 0), (2.2, 1.3, 2.4), (-2.2, 1.3, 2.4)],
        m.diffuse("Wall", (0.45, 0.55, 0.65)),
    )
    ball = m.diffuse("Ball", ORANGE) if second == "floor" else subject
    _with_uv(m.add_sphere("Ball", RADIUS, ball, BALL, segments))
    SECOND[second](subject)
    m.set_world((0.5, 0.65, 1.0), 0.25)
    lamp = m.add_light(
        "Lamp",
        "AREA",
        60.0,
        (0.9, -1.3, 2.4),
        (0.0, 0.1, 0.3),
        shape="RECTANGLE",
        size=1.4,
        size_y=1.0,
    )
    lamp.visible_camera = False
    m.add_camera((0.1, -4.2, 1.9), (0.05, 0.1, 0.48), lens=75.0)


ORANGE = (0.7, 0.4, 0.2)


def _quad(
    name: str, corners: list[tuple[float, float, float]], material: bpy.types.Material
) -> bpy.types.Object:
    return m.add_picture(name, corners, material)


def _with_uv(thing: bpy.types.Object) -> None:
    """Longitude and latitude as UV, without a seam's wrap: each face's corners are mapped around
    its own middle.
    """
    mesh = thing.data
    points = np.array([vertex.co for vertex in mesh.vertices])
    layer = np.empty((len(mesh.loops), 2), np.float32)
    height = points[:, 2].max()
    for face in mesh.polygons:
        corners = points[list(face.vertices)]
        middle = np.arctan2(*corners.mean(0)[1::-1])
        turn = np.arctan2(corners[:, 1], corners[:, 0])
        around = (turn - middle + np.pi) % (2 * np.pi) - np.pi + middle
        around = np.where(np.hypot(corners[:, 0], corners[:, 1]) < 1e-6, middle, around)
        layer[list(face.loop_indices), 0] = around / np.pi + 1.0
        layer[list(face.loop_indices), 1] = (
            np.arcsin(np.clip(corners[:, 2] / height, -1, 1)) / np.pi + 0.5
        )
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", layer.ravel())


# The second thing ---------------------------------------------------------------------------------


def _tilt(thing: bpy.types.Object) -> None:
    thing.location = (0.62, 0.15, 0.47)
    thing.rotation_euler = (radians(-35.0), 0.0, radians(-20.0))


def _slab(material: bpy.types.Material) -> None:
    low, high = (-0.36, -0.05, -0.45), (0.36, 0.05, 0.45)
    slab = m.add_boxes("Slab", [(low, high)], material)
    slab.data.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1] * 6)
    _tilt(slab)


def _sheet(material: bpy.types.Material) -> None:
    sheet = _quad(
        "Sheet", [(-0.36, 0, -0.45), (0.36, 0, -0.45), (0.36, 0, 0.45), (-0.36, 0, 0.45)], material
    )
    _tilt(sheet)


def _turned_sheet(material: bpy.types.Material) -> None:
    """The sheet shows its back."""
    _sheet(material)
    bpy.data.objects["Sheet"].rotation_euler = (radians(35.0), 0.0, radians(160.0))


def _block(material: bpy.types.Material) -> None:
    m.add_boxes(
        "Block",
        [((-0.25, -0.25, 0.001), (0.25, 0.25, 0.6))],
        m.diffuse("Block", (0.3, 0.5, 0.7)),
        (0.62, 0.15, 0.0),
        0.5,
    )


def _glass_in_water(material: bpy.types.Material) -> None:
    """A box of water (its sides meet air) with a glass ball inside, whose surface is glass against
    water.
    """
    m.add_boxes(
        "Water",
        [((-0.38, -0.38, 0.01), (0.38, 0.38, 0.75))],
        build_material("Water", WATER),
        (0.62, 0.15, 0.0),
        0.4,
    )
    inner = build_material("Inner", GLASS | {"inputs": {"IOR": 1.5 / 1.33}})
    m.add_sphere("Inner", 0.24, inner, (0.62, 0.15, 0.38), 64)


def _bubble(material: bpy.types.Material) -> None:
    """A glass ball with a ball of air inside: the inner surface has the inverse ratio."""
    m.add_sphere("Shell", 0.42, build_material("Shell", GLASS), (0.62, 0.15, 0.44), 96)
    m.add_sphere("Bubble", 0.3, build_material("Bubble", AIR_IN_GLASS), (0.62, 0.15, 0.44), 96)


def _filled(material: bpy.types.Material) -> None:
    """A glass box around a diffuse ball."""
    m.add_boxes(
        "Case",
        [((-0.36, -0.36, 0.01), (0.36, 0.36, 0.75))],
        build_material("Case", GLASS),
        (0.62, 0.15, 0.0),
        0.4,
    )
    m.add_sphere("Core", 0.25, m.diffuse("Core", (0.8, 0.3, 0.2)), (0.62, 0.15, 0.38), 48)


SECOND = {
    "slab": _slab,
    "sheet": _sheet,
    "turned_sheet": _turned_sheet,
    "floor": _block,
    "glass_in_water": _glass_in_water,
    "bubble": _bubble,
    "filled": _filled,
}


# Materials ----------------------------------------------------------------------------------------


def build_material(name: str, spec: dict[str, Any]) -> bpy.types.Material:
    material, tree, output = m._node_material(name)
    tree.links.new(add_nodes(tree, spec), output.inputs["Surface"])
    return material


def add_nodes(tree: bpy.types.NodeTree, spec: dict[str, Any]) -> bpy.types.NodeSocket:
    """Make the node and all that feeds it; its chosen output."""
    made = tree.nodes.new(f"ShaderNode{spec['kind']}")
    for key, value in spec["modes"].items():
        if key == "ies":
            made.mode, made.ies = "INTERNAL", _beam()
        elif key != "image":
            setattr(made, key, value)
    if spec["kind"] == "TexImage":
        made.image = _normals_image() if spec["modes"].get("image") == "normals" else _holes_image()
        made.extension = "REPEAT"
    for key, value in spec["inputs"].items():
        socket = made.inputs[int(key[1:])] if key[1:].isdigit() else made.inputs[key]
        if isinstance(value, dict):
            tree.links.new(add_nodes(tree, value), socket)
        elif isinstance(value, (list, tuple)):
            socket.default_value = (*value, 1.0) if socket.type == "RGBA" else tuple(value)
        else:
            socket.default_value = value
    return made.outputs[spec["output"]]


def _beam() -> bpy.types.Text:
    """A photometric profile that is not round: wide across, narrow along, and a little light
    upwards.
    """
    vertical, horizontal = range(0, 181, 15), range(0, 361, 45)
    rows = []
    for turn in horizontal:
        width = 35.0 + 25.0 * abs(np.sin(radians(turn))) + 0.03 * turn * (turn < 360)
        rows.append(
            " ".join(
                f"{1000.0 * np.exp(-((angle / width) ** 2)) + 0.4 * angle:.1f}"
                for angle in vertical
            )
        )
    text = bpy.data.texts.new("beam")
    head = (
        f"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 {len(vertical)} {len(horizontal)} 1 2 0 0 0\n1 "
        "1 100\n"
    )
    text.write(
        head
        + " ".join(map(str, vertical))
        + "\n"
        + " ".join(map(str, horizontal))
        + "\n"
        + "\n".join(rows)
        + "\n"
    )
    return text


def _holes_image() -> bpy.types.Image:
    """(16, 16) coloured squares; alpha 0, 0.5 or 1 by square."""
    row, column = np.mgrid[:16, :16]
    rgba = np.stack(
        [
            (column + 4) / 20,
            (row + 4) / 20,
            np.full((16, 16), 0.4),
            ((row // 4 + column // 4) % 3) / 2,
        ],
        -1,
    )
    return _image("holes", rgba)


def _normals_image() -> bpy.types.Image:
    """(32, 32) tangent-space normals of smooth egg-box bumps, 0..1 as Normal Map wants them."""
    v, u = (np.mgrid[:32, :32] + 0.5) / 32 * 2 * np.pi * 2
    slope = np.stack(
        [-0.5 * np.cos(u) * np.sin(v), -0.5 * np.sin(u) * np.cos(v), np.ones_like(u)], -1
    )
    normal = slope / np.linalg.norm(slope, axis=-1, keepdims=True)
    image = _image("normals", np.concatenate([normal / 2 + 0.5, np.ones((32, 32, 1))], -1))
    image.colorspace_settings.name = "Non-Color"
    return image


def _image(name: str, rgba: np.ndarray) -> bpy.types.Image:
    height, width = rgba.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=True)
    image.pixels.foreach_set(rgba.astype(np.float32).ravel())
    image.update()
    image.pack()
    return image
