"""Cases of what a hit knows, of normals and tangents, and of the ways in which trees are put
together.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.reference.nodes.cases import Case, Sources, enum, input_of
from tests.reference.nodes.cases_textures import picture

THINGS = ("plane", "sphere")


def cases() -> list[Case]:
    return [*_hits(), *_attributes(), *_normals(), *_trees(), *_conversions()]


def _outputs(
    node: str, outputs: tuple[str, ...], things: tuple[str, ...] = THINGS, **given: Any
) -> list[Case]:
    name = node.removeprefix("ShaderNode")
    return [
        Case(f"{name} {output} {thing}", node, output, thing=thing, **given)
        for output in outputs
        for thing in things
    ]


def _hits() -> list[Case]:
    found = _outputs(
        "ShaderNodeTexCoord",
        ("Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection"),
    )
    found += _outputs(
        "ShaderNodeNewGeometry",
        (
            "Position",
            "Normal",
            "Tangent",
            "True Normal",
            "Incoming",
            "Parametric",
            "Backfacing",
            "Random Per Island",
        ),
    )
    found += _outputs("ShaderNodeNewGeometry", ("Pointiness",), (*THINGS, "bumps"))
    found += _outputs(
        "ShaderNodeObjectInfo",
        ("Location", "Color", "Alpha", "Object Index", "Material Index", "Random"),
    )
    found += _outputs("ShaderNodeCameraData", ("View Vector", "View Z Depth", "View Distance"))
    path = (
        "Is Camera Ray",
        "Is Shadow Ray",
        "Is Diffuse Ray",
        "Is Glossy Ray",
        "Is Singular Ray",
        "Is Reflection Ray",
    )
    path += (
        "Is Transmission Ray",
        "Is Volume Scatter Ray",
        "Ray Depth",
        "Diffuse Depth",
        "Glossy Depth",
        "Transparent Depth",
    )
    found += _outputs("ShaderNodeLightPath", (*path, "Transmission Depth"), ("plane",))
    found += _outputs(
        "ShaderNodeHairInfo", ("Is Strand", "Intercept", "Length", "Random"), ("plane",)
    )
    found += _outputs(
        "ShaderNodeParticleInfo",
        ("Index", "Random", "Age", "Location", "Size", "Velocity"),
        ("plane",),
    )
    for thing in THINGS:
        found.append(
            Case(f"uv map {thing}", "ShaderNodeUVMap", "UV", {"uv_map": "Second"}, thing=thing)
        )
        found.append(
            Case(f"uv map first {thing}", "ShaderNodeUVMap", "UV", {"uv_map": "First"}, thing=thing)
        )
        found.append(
            Case(
                f"uv map absent {thing}",
                "ShaderNodeUVMap",
                "UV",
                {"uv_map": "No such"},
                thing=thing,
            )
        )
        for k, blend in enumerate((0.5, 0.2, 0.8, "u")):
            for output in ("Fresnel", "Facing"):
                found.append(
                    Case(
                        f"layer weight {output} {k} {thing}",
                        "ShaderNodeLayerWeight",
                        output,
                        inputs={"Blend": blend},
                        thing=thing,
                    )
                )
        for k, ior in enumerate((1.5, 0.7, "y")):
            found.append(
                Case(
                    f"fresnel {k} {thing}",
                    "ShaderNodeFresnel",
                    "Fac",
                    inputs={"IOR": ior},
                    thing=thing,
                )
            )
        for axis in "XYZ" if thing == "sphere" else "Z":  # around X and Y a plane has no direction
            properties = {"direction_type": "RADIAL", "axis": axis}
            found.append(
                Case(
                    f"tangent {axis} {thing}",
                    "ShaderNodeTangent",
                    "Tangent",
                    properties,
                    thing=thing,
                )
            )
        for uv_map in ("", "Second"):
            properties = {"direction_type": "UV_MAP", "uv_map": uv_map}
            found.append(
                Case(
                    f"tangent uv {uv_map} {thing}",
                    "ShaderNodeTangent",
                    "Tangent",
                    properties,
                    thing=thing,
                )
            )
        found.append(
            Case(
                f"wireframe {thing}",
                "ShaderNodeWireframe",
                "Fac",
                inputs={"Size": 0.05},
                thing=thing,
            )
        )
    found.append(
        Case(
            "wireframe pixels",
            "ShaderNodeWireframe",
            "Fac",
            {"use_pixel_size": True},
            {"Size": 3.0},
        )
    )
    normal = {"Normal": "p"}
    found.append(Case("fresnel of a normal", "ShaderNodeFresnel", "Fac", inputs=normal))
    found.append(Case("layer weight of a normal", "ShaderNodeLayerWeight", "Facing", inputs=normal))
    for output in ("Normal", "Dot"):
        found.append(
            Case(
                f"normal node {output}",
                "ShaderNodeNormal",
                output,
                inputs={"Normal": "p"},
                setup=_turn,
            )
        )
    return found


def _turn(node: Any) -> None:
    node.outputs["Normal"].default_value = (0.36, 0.48, 0.8)


def _attributes() -> list[Case]:
    found = []
    for name in (
        "Number",
        "Where",
        "Whole",
        "Flag",
        "Pair",
        "Edge",
        *(f"Edge {kind}" for kind in ("BOOLEAN", "INT", "INT8", "FLOAT_COLOR")),
        *(f"Edge {kind}" for kind in ("BYTE_COLOR", "QUATERNION")),
        "Bytes",
        "Floats",
        "First",
        "No such",
        "position",
    ):
        outputs: tuple[str, ...] = ("Color", "Vector", "Fac", "Alpha")
        found += [
            Case(f"attribute {name} {o}", "ShaderNodeAttribute", o, {"attribute_name": name})
            for o in outputs
        ]
    for name in ("uv", "generated", "tangent", "pointiness", "random_per_island"):
        found += [
            Case(
                f"attribute {name} {o}",
                "ShaderNodeAttribute",
                o,
                {"attribute_name": name},
                thing="sphere",
            )
            for o in ("Vector", "Fac", "Alpha")
        ]
    for name in ("Bytes", "Floats", "No such", ""):
        outputs = ("Color", "Alpha")
        found += [
            Case(
                f"color attribute {name} {o}",
                "ShaderNodeVertexColor",
                o,
                {"layer_name": name},
                thing="sphere",
            )
            for o in outputs
        ]
    for kind, name in (
        ("OBJECT", "own"),
        ("OBJECT", "own_vector"),
        ("OBJECT", "color"),
        ("OBJECT", "missing"),
        ("INSTANCER", "own"),
    ):
        for output in ("Color", "Fac", "Alpha"):
            properties = {"attribute_type": kind, "attribute_name": name}
            found.append(
                Case(f"attribute {kind} {name} {output}", "ShaderNodeAttribute", output, properties)
            )
    properties = {"attribute_type": "VIEW_LAYER", "attribute_name": "frame_current"}
    found.append(Case("attribute of the view layer", "ShaderNodeAttribute", "Fac", properties))
    return found


def _normals() -> list[Case]:
    found = []
    for space in enum("ShaderNodeNormalMap", "space"):
        for thing in THINGS:
            for k, strength in enumerate((1.0, 0.4, 2.0)):
                properties = {
                    "space": space,
                    "uv_map": "Second" if k == 1 and space == "TANGENT" else "",
                }
                inputs: dict[str, Any] = {"Color": "c", "Strength": strength}
                found.append(
                    Case(
                        f"normal map {space} {thing} {k}",
                        "ShaderNodeNormalMap",
                        "Normal",
                        properties,
                        inputs,
                        thing=thing,
                    )
                )
    for convention in (
        enum("ShaderNodeNormalMap", "convention")
        if "convention" in _properties("ShaderNodeNormalMap")
        else []
    ):
        properties = {"convention": convention}
        found.append(
            Case(
                f"normal map {convention}",
                "ShaderNodeNormalMap",
                "Normal",
                properties,
                {"Color": "c"},
                thing="sphere",
            )
        )
    for thing in ("hexagons", "bare"):
        found.append(
            Case(
                f"normal map {thing}",
                "ShaderNodeNormalMap",
                "Normal",
                inputs={"Color": "c"},
                thing=thing,
            )
        )
        along_map = {"direction_type": "UV_MAP"}
        found.append(
            Case(f"tangent {thing}", "ShaderNodeTangent", "Tangent", along_map, thing=thing)
        )
    found += [
        Case(f"bump of vectors {space} {thing}", "", "", thing=thing, build=_bump_of_vector(space))
        for space in enum("ShaderNodeVectorDisplacement", "space")
        for thing in ("sphere", "hexagons")
    ]
    found += [
        Case(f"bump by {place} {thing}", "", "", thing=thing, build=_bump_by(place), noise=True)
        for place in ("Generated", "UV", "Object", "Where")
        for thing in ("sphere", "hollow")
    ]
    for thing in (*THINGS, "hollow"):
        for invert in (False, True):
            inputs = {"Strength": 0.7, "Distance": 0.3, "Height": "waves"}
            found.append(
                Case(f"bump {thing} {invert}", "", "", thing=thing, build=_bump(invert, **inputs))
            )
        found.append(Case(f"bump twice {thing}", "", "", thing=thing, build=_bump_twice))
        found.append(
            Case(
                f"bump of noise {thing}",
                "",
                "",
                thing=thing,
                build=_bump(False, Height="noise", Distance=0.1),
                noise=True,
            )
        )
        found.append(Case(f"bump without height {thing}", "", "", thing=thing, build=_bump(False)))
    return found


def _properties(node: str) -> set[str]:
    import bpy

    return {p.identifier for p in getattr(bpy.types, node).bl_rna.properties}


def _waves(tree: Any) -> Any:
    wave = tree.nodes.new("ShaderNodeTexWave")
    wave.inputs["Scale"].default_value = 1.0
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], wave.inputs["Vector"])
    return wave.outputs[1]


def _noise(tree: Any) -> Any:
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 2.0
    noise.inputs["Detail"].default_value = 0.0
    return noise.outputs[0]


def _bump(invert: bool, **inputs: Any) -> Callable[[Any], Any]:
    def build(tree: Any) -> Any:
        bump = tree.nodes.new("ShaderNodeBump")
        bump.invert = invert
        for name, value in inputs.items():
            if isinstance(value, str):
                tree.links.new(
                    _waves(tree) if value == "waves" else _noise(tree), input_of(bump, name)
                )
            else:
                input_of(bump, name).default_value = value
        return bump.outputs[0]

    return build


def _bump_by(place: str) -> Callable[[Any], Any]:
    """By waves along texture coordinates, or an attribute."""

    def build(tree: Any) -> Any:
        bump, wave = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Bump", "TexWave"))
        wave.inputs["Scale"].default_value = 1.0
        input_of(bump, "Distance").default_value = 0.1
        if place == "Where":
            at = tree.nodes.new("ShaderNodeAttribute")
            at.attribute_name = place
            vector = at.outputs["Vector"]
        else:
            vector = tree.nodes.new("ShaderNodeTexCoord").outputs[place]
        tree.links.new(vector, wave.inputs["Vector"])
        tree.links.new(wave.outputs[1], input_of(bump, "Height"))
        return bump.outputs[0]

    return build


def _bump_twice(tree: Any) -> Any:
    first, second = (
        _bump(False, Height=height, Distance=0.2)(tree) for height in ("waves", "noise")
    )
    tree.links.new(first, input_of(second.node, "Normal"))
    return second


def _bump_of_vector(space: str) -> Callable[[Any], Any]:
    """By the height along the normal of a displacement by vectors."""

    def build(tree: Any) -> Any:
        moved, seen, height, bump = (
            tree.nodes.new(f"ShaderNode{kind}")
            for kind in ("VectorDisplacement", "NewGeometry", "VectorMath", "Bump")
        )
        moved.space, height.operation = space, "DOT_PRODUCT"
        input_of(moved, "Scale").default_value = 0.3
        input_of(bump, "Distance").default_value = 0.3
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], moved.inputs[0])
        tree.links.new(moved.outputs[0], height.inputs[0])
        tree.links.new(seen.outputs["Normal"], height.inputs[1])
        tree.links.new(height.outputs["Value"], input_of(bump, "Height"))
        return bump.outputs[0]

    return build


# --- how trees are put together ---


def _group(depth: int) -> Callable[[Any], Any]:
    """A colour through `depth` groups, each of which doubles it and adds its own unlinked input."""

    def build(tree: Any) -> Any:
        import bpy

        inner = None
        for k in range(depth):
            group = bpy.data.node_groups.new(f"Level {depth} {k}", "ShaderNodeTree")
            group.interface.new_socket("Tone", in_out="INPUT", socket_type="NodeSocketColor")
            group.interface.new_socket("More", in_out="INPUT", socket_type="NodeSocketVector")
            group.interface.new_socket("Result", in_out="OUTPUT", socket_type="NodeSocketVector")
            start, sum_of, ending = (
                group.nodes.new(kind)
                for kind in ("NodeGroupInput", "ShaderNodeVectorMath", "NodeGroupOutput")
            )
            value = start.outputs[0]
            if inner is not None:
                used = group.nodes.new("ShaderNodeGroup")
                used.node_tree = inner
                group.links.new(value, used.inputs[0])
                used.inputs[1].default_value = (0.1, 0.0, 0.2)
                value = used.outputs[0]
            group.links.new(value, sum_of.inputs[0])
            group.links.new(start.outputs[1], sum_of.inputs[1])
            group.links.new(sum_of.outputs[0], ending.inputs[0])
            inner = group
        outer = tree.nodes.new("ShaderNodeGroup")
        outer.node_tree = inner
        outer.inputs[1].default_value = (0.0, 0.3, 0.0)
        tree.links.new(Sources(tree).get("c"), outer.inputs[0])
        return outer.outputs[0]

    return build


def _number_group(tree: Any) -> Any:
    """A colour that goes through a number on its way into a group."""
    import bpy

    group = bpy.data.node_groups.new("Number", "ShaderNodeTree")
    group.interface.new_socket("Value", in_out="INPUT", socket_type="NodeSocketFloat")
    group.interface.new_socket("Result", in_out="OUTPUT", socket_type="NodeSocketColor")
    start, ending = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    group.links.new(start.outputs[0], ending.inputs[0])
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = group
    mixed = tree.nodes.new("ShaderNodeMix")
    mixed.data_type = "RGBA"
    tree.links.new(Sources(tree).get("p"), input_of(mixed, "A_Color"))
    input_of(mixed, "Factor_Float").default_value = 0.0
    tree.links.new(
        next(s for s in mixed.outputs if s.identifier == "Result_Color"), outer.inputs[0]
    )
    return outer.outputs[0]


def _muted(linked: bool) -> Callable[[Any], Any]:
    def build(tree: Any) -> Any:
        invert, gamma = tree.nodes.new("ShaderNodeInvert"), tree.nodes.new("ShaderNodeGamma")
        input_of(invert, "Color").default_value = (0.2, 0.4, 0.6, 1.0)
        invert.mute = True
        if linked:
            tree.links.new(Sources(tree).get("c"), input_of(invert, "Color"))
        tree.links.new(invert.outputs[0], input_of(gamma, "Color"))
        return gamma.outputs[0]

    return build


def _muted_link(tree: Any) -> Any:
    invert = tree.nodes.new("ShaderNodeInvert")
    input_of(invert, "Color").default_value = (0.2, 0.4, 0.6, 1.0)
    link = tree.links.new(Sources(tree).get("c"), input_of(invert, "Color"))
    link.is_muted = True
    return invert.outputs[0]


def _muted_without_way(tree: Any) -> Any:
    """A muted node whose output has no input to stand for."""
    muted, sum_of = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
    muted.mute = True
    sum_of.inputs[0].default_value = (0.3, 0.2, 0.1)
    tree.links.new(muted.outputs["Object"], sum_of.inputs[0])
    return sum_of.outputs[0]


def _loose_reroute(tree: Any) -> Any:
    """Links that come from nowhere."""
    reroute, invert = tree.nodes.new("NodeReroute"), tree.nodes.new("ShaderNodeInvert")
    input_of(invert, "Color").default_value = (0.2, 0.4, 0.6, 1.0)
    tree.links.new(reroute.outputs[0], input_of(invert, "Color"))
    return invert.outputs[0]


def _hidden_output(way: str) -> Callable[[Any], Any]:
    """A link from an output that the node's mode hides since: straight, by a reroute, in a group or
    into one.
    """

    def hide(tree: Any, target: Any) -> None:
        mixed = tree.nodes.new("ShaderNodeMix")
        mixed.data_type = "FLOAT"
        output = next(s for s in mixed.outputs if s.identifier == "Result_Float")
        if way == "reroute":
            reroute = tree.nodes.new("NodeReroute")
            tree.links.new(output, reroute.inputs[0])
            output = reroute.outputs[0]
        tree.links.new(output, target)
        mixed.data_type = "RGBA"

    def build(tree: Any) -> Any:
        if way.startswith("group"):
            outer = _number_group(tree).node
            inner = outer.node_tree
            ending = next(n for n in inner.nodes if n.type == "GROUP_OUTPUT")
            hide(*((inner, ending.inputs[0]) if way == "group" else (tree, outer.inputs[0])))
            return outer.outputs[0]
        sum_of = tree.nodes.new("ShaderNodeMath")
        sum_of.inputs[0].default_value, sum_of.inputs[1].default_value = 0.2, 0.4
        hide(tree, sum_of.inputs[1])
        return sum_of.outputs[0]

    return build


def _muted_group(tree: Any) -> Any:
    outer = _number_group(tree).node
    outer.mute = True
    return outer.outputs[0]


def _whole_group(tree: Any) -> Any:
    """A number that goes through an integer and a switch."""
    import bpy

    group = bpy.data.node_groups.new("Whole", "ShaderNodeTree")
    group.interface.new_socket("Count", in_out="INPUT", socket_type="NodeSocketInt")
    group.interface.new_socket("Switch", in_out="INPUT", socket_type="NodeSocketBool")
    group.interface.new_socket("Result", in_out="OUTPUT", socket_type="NodeSocketFloat")
    start, ending, sum_of = (
        group.nodes.new(kind) for kind in ("NodeGroupInput", "NodeGroupOutput", "ShaderNodeMath")
    )
    for k in range(2):
        group.links.new(start.outputs[k], sum_of.inputs[k])
    group.links.new(sum_of.outputs[0], ending.inputs[0])
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = group
    for socket in outer.inputs[:2]:
        tree.links.new(Sources(tree).get("x"), socket)
    return outer.outputs[0]


def _reroutes(tree: Any) -> Any:
    socket = Sources(tree).get("c")
    for _ in range(5):
        reroute = tree.nodes.new("NodeReroute")
        tree.links.new(socket, reroute.inputs[0])
        socket = reroute.outputs[0]
    return socket


def _texture_mapping(kind: str) -> Callable[[Any], Any]:
    def build(tree: Any) -> Any:
        image = tree.nodes.new("ShaderNodeTexImage")
        image.image = picture("opaque", alpha=False)
        mapping = image.texture_mapping
        mapping.vector_type = kind
        mapping.translation, mapping.rotation, mapping.scale = (
            (0.1, 0.2, 0.3),
            (0.1, 0.2, 0.5),
            (1.5, 0.8, 2.0),
        )
        mapping.mapping_x, mapping.mapping_y = "Y", "X"
        tree.links.new(Sources(tree).get("p"), image.inputs[0])
        return image.outputs[0]

    return build


def _object_coordinates(tree: Any) -> Any:
    import bpy

    ob = bpy.data.objects.get("Guide")
    if ob is None:
        ob = bpy.data.objects.new("Guide", None)
        ob.location, ob.rotation_euler, ob.scale = (1.0, 2.0, 0.5), (0.2, 0.4, 0.6), (1.0, 2.0, 0.5)
        bpy.context.scene.collection.objects.link(ob)
        bpy.context.view_layer.update()
    node = tree.nodes.new("ShaderNodeTexCoord")
    node.object = ob
    return node.outputs["Object"]


def _trees() -> list[Case]:
    made: dict[str, Callable[[Any], Any]] = {
        f"{depth} groups": _group(depth) for depth in (1, 2, 8)
    }
    made |= {
        "number group": _number_group,
        "muted": _muted(True),
        "muted unlinked": _muted(False),
        "muted link": _muted_link,
    }
    made |= {
        "muted without way": _muted_without_way,
        "reroutes": _reroutes,
        "loose reroute": _loose_reroute,
        "object coordinates": _object_coordinates,
    }
    made |= {"muted group": _muted_group, "whole group": _whole_group}
    made |= {
        f"hidden output {way}": _hidden_output(way)
        for way in ("straight", "reroute", "group", "group input")
    }
    made |= {
        f"texture mapping {kind}": _texture_mapping(kind)
        for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL")
    }
    return [Case(name, "", "", build=build) for name, build in made.items()]


def _conversions() -> list[Case]:
    """Colour, vector and number sockets linked to each other."""

    def build(source: str, target: str) -> Callable[[Any], Any]:
        def made(tree: Any) -> Any:
            node = {
                "float": "ShaderNodeMath",
                "vector": "ShaderNodeVectorMath",
                "color": "ShaderNodeGamma",
            }[target]
            used = tree.nodes.new(node)
            values = {"float": "x", "vector": "p"}
            if source == "color":
                mixed = tree.nodes.new("ShaderNodeInvert")
                input_of(mixed, "Fac").default_value = 0.0
                tree.links.new(Sources(tree).get("p"), input_of(mixed, "Color"))
                tree.links.new(mixed.outputs[0], used.inputs[0])
            else:
                tree.links.new(Sources(tree).get(values[source]), used.inputs[0])
            return used.outputs[0]

        return made

    kinds = ("float", "vector", "color")
    return [
        Case(f"{source} to {target}", "", "", build=build(source, target))
        for source in kinds
        for target in kinds
    ]
