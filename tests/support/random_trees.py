"""Random node trees: any nodes and settings, any socket linked to any other, circles, groups in
groups, reroutes, muted nodes, outputs in the wrong tree. Runs inside Blender.
"""

from __future__ import annotations

import contextlib
import random
from typing import Any

SOCKETS = tuple(
    f"NodeSocket{kind}" for kind in ("Float", "Vector", "Color", "Shader", "Int", "Bool")
)
NOT_ALONE = {"ShaderNode", "ShaderNodeTree", "ShaderNodeGroup", "ShaderNodeCustomGroup"}
"""What is no node that could be added, or is added otherwise."""
DEPTH = 2
"""Of groups in groups."""

Place = tuple[str, int, str]
"""A socket by its node's name, its number and its type: Blender moves sockets about."""


def kinds() -> list[str]:
    import bpy

    names = (name for name in dir(bpy.types) if name.startswith("ShaderNode"))
    return sorted(name for name in names if name not in NOT_ALONE)


def fill(chance: random.Random, tree: Any, ends: list[Any], depth: int = DEPTH) -> None:
    """Adds nodes to `tree` and links them to each other and to the nodes in `ends`."""
    names, nodes = kinds(), []
    for _ in range(chance.randint(1, 12 if depth == DEPTH else 6)):
        draw = chance.random()
        if draw < 0.12 and depth:
            nodes.append(_group(chance, tree, depth - 1))
        elif draw < 0.2:
            nodes.append(tree.nodes.new("NodeReroute"))
        else:
            with contextlib.suppress(RuntimeError):  # not a node of shaders in this Blender
                nodes.append(tree.nodes.new(chance.choice(names)))
                _set(chance, nodes[-1])
    giving = [*nodes, *(node for node in tree.nodes if node.type == "GROUP_INPUT")]
    outputs = [place for node in giving for place in _places(node, node.outputs)]
    if not outputs:
        return
    for node in nodes:
        for place in _places(node, node.inputs):
            if chance.random() < 0.55:
                _link(chance, tree, outputs, place, 0.8)
    for node in ends:
        for place in _places(node, node.inputs):
            if chance.random() < 0.85:
                _link(chance, tree, outputs, place, 0.9)


def _places(node: Any, sockets: Any) -> list[Place]:
    return [
        (node.name, k, socket.type)
        for k, socket in enumerate(sockets)
        if "Virtual" not in socket.bl_idname
    ]


def _link(
    chance: random.Random, tree: Any, outputs: list[Place], to: Place, of_its_kind: float
) -> None:
    alike = [place for place in outputs if place[2] == to[2]]
    name, k, _ = chance.choice(alike if alike and chance.random() < of_its_kind else outputs)
    with contextlib.suppress(RuntimeError, IndexError):
        tree.links.new(tree.nodes[name].outputs[k], tree.nodes[to[0]].inputs[to[1]])


def _set(chance: random.Random, node: Any) -> None:
    import bpy

    common = {one.identifier for one in bpy.types.Node.bl_rna.properties}
    for one in node.bl_rna.properties:
        if one.is_readonly or one.identifier in common:
            continue
        with contextlib.suppress(TypeError, AttributeError):
            if one.type == "ENUM" and not one.is_enum_flag:
                choices = [item.identifier for item in one.enum_items]
                setattr(node, one.identifier, chance.choice(choices or [""]))
            elif one.type == "BOOLEAN" and not one.is_array:
                setattr(node, one.identifier, chance.random() < 0.5)
    for socket in node.inputs:
        if chance.random() < 0.5:
            continue
        if socket.type == "VALUE":
            socket.default_value = chance.choice([0.0, 1.0, chance.uniform(-1.0, 2.0)])
        elif socket.type == "RGBA":
            socket.default_value = (*(chance.random() for _ in range(3)), 1.0)
        elif socket.type == "VECTOR":
            for i in range(len(socket.default_value)):
                socket.default_value[i] = chance.uniform(-1.0, 1.0)
    node.mute = chance.random() < 0.05


def _group(chance: random.Random, tree: Any, depth: int) -> Any:
    import bpy

    inner = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    for direction, most in (("INPUT", 4), ("OUTPUT", 3)):
        for _ in range(chance.randint(0, most)):
            kind = chance.choice(SOCKETS)
            inner.interface.new_socket("Socket", in_out=direction, socket_type=kind)
    inner.nodes.new("NodeGroupInput")
    ends = [inner.nodes.new("NodeGroupOutput") for _ in range(chance.choice([0, 1, 1, 1, 2]))]
    fill(chance, inner, ends, depth)
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = inner
    node.mute = chance.random() < 0.05
    return node


def material(chance: random.Random) -> Any:
    from tests.support import stage

    made, tree = stage.empty_material("Random")
    tree.nodes.clear()
    outputs = [
        tree.nodes.new("ShaderNodeOutputMaterial") for _ in range(chance.choice([1, 1, 1, 2]))
    ]
    for node in outputs:
        node.target = chance.choice(["ALL", "ALL", "CYCLES", "EEVEE"])
    fill(chance, tree, outputs)
    return made


def world(chance: random.Random) -> Any:
    return _owned(chance, "worlds", "ShaderNodeOutputWorld", ())


def lamp(chance: random.Random) -> Any:
    kind = chance.choice(["POINT", "SUN", "SPOT", "AREA"])
    return _owned(chance, "lights", "ShaderNodeOutputLight", (kind,))


def _owned(chance: random.Random, where: str, output: str, kind: tuple[str, ...]) -> Any:
    import bpy

    made = getattr(bpy.data, where).new("Random", *kind)
    made.use_nodes = True
    made.node_tree.nodes.clear()
    fill(chance, made.node_tree, [made.node_tree.nodes.new(output)])
    return made
