"""Light and shadow linking: which objects each light lights and which block it, as groups of
objects.
"""

from __future__ import annotations

from typing import Any

from ..core.scene import ALL_GROUPS, GROUPS
from .report import Report


class Linking:
    """Objects that every light treats alike are one group; 0 is that of objects no light names."""

    def __init__(self, depsgraph: Any, report: Report) -> None:
        self._report = report
        self._collections: dict[int, int] = {}
        self._group_of: dict[int, int] = {}
        self._chosen: list[int] = []
        states: list[dict[int, bool]] = []
        for ob in depsgraph.objects:
            for collection in (
                _linked(ob, "receiver_collection"),
                _linked(ob, "blocker_collection"),
            ):
                if collection is not None and collection.as_pointer() not in self._collections:
                    self._collections[collection.as_pointer()] = len(states)
                    states.append(_states(collection))
        if states:
            self._make_groups(states)

    def group(self, instance: Any) -> int:
        """The group of an instance of the graph, or else of the object that makes it."""
        own = self._group_of.get(instance.object.original.as_pointer(), 0)
        if own == 0 and instance.is_instance and instance.parent is not None:
            return self._group_of.get(instance.parent.original.as_pointer(), 0)
        return own

    def lit_groups(self, ob: Any) -> int:
        """Bits of the groups that a lamp or a shining object lights."""
        return self._groups_of(_linked(ob, "receiver_collection"))

    def blockers(self, ob: Any) -> int:
        """Bits of the groups that cast shadows in its light."""
        return self._groups_of(_linked(ob, "blocker_collection"))

    def _groups_of(self, collection: Any) -> int:
        known = None if collection is None else self._collections.get(collection.as_pointer())
        return ALL_GROUPS if known is None else self._chosen[known]

    def _make_groups(self, states: list[dict[int, bool]]) -> None:
        groups: dict[tuple[bool | None, ...], int] = {(None,) * len(states): 0}
        for pointer in dict.fromkeys(pointer for state in states for pointer in state):
            seen = tuple(state.get(pointer) for state in states)
            if seen not in groups and len(groups) == GROUPS:
                self._report.warn(
                    f"Light linking tells more than {GROUPS} kinds of object apart; the others "
                    "are lit as if no light named them"
                )
            elif seen not in groups:
                groups[seen] = len(groups)
            self._group_of[pointer] = groups.get(seen, 0)
        for k, state in enumerate(states):
            chosen = any(state.values())  # only what is included, or all but what is excluded
            others = (
                group
                for seen, group in groups.items()
                if (seen[k] is not True if chosen else seen[k] is False)
            )
            self._chosen.append(ALL_GROUPS & ~sum(1 << group for group in others))


def _linked(ob: Any, role: str) -> Any:
    linking = getattr(ob.original, "light_linking", None)
    return None if linking is None else getattr(linking, role)


def _states(collection: Any) -> dict[int, bool]:
    """Whether each object of a collection (by its pointer) is included or excluded; what is said of
    an object beats its collection.
    """
    states: dict[int, bool] = {}
    for child, link in zip(collection.children, collection.collection_children, strict=True):
        for ob in child.all_objects:
            states[ob.as_pointer()] = link.light_linking.link_state == "INCLUDE"
    for ob, link in zip(collection.objects, collection.collection_objects, strict=True):
        states[ob.as_pointer()] = link.light_linking.link_state == "INCLUDE"
    return states
