"""AOV Output nodes of a material, in its own tree and in its groups."""

from __future__ import annotations

from typing import Any

from .trees import Groups

AOV_OUTPUT = "ShaderNodeOutputAOV"


class AovOutputs:
    """Finds them; which trees have any is remembered, as groups are used by many."""

    def __init__(self) -> None:
        self._writes: dict[int, bool] = {}

    def found(self, tree: Any) -> dict[str, list[tuple[Any, Groups]]]:
        """By the name of the pass: nodes, and the group nodes around each, outermost first."""
        self._look(tree)
        found: dict[str, list[tuple[Any, Groups]]] = {}
        waiting: list[tuple[Any, Groups]] = [(tree, ())]
        while waiting:
            inner, groups = waiting.pop()
            for node in inner.nodes:
                if node.mute:
                    continue
                if node.bl_idname == AOV_OUTPUT:
                    found.setdefault(node.aov_name, []).append((node, groups))
                elif _has_tree(node) and self._writes[node.node_tree.as_pointer()]:
                    waiting.append((node.node_tree, (*groups, node)))
        return found

    def _look(self, tree: Any) -> None:
        """Whether the tree and those of its groups have such outputs, or groups that have some."""
        waiting = [(tree, False)]
        while waiting:
            inner, known = waiting.pop()
            groups = [node.node_tree for node in inner.nodes if _has_tree(node)]
            key = inner.as_pointer()
            if known:
                own = any(node.bl_idname == AOV_OUTPUT for node in inner.nodes)
                self._writes[key] = own or any(self._writes[g.as_pointer()] for g in groups)
            elif key not in self._writes:
                self._writes[key] = False
                waiting.append((inner, True))
                waiting += [(group, False) for group in groups]


def _has_tree(node: Any) -> bool:
    return node.type == "GROUP" and node.node_tree is not None
