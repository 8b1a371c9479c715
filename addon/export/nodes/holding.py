"""Which node trees hold nodes of some kinds, in themselves or in their groups."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any


class Holding:
    """Finds out for trees; what it found is remembered, as groups are used by many."""

    def __init__(self, kinds: Collection[str]) -> None:
        """`kinds`: names of types of nodes (Node.bl_idname)."""
        self.kinds = frozenset(kinds)
        self._known: dict[int, bool] = {}

    def holds(self, tree: Any) -> bool:
        """Whether the tree or one of its groups, at any depth, has a node of these kinds."""
        waiting = [(tree, False)]
        while waiting:
            inner, groups_known = waiting.pop()
            groups = [node.node_tree for node in inner.nodes if has_tree(node)]
            key = inner.as_pointer()
            if groups_known:
                own = any(node.bl_idname in self.kinds for node in inner.nodes)
                self._known[key] = own or any(self._known[g.as_pointer()] for g in groups)
            elif key not in self._known:
                self._known[key] = False
                waiting.append((inner, True))
                waiting += [(group, False) for group in groups]
        return self._known[tree.as_pointer()]


def has_tree(node: Any) -> bool:
    return node.type == "GROUP" and node.node_tree is not None
