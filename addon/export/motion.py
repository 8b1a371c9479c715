"""What has moved while the shutter is open, as Cycles does it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Mesh, Neighbours, Scene
from ..core.scene.motion import CameraMotion, MeshMotion, Shutter
from .arrays import read
from .camera import camera_matrix
from .geometry.mesh import sound_triangles
from .geometry.particle_hair import hair_keys, hair_of
from .geometry.strands import STRANDS, keys_now
from .report import Report
from .shutter import (
    VECTOR_STEPS,
    Blur,
    Key,
    key_of,
    shutter_curve,
    steps_of,
    times_of,
)
from .views import View

HAIR = -1
"""Stands behind the key of an instance for the hair that grows on it."""


@dataclass(slots=True)
class _Placed:
    rows: list[int]
    steps: int
    vanishes: bool  # a particle is there as long as all steps know it
    matrices: dict[float, NDArray[np.float64]] = field(default_factory=dict)


@dataclass(slots=True)
class _Shape:
    """A mesh that may change its shape. corners: loops of its triangles, where normals are
    theirs. known: positions are, by the velocities of its vertices. looked_at: times at which an
    instance has been asked, whether it could tell or not.
    """

    name: str
    steps: int
    mesh: Mesh
    corners: NDArray[np.int32] | None
    rows: list[int] = field(default_factory=list)
    known: bool = False
    of_hair: bool = False  # keys of particles' hair; positions of strands have radii
    looked_at: set[float] = field(default_factory=set)
    positions: dict[float, NDArray[np.float32]] = field(default_factory=dict)
    normals: dict[float, NDArray[np.float32]] = field(default_factory=dict)


class Moving:
    """What may move of the instances of one export, found at the shutter's centre, looked at again
    at other times.
    """

    def __init__(
        self, depsgraph: Any, blur: Blur, report: Report, view: View | None = None
    ) -> None:
        self._scene, self._blur, self._report = depsgraph.scene, blur, report
        self._placed: dict[Key, _Placed] = {}
        self._shapes: dict[Key, _Shape] = {}
        self._shape_of: dict[int, _Shape | None] = {}
        self._camera: dict[float, tuple[NDArray[np.float64], float]] = {}
        self._camera_steps = 0
        self._view = view
        self._about = "Vector pass" if blur.vectors else "Motion blur"

    def _steps_of(self, ob: Any, parent: Any = None) -> int:
        return VECTOR_STEPS if self._blur.vectors else steps_of(ob, parent)

    def add(
        self, instance: Any, row: int, mesh: Mesh, flat: bool = False, diced: bool = False
    ) -> None:
        """An instance that has become `row`; `mesh` as it is before displacement. `flat`: its scale
        flattens it; `diced`: it is subdivided adaptively.
        """
        ob = instance.object
        parent = instance.parent if instance.is_instance else None
        steps = self._steps_of(ob, parent)
        if not steps:
            return
        if flat:
            self._report.warn(
                f"{self._about}: objects that their scale flattens stand still: {{}}", ob.name
            )
            return
        key = key_of(instance)
        vanishes = instance.is_instance and instance.particle_system is not None
        self._placed.setdefault(key, _Placed([], steps, vanishes)).rows.append(row)
        if diced:
            if self._changes(ob, parent):
                self._report.warn(
                    f"{self._about}: meshes that are subdivided adaptively keep their shape: {{}}",
                    ob.name,
                )
            return
        of_hair = mesh.strands is not None and ob.type == "MESH"
        shape = self._shape((*key, HAIR) if of_hair else key, ob, parent, steps, mesh)
        if shape is not None:
            shape.rows.append(row)

    def _shape(self, key: Key, ob: Any, parent: Any, steps: int, mesh: Mesh) -> _Shape | None:
        """That of the mesh, which any instance tells that is there at the time."""
        if not self._may_change(ob, parent):
            return None
        if id(mesh) not in self._shape_of:
            self._shape_of[id(mesh)] = self._new_shape(ob, steps, mesh)
        shape = self._shape_of[id(mesh)]
        if shape is not None:
            self._shapes[key] = shape
        return shape

    def _new_shape(self, ob: Any, steps: int, mesh: Mesh) -> _Shape | None:
        if mesh.shading.grids:
            return None
        of_hair = mesh.strands is not None and ob.type == "MESH"
        velocity, places = None if of_hair else _velocities(ob.data), _places(mesh)
        if velocity is not None and len(velocity) == len(places):
            shape = _Shape(ob.name, 3, mesh, None, known=True)
            way = np.zeros_like(places)
            way[:, :3] = velocity * np.float32(0.5 * self._blur.shutter * self._blur.frame_seconds)
            shape.positions = {-1.0: places - way, 1.0: places + way}
            return shape
        if not self._is_deformed(ob):
            return None
        corners = None
        if mesh.corner_normals is not None:
            found = sound_triangles(ob.data, ob.name, Report())
            corners = None if found is None else np.array(found.corners)
        return _Shape(ob.name, steps, mesh, corners, of_hair=of_hair)

    def _is_deformed(self, ob: Any) -> bool:
        """Blender does not tell of text and curves that their own settings may be keyed."""
        return ob.original.type in {"FONT", "CURVE", "SURFACE"} or bool(
            ob.is_deform_modified(self._scene, "RENDER")
        )

    def _may_change(self, ob: Any, parent: Any) -> bool:
        asked = [getattr(one, "cycles", None) for one in (ob, parent) if one is not None]
        return self._blur.vectors or all(getattr(one, "use_deform_motion", True) for one in asked)

    def _changes(self, ob: Any, parent: Any) -> bool:
        """Whether the shape of a mesh does."""
        return self._may_change(ob, parent) and (
            _velocities(ob.data) is not None or self._is_deformed(ob)
        )

    def add_camera(self, ob: Any, report: Report) -> None:
        self._camera_steps = self._steps_of(ob)
        self._see_camera(0.0, ob, report)

    def times(self) -> list[float]:
        """All that are to be looked at, the centre aside."""
        steps = {self._camera_steps, *(placed.steps for placed in self._placed.values())} - {0}
        return sorted({time for count in steps for time in times_of(count)} - {0.0})

    def see(self, depsgraph: Any, camera: Any, time: float, go_on: Callable[[], None]) -> None:
        """Looks at the graph where it is at `time`. `camera`: the original."""
        for instance in depsgraph.object_instances:
            go_on()
            if instance.object.type not in {"MESH", "VOLUME", *STRANDS}:
                continue
            key = key_of(instance)
            placed = self._placed.get(key)
            if placed is None or time not in times_of(placed.steps):
                continue
            placed.matrices[time] = np.array(instance.matrix_world, np.float64)
            for shape in (self._shapes.get(key), self._shapes.get((*key, HAIR))):
                if shape is None or shape.known or time in shape.looked_at:
                    continue
                shape.looked_at.add(time)
                if shape.mesh.strands is not None:
                    rendered = depsgraph.mode == "RENDER"
                    self._see_strands(shape, instance.object, time, rendered, go_on)
                else:
                    self._see_shape(shape, instance.object, time)
        if self._camera_steps and time in times_of(self._camera_steps):
            self._see_camera(time, camera.evaluated_get(depsgraph), Report())

    def _see_shape(self, shape: _Shape, ob: Any, time: float) -> None:
        mesh = ob.data
        positions = read(mesh.vertices, "co", np.float32, 3)
        if len(positions) != len(shape.mesh.positions) or not np.isfinite(positions).all():
            self._report.warn(
                f"{self._about}: meshes keep their shape, as their number of vertices changes: "
                "{}",
                ob.name,
            )
            return
        shape.positions[time] = np.array(positions)
        if shape.mesh.vertex_normals is not None:
            shape.normals[time] = np.array(read(mesh.vertex_normals, "vector", np.float32, 3))
        elif shape.corners is not None:
            normals = read(mesh.corner_normals, "vector", np.float32, 3)
            if not len(shape.corners) or int(np.max(shape.corners)) < len(normals):
                shape.normals[time] = np.take(normals, shape.corners, axis=0)

    def _see_strands(
        self, shape: _Shape, ob: Any, time: float, rendered: bool, go_on: Callable[[], None]
    ) -> None:
        keys = (
            hair_keys(ob, hair_of(ob, rendered), go_on)
            if shape.of_hair
            else keys_now(ob.data, ob.type)
        )
        if keys is None or len(keys) != len(_places(shape.mesh)) or not np.isfinite(keys).all():
            self._report.warn(
                f"{self._about}: strands keep their shape, as their number of keys changes: {{}}",
                ob.name,
            )
            return
        shape.positions[time] = keys

    def _see_camera(self, time: float, ob: Any, report: Report) -> None:
        data = ob.data
        lens = float(data.lens) if data.type == "PERSP" else 1.0
        side = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
        extent = float(side) / lens if data.type == "PERSP" else 1.0
        self._camera[time] = (camera_matrix(ob, report, self._view), extent)

    def move(self, scene: Scene, render: Any) -> None:
        """Tells `scene` what has moved, and its shutter if anything has."""
        motion: dict[int, NDArray[np.float64]] = {}
        lost = []
        for placed in self._placed.values():
            rows, times = placed.rows, times_of(placed.steps)
            if placed.vanishes and any(time and time not in placed.matrices for time in times):
                lost += rows
                continue
            own = scene.instances.matrix[rows[0]]
            steps = np.stack([placed.matrices.get(time, own) for time in times])
            if _differ(steps, own) and np.isfinite(steps).all():
                motion |= dict.fromkeys(rows, steps)
        scene.instances.motion = motion
        for shape in filter(None, self._shape_of.values()):
            self._move_shape(scene, shape)
        self._move_camera(scene)
        _remove(scene, lost)
        if scene.instances.motion or scene.camera.motion or any(m.moves for m in scene.meshes):
            scene.shutter = Shutter(shutter_curve(render), self._blur.rolling)

    def neighbours(self, scene: Scene) -> Neighbours:
        """Where all that moves is in the frames before and after."""
        times = (-1.0, 1.0)
        moves: dict[int, NDArray[np.float64]] = {}
        for placed in self._placed.values():
            own = scene.instances.matrix[placed.rows[0]]
            steps = np.stack([placed.matrices.get(time, own) for time in times])
            if _differ(steps, own) and np.isfinite(steps).all() and np.linalg.det(own) != 0.0:
                moves |= dict.fromkeys(placed.rows, steps @ np.linalg.inv(own))
        shapes: dict[int, NDArray[np.float32]] = {}
        for shape in filter(None, self._shape_of.values()):
            places = _places(shape.mesh)
            by = np.stack([(shape.positions.get(t, places) - places)[:, :3] for t in times])
            if by.any():
                shapes |= {int(scene.instances.mesh[row]): by for row in shape.rows}
        own, extent = self._camera[0.0]
        seen = [self._camera.get(time, (own, extent)) for time in times]
        zoom = (seen[0][1] / extent, seen[1][1] / extent)
        return Neighbours(moves, shapes, np.stack([matrix for matrix, _ in seen]), zoom)

    def _move_shape(self, scene: Scene, shape: _Shape) -> None:
        base, times = shape.mesh, times_of(shape.steps)
        places = _places(base)
        if not any(not np.array_equal(p, places) for p in shape.positions.values()):
            return
        if base.strands is not None:
            steps = np.stack([shape.positions.get(time, places) for time in times])
            moved = replace(base.strands, motion=steps)
            for index in {int(scene.instances.mesh[row]) for row in shape.rows}:
                scene.meshes[index] = replace(scene.meshes[index], strands=moved)
            return
        for index in {int(scene.instances.mesh[row]) for row in shape.rows}:
            mesh = scene.meshes[index]
            positions = np.stack(
                [
                    mesh.positions + (shape.positions.get(time, base.positions) - base.positions)
                    for time in times
                ]
            )
            motion = MeshMotion(positions)
            if mesh.positions is base.positions and shape.normals:
                own = base.corner_normals if base.vertex_normals is None else base.vertex_normals
                assert own is not None
                normals = np.stack([shape.normals.get(time, own) for time in times])
                if base.vertex_normals is None:
                    motion.corner_normals = normals
                else:
                    motion.vertex_normals = normals
            scene.meshes[index] = replace(mesh, motion=motion)

    def _move_camera(self, scene: Scene) -> None:
        if not self._camera_steps:
            return
        own, extent = self._camera[0.0]
        times = times_of(self._camera_steps)
        matrices = np.stack([self._camera[time][0] for time in times])
        zoom = (self._camera[-1.0][1] / extent, self._camera[1.0][1] / extent)
        if _differ(matrices, own) or zoom != (1.0, 1.0):
            scene.camera.motion = CameraMotion(matrices, zoom)


def _places(mesh: Mesh) -> NDArray[np.float32]:
    return mesh.positions if mesh.strands is None else mesh.strands.keys


def _velocities(mesh: Any) -> NDArray[np.float32] | None:
    """(V, 3) m/s, of simulations and caches, whose vertices are others in each frame."""
    found = mesh.attributes.get("velocity")
    if found is None or found.domain != "POINT" or found.data_type != "FLOAT_VECTOR":
        return None
    return np.nan_to_num(read(found.data, "vector", np.float32, 3), posinf=0.0, neginf=0.0)


def _differ(steps: NDArray[np.float64], own: NDArray[np.float64]) -> bool:
    """Whether matrices do, as the renderer holds them."""
    return bool((steps.astype(np.float32) != own.astype(np.float32)).any())


def _remove(scene: Scene, rows: list[int]) -> None:
    """Takes instances out of the scene: particles that are not there all of the time, which Cycles
    hides.
    """
    if not rows:
        return
    old = scene.instances
    left = np.ones(len(old.mesh), bool)
    left[rows] = False
    number = np.cumsum(left) - 1

    kept: dict[str, Any] = {
        one.name: getattr(old, one.name)[left]
        for one in fields(old)
        if isinstance(getattr(old, one.name), np.ndarray)
    }
    scene.instances = replace(
        old,
        **kept,
        attributes=[replace(one, values=one.values[left]) for one in old.attributes],
        motion={int(number[row]): steps for row, steps in old.motion.items()},
    )
