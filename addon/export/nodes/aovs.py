"""AOV Output nodes of a material or a world, in its own tree and in its groups."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ..report import Report
from .holding import Holding, has_tree
from .trees import Groups

AOV_OUTPUT = "ShaderNodeOutputAOV"


class AovOutputs:
    """Finds them."""

    def __init__(self) -> None:
        self._writing = Holding({AOV_OUTPUT})

    def found(self, tree: Any) -> dict[str, list[tuple[Any, Groups]]]:
        """By the name of the pass: nodes, and the group nodes around each, outermost first."""
        found: dict[str, list[tuple[Any, Groups]]] = {}
        waiting: list[tuple[Any, Groups]] = [(tree, ())]
        while waiting:
            inner, groups = waiting.pop()
            for node in inner.nodes:
                if node.mute:
                    continue
                if node.bl_idname == AOV_OUTPUT:
                    found.setdefault(node.aov_name, []).append((node, groups))
                elif has_tree(node) and self._writing.holds(node.node_tree):
                    waiting.append((node.node_tree, (*groups, node)))
        return found


def report_aovs_of_world(world: Any, tree: Any, passes: Iterable[str], report: Report) -> None:
    """Names those that write to a pass: data are of surfaces alone."""
    for name in sorted(AovOutputs().found(tree).keys() & set(passes)):
        report.warn(f"World '{world.name}': AOV Output gives nothing to the pass {{}}", name)
