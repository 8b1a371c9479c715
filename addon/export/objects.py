"""Everything that stands in the scene: meshes once each, and instances and lamps where they are."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import NO_LIGHT_GROUP, NO_PROGRAM, Camera, Frame, Instances, Light, Mesh, Ray
from ..core.scene.shading import InstanceAttribute
from .geometry.adaptive import Adaptive, adaptive_of, eye_of, levels_of
from .geometry.displacement import Displaced, slots_of
from .geometry.flatness import is_flat
from .geometry.instance_attributes import InstanceAttributes
from .geometry.instance_values import reader_of
from .geometry.object_shading import ObjectShading
from .geometry.particle_hair import hair_of
from .geometry.rows import Rows, Traits
from .geometry.shapes import Shapes
from .geometry.strands import STRANDS, look_of, uv_layer
from .geometry.volumes import density_of, is_volume
from .kept import Kept
from .labels import Labelled
from .lights import export_light
from .linking import Linking
from .material_sets import MaterialSets, materials_of
from .materials import Materials, Shading, grid_interpolation
from .matrices import Matrices
from .motion import Moving
from .nodes.node import Want, Wants
from .repeats import Repeats
from .visibility import FLAGS, Visibility, report_unsupported, terminator_offset

SEEING_RAYS = sum(FLAGS.values())
PENCILS = {"GREASEPENCIL", "GPENCIL"}
"""Of Blender 4.3 and of older ones."""
LOOKS = 64
"""Of as many instances of known meshes, one asks whether the export has been cancelled."""


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
        self.lights: list[Light] = []
        self._materials, self._shading, self._report = materials, shading, shading.around.report
        self._moving = moving
        self._labelled = labelled
        # Edits of materials in a viewport change no mesh.
        in_viewport = shading.around.depsgraph.mode == "VIEWPORT"
        self._shapes = Shapes(kept, self._report, shading.around.watch.go_on, in_viewport)
        self._sets = MaterialSets(materials)
        self._set_of: dict[tuple[int, int], int] = {}
        self._rows = Rows()
        self._light_group_of = {name: i for i, name in enumerate(light_groups)}
        self._object_shading = ObjectShading(self._shapes, self._rows, shading, kept)
        self._attributes: list[InstanceAttribute] = []
        go_on = shading.around.watch.go_on
        self._of_nodes = InstanceAttributes(self._report)
        self._displaced = Displaced(self._shapes.list, kept, self._report, go_on)

    @property
    def meshes(self) -> list[Mesh]:
        return self._shapes.list

    @property
    def material_sets(self) -> list[NDArray[np.int32]]:
        return self._sets.list

    def instances(self) -> Instances:
        return self._rows.instances(self._attributes)

    def collect(self, depsgraph: Any, visible: Callable[[Any], bool] | None = None) -> None:
        """Blender reuses the objects that the graph's iterator returns, so none of them may be
        kept.
        """
        view_layer = depsgraph.view_layer
        override = view_layer.material_override
        linking = Linking(depsgraph, self._report)
        visibility = Visibility(view_layer)
        repeats, matrices = Repeats(), Matrices(depsgraph)
        self._rows.of_graph = matrices.all
        plain = self._moving is None and self._labelled is None
        catches, of_things = False, list[str]()
        for place, instance in enumerate(depsgraph.object_instances):
            ob = instance.object
            if visible is not None and not visible(instance):
                continue
            key = Repeats.key(instance, ob)
            known = repeats.get(key)
            if known is None or place % LOOKS == 0:
                self._shading.around.watch.go_on()
            if known is not None:
                if plain and matrices.ordinary[place]:
                    self._rows.repeat(place, known, instance.random_id)
                else:
                    self._repeat(place, instance, matrices.of(place), known)
                continue
            kind = ob.type
            if kind in {"MESH", "VOLUME"} or kind in STRANDS:
                rays, holdout, catcher = visibility.of(instance)
                catches |= catcher
                if not rays & SEEING_RAYS:
                    continue
                matrix = matrices.of(place)
                rows = self._add_rows(instance, matrix, depsgraph, override)
                if not rows:
                    continue
                traits = Traits(
                    owner=ob.name,
                    group=linking.group(instance),
                    lit_groups=linking.lit_groups(ob),
                    blockers=linking.blockers(ob),
                    light_group=self._light_group(ob),
                    seen_by=rays,
                    holdout=holdout,
                    catcher=catcher,
                    terminator_offset=terminator_offset(ob, "geometry"),
                )
                self._describe(place, instance, rows, traits)
                if not rays & Ray.VOLUME and self._has_medium(rows):
                    self._report.warn(
                        "Volumes whose object hides from volume rays (Ray Visibility, Volume "
                        "Scatter) scatter light once; in Cycles more often, so that they may be "
                        "brighter or darker here: {}",
                        ob.name,
                    )
                mesh, _ = self._rows.placed(rows.start)
                # neither flattened nor displaced
                if len(rows) == 1 and kind == "MESH" and mesh == self._shapes.of_mesh(ob):
                    repeats.keep(key, ob, self._rows.kinds[rows.start])
            elif kind == "LIGHT":
                if instance.show_self:
                    if not ob.is_shadow_catcher:
                        of_things.append(ob.name)
                    self._add_light(
                        instance, matrices.of(place), linking, visibility.of(instance)[0]
                    )
            elif kind in PENCILS and instance.show_self:
                self._report.warn(
                    "Blender draws grease pencil objects over the picture; they cast no shadow, "
                    "and nothing mirrors them: {}",
                    ob.name,
                )
        for name in of_things if catches else ():
            self._report.warn(
                "Lamps whose Shadow Catcher is off light shadow catchers as any other lamp does, "
                "while in Cycles they add light to them: {}",
                name,
            )

    def _has_medium(self, rows: range) -> bool:
        sets = {self._rows.placed(row)[1] for row in rows}
        return any(
            self._materials.list[material].volume != NO_PROGRAM
            for found in sets
            for material in self._sets.list[found].tolist()
        )

    def _describe(self, place: int, instance: Any, rows: range, traits: Traits) -> None:
        """Of an instance of the graph that has become these rows."""
        for row in rows:
            self._rows.describe(place, traits)
            self._follow(instance, row)

    def _follow(self, instance: Any, row: int) -> None:
        self._add_moving(instance, row)
        if self._labelled is not None:
            self._labelled.add(instance.object)

    def _repeat(self, place: int, instance: Any, matrix: NDArray[np.float64], kind: int) -> None:
        """Places the mesh of an earlier instance, whose matrix may flatten it."""
        ob, row = instance.object, len(self._rows)
        flat = is_flat(matrix, ob.name, self._report)
        if flat is None:
            return
        if not flat:
            self._rows.repeat(place, kind, instance.random_id)
            self._follow(instance, row)
            return
        mesh, materials = self._rows.placed(self._rows.first_rows[kind])
        flattened = self._shapes.flattened(mesh, matrix, ob.name)
        if flattened is None:
            return
        self._rows.add(flattened, materials, np.eye(4))
        self._describe(place, instance, range(row, row + 1), self._rows.traits(kind))

    def collect_shading(self, depsgraph: Any, wants: Wants, of_instances: frozenset[int]) -> None:
        """What programs read from meshes and instances (ids of `wants`). The graph has not changed
        since collect().
        """
        of_materials = [
            self._materials.wanted_of_meshes(index) for index in range(len(self._materials.list))
        ]
        of_sets = [
            frozenset[int]().union(*(of_materials[index] for index in set(found.tolist())))
            for found in self._sets.list
        ]
        with_uv = wants.active_uv_map or depsgraph.view_layer.use_pass_uv
        self._attributes = self._object_shading.collect(
            depsgraph, wants, self._rows.of_meshes(of_sets), of_instances, with_uv
        )

    def displace(self, depsgraph: Any, camera: Camera, frame: Frame) -> None:
        """Dices the meshes that are subdivided adaptively, and moves those that materials displace;
        after collect_shading().
        """
        if not self._displaced.found:
            return
        self._displaced.move(
            self._rows.matrices(),
            self._attributes,
            self._shading.around.textures.list,
            camera,
            self._shading.asked_of_displaced,
            eye_of(depsgraph, camera, frame),
            levels_of(depsgraph.scene_eval),
        )
        # not those that stand nowhere undisplaced
        self._shapes.list = [self._shapes.list[i] for i in self._rows.keep_used_meshes()]

    def _light_group(self, ob: Any) -> int:
        return self._light_group_of.get(ob.original.lightgroup, NO_LIGHT_GROUP)

    def _add_light(
        self, instance: Any, matrix: NDArray[np.float64], linking: Linking, rays: int
    ) -> None:
        ob = instance.object

        def read(want: Want) -> Any:
            graph = self._shading.around.depsgraph
            return reader_of(want, graph, self._of_nodes)(instance)

        light = export_light(ob, matrix, rays, self._shading, read)
        if light is None:
            return
        light.lit_groups, light.blockers = linking.lit_groups(ob), linking.blockers(ob)
        light.light_group = self._light_group(ob)
        self.lights.append(light)

    def _add_rows(
        self, instance: Any, matrix: NDArray[np.float64], depsgraph: Any, override: Any
    ) -> range:
        """What an instance of the graph shows: its mesh, curves or points, and its hair."""
        ob, before = instance.object, len(self._rows)
        view_layer = depsgraph.view_layer
        strands_shown = view_layer.use_strand
        if instance.show_self and is_volume(ob):
            if getattr(view_layer, "use_volumes", True):
                self._add_volume(ob, matrix, depsgraph, override)
        elif instance.show_self and ob.type == "MESH":
            if view_layer.use_solid:
                self._add_mesh(ob, matrix, override, adaptive_of(ob, depsgraph))
        elif instance.show_self and (strands_shown or ob.type != "CURVES"):
            index = self._shapes.of_strands(ob, look_of(depsgraph.scene_eval))
            layer = uv_layer(ob.data) if ob.type == "CURVES" else None
            self._place_strands(ob, index, matrix, layer and layer.name, override)
        if instance.show_particles and strands_shown and ob.type == "MESH":
            self._add_hair(ob, matrix, depsgraph, override)
        return range(before, len(self._rows))

    def _add_hair(
        self, ob: Any, matrix: NDArray[np.float64], depsgraph: Any, override: Any
    ) -> None:
        systems = hair_of(ob, depsgraph.mode == "RENDER") if ob.particle_systems else []
        if not systems:
            return
        index = self._shapes.of_hair(ob, systems, look_of(depsgraph.scene_eval))
        self._place_strands(ob, index, matrix, _uv_map(ob.data), override)

    def _place_strands(
        self,
        ob: Any,
        index: int | None,
        matrix: NDArray[np.float64],
        uv_map: str | None,
        override: Any,
    ) -> None:
        if index is None:
            return
        flat = is_flat(matrix, ob.name, self._report)
        if flat:
            self._report.warn(
                "Strands left out, as their object's scale flattens them: {}", ob.name
            )
        if flat is not False:
            return
        materials = self._material_set(-1 - index, ob, index, uv_map, override)
        self._rows.add(index, materials, matrix)

    def _add_volume(
        self, ob: Any, matrix: NDArray[np.float64], depsgraph: Any, override: Any
    ) -> None:
        """The box around its grids, with the first of its materials that has a volume."""
        found = [override] if override else materials_of(ob)
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
        index = self._shapes.of_volume(ob, names, padding, frame)
        if index is None or is_flat(matrix, ob.name, self._report) is not False:
            return
        report_unsupported(ob, self._report)
        self._rows.add(index, self._sets.index((own,)), matrix, density_of(ob, matrix))

    def _add_mesh(
        self, ob: Any, matrix: NDArray[np.float64], override: Any, adaptive: Adaptive | None
    ) -> None:
        index = self._shapes.of_mesh(ob)
        if index is None:
            return
        flat = is_flat(matrix, ob.name, self._report)
        if flat is None:
            return
        materials = self._material_set(ob.data.as_pointer(), ob, index, _uv_map(ob.data), override)
        index = self._displaced_index(ob, index, materials, adaptive, flat)
        if flat:
            flattened = self._shapes.flattened(index, matrix, ob.name)
            if flattened is None:
                return
            index, matrix = flattened, np.eye(4)
        self._rows.add(index, materials, matrix)

    def _displaced_index(
        self, ob: Any, index: int, materials: int, adaptive: Adaptive | None, flat: bool
    ) -> int:
        """That of the mesh to be diced, or displaced by one of its materials; else its own."""
        slots = slots_of(
            self.meshes[index],
            self.material_sets[materials].tolist(),
            self._materials.displacements,
        )
        if slots is None and adaptive is None:
            return index
        if flat:
            if slots is not None:
                self._report.warn(
                    "Objects that their scale flattens are not displaced: {}", ob.name
                )
            return index
        return self._displaced.index(ob, slots, adaptive, index, len(self._rows))

    def _material_set(
        self, shape: int, ob: Any, index: int, uv_map: str | None, override: Any
    ) -> int:
        """That of an object's slots; `shape` tells its mesh from its hair."""
        key = (shape, ob.original.as_pointer())
        if key not in self._set_of:
            self._set_of[key] = self._sets.of_object(ob, self.meshes[index], uv_map, override)
            report_unsupported(ob, self._report)
        return self._set_of[key]

    def _add_moving(self, instance: Any, row: int) -> None:
        if self._moving is None:
            return
        own, _ = self._rows.placed(row)
        strands = self.meshes[own].strands is not None or bool(self.meshes[own].shading.grids)
        index = own if strands else self._shapes.of_mesh(instance.object)
        assert index is not None
        flat, diced = own in self._shapes.flat, self._displaced.is_diced(own)
        self._moving.add(instance, row, self.meshes[index], flat, diced)


def _uv_map(mesh: Any) -> str | None:
    return next((layer.name for layer in mesh.uv_layers if layer.active_render), None)
