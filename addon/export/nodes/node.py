"""What the compilation of one node gets to see: its inputs as values, its owner's names, the
attributes it may ask for.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...core.scene.displacement import UNDISPLACED, UNDISPLACED_NORMALS
from ...core.scene.shading import GENERATED
from ..cancelled import Watch
from .values import ORIGIN, ZERO, Graph, Value, number, vector

if TYPE_CHECKING:
    from ..images import Textures
    from ..report import Report
    from .trees import Feed, Groups, Trees


@dataclass(frozen=True, slots=True)
class Want:
    """Something that programs read. Of a mesh: kind "uv", "attribute", "color", "tangent",
    "island", "pointiness", "curve normal" or "generated", of the layer `name` ("": the active
    one). Of instances: "object" or "instancer" for a property `name`, "particle" or "info" for what
    nodes name.
    """

    kind: str
    name: str = ""


class Wants:
    """Ids of everything that programs of one scene read from meshes or instances;
    `active_uv_map`: whether some read the render-active UV map, which has none.
    """

    def __init__(self) -> None:
        self.ids = {
            Want("generated"): GENERATED,
            Want("undisplaced"): UNDISPLACED,
            Want("undisplaced normals"): UNDISPLACED_NORMALS,
        }
        # of tangents: (owner, node) by how warnings name them
        self.askers: dict[int, dict[tuple[str, str], None]] = {}
        self.active_uv_map = False

    def id(self, kind: str, name: str = "") -> int:
        return self.ids.setdefault(Want(kind, name), len(self.ids))


@dataclass(slots=True)
class Surroundings:
    """What trees of one export have in common."""

    textures: Textures
    report: Report
    wants: Wants
    trees: Trees
    depsgraph: Any = None
    watch: Watch = field(default_factory=Watch)


@dataclass(slots=True)
class Owner:
    """The material, world or light whose tree is compiled. `name` is how warnings name it, `id` is
    Blender's data.

    `backfacing`: the side alone that is compiled, or None for both. `uv_map`: the render-active one
    of the object, if known.
    """

    name: str
    id: Any = None
    backfacing: bool | None = None
    uv_map: str | None = None
    asked_uv_map: bool = False
    of_world: bool = False
    of_volume: bool = False  # the tree describes a medium
    grids: str | None = None  # of an object with volume grids: how they are interpolated
    opaque_shadow: bool = False  # its transparency does not count for shadow rays
    # Where the tree is a light's: what programs read from instances, of that one. RGBA, a vector or
    # a number
    read: Callable[[Want], tuple[float, ...] | float] | None = None
    normal: Value | None = None  # in place of the shading normal, where a displacement bends it


@dataclass(slots=True)
class Node:
    """A node that is being compiled. `values` are those of its linked inputs, by identifier."""

    node: Any
    groups: Groups
    graph: Graph
    owner: Owner
    around: Surroundings
    feeds: dict[str, Feed] = field(default_factory=dict)
    values: dict[str, Value] = field(default_factory=dict)

    def warn(self, what: str) -> None:
        self.around.report.warn(f"{self.owner.name}, node '{label(self.node)}': {what}")

    def unsupported(self, what: str) -> None:
        self.warn(f"{self.node.bl_label} {what}")

    def socket(self, identifier: str) -> Any:
        """The input with that identifier, an enabled one first; None if this version of Blender has
        none.
        """
        found = None
        for socket in self.node.inputs:
            if socket.identifier == identifier:
                if socket.enabled:
                    return socket
                found = found or socket
        return found

    def linked(self, identifier: str) -> bool:
        return identifier in self.values

    def wanted(self, identifier: str) -> bool:
        """True if an output leads to what is rendered."""
        return any(
            socket.identifier == identifier
            and self.around.trees.leads_to_output(socket, self.groups)
            for socket in self.node.outputs
        )

    def number(self, identifier: str, default: float = 0.0) -> Value:
        return self._get(identifier, number(default), 1)

    def share(self, identifier: str, default: float = 0.0) -> Value:
        """A number that native code takes into 0..1."""
        return self._told(identifier, self.number(identifier, default), 0.0, 1.0)

    def ior(self, identifier: str = "IOR", default: float = 1.5) -> Value:
        """A refractive index; native code takes none below LEAST_IOR."""
        return self._told(identifier, self.number(identifier, default), LEAST_IOR, math.inf)

    def _told(self, identifier: str, value: Value, least: float, most: float) -> Value:
        """`value`, and a warning if it is known to lie outside of its range."""
        if value.is_constant and not least <= value.data[0] <= most:
            taken = least if value.data[0] < least else most
            self.warn(f"its {identifier} is {value.data[0]:g}, taken as {taken:g}")
        return value

    def vector(
        self, identifier: str, default: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> Value:
        return self._get(identifier, vector(default), 3)

    color = vector

    def _get(self, identifier: str, default: Value, width: int) -> Value:
        if identifier in self.values:
            value = self.values[identifier]
        else:
            socket = self.socket(identifier)
            value = default if socket is None else self.own_value(socket) or default
        if value.width != width:
            return value.component(0) if width == 1 else self.graph.one("Spread", value=value)
        return value

    def own_value(self, socket: Any) -> Value | None:
        """What a socket that is not linked holds, None if nothing."""
        value = getattr(socket, "default_value", None)
        if value is None or isinstance(value, str) or socket.type in {"SHADER", "CUSTOM", "MATRIX"}:
            return None
        numbers = [float(v) for v in value] if hasattr(value, "__len__") else [float(value)]
        if not all(math.isfinite(v) for v in numbers):
            self.warn(f"its {socket.name} is not a finite number; taken as 0")
            numbers = [v if math.isfinite(v) else 0.0 for v in numbers]
        return number(numbers[0]) if len(numbers) == 1 else vector([*numbers, 0.0, 0.0][:3])

    def tangent_id(self, uv_map: str) -> int:
        """Of the tangents along a UV map ("": the render-active one)."""
        found = self.around.wants.id("tangent", uv_map)
        self.around.wants.askers.setdefault(found, {})[self.owner.name, label(self.node)] = None
        return found

    # --- what inputs hold that are neither linked nor given a value ---

    def normal(self, identifier: str = "Normal") -> Value:
        return self.values[identifier] if self.linked(identifier) else self.shading_normal()

    def closure_normal(self, identifier: str = "Normal") -> Value:
        """As normal(); the shading normal of closures is the vector of length 0."""
        if self.linked(identifier):
            return self.values[identifier]
        return ORIGIN

    def shading_normal(self) -> Value:
        return self.owner.normal or self.graph.one("Geometry", what="NORMAL")

    def tangent(self, anisotropy: Value, identifier: str = "Tangent") -> Value:
        if anisotropy == ZERO:
            return ORIGIN
        return (
            self.values[identifier]
            if self.linked(identifier)
            else self.graph.one("Geometry", what="TANGENT")
        )

    def generated(self) -> Value:
        return self.graph.one("TextureCoordinate", what="GENERATED")


LEAST_IOR = 1e-5


def label(node: Any) -> str:
    """How a warning names a node: by the name the user gave it, or by its name in the tree."""
    return node.label or node.name
