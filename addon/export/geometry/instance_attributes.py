"""Attributes that Geometry Nodes have given to instances: what an Attribute node of type Instancer
looks for first.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import read_copy
from ..report import Report
from .attribute_values import numbers_of

NO_LEVEL = 0x7FFFFFFF  # number that fills the unused levels of a persistent id


class InstanceAttributes:
    """Looks attributes of the instances of one dependency graph up, each geometry read once."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._of_parent: dict[int, _Level | None] = {}

    def find(self, instance: Any, name: str) -> tuple[float, ...] | None:
        """RGBA of the innermost level of instances that has an attribute `name`; None: no level
        has, or the instance is of another kind.
        """
        parent = instance.parent if instance.is_instance else None
        if parent is None or not any(modifier.type == "NODES" for modifier in parent.modifiers):
            return None
        key = parent.as_pointer()
        if key not in self._of_parent:
            self._of_parent[key] = self._top(parent, name)
        level, found = self._of_parent[key], None
        # from the outermost one on
        for number in reversed([number for number in instance.persistent_id if number != NO_LEVEL]):
            index = None if level is None else level.index_of(number)
            if level is None or index is None:
                break
            found = level.value(name, index) or found
            level = level.below(index)
        return found

    def _top(self, parent: Any, name: str) -> _Level | None:
        if not hasattr(parent, "evaluated_geometry"):
            said = (
                f"Attribute '{name}' of instances made by Geometry Nodes cannot be read before "
                "Blender 4.5:"
            )
            self._report.warn(f"{said} {{}}", parent.name)
            return None
        return _Level(parent.evaluated_geometry())


class _Level:
    """The instances of one geometry (bpy.types.GeometrySet)."""

    def __init__(self, geometry: Any) -> None:
        self._geometry = geometry
        self._cloud = geometry.instances_pointcloud()
        self._values: dict[str, NDArray[np.float32] | None] = {}
        self._below: dict[int, _Level] = {}
        self._reference_of: NDArray[np.int32] = np.empty(0, np.int32)
        if self._cloud is not None:
            self._reference_of = read_copy(
                self._cloud.attributes[".reference_index"].data, "value", np.int32
            )
        self._index_of, self._repeated = self._numbered()

    def _numbered(self) -> tuple[dict[int, int], list[int]]:
        """Indices by what persistent ids call them, which is the attribute `id` if there is one;
        and, in order, those whose `id` another one before has: Blender gives these a random one.
        """
        count = len(self._reference_of)
        ids = self._cloud.attributes.get("id") if count else None
        if ids is None:
            return {index: index for index in range(count)}, []
        first: dict[int, int] = {}
        repeated = []
        for index, number in enumerate(read_copy(ids.data, "value", np.int32).tolist()):
            if first.setdefault(number, index) != index:
                repeated.append(index)
        return first, repeated

    def index_of(self, number: int) -> int | None:
        """Of an instance, from its part of a persistent id. Instances come in order, so those of
        random numbers do."""
        if number not in self._index_of and self._repeated:
            self._index_of[number] = self._repeated.pop(0)
        return self._index_of.get(number)

    def value(self, name: str, index: int) -> tuple[float, ...] | None:
        """RGBA; a number is grey, what has no alpha is opaque."""
        if name not in self._values:
            self._values[name] = self._read(name)
        values = self._values[name]
        return None if values is None else tuple(values[index].tolist())

    def below(self, index: int) -> _Level | None:
        """The instances within an instance, where that is a geometry itself."""
        number = int(self._reference_of[index])
        if number not in self._below:
            references = self._geometry.instance_references()
            reference = references[number] if 0 <= number < len(references) else None
            if not hasattr(reference, "instances_pointcloud"):
                return None
            self._below[number] = _Level(reference)
        return self._below[number]

    def _read(self, name: str) -> NDArray[np.float32] | None:
        attribute = None if self._cloud is None else self._cloud.attributes.get(name)
        # a rotation is no colour, which Blender asks for
        known = attribute is not None and attribute.data_type != "QUATERNION"
        values = numbers_of(attribute) if known else None
        if values is None:
            return None
        width = values.shape[1]
        whole = np.zeros((len(values), 4), np.float32)
        whole[:, 3] = 1.0
        whole[:, : 3 if width == 1 else width] = values
        return whole
