"""Where the value of an input socket comes from: through groups, reroutes, muted nodes and links,
in any number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy

from .inlined import InlinedTrees
from .links import OUTPUTS, counts, output_node

Groups = tuple[Any, ...]


@dataclass(slots=True)
class Feed:
    """What feeds an input: output `socket` of `node`, or (node is None) an input `socket` with its
    own value.

    `groups` are the group nodes around it, outermost first. `types` are the kinds of sockets that
    the value passes on its way, the last one first: it is converted to each of them. `empty`: the
    value is 0 whatever the socket says.
    """

    node: Any
    socket: Any
    groups: Groups
    types: tuple[str, ...] = ()
    empty: bool = False


# Blender 5 takes groups apart before a renderer sees them: what passes their sockets is not
# converted to their kind any more.
INLINED = bpy.app.version >= (5, 0, 0)


class Trees:
    """Links of node trees by the input that they feed: Blender itself looks through all links of a
    tree for each question.
    """

    def __init__(self) -> None:
        self.inlined = InlinedTrees()
        self._links: dict[int, dict[int, Any]] = {}
        self._endings: dict[int, Any] = {}
        self._onward: dict[int, dict[int, list[Any]]] = {}

    def link(self, socket: Any) -> Any:
        """The link into an input that counts, or None."""
        if not socket.is_linked:
            return None
        tree = socket.id_data
        key = tree.as_pointer()
        links = self._links.get(key)
        if links is None:
            links = self._links[key] = {
                link.to_socket.as_pointer(): link for link in tree.links if counts(link)
            }
        return links.get(socket.as_pointer())

    def feed(self, socket: Any, groups: Groups) -> Feed | None:
        """What feeds `socket`, an input; None if it feeds itself."""
        asked = Feed(None, socket, groups)
        types: list[str] = []
        passed: set[tuple[int, int]] = set()
        loose = False
        while True:
            mark = (socket.as_pointer(), len(groups))
            if mark in passed:
                return None
            passed.add(mark)
            link = self.link(socket)
            if link is None and loose:
                return asked if INLINED else Feed(None, socket, groups, tuple(types), empty=True)
            if link is None:
                return Feed(None, socket, groups, () if INLINED else tuple(types))
            loose = False
            node, output = link.from_node, link.from_socket
            if node.type == "REROUTE":
                socket, loose = node.inputs[0], True
            elif node.mute:
                inner = next(
                    (
                        inner.from_socket
                        for inner in node.internal_links
                        if inner.to_socket == output
                    ),
                    None,
                )
                if inner is None:
                    return asked
                types.append(output.type)
                socket, loose = inner, True
            elif node.type == "GROUP":
                inner = self._group_input(node, output.identifier)
                if inner is None:
                    return asked
                types.append(output.type)
                socket, groups = inner, (*groups, node)
            elif node.type == "GROUP_INPUT" and groups:
                outer = by_identifier(groups[-1].inputs, output.identifier)
                if outer is None:
                    return asked
                types.append(output.type)
                socket, groups = outer, groups[:-1]
            else:
                return Feed(node, output, groups, () if INLINED else tuple(types))

    def leads_to_output(self, socket: Any, groups: Groups) -> bool:
        """True if an output socket leads to what is rendered: nodes that do not are none in Cycles,
        which takes them away first.
        """
        waiting, passed = [(socket, groups)], set()
        while waiting:
            socket, groups = waiting.pop()
            if socket is None:  # a group that has no such input or output any more
                continue
            mark = (socket.as_pointer(), len(groups))
            if mark in passed:
                continue
            passed.add(mark)
            for link in self._links_from(socket):
                node, entry = link.to_node, link.to_socket
                if node.bl_idname in OUTPUTS:
                    if groups or node == output_node(node.id_data):
                        return True
                elif node.type == "OUTPUT_AOV":
                    return True
                elif node.type == "GROUP" and node.node_tree is not None and not node.mute:
                    waiting += [
                        (by_identifier(start.outputs, entry.identifier), (*groups, node))
                        for start in node.node_tree.nodes
                        if start.type == "GROUP_INPUT"
                    ]
                elif node.type == "GROUP_OUTPUT" and groups:
                    if node.is_active_output:
                        outer = by_identifier(groups[-1].outputs, entry.identifier)
                        waiting.append((outer, groups[:-1]))
                elif node.mute:
                    waiting += [
                        (inner.to_socket, groups)
                        for inner in node.internal_links
                        if inner.from_socket == entry
                    ]
                else:
                    waiting += [(output, groups) for output in node.outputs]
        return False

    def _links_from(self, socket: Any) -> list[Any]:
        if not socket.is_linked:
            return []
        tree = socket.id_data
        key = tree.as_pointer()
        onward = self._onward.get(key)
        if onward is None:
            onward = self._onward[key] = {}
            for link in tree.links:
                if counts(link):
                    onward.setdefault(link.from_socket.as_pointer(), []).append(link)
        return onward.get(socket.as_pointer(), [])

    def _group_input(self, group: Any, identifier: str) -> Any:
        """The input of a group's output node that stands for one of its outputs, or None."""
        tree = group.node_tree
        if tree is None:
            return None
        key = tree.as_pointer()
        if key not in self._endings:
            self._endings[key] = next(
                (n for n in tree.nodes if n.type == "GROUP_OUTPUT" and n.is_active_output), None
            )
        ending = self._endings[key]
        return by_identifier(ending.inputs, identifier) if ending is not None else None


def by_identifier(sockets: Any, identifier: str) -> Any:
    return next((socket for socket in sockets if socket.identifier == identifier), None)
