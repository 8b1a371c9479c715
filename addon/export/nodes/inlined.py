"""Node trees whose menus, zones, closures and bundles have been taken apart: by Blender itself,
which does so for Cycles too.
"""

from __future__ import annotations

from typing import Any

import bpy

from .holding import Holding

TAKEN_APART = frozenset(
    {
        "GeometryNodeMenuSwitch",
        "GeometryNodeRepeatInput",
        "GeometryNodeRepeatOutput",
        "NodeClosureInput",
        "NodeClosureOutput",
        "NodeEvaluateClosure",
        "NodeCombineBundle",
        "NodeSeparateBundle",
        "NodeJoinBundle",
        "NodeImplicitConversion",
        "FunctionNodeInputBool",
        "FunctionNodeInputInt",
        "FunctionNodeInputMenu",
        "FunctionNodeInputVector",
    }
)
"""Node.bl_idname of nodes that are gone from an inlined tree (Blender 5)."""
COPY = "Inlined"  # how the name of an inlined tree ends


class InlinedTrees:
    """The trees of materials, lights and worlds as they are compiled."""

    def __init__(self) -> None:
        self._asking = Holding(TAKEN_APART)
        self._copies: dict[int, Any] = {}  # a tree lives as long as the copy that holds it

    def tree(self, owner: Any) -> Any:
        """The owner's node tree; a copy without these nodes where it has any."""
        own = owner.node_tree
        maker = getattr(bpy.types, "InlineShaderNodes", None)
        if maker is None or not self._asking.holds(own):
            return own
        key = owner.as_pointer()
        if key not in self._copies:
            make = {"WORLD": maker.from_world, "LIGHT": maker.from_light}.get(
                owner.id_type, maker.from_material
            )
            self._copies[key] = make(owner)
        return self._copies[key].node_tree


def name_in_tree(node: Any) -> str:
    """A node's name. Inlined trees number their nodes: 2_Math stands for the user's Math."""
    name = str(node.name)
    number, _, rest = name.partition("_")
    return rest if rest and number.isdigit() and node.id_data.name.endswith(COPY) else name
