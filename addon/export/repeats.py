"""Instances of what has stood elsewhere before: all but their places is known. Leaves and grass are
tens of thousands of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .geometry.rows import Traits

Key = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Repeat:
    """The mesh of a row and its material set, by their indices, and the row's traits."""

    mesh: int
    materials: int
    traits: Traits


class Repeats:
    """By the object, what makes its instances, and its mesh, as they are within one export."""

    def __init__(self) -> None:
        self._known: dict[Key, Repeat] = {}

    @staticmethod
    def key(instance: Any, ob: Any) -> Key | None:
        """None where each row is to be made on its own: no instances of a mesh, or ones that may
        have hair.
        """
        if not instance.is_instance or ob.type != "MESH" or not instance.show_self:
            return None
        maker, mesh = instance.parent, ob.data
        if maker is None or mesh is None or len(ob.particle_systems):
            return None
        return ob.original.as_pointer(), maker.original.as_pointer(), mesh.as_pointer()

    def get(self, key: Key | None) -> Repeat | None:
        return None if key is None else self._known.get(key)

    def keep(self, key: Key, repeat: Repeat) -> None:
        self._known[key] = repeat
