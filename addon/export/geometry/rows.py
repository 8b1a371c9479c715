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

    owner: str
    group: int
    lit_groups: int
    blockers: int
    light_group: int
    seen_by: int
    holdout: bool
    catcher: bool
    terminator_offset: float


class Rows:
    """Meshes and material sets by their indices, with places and traits. Rows of a kind differ in
    their places alone: leaves and grass are tens of thousands of one.
    """

    def __init__(self) -> None:
        self.places: list[int] = []  # in the graph's list of instances
        self.kinds: list[int] = []
        self.first_rows: list[int] = []  # of each kind; the others repeat it
        self.random_ids: list[int] = []  # those of repeats; 0 of first rows
        self.of_graph: NDArray[np.float64] = np.empty((0, 4, 4))
        """Where the graph's instances stand."""
        self._placed: list[tuple[int, int]] = []  # mesh and material set of each kind
        self._traits: list[Traits] = []  # of each kind
        self._matrices: list[NDArray[np.float64]] = []  # of each kind's first row
        self._densities: dict[int, float] = {}  # of media, by kind

    def __len__(self) -> int:
        return len(self.kinds)

    def add(
        self, mesh: int, materials: int, matrix: NDArray[np.float64], density: float | None = None
    ) -> None:
        kind = len(self._placed)
        if density is not None:
            self._densities[kind] = density
        self.first_rows.append(len(self.kinds))
        self.kinds.append(kind)
        self.random_ids.append(0)
        self._placed.append((mesh, materials))
        self._matrices.append(matrix)

    def describe(self, place: int, traits: Traits) -> None:
        """Of the next row that has not been described."""
        self.places.append(place)
        self._traits.append(traits)

    def repeat(self, place: int, kind: int, random_id: int) -> None:
        """What stands elsewhere already, where the graph says; not between add() and describe()."""
        self.kinds.append(kind)
        self.places.append(place)
        self.random_ids.append(random_id)

    def placed(self, row: int) -> tuple[int, int]:
        """Mesh and material set."""
        return self._placed[self.kinds[row]]

    def of_meshes(self, of_sets: Sequence[frozenset[int]]) -> dict[int, frozenset[int]]:
        """By mesh: what the material sets ask for that it has somewhere."""
        found: dict[int, frozenset[int]] = {}
        for mesh, materials in set(self._placed):
            found[mesh] = found.get(mesh, frozenset()) | of_sets[materials]
        return found

    def traits(self, kind: int) -> Traits:
        return self._traits[kind]

    def matrices(self) -> NDArray[np.float64]:
        """(N, 4, 4), of all rows."""
        found = self.of_graph[self.places]
        found[self.first_rows] = self._matrices
        return found

    def repeats(self) -> NDArray[np.bool_]:
        """Mask of the rows that are not the first of their kind."""
        mask = np.ones(len(self), np.bool_)
        mask[self.first_rows] = False
        return mask

    def keep_used_meshes(self) -> NDArray[np.uint32]:
        """Numbers the meshes that rows use anew; returns their old numbers."""
        kinds = np.array(self._placed, np.uint32)
        used, kinds[:, 0] = np.unique(kinds[:, 0], return_inverse=True)
        self._placed = [(int(mesh), int(materials)) for mesh, materials in kinds]
        return used

    def instances(self, attributes: Sequence[InstanceAttribute]) -> Instances:
        if not self.kinds:
            return Instances.empty()
        kinds = np.array(self.kinds)
        meshes, materials = np.array(self._placed, np.uint32).T
        placed = Instances(meshes[kinds], self.matrices(), materials[kinds], list(attributes))

        def column(name: str, usual: int | float | bool, dtype: type) -> NDArray | None:
            values: NDArray = np.array(list(map(attrgetter(name), self._traits)), dtype)
            return values[kinds] if (values != dtype(usual)).any() else None

        owners = [traits.owner for traits in self._traits]
        placed.owners = [owners[kind] for kind in self.kinds]
        placed.group = column("group", 0, np.uint8)
        placed.lit_groups = column("lit_groups", ALL_GROUPS, np.uint64)
        placed.blockers = column("blockers", ALL_GROUPS, np.uint64)
        placed.light_group = column("light_group", NO_LIGHT_GROUP, np.int16)
        placed.seen_by = column("seen_by", ALL_RAYS, np.uint32)
        placed.holdout = column("holdout", False, np.bool_)
        placed.catcher = column("catcher", False, np.bool_)
        placed.terminator_offset = column("terminator_offset", TERMINATOR_OFFSET, np.float32)
        if any(density != 1.0 for density in self._densities.values()):
            densities = np.ones(len(self._placed), np.float32)
            densities[list(self._densities)] = list(self._densities.values())
            placed.density = densities[kinds]
        return placed
