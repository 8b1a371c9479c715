"""Everything that stands in the scene: meshes once each, and instances and lamps where they are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..core.scene import (
    ALL_GROUPS,
    ALL_RAYS,
    NO_LIGHT_GROUP,
    NO_PROGRAM,
    TERMINATOR_OFFSET,
    Camera,
    Instances,
    Light,
    Mesh,
)
from ..core.scene.displacement import Normals
from ..core.scene.shading import InstanceAttribute, MeshShading
from .attributes import instance_value, mesh_shading, width_of
from .displacement import Displaced, slots_of, smooth_normals
from .flat_uv_maps import report_flat_uv_maps
from .instance_attributes import InstanceAttributes
from .kept import Kept, identity
from .labels import Labelled
from .lights import export_light
from .linking import Linking
from .materials import Materials, Shading, grid_interpolation
from .mesh import export_mesh, flattened
from .motion import Moving
from .nodes.node import Want, Wants
from .particle_hair import export_hair, hair_of, hair_shading, known_as, made_of
from .report import Report
from .strands import STRANDS, export_strands, look_of, strand_shading, uv_layer
from .visibility import FLAGS, Visibility, report_unsupported
from .volumes import density_of, is_volume, known_volume, volume_mesh

Value = TypeVar("Value")
SEEING_RAYS = sum(FLAGS.values())
UNSUPPORTED = {
    "GREASEPENCIL": "grease pencil objects",
}


class Objects:
    """Walks the instances of a dependency graph and collects meshes, instances, material sets and
    lamps.
    """

    def __init__(
        self,
        materials: Materials,
        shading: Shading,
        kept: Kept,
        light_groups: list[str],
        moving: Moving | None = None,
        labelled: Labelled | None = None,
    ) -> None:
        self.meshes: list[Mesh] = []
        self.material_sets: list[NDArray[np.int32]] = []
        self.lights: list[Light] = []
        self._materials, self._shading, self._report, self._kept = (
            materials,
            shading,
            shading.around.report,
            kept,
        )
        self._moving = moving
        self._labelled = labelled
        self._mesh_of: dict[int, int | None] = {}
        self._set_of: dict[tuple[int, int], int] = {}
        self._sets: dict[tuple[int, ...], int] = {}
        self._rows: list[tuple[int, int]] = []
        self._groups: list[int] = []
        self._lit_groups: list[int] = []
        self._blockers: list[int] = []
        self._light_groups: list[int] = []
        self._seen_by: list[int] = []
        self._holdouts: list[bool] = []
        self._catchers: list[bool] = []
        self._terminator_offsets: list[float] = []
        self._densities: dict[int, float] = {}  # of media, by row
        self._light_group_of = {name: i for i, name in enumerate(light_groups)}
        self._matrices: list[NDArray[np.float64]] = []
        self._rows_of: dict[int, range] = {}  # by index in the graph's list of instances
        self._volumes: dict[tuple[Any, ...], int | None] = {}
        self._hair: set[int] = set()  # which meshes are hair of particles
        self._attributes: list[InstanceAttribute] = []
        self._displaced = Displaced(self.meshes, kept, self._report)
        # flattened meshes: which triangles are left
        self._flat: dict[int, NDArray[np.bool_] | None] = {}

    def collect(self, depsgraph: Any, visible: Callable[[Any], bool] | None = None) -> None:
        """Blender reuses the objects that the graph's iterator returns, so none of them may be
        kept.
        """
        view_layer = depsgraph.view_layer
        override = view_layer.material_override
        linking = Linking(depsgraph, self._report)
        visibility = Visibility(view_layer)
        for place, instance in enumerate(depsgraph.object_instances):
            self._shading.around.watch.go_on()
            ob = instance.object
            kind = ob.type
            if visible is not None and not visible(instance):
                continue
            if kind in {"MESH", "VOLUME"} or kind in STRANDS:
                rays, holdout, catcher = visibility.of(instance)
                if rays & SEEING_RAYS:
                    rows = self._add_rows(instance, depsgraph, override)
                    if rows:
                        self._rows_of[place] = rows
                    for row in rows:
                        self._add_moving(instance, row)
                        if self._labelled is not None:
                            self._labelled.add(ob)
                        self._groups.append(linking.group(instance))
                        self._lit_groups.append(linking.lit_groups(ob))
                        self._blockers.append(linking.blockers(ob))
                        self._seen_by.append(rays)
                        self._holdouts.append(holdout)
                        self._catchers.append(catcher)
                        self._terminator_offsets.append(
                            float(ob.original.shadow_terminator_geometry_offset)
                        )
                        self._light_groups.append(
                            self._light_group_of.get(ob.original.lightgroup, NO_LIGHT_GROUP)
                        )
            elif kind == "LIGHT":
                if instance.show_self:
                    light = export_light(
                        ob, np.array(instance.matrix_world, np.float64), self._shading
                    )
                    if light is not None:
                        light.lit_groups, light.blockers = (
                            linking.lit_groups(ob),
                            linking.blockers(ob),
                        )
                        light.light_group = self._light_group_of.get(
                            ob.original.lightgroup, NO_LIGHT_GROUP
                        )
                        self.lights.append(light)
            elif kind in UNSUPPORTED and instance.show_self:
                self._report.warn(
                    f"Not supported yet and left out, {UNSUPPORTED[kind]}: {{}}", ob.name
                )

    def collect_shading(
        self, depsgraph: Any, wants: Wants, of_meshes: frozenset[int], of_instances: frozenset[int]
    ) -> None:
        """What programs read from meshes and instances (ids of `wants`). The graph has not changed
        since collect().
        """
        if not of_meshes and not of_instances:
            return
        names = {number: want for want, number in wants.ids.items()}
        mesh_wants = {number: names[number] for number in sorted(of_meshes)}
        askers = {
            number: list(found) for number, found in wants.askers.items() if number in of_meshes
        }
        instance_wants = {number: names[number] for number in sorted(of_instances)}
        values = {
            number: np.zeros((len(self._rows), width_of(want)), np.float32)
            for number, want in instance_wants.items()
        }
        done: set[int] = set()
        of_nodes = InstanceAttributes(self._report)
        for place, instance in enumerate(depsgraph.object_instances):
            rows = self._rows_of.get(place)
            if rows is None:
                continue
            self._shading.around.watch.go_on()
            for index in {self._rows[row][0] for row in rows} - done if mesh_wants else ():
                done.add(index)
                ob = instance.object
                self.meshes[index] = replace(
                    self.meshes[index],
                    shading=self._shading_of(ob, index, mesh_wants, depsgraph),
                )
                if self.meshes[index].strands is None and not self.meshes[index].shading.grids:
                    report_flat_uv_maps(ob, mesh_wants, askers, self._report)
            for number, want in instance_wants.items():
                found = instance_value(instance, want, depsgraph, of_nodes)
                values[number][rows.start : rows.stop] = found
        self._attributes = [InstanceAttribute(number, found) for number, found in values.items()]

    def displace(self, camera: Camera) -> None:
        """Moves the meshes that materials displace, after collect_shading()."""
        if not self._displaced.found:
            return
        self._displaced.move(
            self._matrices,
            self._attributes,
            self._shading.around.textures.list,
            camera,
            self._shading.asks_old_normals,
        )
        rows = np.array(self._rows, np.uint32)
        used, rows[:, 0] = np.unique(rows[:, 0], return_inverse=True)
        self.meshes = [self.meshes[i] for i in used]  # not those that stand nowhere undisplaced
        self._rows = [(int(mesh), int(materials)) for mesh, materials in rows]

    def _shading_of(
        self, ob: Any, index: int, wants: dict[int, Want], depsgraph: Any
    ) -> MeshShading:
        strands = self.meshes[index].strands
        if self.meshes[index].shading.grids:
            return self.meshes[index].shading
        if strands is not None and index in self._hair:
            return hair_shading(ob, hair_of(ob, depsgraph.mode == "RENDER"), strands, wants)
        if strands is not None:
            return strand_shading(ob.data, ob.type, ob.name, wants)
        return self._mesh_shading(ob, wants, self._flat.get(index))

    def _mesh_shading(
        self, ob: Any, wants: dict[int, Want], left: NDArray[np.bool_] | None
    ) -> MeshShading:
        def make(report: Report) -> MeshShading:
            return _with_mesh(ob, lambda mesh: mesh_shading(mesh, ob.name, wants, left, report))

        known_as = (
            "shading",
            *_known_as(ob),
            tuple(wants.items()),
            left is not None and left.tobytes(),
        )
        return self._kept.get(known_as, _made_of(ob), self._report, make)

    def instances(self) -> Instances:
        if not self._rows:
            return Instances.empty()
        rows = np.array(self._rows, np.uint32)
        placed = Instances(
            rows[:, 0].copy(), np.stack(self._matrices), rows[:, 1].copy(), self._attributes
        )
        if any(self._groups):
            placed.group = np.array(self._groups, np.uint8)
        if any(lit != ALL_GROUPS for lit in self._lit_groups):
            placed.lit_groups = np.array(self._lit_groups, np.uint64)
        if any(blockers != ALL_GROUPS for blockers in self._blockers):
            placed.blockers = np.array(self._blockers, np.uint64)
        if any(group != NO_LIGHT_GROUP for group in self._light_groups):
            placed.light_group = np.array(self._light_groups, np.int16)
        if any(rays != ALL_RAYS for rays in self._seen_by):
            placed.seen_by = np.array(self._seen_by, np.uint32)
        if any(self._holdouts):
            placed.holdout = np.array(self._holdouts, np.bool_)
        if any(self._catchers):
            placed.catcher = np.array(self._catchers, np.bool_)
        if any(offset != TERMINATOR_OFFSET for offset in self._terminator_offsets):
            placed.terminator_offset = np.array(self._terminator_offsets, np.float32)
        if any(density != 1.0 for density in self._densities.values()):
            placed.density = np.ones(len(rows), np.float32)
            placed.density[list(self._densities)] = list(self._densities.values())
        return placed

    def _add_rows(self, instance: Any, depsgraph: Any, override: Any) -> range:
        """What an instance of the graph shows: its mesh, curves or points, and its hair."""
        ob, before = instance.object, len(self._rows)
        matrix = np.array(instance.matrix_world, np.float64)
        view_layer = depsgraph.view_layer
        strands_shown = view_layer.use_strand
        if instance.show_self and is_volume(ob):
            if getattr(view_layer, "use_volumes", True):
                self._add_volume(ob, matrix, depsgraph, override)
        elif instance.show_self and ob.type == "MESH":
            if view_layer.use_solid:
                self._add_mesh(ob, matrix, override)
        elif instance.show_self and (strands_shown or ob.type != "CURVES"):
            self._add_strands(ob, matrix, depsgraph, override)
        if instance.show_particles and strands_shown and ob.type == "MESH":
            self._add_hair(ob, matrix, depsgraph, override)
        return range(before, len(self._rows))

    def _add_strands(
        self, ob: Any, matrix: NDArray[np.float64], depsgraph: Any, override: Any
    ) -> None:
        data, look = ob.data, look_of(depsgraph.scene_eval)
        pointer = data.as_pointer()
        if pointer not in self._mesh_of:
            positions = data.attributes.get("position")
            known = (pointer, *_made_of(ob), look, 0 if positions is None else len(positions.data))
            self._mesh_of[pointer] = self._append(
                self._kept.get(
                    ("strands", *known),
                    _made_of(ob),
                    self._report,
                    lambda report: export_strands(data, ob.type, ob.name, look, report),
                )
            )
        layer = uv_layer(data) if ob.type == "CURVES" else None
        self._add_row(ob, self._mesh_of[pointer], matrix, layer and layer.name, override)

    def _add_hair(
        self, ob: Any, matrix: NDArray[np.float64], depsgraph: Any, override: Any
    ) -> None:
        systems = hair_of(ob, depsgraph.mode == "RENDER") if ob.particle_systems else []
        if not systems:
            return
        look, key = look_of(depsgraph.scene_eval), -ob.data.as_pointer()
        if key not in self._mesh_of:
            known = ("hair", *_known_as(ob), look, *known_as(systems))
            found = self._append(
                self._kept.get(
                    known,
                    (*_made_of(ob), *made_of(systems)),
                    self._report,
                    lambda report: export_hair(
                        ob, systems, look, report, self._shading.around.watch.go_on
                    ),
                )
            )
            self._mesh_of[key] = found
            if found is not None:
                self._hair.add(found)
        self._add_row(ob, self._mesh_of[key], matrix, _uv_map(ob.data), override)

    def _add_volume(
        self, ob: Any, matrix: NDArray[np.float64], depsgraph: Any, override: Any
    ) -> None:
        """The box around its grids, with the first of its materials that has a volume."""
        found = [override] if override else [slot.material for slot in ob.material_slots]
        for material in filter(None, found):
            own = self._materials.index(material, grids=True)
            volume = self._materials.list[own].volume
            if volume != NO_PROGRAM:
                break
        else:
            return
        wants = self._shading.programs[volume].wants
        names = {
            number: want.name
            for want, number in self._shading.around.wants.ids.items()
            if number in wants and want.kind == "attribute"
        }
        padding = 2 if grid_interpolation(material) == "CUBIC" else 1
        frame = int(depsgraph.scene_eval.frame_current)
        key = ("volume", *known_volume(ob, frame), padding, *names.items())
        if key not in self._volumes:
            self._volumes[key] = self._append(
                self._kept.get(
                    key,
                    _made_of(ob),
                    self._report,
                    lambda report: volume_mesh(ob, names, padding, frame, report),
                )
            )
        index = self._volumes[key]
        if index is None or self._is_flat(matrix, ob.name) is not False:
            return
        materials = (own,)
        if materials not in self._sets:
            self._sets[materials] = len(self.material_sets)
            self.material_sets.append(np.array(materials, np.int32))
        report_unsupported(ob, self._report)
        self._densities[len(self._rows)] = density_of(ob, matrix)
        self._rows.append((index, self._sets[materials]))
        self._matrices.append(matrix)

    def _add_row(
        self,
        ob: Any,
        index: int | None,
        matrix: NDArray[np.float64],
        uv_map: str | None,
        override: Any,
    ) -> None:
        """Of strands."""
        if index is None:
            return
        flat = self._is_flat(matrix, ob.name)
        if flat:
            self._report.warn(
                "Strands left out, as their object's scale flattens them: {}", ob.name
            )
        if flat is not False:
            return
        key = (-1 - index, ob.original.as_pointer())
        if key not in self._set_of:
            self._set_of[key] = self._material_set(ob, index, uv_map, override)
            report_unsupported(ob, self._report)
        self._rows.append((index, self._set_of[key]))
        self._matrices.append(matrix)

    def _add_mesh(self, ob: Any, matrix: NDArray[np.float64], override: Any) -> None:
        data = ob.data
        pointer = data.as_pointer()
        if pointer not in self._mesh_of:
            mesh = self._kept.get(
                ("mesh", *_known_as(ob)),
                _made_of(ob),
                self._report,
                lambda report: _exported(ob, report),
            )
            self._mesh_of[pointer] = self._append(mesh)
        index = self._mesh_of[pointer]
        if index is None:
            return
        flat = self._is_flat(matrix, ob.name)
        if flat is None:
            return
        key = (pointer, ob.original.as_pointer())
        if key not in self._set_of:
            self._set_of[key] = self._material_set(ob, index, _uv_map(data), override)
            report_unsupported(ob, self._report)
        slots = slots_of(
            self.meshes[index],
            self.material_sets[self._set_of[key]].tolist(),
            self._materials.displacements,
        )
        if slots is not None and flat:
            self._report.warn("Objects that their scale flattens are not displaced: {}", ob.name)
        elif slots is not None:
            exported = self.meshes[index]

            def normals(_: Report) -> Normals:
                return _with_mesh(ob, lambda mesh: smooth_normals(mesh, exported, ob.name))

            index = self._displaced.index(
                ob, slots, index, len(self._rows), _known_as(ob), _made_of(ob), normals
            )
        if flat:
            left = flattened(self.meshes[index], matrix, ob.name, self._report)
            if left is None:
                return
            self.meshes.append(left[0])
            index = len(self.meshes) - 1
            self._flat[index] = left[1]
            matrix = np.eye(4)
        self._rows.append((index, self._set_of[key]))
        self._matrices.append(matrix)

    def _add_moving(self, instance: Any, row: int) -> None:
        if self._moving is None:
            return
        ob = instance.object
        own = self._rows[row][0]
        strands = self.meshes[own].strands is not None or bool(self.meshes[own].shading.grids)
        index = own if strands else self._mesh_of[ob.data.as_pointer()]
        assert index is not None
        self._moving.add(instance, row, self.meshes[index], own in self._flat)

    def _append(self, mesh: Mesh | None) -> int | None:
        if mesh is None:
            return None
        self.meshes.append(mesh)
        return len(self.meshes) - 1

    def _is_flat(self, matrix: NDArray[np.float64], name: str) -> bool | None:
        """False: an ordinary matrix. True: it flattens the mesh into a plane. None: it leaves
        nothing (reported).
        """
        if not np.isfinite(matrix).all():
            self._report.warn(
                "Objects left out, as their transformation is not a finite number: {}", name
            )
            return None
        x, y, z = matrix[:3, 0], matrix[:3, 1], matrix[:3, 2]
        largest = np.abs(matrix[:3, :3]).max()
        if largest > 0.0:
            x, y, z = x / largest, y / largest, z / largest
            yz = np.array(
                (y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0])
            )
            if abs(x @ yz) > 1e-12:
                return False
            if (
                max(np.abs(yz).max(), np.abs(np.cross(x, y)).max(), np.abs(np.cross(x, z)).max())
                > 1e-12
            ):
                return True
        self._report.warn("Objects left out, as their scale is zero: {}", name)
        return None

    def _material_set(self, ob: Any, mesh_index: int, uv_map: str | None, override: Any) -> int:
        """Index of the set for an object's slots, as long as the mesh's slots need: the last
        material serves those beyond.
        """
        found = [override] if override else [slot.material for slot in ob.material_slots] or [None]
        indices = [self._materials.index(material, uv_map) for material in found]
        mesh = self.meshes[mesh_index]
        slots = mesh.slots if mesh.strands is None else mesh.strands.slots
        needed = 1 if slots is None else int(np.max(slots)) + 1
        indices += [indices[-1]] * (needed - len(indices))
        key = tuple(indices)
        if key not in self._sets:
            self._sets[key] = len(self.material_sets)
            self.material_sets.append(np.array(indices, np.int32))
        return self._sets[key]


def _uv_map(mesh: Any) -> str | None:
    return next((layer.name for layer in mesh.uv_layers if layer.active_render), None)


def _made_of(ob: Any) -> tuple[int, int]:
    return identity(ob), identity(ob.original.data)


def _known_as(ob: Any) -> tuple[int, ...]:
    data = ob.data
    return (data.as_pointer(), *_made_of(ob), len(data.vertices), len(data.polygons))


def _exported(ob: Any, report: Report) -> Mesh | None:
    return _with_mesh(ob, lambda mesh: export_mesh(mesh, ob.name, report))


def _with_mesh(ob: Any, make: Callable[[Any], Value]) -> Value:
    """What `make` makes of an object's mesh."""
    if not ob.data.is_editmode:
        return make(ob.data)
    try:  # in edit mode the arrays of the mesh itself are not up to date
        return make(ob.to_mesh())
    finally:
        ob.to_mesh_clear()
