"""Instances of what has stood elsewhere before: all but their places is known. Leaves and grass are
tens of thousands of them.
"""

from __future__ import annotations

from typing import Any

Key = tuple[int, int, int]


class Repeats:
    """The kinds of rows by the object, what makes its instances, and its mesh, as they are within
    one export.
    """

    def __init__(self) -> None:
        self._known: dict[Key, int] = {}

    @staticmethod
    def key(instance: Any, ob: Any) -> Key | None:
        """None where each row is to be made on its own: what is no instance, or not shown."""
        if not instance.is_instance or not instance.show_self:
            return None
        own, maker, data = instance.instance_object, instance.parent, ob.data
        if own is None or maker is None or data is None:
            return None
        return own.as_pointer(), maker.as_pointer(), data.as_pointer()

    def get(self, key: Key | None) -> int | None:
        return None if key is None else self._known.get(key)

    def keep(self, key: Key | None, ob: Any, kind: int) -> None:
        """Of a mesh; not if it may have hair."""
        if key is not None and not len(ob.particle_systems):
            self._known[key] = kind
