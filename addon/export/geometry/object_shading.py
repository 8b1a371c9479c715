"""What programs read from meshes and instances: attributes, UV maps, generated coordinates."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.scene.shading import InstanceAttribute, MeshShading
from ..kept import Kept
from ..materials import Shading
from ..nodes.node import Want, Wants
from ..report import Report
from .attributes import mesh_shading
from .flat_uv_maps import report_flat_uv_maps
from .instance_attributes import InstanceAttributes
from .instance_values import Reader, is_of_kind, is_random, random_of, reader_of, width_of
from .particle_hair import hair_of, hair_shading
from .rows import Rows
from .shapes import Shapes, may_deform, mesh_key, sources, with_mesh
from .strands import strand_shading

LOOKS = 64
"""Of as many instances one asks whether the export has been cancelled; so does each mesh."""


@dataclass(slots=True)
class Reading:
    """What is read of the graph's instances: once for each kind of rows where that tells of all."""

    number: int
    want: Want
    read: Reader
    found: list[Any] = field(default_factory=list)

    @property
    def by_kind(self) -> bool:
        return is_of_kind(self.want)

    def values(self, rows: Rows) -> NDArray[np.float32]:
        """(N, components) of all rows."""
        count = len(rows.first_rows) if self.by_kind else len(rows)
        values = np.array(self.found, np.float32).reshape(count, width_of(self.want))
        if not self.by_kind:
            return values
        values = values[rows.kinds]
        if is_random(self.want):
            repeats = rows.repeats()
            values[repeats, 0] = random_of(np.array(rows.random_ids)[repeats])
        return values


class ObjectShading:
    def __init__(self, shapes: Shapes, rows: Rows, shading: Shading, kept: Kept) -> None:
        self._shapes, self._rows, self._kept = shapes, rows, kept
        self._watch, self._report = shading.around.watch, shading.around.report

    def collect(
        self,
        depsgraph: Any,
        wants: Wants,
        of_meshes: dict[int, frozenset[int]],
        of_instances: frozenset[int],
        with_uv: bool,
    ) -> list[InstanceAttribute]:
        """Gives meshes what programs read from them (ids of `wants`, by mesh), and returns what
        they read from instances (ids). The graph has not changed since the rows were made.
        `with_uv`: meshes are to have their render-active UV maps.
        """
        of_any = with_uv or any(of_meshes.values())
        if not of_any and not of_instances:
            return []
        names = {number: want for want, number in wants.ids.items()}
        of_nodes = InstanceAttributes(self._report)
        readers = [
            Reading(number, names[number], reader_of(names[number], depsgraph, of_nodes))
            for number in sorted(of_instances)
        ]
        done: set[int] = set()
        meshes = self._shapes.list
        rows, first_rows = self._rows, set(self._rows.first_rows)
        looked_at = (
            rows.first_rows if all(reader.by_kind for reader in readers) else list(range(len(rows)))
        )
        places = [rows.places[row] for row in looked_at]
        at = 0
        for place, instance in enumerate(depsgraph.object_instances):
            if at == len(places):
                break
            if places[at] != place:
                continue
            if place % LOOKS == 0:
                self._watch.go_on()
            # a mesh and its hair have rows of their own
            while at < len(places) and places[at] == place:
                row = looked_at[at]
                at += 1
                for reader in readers:
                    if not reader.by_kind or row in first_rows:
                        reader.found.append(reader.read(instance))
                index, _ = rows.placed(row)
                if index in done or not of_any:
                    continue
                self._watch.go_on()
                done.add(index)
                ob = instance.object
                if with_uv:
                    self._shapes.give_uv(ob, index)
                if not of_meshes[index]:
                    continue
                mesh_wants = {number: names[number] for number in sorted(of_meshes[index])}
                askers = {
                    number: list(wants.askers[number])
                    for number in mesh_wants
                    if number in wants.askers
                }
                meshes[index] = replace(
                    meshes[index], shading=self._of_mesh(ob, index, mesh_wants, depsgraph)
                )
                if meshes[index].strands is None and not meshes[index].shading.grids:
                    report_flat_uv_maps(ob, mesh_wants, askers, self._report)
        return [InstanceAttribute(reader.number, reader.values(rows)) for reader in readers]

    def _of_mesh(self, ob: Any, index: int, wants: dict[int, Want], depsgraph: Any) -> MeshShading:
        mesh = self._shapes.list[index]
        if mesh.shading.grids:
            return mesh.shading
        if mesh.strands is not None and index in self._shapes.hair:
            systems = hair_of(ob, depsgraph.mode == "RENDER")
            return hair_shading(ob, systems, mesh.strands, wants)
        if mesh.strands is not None:
            return strand_shading(ob.data, ob.type, ob.name, wants)
        left = self._shapes.flat.get(index)

        def make(_: Report) -> MeshShading:
            moved = may_deform(ob)
            return with_mesh(ob, lambda mesh: mesh_shading(mesh, ob.name, wants, left, moved))

        key = (
            "shading",
            *mesh_key(ob),
            tuple(wants.items()),
            left is not None and left.tobytes(),
        )
        return self._kept.get(key, sources(ob), self._report, make)
