"""Node trees whose output Photon Splat and Cycles must agree on: one small tree per case, made by
script.

Most inputs are swept over the cell: sources "x" and "y" run from -2 to 2 across it, "u" and "v"
from 0 to 1, "uv" is the UV coordinate, "p" the vector (x, y, x - y), "c" the colour (u, v, 1 - u),
"s" and "t" are p and y in steps, "h" is about v.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

Setup = Callable[[Any], None]


@dataclass
class Case:
    """One tree: `node` with properties and inputs (numbers, tuples, or names of sources), read at
    `output`.
    """

    name: str
    node: str
    output: str
    properties: dict[str, Any] = field(default_factory=dict)
    inputs: dict[str, Any] = field(default_factory=dict)
    setup: Setup | None = None
    thing: str = "plane"  # "sphere", "bumps", "hexagons", "bare", "hollow"
    noise: bool = False  # 0.5 % is allowed instead of 1/255
    build: Callable[[Any], Any] | None = None  # instead of all that: tree -> output socket

    def make(self, tree: Any) -> Any:
        """Puts the nodes into `tree` and returns the socket to look at."""
        if self.build is not None:
            return self.build(tree)
        sources = Sources(tree)
        node = tree.nodes.new(self.node)
        for name, value in self.properties.items():
            setattr(node, name, value)
        if self.setup is not None:
            self.setup(node)
        for name, value in self.inputs.items():
            socket = input_of(node, name)
            if isinstance(value, str):
                tree.links.new(sources.get(value), socket)
            else:
                socket.default_value = value
        return output_of(node, self.output)


def input_of(node: Any, identifier: str) -> Any:
    return next(socket for socket in node.inputs if socket.identifier == identifier)


def output_of(node: Any, identifier: str) -> Any:
    return next(socket for socket in node.outputs if socket.identifier == identifier)


class Sources:
    """The things that inputs are swept by, as sockets of a tree."""

    def __init__(self, tree: Any) -> None:
        self.tree = tree
        self._made: dict[str, Any] = {}

    def get(self, name: str) -> Any:
        if name not in self._made:
            self._made[name] = getattr(self, f"_{name}")()
        return self._made[name]

    def _uv(self) -> Any:
        return self.tree.nodes.new("ShaderNodeTexCoord").outputs["UV"]

    def _parts(self) -> Any:
        node = self.tree.nodes.new("ShaderNodeSeparateXYZ")
        self.tree.links.new(self.get("uv"), node.inputs[0])
        return node

    def _u(self) -> Any:
        return self.get("parts").outputs[0]

    def _v(self) -> Any:
        return self.get("parts").outputs[1]

    def _math(self, operation: str, a: Any, b: Any, c: float = 0.0) -> Any:
        node = self.tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (a, b, c), strict=False):
            if isinstance(value, float):
                socket.default_value = value
            else:
                self.tree.links.new(value, socket)
        return node.outputs[0]

    def _x(self) -> Any:
        return self._math("MULTIPLY_ADD", self.get("u"), 3.97, -1.96)

    def _y(self) -> Any:
        return self._math("MULTIPLY_ADD", self.get("v"), 4.03, -2.05)

    def _h(self) -> Any:
        return self._math("MULTIPLY_ADD", self.get("v"), 0.913, 0.071)

    def _combined(self, *parts: Any) -> Any:
        node = self.tree.nodes.new("ShaderNodeCombineXYZ")
        for socket, value in zip(node.inputs, parts, strict=True):
            self.tree.links.new(value, socket)
        return node.outputs[0]

    def _p(self) -> Any:
        return self._combined(
            self.get("x"), self.get("y"), self._math("SUBTRACT", self.get("x"), self.get("y"))
        )

    def _s(self) -> Any:
        node = self.tree.nodes.new("ShaderNodeVectorMath")
        node.operation = "SNAP"
        self.tree.links.new(self.get("p"), node.inputs[0])
        node.inputs[1].default_value = (0.37, 0.43, 0.29)
        return node.outputs[0]

    def _t(self) -> Any:
        return self._math("SNAP", self.get("y"), 0.41)

    def _q(self) -> Any:
        return self._combined(self.get("y"), self.get("v"), self.get("x"))

    def _c(self) -> Any:
        return self._combined(
            self.get("u"), self.get("v"), self._math("SUBTRACT", 1.0, self.get("u"))
        )

    def _d(self) -> Any:
        return self._combined(
            self.get("v"), self._math("MULTIPLY", self.get("u"), self.get("v")), self.get("u")
        )


def enum(node: str, name: str) -> list[str]:
    """Identifiers of an enumeration of a node type, as this version of Blender has them."""
    import bpy

    kind = getattr(bpy.types, node, None)
    return (
        [item.identifier for item in kind.bl_rna.properties[name].enum_items]
        if kind is not None
        else []
    )


def exists(node: str) -> bool:
    import bpy

    return hasattr(bpy.types, node)


def since(*version: int) -> bool:
    """Whether this Blender is of that version, or newer."""
    import bpy

    return tuple(bpy.app.version) >= version


def all_cases() -> list[Case]:
    """Every case that this version of Blender has, in a fixed order."""
    from tests.reference.nodes import (
        cases_converters,
        cases_inlined,
        cases_inputs,
        cases_textures,
    )

    found: list[Case] = []
    for kind in (cases_converters, cases_textures, cases_inputs, cases_inlined):
        found += kind.cases()
    names = [case.name for case in found]
    assert len(set(names)) == len(names), sorted(name for name in names if names.count(name) > 1)
    return found


def swept(
    name: str, node: str, output: str, sweeps: list[dict[str, Any]], **common: Any
) -> Iterator[Case]:
    """A case per set of inputs."""
    for k, inputs in enumerate(sweeps):
        yield Case(
            f"{name} {k}" if len(sweeps) > 1 else name, node, output, inputs=inputs, **common
        )
