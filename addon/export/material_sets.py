"""The materials of objects' slots: sets of indices into the scene's materials, each once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Mesh
from .materials import Materials


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
        # Slots of the object beyond those of its evaluated data count in Blender, not in Cycles.
        slots_of_data = ob.material_slots[: len(ob.data.materials)]
        found = [override] if override else [slot.material for slot in slots_of_data] or [None]
        indices = [self._materials.index(material, uv_map) for material in found]
        slots = mesh.slots if mesh.strands is None else mesh.strands.slots
        needed = 1 if slots is None else int(np.max(slots)) + 1
        indices += [indices[-1]] * (needed - len(indices))
        return self.index(tuple(indices))
