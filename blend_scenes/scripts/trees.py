"""Node trees in a few lines: `tree("Name")`, then `add` per node; what `add` returns is an output
that other inputs take.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy

Ramp = Sequence[tuple[float, Sequence[float] | float]]


class Tree:
    """A material's, light's, world's or group's node tree while it is written."""

    def __init__(self, owner: Any) -> None:
        self.owner = owner
        if not isinstance(owner, bpy.types.NodeTree):
            owner.use_nodes = True
            self.nodes, self.links = owner.node_tree.nodes, owner.node_tree.links
        else:
            self.nodes, self.links = owner.nodes, owner.links
        self.nodes.clear()
        self._column = 0

    def add(
        self, kind: str, out: str | int = 0, modes: dict[str, Any] | None = None, **inputs: Any
    ) -> Any:
        """The output `out` of a new node ShaderNode`kind`. inputs: socket names with `_` for
        spaces, or i0, i1, ... by index.
        """
        node = self.nodes.new(f"ShaderNode{kind}")
        node.location = (self._column * 190.0, -260.0 * (self._column % 3))
        self._column += 1
        for name, value in (modes or {}).items():
            setattr(node, name, value)
        for name, value in inputs.items():
            self.feed(
                node.inputs[int(name[1:])]
                if name[0] == "i" and name[1:].isdigit()
                else node.inputs[name.replace("_", " ")],
                value,
            )
        return node.outputs[out]

    def feed(self, socket: Any, value: Any) -> None:
        if isinstance(value, bpy.types.NodeSocket):
            self.links.new(value, socket)
        elif socket.type == "RGBA":
            socket.default_value = (
                (value, value, value, 1.0) if isinstance(value, float) else (*value[:3], 1.0)
            )
        else:
            socket.default_value = value

    def surface(self, shader: Any) -> Any:
        """Ends the tree with `shader`; returns its owner."""
        kind = (
            "Light"
            if isinstance(self.owner, bpy.types.Light)
            else "World"
            if isinstance(self.owner, bpy.types.World)
            else "Material"
        )
        output = self.nodes.new(f"ShaderNodeOutput{kind}")
        output.location = (self._column * 190.0, 0.0)
        self.links.new(shader, output.inputs["Surface"])
        return self.owner

    def principled(self, **inputs: Any) -> Any:
        return self.surface(self.add("BsdfPrincipled", **inputs))

    # --- what materials are made of ---

    def image(
        self, image: bpy.types.Image, vector: Any = None, out: str = "Color", **modes: Any
    ) -> Any:
        given = {} if vector is None else {"Vector": vector}
        return self.add("TexImage", out, {"image": image, **modes}, **given)

    def coordinates(
        self,
        out: str = "Generated",
        scale: Any = None,
        rotation: Any = (0.0, 0.0, 0.0),
        location: Any = (0.0, 0.0, 0.0),
    ) -> Any:
        where = self.add("TexCoord", out)
        if scale is None:
            return where
        scale = (scale,) * 3 if isinstance(scale, float) else scale
        return self.add("Mapping", Vector=where, Scale=scale, Rotation=rotation, Location=location)

    def noise(
        self, vector: Any, scale: float, detail: float = 3.0, out: str | int = 0, **more: Any
    ) -> Any:
        return self.add("TexNoise", out, Vector=vector, Scale=scale, Detail=detail, **more)

    def ramp(self, factor: Any, stops: Ramp, interpolation: str = "LINEAR") -> Any:
        result = self.add("ValToRGB", Fac=factor)
        ramp = result.node.color_ramp
        ramp.interpolation = interpolation
        while len(ramp.elements) < len(stops):
            ramp.elements.new(1.0)
        for element, (at, color) in zip(ramp.elements, stops, strict=True):
            element.position = at
            element.color = (
                (color, color, color, 1.0) if isinstance(color, float) else (*color, 1.0)
            )
        return result

    def mix(self, factor: Any, a: Any, b: Any, blend: str = "MIX") -> Any:
        node = self.add("Mix", 2, {"data_type": "RGBA", "blend_type": blend}).node
        for identifier, value in (("Factor_Float", factor), ("A_Color", a), ("B_Color", b)):
            self.feed(
                next(socket for socket in node.inputs if socket.identifier == identifier), value
            )
        return next(socket for socket in node.outputs if socket.identifier == "Result_Color")

    def math(self, operation: str, a: Any, b: Any = 0.0) -> Any:
        return self.add("Math", 0, {"operation": operation}, i0=a, i1=b)

    def map_range(
        self, value: Any, low: float, high: float, to_low: float = 0.0, to_high: float = 1.0
    ) -> Any:
        return self.add(
            "MapRange", 0, Value=value, From_Min=low, From_Max=high, To_Min=to_low, To_Max=to_high
        )

    def bump(self, height: Any, distance: float, strength: float = 1.0, **more: Any) -> Any:
        """`distance` in metres."""
        return self.add("Bump", Height=height, Distance=distance, Strength=strength, **more)

    def normal_map(self, image: bpy.types.Image, vector: Any = None, strength: float = 1.0) -> Any:
        return self.add("NormalMap", Color=self.image(image, vector), Strength=strength)


def material(name: str) -> Tree:
    return Tree(bpy.data.materials.new(name))


def plain(
    name: str, color: Sequence[float], roughness: float = 0.5, **more: Any
) -> bpy.types.Material:
    """A Principled BSDF of constants."""
    return material(name).principled(Base_Color=color, Roughness=roughness, **more)


def group(
    name: str, inputs: Sequence[tuple[str, str, Any]], outputs: Sequence[tuple[str, str]]
) -> tuple[Tree, Any, Any]:
    """A new node group: its tree, its input node and its output node. inputs: (name, socket type,
    default); outputs: (name, type).
    """
    made = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for title, kind, default in inputs:
        socket = made.interface.new_socket(title, in_out="INPUT", socket_type=f"NodeSocket{kind}")
        if default is not None:
            socket.default_value = (*default, 1.0) if kind == "Color" else default
    for title, kind in outputs:
        made.interface.new_socket(title, in_out="OUTPUT", socket_type=f"NodeSocket{kind}")
    tree = Tree(made)
    return tree, made.nodes.new("NodeGroupInput"), made.nodes.new("NodeGroupOutput")


def use_group(tree: Tree, made: bpy.types.NodeTree, out: str | int = 0, **inputs: Any) -> Any:
    return tree.add("Group", out, {"node_tree": made}, **inputs)
