"""Meshes that the displacement of their materials moves, and those that are subdivided adaptively:
each has vertices of its own then, as Cycles has it, for every set of materials.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.dicing.dice import MAX_TRIANGLES, diced
from ...core.dicing.eye import Eye
from ...core.dicing.values import Faces
from ...core.dicing.wanted import Wanted
from ...core.native.displace import displaced
from ...core.native.operations import textures_of
from ...core.render.memory import free_memory_bytes
from ...core.scene import Camera, Mesh, Texture
from ...core.scene.displacement import Displacement, Normals
from ...core.scene.shading import Domain, InstanceAttribute, MeshAttribute
from ..arrays import read
from ..kept import Kept
from ..report import Report
from .adaptive import Adaptive, faces_of, wanted_of
from .mesh import sound_part, sound_triangles
from .shapes import mesh_key, sources, with_mesh

Slots = tuple[Displacement | None, ...]

DICING_BYTES = 400
"""Of memory that a triangle takes while it is made."""


@dataclass(slots=True)
class _Job:
    """A mesh to be displaced or diced: where it stands in the list of meshes, and which instance
    says where it is. `slots` None: nothing moves; `adaptive` None: it has the triangles it has.
    """

    mesh: int
    row: int
    name: str
    known_as: tuple[int, ...]
    sources: tuple[int, ...]
    normals: Normals | Faces
    slots: Slots | None
    adaptive: Adaptive | None


class Displaced:
    """The meshes of one export that are displaced or diced."""

    def __init__(
        self, meshes: list[Mesh], kept: Kept, report: Report, go_on: Callable[[], None]
    ) -> None:
        self._meshes, self._kept, self._report, self._go_on = meshes, kept, report, go_on
        self._index_of: dict[tuple[Hashable, ...], int] = {}
        self._jobs: list[_Job] = []

    @property
    def found(self) -> bool:
        return bool(self._jobs)

    def is_diced(self, index: int) -> bool:
        return any(job.mesh == index and job.adaptive is not None for job in self._jobs)

    def index(
        self,
        ob: Any,
        slots: Slots | None,
        adaptive: Adaptive | None,
        index: int,
        row: int,
    ) -> int:
        """Index of the mesh that the materials of `slots` make of that of `index`, where the
        instance of `row` stands.
        """
        by_object = any(slot.link == "OBJECT" for slot in ob.material_slots)
        own = ob.original.as_pointer() if by_object else 0
        key = (index, own, adaptive, *(id(slot) for slot in slots or ()))
        if key not in self._index_of:
            exported = self._meshes[index]
            known_as, made_of = mesh_key(ob), sources(ob)

            def make(_: Report) -> Normals | Faces:
                if adaptive is None:
                    return with_mesh(ob, lambda mesh: smooth_normals(mesh, exported, ob.name))
                return with_mesh(ob, lambda mesh: faces_of(mesh, exported, adaptive, ob.name))

            found = self._kept.get(("normals", adaptive, *known_as), made_of, self._report, make)
            self._index_of[key] = len(self._meshes)
            job = _Job(len(self._meshes), row, ob.name, known_as, made_of, found, slots, adaptive)
            self._jobs.append(job)
            self._meshes.append(exported)
        return self._index_of[key]

    def move(
        self,
        matrices: NDArray[np.float64],
        attributes: Sequence[InstanceAttribute],
        textures: Sequence[Texture],
        camera: Camera,
        asked: frozenset[int],
        eye: Eye,
        levels: int,
    ) -> None:
        """Dices and displaces them all, with everything known that programs ask for; `asked`: ids
        of what surfaces read as it was before; `eye` and `levels`: how finely.
        """
        for job in self._jobs:
            own = [
                InstanceAttribute(one.id, one.values[job.row : job.row + 1]) for one in attributes
            ]
            matrix, mesh, normals = matrices[job.row], self._meshes[job.mesh], job.normals
            if job.adaptive is not None:
                wanted = wanted_of(job.adaptive, eye, levels)
                mesh, normals = self._diced(job, mesh, matrix, wanted)
            if job.slots is None:
                self._meshes[job.mesh] = mesh
                continue
            assert isinstance(normals, Normals)
            slots = job.slots
            key = self._key(job, slots, normals, mesh, matrix, own, textures, camera, asked)

            def make(
                report: Report,
                job: _Job = job,
                slots: Slots = slots,
                normals: Normals = normals,
                mesh: Mesh = mesh,
                matrix: NDArray[np.float64] = matrix,
                own: list[InstanceAttribute] = own,
            ) -> tuple[Mesh, Any]:
                moved, lost = displaced(mesh, normals, slots, matrix, own, textures, camera, asked)
                if lost:
                    report.warn(
                        "Object {}: its displacement is not a finite number at "
                        f"{lost} vertices, which stay where they are",
                        job.name,
                    )
                # what the key names by its place in memory has to stay there
                return _with_area(moved, job.name, report), (mesh, normals, textures)

            self._meshes[job.mesh], _ = self._kept.get(key, job.sources, self._report, make)

    def _diced(
        self, job: _Job, mesh: Mesh, matrix: NDArray[np.float64], wanted: Wanted
    ) -> tuple[Mesh, Normals]:
        faces = job.normals
        assert isinstance(faces, Faces)
        key = (
            "diced",
            *job.known_as,
            id(mesh.positions),
            id(mesh.uv),
            id(faces),
            wanted.length,
            wanted.levels,
            None if wanted.eye is None else (matrix.tobytes(), wanted.eye.known_as()),
            *((one.id, id(one.values)) for one in mesh.shading.attributes),
            _space(mesh),
        )

        def make(report: Report) -> tuple[Mesh, Normals, Any]:
            free = free_memory_bytes()
            limit = MAX_TRIANGLES if free is None else min(MAX_TRIANGLES, free // DICING_BYTES)
            fine, normals, coarse = diced(mesh, faces, wanted, matrix, limit, self._go_on)
            if coarse:
                report.warn(
                    "Adaptive subdivision ends at "
                    f"{len(fine.triangles):,} triangles, coarser than its pixel size asks for; "
                    "there is no memory for more: {}",
                    job.name,
                )
            return _with_area(fine, job.name, Report()), normals, (mesh, faces)

        fine, normals, _ = self._kept.get(key, job.sources, self._report, make)
        return fine, normals

    @staticmethod
    def _key(
        job: _Job,
        slots: Slots,
        normals: Normals,
        mesh: Mesh,
        matrix: NDArray[np.float64],
        attributes: list[InstanceAttribute],
        textures: Sequence[Texture],
        camera: Camera,
        asked: frozenset[int],
    ) -> tuple[Any, ...]:
        programs = [slot.program for slot in slots if slot is not None]
        read = [textures[i] for i in sorted({i for one in programs for i in textures_of(one)})]
        return (
            "displaced",
            *job.known_as,
            id(mesh.positions),
            id(mesh.uv),
            id(normals),
            *(None if s is None else (_code(s), s.bumps) for s in slots),
            matrix.tobytes(),
            *((one.id, one.values.tobytes()) for one in attributes),
            *((one.id, id(one.values)) for one in mesh.shading.attributes),
            _space(mesh),
            *((id(t.pixels), t.srgb, t.interpolation, t.extension) for t in read),
            camera.matrix.tobytes(),
            *sorted(asked),
        )


def _space(mesh: Mesh) -> tuple[Any, ...] | None:
    space = mesh.shading.generated
    return None if space is None else (space.scale, space.offset)


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
        of_vertices = np.array(read(mesh.vertex_normals, "vector", np.float32, 3))
        if not np.isfinite(of_vertices).all():
            of_vertices = np.nan_to_num(of_vertices)
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
