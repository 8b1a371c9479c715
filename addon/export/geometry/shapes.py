"""The meshes of one export: each once, however many instances it has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...core.scene import Mesh
from ..kept import Kept, identity
from ..report import Report
from .mesh import active_uv, export_mesh, flattened
from .particle_hair import System, export_hair, known_as, made_of
from .strands import Look, export_strands
from .volumes import known_volume, volume_mesh

Value = TypeVar("Value")


class Shapes:
    """Indices point into `list`; None: nothing is left of it. `flat`: of meshes that a scale has
    flattened which triangles are left. `hair`: which are hair of particles. `with_uv`: meshes have
    their UV maps at once, and not only where give_uv() is asked to.
    """

    def __init__(
        self, kept: Kept, report: Report, go_on: Callable[[], None], with_uv: bool
    ) -> None:
        self.list: list[Mesh] = []
        self.flat: dict[int, NDArray[np.bool_] | None] = {}
        self.hair: set[int] = set()
        self._kept, self._report, self._go_on = kept, report, go_on
        self._with_uv = with_uv
        self._sound: dict[int, NDArray[np.bool_] | None] = {}  # by pointers of data
        self._index_of: dict[int, int | None] = {}  # by pointers of data; of hair negative
        self._volumes: dict[tuple[Any, ...], int | None] = {}

    def of_mesh(self, ob: Any) -> int | None:
        pointer = ob.data.as_pointer()
        if pointer not in self._index_of:
            found = self._kept.get(
                ("mesh", self._with_uv, *mesh_key(ob)),
                sources(ob),
                self._report,
                lambda report: with_mesh(ob, lambda mesh: self._exported(mesh, ob.name, report)),
            )
            mesh, self._sound[pointer] = found or (None, None)
            self._index_of[pointer] = self._append(mesh)
        return self._index_of[pointer]

    def _exported(
        self, mesh: Any, name: str, report: Report
    ) -> tuple[Mesh, NDArray[np.bool_] | None] | None:
        found = export_mesh(mesh, name, report)
        if found is not None and self._with_uv:
            found[0].uv = active_uv(mesh, found[1])
        return found

    def give_uv(self, ob: Any, index: int) -> None:
        """Gives the mesh of `index`, which of_mesh(ob) is or was made of, its render-active UV
        map.
        """
        mesh = self.list[index]
        if self._with_uv or mesh.strands is not None or mesh.shading.grids:
            return
        kept = self._sound[ob.data.as_pointer()]
        uv = self._kept.get(
            ("uv", *mesh_key(ob)),
            sources(ob),
            self._report,
            lambda _: with_mesh(ob, lambda mesh: active_uv(mesh, kept)),
        )
        left = self.flat.get(index)
        self.list[index] = replace(mesh, uv=uv if uv is None or left is None else uv[left])

    def of_strands(self, ob: Any, look: Look) -> int | None:
        data = ob.data
        pointer = data.as_pointer()
        if pointer not in self._index_of:
            positions = data.attributes.get("position")
            count = 0 if positions is None else len(positions.data)
            strands = self._kept.get(
                ("strands", pointer, *sources(ob), look, count),
                sources(ob),
                self._report,
                lambda report: export_strands(data, ob.type, ob.name, look, report),
            )
            self._index_of[pointer] = self._append(strands)
        return self._index_of[pointer]

    def of_hair(self, ob: Any, systems: list[System], look: Look) -> int | None:
        key = -ob.data.as_pointer()
        if key not in self._index_of:
            hair = self._kept.get(
                ("hair", *mesh_key(ob), look, *known_as(systems)),
                (*sources(ob), *made_of(systems)),
                self._report,
                lambda report: export_hair(ob, systems, look, report, self._go_on),
            )
            found = self._append(hair)
            self._index_of[key] = found
            if found is not None:
                self.hair.add(found)
        return self._index_of[key]

    def of_volume(self, ob: Any, names: dict[int, str], padding: int, frame: int) -> int | None:
        """The box around its grids; `names`: of those that are wanted, `padding`: voxels around
        them.
        """
        key = ("volume", *known_volume(ob, frame), padding, *names.items())
        if key not in self._volumes:
            box = self._kept.get(
                key,
                sources(ob),
                self._report,
                lambda report: volume_mesh(ob, names, padding, frame, report),
            )
            self._volumes[key] = self._append(box)
        return self._volumes[key]

    def flattened(self, index: int, matrix: NDArray[np.float64], name: str) -> int | None:
        """Another mesh: that one as `matrix`, which flattens it, places it."""
        left = flattened(self.list[index], matrix, name, self._report)
        if left is None:
            return None
        flat = self._append(left[0])
        assert flat is not None
        self.flat[flat] = left[1]
        return flat

    def _append(self, mesh: Mesh | None) -> int | None:
        if mesh is None:
            return None
        self.list.append(mesh)
        return len(self.list) - 1


def sources(ob: Any) -> tuple[int, int]:
    """The data-blocks that an object's mesh is made of."""
    return identity(ob), identity(ob.original.data)


def mesh_key(ob: Any) -> tuple[int, ...]:
    """What an object's mesh is known by from one export to the next."""
    data = ob.data
    return (data.as_pointer(), *sources(ob), len(data.vertices), len(data.polygons))


def may_deform(ob: Any) -> bool:
    """Whether the vertices of an object's mesh may be elsewhere than those of its data, or than
    those of the mesh that it takes texture coordinates from.
    """
    data = ob.original.data
    return (
        ob.original.type != "MESH"  # those of curves and text come as meshes
        or len(ob.modifiers) > 0
        or data.shape_keys is not None
        or data.texture_mesh is not None
        or ob.parent_type in {"ARMATURE", "LATTICE"}
    )


def with_mesh(ob: Any, make: Callable[[Any], Value]) -> Value:
    """What `make` makes of an object's mesh."""
    if not ob.data.is_editmode:
        return make(ob.data)
    try:  # in edit mode the arrays of the mesh itself are not up to date
        return make(ob.to_mesh())
    finally:
        ob.to_mesh_clear()
