"""The materials of objects' slots: sets of indices into the scene's materials, each once."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.scene import Mesh
from .materials import Materials

# Blender's new sync to Cycles, seen in 5.2 (4.5 does as Python says).
BY_DATA = bpy.app.version >= (5, 1, 0)


def materials_of(ob: Any) -> list[Any]:
    """What Cycles shows in the slots of an evaluated object. From Blender 5.1 on that is not what
    Python says of them: it has as many as the evaluated data has, and a slot that is linked to the
    object and empty is empty, whatever the data has there.
    """
    if not BY_DATA:
        return [slot.material for slot in ob.material_slots]
    own = ob.original.material_slots
    return [
        None
        if slot.link == "OBJECT" and k < len(own) and own[k].material is None
        else slot.material
        for k, slot in enumerate(ob.material_slots[: len(ob.data.materials)])
    ]


class MaterialSets:
    def __init__(self, materials: Materials) -> None:
        self.list: list[NDArray[np.int32]] = []
        self._materials = materials
        self._known: dict[tuple[int, ...], int] = {}

    def index(self, materials: tuple[int, ...]) -> int:
        """Of the set of these materials, which is added where there is none."""
        if materials not in self._known:
            self._known[materials] = len(self.list)
            self.list.append(np.array(materials, np.int32))
        return self._known[materials]

    def of_object(self, ob: Any, mesh: Mesh, uv_map: str | None, override: Any) -> int:
        """Index of the set for an object's slots, as long as the mesh's slots need: the last
        material serves those beyond.
        """
        found = [override] if override else materials_of(ob) or [None]
        indices = [self._materials.index(material, uv_map) for material in found]
        slots = mesh.slots if mesh.strands is None else mesh.strands.slots
        needed = 1 if slots is None else int(np.max(slots)) + 1
        indices += [indices[-1]] * (needed - len(indices))
        return self.index(tuple(indices))
