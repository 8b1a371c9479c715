"""What stands where: a row for each instance that the renderer gets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from ...core.scene import ALL_GROUPS, ALL_RAYS, NO_LIGHT_GROUP, TERMINATOR_OFFSET, Instances
from ...core.scene.shading import InstanceAttribute


@dataclass(frozen=True, slots=True)
class Traits:
    """What an object's rows have in common, as the fields of core.scene.Instances say."""

    group: int
    lit_groups: int
    blockers: int
    light_group: int
    seen_by: int
    holdout: bool
    catcher: bool
    terminator_offset: float


class Rows:
    """Meshes and material sets by their indices, with places and traits."""

    def __init__(self) -> None:
        self.placed: list[tuple[int, int]] = []  # mesh, material set
        self.matrices: list[NDArray[np.float64]] = []
        self.places: list[int] = []  # in the graph's list of instances
        self._densities: dict[int, float] = {}  # of media, by row
        self._traits: list[Traits] = []

    def __len__(self) -> int:
        return len(self.placed)

    def add(
        self, mesh: int, materials: int, matrix: NDArray[np.float64], density: float | None = None
    ) -> None:
        if density is not None:
            self._densities[len(self.placed)] = density
        self.placed.append((mesh, materials))
        self.matrices.append(matrix)

    def repeat(
        self, place: int, placed: tuple[int, int], matrix: NDArray[np.float64], traits: Traits
    ) -> None:
        """add() and describe() of a mesh and material set that have stood elsewhere."""
        self.placed.append(placed)
        self.matrices.append(matrix)
        self.places.append(place)
        self._traits.append(traits)

    def describe(self, place: int, traits: Traits) -> None:
        """Of the next row that has not been described."""
        self.places.append(place)
        self._traits.append(traits)

    def keep_used_meshes(self) -> NDArray[np.uint32]:
        """Numbers the meshes that rows use anew; returns their old numbers."""
        rows = np.array(self.placed, np.uint32)
        used, rows[:, 0] = np.unique(rows[:, 0], return_inverse=True)
        self.placed = [(int(mesh), int(materials)) for mesh, materials in rows]
        return used

    def instances(self, attributes: Sequence[InstanceAttribute]) -> Instances:
        if not self.placed:
            return Instances.empty()
        rows = np.array(self.placed, np.uint32)
        placed = Instances(
            rows[:, 0].copy(), np.stack(self.matrices), rows[:, 1].copy(), list(attributes)
        )

        def column(name: str, usual: int | float | bool, kind: type) -> NDArray | None:
            values: NDArray = np.array(list(map(attrgetter(name), self._traits)), kind)
            return values if (values != kind(usual)).any() else None

        placed.group = column("group", 0, np.uint8)
        placed.lit_groups = column("lit_groups", ALL_GROUPS, np.uint64)
        placed.blockers = column("blockers", ALL_GROUPS, np.uint64)
        placed.light_group = column("light_group", NO_LIGHT_GROUP, np.int16)
        placed.seen_by = column("seen_by", ALL_RAYS, np.uint32)
        placed.holdout = column("holdout", False, np.bool_)
        placed.catcher = column("catcher", False, np.bool_)
        placed.terminator_offset = column("terminator_offset", TERMINATOR_OFFSET, np.float32)
        if any(density != 1.0 for density in self._densities.values()):
            placed.density = np.ones(len(rows), np.float32)
            placed.density[list(self._densities)] = list(self._densities.values())
        return placed
