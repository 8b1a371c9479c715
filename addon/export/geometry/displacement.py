"""Meshes that the displacement of their materials moves: each has vertices of its own then, as
Cycles has it, for every set of materials.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.native.displace import displaced, textures_of
from ...core.scene import Camera, Mesh, Texture
from ...core.scene.displacement import Displacement, Normals
from ...core.scene.shading import Domain, InstanceAttribute, MeshAttribute
from ..arrays import read
from ..kept import Kept
from ..report import Report
from .mesh import sound_part, sound_triangles

Slots = tuple[Displacement | None, ...]


@dataclass(slots=True)
class _Job:
    """A mesh to be displaced: where it stands in the list of meshes, and which instance says
    where it is.
    """

    mesh: int
    row: int
    name: str
    known_as: tuple[int, ...]
    sources: tuple[int, ...]
    normals: Normals
    slots: Slots


class Displaced:
    """The meshes of one export that are displaced."""

    def __init__(self, meshes: list[Mesh], kept: Kept, report: Report) -> None:
        self._meshes, self._kept, self._report = meshes, kept, report
        self._index_of: dict[tuple[int, ...], int] = {}
        self._jobs: list[_Job] = []

    @property
    def found(self) -> bool:
        return bool(self._jobs)

    def index(
        self,
        ob: Any,
        slots: Slots,
        index: int,
        row: int,
        known_as: tuple[int, ...],
        sources: tuple[int, ...],
        normals: Callable[[Report], Normals],
    ) -> int:
        """Index of the mesh that the materials of `slots` make of that of `index`, where the
        instance of `row` stands.
        """
        by_object = any(slot.link == "OBJECT" for slot in ob.material_slots)
        own = ob.original.as_pointer() if by_object else 0
        key = (index, own, *(id(slot) for slot in slots))
        if key not in self._index_of:
            report_adaptive(ob, self._report)
            found = self._kept.get(("normals", *known_as), sources, self._report, normals)
            self._index_of[key] = len(self._meshes)
            job = _Job(len(self._meshes), row, ob.name, known_as, sources, found, slots)
            self._jobs.append(job)
            self._meshes.append(self._meshes[index])
        return self._index_of[key]

    def move(
        self,
        matrices: Sequence[NDArray[np.float64]],
        attributes: Sequence[InstanceAttribute],
        textures: Sequence[Texture],
        camera: Camera,
        keep_normals: bool,
    ) -> None:
        """Displaces them all, with everything known that programs ask for."""
        for job in self._jobs:
            own = [
                InstanceAttribute(one.id, one.values[job.row : job.row + 1]) for one in attributes
            ]
            matrix, mesh = matrices[job.row], self._meshes[job.mesh]
            key = self._key(job, mesh, matrix, own, textures, camera, keep_normals)

            def make(
                report: Report,
                job: _Job = job,
                mesh: Mesh = mesh,
                matrix: NDArray[np.float64] = matrix,
                own: list[InstanceAttribute] = own,
            ) -> tuple[Mesh, Any]:
                moved, lost = displaced(
                    mesh, job.normals, job.slots, matrix, own, textures, camera, keep_normals
                )
                if lost:
                    report.warn(
                        "Object {}: its displacement is not a finite number at "
                        f"{lost} vertices, which stay where they are",
                        job.name,
                    )
                # what the key names by its place in memory has to stay there
                return _with_area(moved, job.name, report), (mesh, job.normals, textures)

            self._meshes[job.mesh], _ = self._kept.get(key, job.sources, self._report, make)

    @staticmethod
    def _key(
        job: _Job,
        mesh: Mesh,
        matrix: NDArray[np.float64],
        attributes: list[InstanceAttribute],
        textures: Sequence[Texture],
        camera: Camera,
        keep_normals: bool,
    ) -> tuple[Any, ...]:
        programs = [slot.program for slot in job.slots if slot is not None]
        read = [textures[i] for i in sorted({i for one in programs for i in textures_of(one)})]
        return (
            "displaced",
            *job.known_as,
            id(mesh.positions),
            id(job.normals),
            *(None if s is None else (_code(s), s.bumps) for s in job.slots),
            matrix.tobytes(),
            *((one.id, one.values.tobytes()) for one in attributes),
            *((one.id, id(one.values)) for one in mesh.shading.attributes),
            *((id(t.pixels), t.srgb, t.interpolation, t.extension) for t in read),
            camera.matrix.tobytes(),
            keep_normals,
        )


def _code(displacement: Displacement) -> tuple[bytes, bytes]:
    program = displacement.program
    return program.code.tobytes(), program.constants.tobytes()


def slots_of(
    mesh: Mesh, materials: Sequence[int], displacements: dict[int, Displacement]
) -> Slots | None:
    """The displacement of each slot, None where no triangle of `mesh` is moved."""
    if not displacements:
        return None
    slots = tuple(displacements.get(int(material)) for material in materials)
    used = [0] if mesh.slots is None else np.unique(mesh.slots)
    return slots if any(slots[min(int(i), len(slots) - 1)] for i in used) else None


def smooth_normals(mesh: Any, exported: Mesh, name: str) -> Normals:
    """The normals along which a bpy.types.Mesh is displaced: smooth ones of flat faces as well."""
    domain = mesh.normals_domain
    if domain == "FACE":
        of_vertices = np.nan_to_num(read(mesh.vertex_normals, "vector", np.float32, 3))
        return Normals(None, of_vertices, np.zeros(len(exported.triangles), np.bool_))
    smooth_ones = None
    sharp = mesh.attributes.get("sharp_face")
    if domain == "CORNER" and sharp is not None and sharp.domain == "FACE":
        faces = read(mesh.loop_triangle_polygons, "value", np.int32)
        found = sound_triangles(mesh, name, Report())
        if found is not None and found.kept is not None:
            faces = faces[found.kept]
        smooth_ones = ~read(sharp.data, "value", np.bool_)[faces]
    return Normals(
        exported.corner_normals,
        exported.vertex_normals,
        smooth_ones,
        own_corners=domain == "CORNER",
    )


def report_adaptive(ob: Any, report: Report) -> None:
    """Says so where Cycles would subdivide as finely as the camera sees it."""
    original = ob.original
    last = original.modifiers[-1] if len(original.modifiers) else None
    if last is None or last.type != "SUBSURF":
        return
    # before Blender 5.0 a property of the object
    adaptive = getattr(
        last,
        "use_adaptive_subdivision",
        getattr(getattr(original, "cycles", None), "use_adaptive_subdivision", False),
    )
    if adaptive:
        report.warn(
            "Adaptive subdivision is not supported; displaced as finely as the modifier's own "
            "levels subdivide: {}",
            ob.name,
        )


def _with_area(mesh: Mesh, name: str, report: Report) -> Mesh:
    """Without triangles that displacement has left without an area."""
    kept = sound_part(mesh.positions, mesh.triangles, name, report)
    if kept is None:
        return mesh

    def part(attribute: MeshAttribute) -> MeshAttribute:
        values = attribute.values
        if attribute.domain == Domain.FACE:
            values = values[kept]
        elif attribute.domain == Domain.CORNER:
            values = values.reshape(len(kept), 3, -1)[kept].reshape(-1, values.shape[1])
        return replace(attribute, values=values)

    shading = replace(mesh.shading, attributes=[part(one) for one in mesh.shading.attributes])
    return replace(
        mesh,
        triangles=mesh.triangles[kept],
        corner_normals=None if mesh.corner_normals is None else mesh.corner_normals[kept],
        uv=None if mesh.uv is None else mesh.uv[kept],
        slots=None if mesh.slots is None else mesh.slots[kept],
        shading=shading,
    )
