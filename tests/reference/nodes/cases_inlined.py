"""Cases of menus, zones, closures and bundles, which Blender 5 has in shader trees too."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.reference.nodes.cases import Case, Sources


def cases() -> list[Case]:
    import bpy

    if not hasattr(bpy.types, "InlineShaderNodes"):  # Blender 4 has none of them
        return []
    found = [
        Case(f"Scene Time {output}", "GeometryNodeInputSceneTime", output)
        for output in ("Seconds", "Frame")
    ]
    made: dict[str, Callable[[Any], Any]] = {
        "menu switch A": _menu("A"),
        "menu switch B": _menu("B"),
        "menu of a group": _menu_of_group,
        "repeat zone": _repeat(4),
        "repeat zone of no turns": _repeat(0),
        "closure": _closure,
        "bundle": _bundle,
        "closure in a bundle": _closure_in_bundle,
        "integer": _constant("FunctionNodeInputInt", integer=2),
        "boolean": _constant("FunctionNodeInputBool", boolean=True),
        "vector": _constant("FunctionNodeInputVector", vector=(0.25, 0.5, 1.0)),
    }
    return found + [Case(name, "", "", build=build) for name, build in made.items()]


def _menu(choice: str) -> Callable[[Any], Any]:
    def build(tree: Any) -> Any:
        switch = _switch(tree)
        switch.inputs[0].default_value = choice
        return switch.outputs[0]

    return build


def _switch(tree: Any) -> Any:
    """Between the colour c and the vector p."""
    sources = Sources(tree)
    switch = tree.nodes.new("GeometryNodeMenuSwitch")
    switch.data_type = "RGBA"
    tree.links.new(sources.get("c"), switch.inputs["A"])
    tree.links.new(sources.get("p"), switch.inputs["B"])
    return switch


def _menu_of_group(tree: Any) -> Any:
    """Two uses of a group that choose otherwise, of which one is taken from the other."""
    import bpy

    group = bpy.data.node_groups.new("Chooses", "ShaderNodeTree")
    group.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketColor")
    group.interface.new_socket("Which", in_out="INPUT", socket_type="NodeSocketMenu")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    switch = _switch(group)
    group.links.new(start.outputs[0], switch.inputs[0])
    group.links.new(switch.outputs[0], end.inputs[0])
    uses = []
    for choice in "AB":
        use = tree.nodes.new("ShaderNodeGroup")
        use.node_tree = group
        use.inputs[0].default_value = choice
        uses.append(use.outputs[0])
    return _subtract(tree, *uses)


def _subtract(tree: Any, a: Any, b: Any) -> Any:
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = "SUBTRACT"
    tree.links.new(a, node.inputs[0])
    tree.links.new(b, node.inputs[1])
    return node.outputs[0]


def _repeat(turns: int) -> Callable[[Any], Any]:
    """x, halved and moved `turns` times."""

    def build(tree: Any) -> Any:
        start, end = (tree.nodes.new(f"GeometryNodeRepeat{side}") for side in ("Input", "Output"))
        start.pair_with_output(end)
        end.repeat_items.clear()
        end.repeat_items.new("FLOAT", "Moved")
        start.inputs["Iterations"].default_value = turns
        tree.links.new(Sources(tree).get("x"), start.inputs["Moved"])
        tree.links.new(_halved(tree, start.outputs["Moved"]), end.inputs["Moved"])
        return end.outputs["Moved"]

    return build


def _halved(tree: Any, value: Any) -> Any:
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = "MULTIPLY_ADD"
    tree.links.new(value, node.inputs[0])
    node.inputs[1].default_value, node.inputs[2].default_value = 0.5, 0.3
    return node.outputs[0]


def _defined(tree: Any) -> Any:
    """A closure that halves and moves a number."""
    start, end = tree.nodes.new("NodeClosureInput"), tree.nodes.new("NodeClosureOutput")
    start.pair_with_output(end)
    end.input_items.new("FLOAT", "Value")
    end.output_items.new("FLOAT", "Moved")
    tree.links.new(_halved(tree, start.outputs["Value"]), end.inputs["Moved"])
    return end.outputs[0]


def _evaluated(tree: Any, closure: Any) -> Any:
    use = tree.nodes.new("NodeEvaluateClosure")
    use.input_items.new("FLOAT", "Value")
    use.output_items.new("FLOAT", "Moved")
    tree.links.new(closure, use.inputs[0])
    tree.links.new(Sources(tree).get("x"), use.inputs["Value"])
    return use.outputs["Moved"]


def _closure(tree: Any) -> Any:
    return _evaluated(tree, _defined(tree))


def _bundled(tree: Any, kind: str, value: Any) -> Any:
    """`value` out of a bundle that it was put into."""
    put, taken = tree.nodes.new("NodeCombineBundle"), tree.nodes.new("NodeSeparateBundle")
    put.bundle_items.new(kind, "Held")
    taken.bundle_items.new(kind, "Held")
    tree.links.new(value, put.inputs["Held"])
    tree.links.new(put.outputs[0], taken.inputs[0])
    return taken.outputs["Held"]


def _bundle(tree: Any) -> Any:
    return _bundled(tree, "VECTOR", Sources(tree).get("p"))


def _closure_in_bundle(tree: Any) -> Any:
    return _evaluated(tree, _bundled(tree, "CLOSURE", _defined(tree)))


def _constant(kind: str, **given: Any) -> Callable[[Any], Any]:
    """x + a constant node's value."""

    def build(tree: Any) -> Any:
        node = tree.nodes.new(kind)
        for name, value in given.items():
            setattr(node, name, value)
        return _subtract(tree, Sources(tree).get("p"), node.outputs[0])

    return build
