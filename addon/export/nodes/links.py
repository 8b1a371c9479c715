"""Reading shader node trees: where a socket's value comes from, through groups, reroutes, muted
nodes and links.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import bpy

from ..report import Report
from .inlined import name_in_tree

OUTPUTS = ("ShaderNodeOutputMaterial", "ShaderNodeOutputWorld", "ShaderNodeOutputLight")


@dataclass(slots=True)
class Source:
    """What feeds a socket: an output `socket` of `node`, or (node is None) an unlinked input
    `socket` with its own value.

    `groups` are the group nodes around it, outermost first.
    """

    node: Any
    socket: Any
    groups: tuple[Any, ...] = ()

    def input(self, *names: str) -> Source | None:
        """Source of the node's first enabled input that has one of these names or identifiers."""
        for name in names:
            for socket in self.node.inputs:
                if name in (socket.name, socket.identifier) and getattr(socket, "enabled", True):
                    return source(socket, self.groups)
        return None


def counts(link: Any) -> bool:
    """Whether Cycles follows a link. One from an output that its node's mode hides is kept by
    Blender, and left out by Cycles.
    """
    return not link.is_muted and link.from_socket.enabled


def source(socket: Any, groups: tuple[Any, ...] = ()) -> Source:
    """Follow `socket` (an input) upstream to what really feeds it; nothing does in a circle."""
    seen: set[tuple[int, int]] = set()
    while (here := (socket.as_pointer(), len(groups))) not in seen:
        seen.add(here)
        link = next((link for link in socket.links if counts(link)), None)
        if link is None:
            return Source(None, socket, groups)
        node, output = link.from_node, link.from_socket
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.mute:
            passed = next(
                (inner.from_socket for inner in node.internal_links if inner.to_socket == output),
                None,
            )
            if passed is None:
                return Source(None, socket, groups)
            socket = passed
        elif node.type == "GROUP" and node.node_tree is not None:
            ending = next(
                (
                    n
                    for n in node.node_tree.nodes
                    if n.type == "GROUP_OUTPUT" and n.is_active_output
                ),
                None,
            )
            inner = _by_identifier(ending.inputs, output.identifier) if ending else None
            if inner is None:
                return Source(None, socket, groups)
            socket, groups = inner, (*groups, node)
        elif node.type == "GROUP_INPUT" and groups:
            outer = _by_identifier(groups[-1].inputs, output.identifier)
            if outer is None:
                return Source(None, socket, groups)
            socket, groups = outer, groups[:-1]
        else:
            return Source(node, output, groups)
    return Source(None, socket, groups)


def output_node(tree: Any) -> Any:
    """The output node that Cycles reads, or None: its own, whether it is active or not, else that
    of all renderers.
    """
    return tree.get_output_node("CYCLES")


def is_linked(output: Any, name: str) -> bool:
    """Whether an output node has an input of that name and it is linked: a lamp's output, which may
    stand in any tree, has a Surface alone.
    """
    return name in output.inputs and output.inputs[name].is_linked


def report_foreign_output(tree: Any, owner: str, report: Report) -> None:
    """Says so where there is an output, but not for us."""
    if any(node.bl_idname in OUTPUTS for node in tree.nodes):
        report.warn(
            f"{owner}: its only output is for another renderer (Target); black, as in Cycles"
        )


def uses_nodes(owner: Any) -> bool:
    """True if a material, light or world is shaded by its node tree (always, from Blender 5.0
    on).
    """
    if owner.node_tree is None:
        return False
    if bpy.app.version >= (5, 0, 0):
        return True
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return bool(owner.use_nodes)


def hollow_groups(tree: Any) -> list[Any]:
    """Group nodes in `tree`, at any depth, whose output is linked and which have no tree or no
    output node in it.
    """
    found, seen, waiting = [], {tree.as_pointer()}, [tree]
    while waiting:
        for node in waiting.pop().nodes:
            if node.type != "GROUP":
                continue
            inner = node.node_tree
            if inner is None or not any(one.type == "GROUP_OUTPUT" for one in inner.nodes):
                if any(output.is_linked for output in node.outputs):
                    found.append(node)
            elif inner.as_pointer() not in seen:
                seen.add(inner.as_pointer())
                waiting.append(inner)
    return found


def default_value(socket: Any) -> Any:
    """A socket's own value: a tuple of floats, a float, or None for sockets without one
    (shaders).
    """
    value = getattr(socket, "default_value", None)
    if value is None or isinstance(value, str):
        return None
    return tuple(float(v) for v in value) if hasattr(value, "__len__") else float(value)


def label(node: Any) -> str:
    """How a warning names a node: by the name the user gave it, or by its name in the tree."""
    return node.label or name_in_tree(node)


def _by_identifier(sockets: Any, identifier: str) -> Any:
    return next((socket for socket in sockets if socket.identifier == identifier), None)
