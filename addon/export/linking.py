"""Light linking: which lights which objects see, as groups of objects and the groups that each light lights."""

from __future__ import annotations

from typing import Any

from ..core.scene import ALL_GROUPS, GROUPS
from ..report import Report


class Linking:
    """Objects that every light treats alike are one group; 0 is that of objects no light names."""

    def __init__(self, depsgraph: Any, report: Report) -> None:
        self._report = report
        self._collections: dict[int, int] = {}
        self._group_of: dict[int, int] = {}
        self._lit: list[int] = []
        states: list[dict[int, bool]] = []
        for ob in depsgraph.objects:
            collection = _receivers(ob)
            if collection is not None and collection.as_pointer() not in self._collections:
                self._collections[collection.as_pointer()] = len(states)
                states.append(_states(collection))
        if states:
            self._make_groups(states)

    def group(self, instance: Any) -> int:
        """That of an instance of the graph, or else of the object that makes it."""
        own = self._group_of.get(instance.object.original.as_pointer(), 0)
        if own == 0 and instance.is_instance and instance.parent is not None:
            return self._group_of.get(instance.parent.original.as_pointer(), 0)
        return own

    def lit_groups(self, ob: Any) -> int:
        """Bits of the groups that a lamp or a shining object lights."""
        if (linking := getattr(ob, "light_linking", None)) is not None and linking.blocker_collection:
            self._report.warn("Shadow linking is not supported; everything casts shadows in the light of: {}", ob.name)
        collection = _receivers(ob) if self._collections else None
        return ALL_GROUPS if collection is None else self._lit[self._collections[collection.as_pointer()]]

    def _make_groups(self, states: list[dict[int, bool]]) -> None:
        groups: dict[tuple[bool | None, ...], int] = {(None,) * len(states): 0}
        for pointer in dict.fromkeys(pointer for state in states for pointer in state):
            seen = tuple(state.get(pointer) for state in states)
            if seen not in groups and len(groups) == GROUPS:
                self._report.warn(
                    f"Light linking tells more than {GROUPS} kinds of object apart; the others are lit as if no light named them"
                )
            elif seen not in groups:
                groups[seen] = len(groups)
            self._group_of[pointer] = groups.get(seen, 0)
        for k, state in enumerate(states):
            chosen = any(state.values())  # only what is included, or all but what is excluded
            lit = (group for seen, group in groups.items() if (seen[k] is True if chosen else seen[k] is not False))
            self._lit.append(sum(1 << group for group in lit))


def _receivers(ob: Any) -> Any:
    linking = getattr(ob.original, "light_linking", None)
    return None if linking is None else linking.receiver_collection


def _states(collection: Any) -> dict[int, bool]:
    """Whether each object of a collection (by its pointer) is included or excluded; what is said of an object beats its collection."""
    states: dict[int, bool] = {}
    for child, link in zip(collection.children, collection.collection_children, strict=True):
        for ob in child.all_objects:
            states[ob.as_pointer()] = link.light_linking.link_state == "INCLUDE"
    for ob, link in zip(collection.objects, collection.collection_objects, strict=True):
        states[ob.as_pointer()] = link.light_linking.link_state == "INCLUDE"
    return states
