"""Trees as files in the wild have them: loops, groups without output, unknown nodes, ten thousand
nodes.
"""

from __future__ import annotations

import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.reference.nodes.cases import input_of
from tests.support import stage
from tests.support.blender import in_blender


def _emitting(name: str = "Made") -> tuple[Any, Any]:
    """A tree that emits, and the node that does."""
    made, tree = stage.empty_material(name)
    shader = tree.nodes.new("ShaderNodeEmission")
    stage.surface(tree, shader)
    stage.plane(name).data.materials[0] = made
    return tree, shader


def _program_size(what: Any, index: int = 0) -> int:
    return len(what.programs[what.materials[index].program].code)


@in_blender
def test_a_loop_of_values_is_named() -> None:
    tree, shader = _emitting()
    first, second = (tree.nodes.new("ShaderNodeMath") for _ in range(2))
    first.label = "Chicken"
    tree.links.new(first.outputs[0], second.inputs[0])
    tree.links.new(second.outputs[0], first.inputs[0])
    tree.links.new(second.outputs[0], shader.inputs["Strength"])
    said = stage.the_one_warning(stage.exported())
    assert (
        said
        == "Material 'Made', node 'Chicken': its links run in a circle; one of them counts as not "
        "there"
    )


@in_blender
def test_loops_of_shaders_and_reroutes_are_named() -> None:
    made, tree = stage.empty_material("Knot")
    first, second = (tree.nodes.new("ShaderNodeAddShader") for _ in range(2))
    glow = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(glow.outputs[0], first.inputs[0])
    tree.links.new(second.outputs[0], first.inputs[1])
    tree.links.new(first.outputs[0], second.inputs[0])
    stage.surface(tree, first)
    reroutes = [tree.nodes.new("NodeReroute") for _ in range(2)]
    for a, b in (reroutes, reroutes[::-1]):
        tree.links.new(a.outputs[0], b.inputs[0])
    tree.links.new(reroutes[0].outputs[0], glow.inputs["Strength"])
    stage.plane("Knot").data.materials[0] = made
    what = stage.exported()
    assert what.materials[0].front.emission != (0, 0, 0)
    assert len(what.warnings) == 2
    assert all("'Knot'" in said and "circle" in said for said in what.warnings), what.warnings


@in_blender
def test_groups_without_output_or_tree() -> None:
    import bpy

    tree, shader = _emitting()
    hollow, absent = (tree.nodes.new("ShaderNodeGroup") for _ in range(2))
    inner = bpy.data.node_groups.new("Hollow", "ShaderNodeTree")
    inner.interface.new_socket("Value", in_out="OUTPUT", socket_type="NodeSocketFloat")
    hollow.node_tree = inner
    tree.links.new(hollow.outputs[0], shader.inputs["Strength"])
    shader.inputs["Strength"].default_value = 3.0
    assert absent.node_tree is None
    what = stage.exported()
    assert what.materials[0].front.emission == (3, 3, 3)
    said = "the group has no output; links from it count as not there"
    assert what.warnings == [f"Material 'Made', node '{hollow.name}': {said}"]


@in_blender
def test_a_node_of_a_later_blender_version_is_named(tmp_path: str) -> None:
    """A file whose node has a type that this Blender does not know: as one from a later version."""
    import bpy

    tree, shader = _emitting()
    later = tree.nodes.new("ShaderNodeGamma")
    later.label = "Tomorrow"
    shader.inputs["Strength"].default_value = 3.0
    tree.links.new(later.outputs[0], shader.inputs["Color"])
    path = Path(tmp_path, "later.blend")
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    saved = path.read_bytes()
    assert b"ShaderNodeGamma\0" in saved
    path.write_bytes(saved.replace(b"ShaderNodeGamma\0", b"ShaderNodeZamma\0"))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    said = stage.the_one_warning(stage.exported())
    assert said.startswith("Material 'Made', node 'Tomorrow': "), said
    assert "is not supported; links from it count as not there" in said


@in_blender
def test_nodes_that_are_not_supported_are_named() -> None:
    tree, shader = _emitting()
    stroke = tree.nodes.new("ShaderNodeUVAlongStroke")
    stroke.label = "Lines"
    tree.links.new(stroke.outputs[0], shader.inputs["Color"])
    shader.inputs["Color"].default_value = (0.25, 0.5, 1.0, 1.0)
    what = stage.exported()
    assert what.materials[0].front.emission == (0.25, 0.5, 1)
    assert what.warnings == [
        "Material 'Made', node 'Lines': UV Along Stroke is not supported; links from it count as "
        "not there"
    ]


@in_blender
def test_shader_in_a_place_for_values_and_the_reverse() -> None:
    tree, shader = _emitting()
    other = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(other.outputs[0], shader.inputs["Color"])
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    what = stage.exported()
    assert "a shader is linked to a value" in stage.the_one_warning(what)
    color = tree.nodes.new("ShaderNodeRGB")
    color.outputs[0].default_value = (0.25, 0.5, 1.0, 1.0)
    tree.links.new(color.outputs[0], output.inputs["Surface"])
    assert stage.exported().materials[0].front.emission == (0.25, 0.5, 1)


def _in_a_row(name: str, make: Any, count: int, kind: str) -> Any:
    """A group of `count` nodes, each fed by the one before at its inputs of `kind`."""
    import bpy

    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    group.interface.new_socket("In", in_out="INPUT", socket_type=kind)
    group.interface.new_socket("Out", in_out="OUTPUT", socket_type=kind)
    start, ending = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    socket = start.outputs[0]
    for k in range(count):
        node = make(group, k)
        for target in [one for one in node.inputs if one.bl_idname == kind][:1]:
            group.links.new(socket, target)
        socket = node.outputs[0]
    group.links.new(socket, ending.inputs[0])
    return group


def _group_of(inner: Any) -> Any:
    def make(group: Any, _: int) -> Any:
        node = group.nodes.new("ShaderNodeGroup")
        node.node_tree = inner
        return node

    return make


@pytest.mark.smoke
@in_blender
def test_ten_thousand_nodes_in_a_row() -> None:
    """Deep for values, shaders and groups; the recursion limit does not matter."""

    def moved(group: Any, k: int) -> Any:
        node = group.nodes.new("ShaderNodeVectorMath")
        node.inputs[1].default_value = (k, 0, 1)
        return node

    def mixed(group: Any, _: int) -> Any:
        node = group.nodes.new("ShaderNodeMixShader")
        node.inputs[0].default_value = 0.001
        return node

    tree, shader = _emitting()
    values, shaders = (
        _in_a_row("Values", moved, 90, "NodeSocketVector"),
        _in_a_row("Shaders", mixed, 10, "NodeSocketShader"),
    )
    for level in range(2):
        values = _in_a_row(f"Values {level}", _group_of(values), 10, "NodeSocketVector")
        shaders = _in_a_row(f"Shaders {level}", _group_of(shaders), 10, "NodeSocketShader")
    used, above = _group_of(values)(tree, 0), _group_of(shaders)(tree, 0)
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    for start, end in (
        (coordinates.outputs["UV"], used.inputs[0]),
        (used.outputs[0], shader.inputs["Color"]),
        (shader.outputs[0], above.inputs[0]),
        (above.outputs[0], output.inputs["Surface"]),
    ):
        tree.links.new(start, end)
    started = time.process_time()
    what = stage.exported()
    assert time.process_time() - started < 20
    assert what.warnings == []
    assert 9000 * 8 < _program_size(what) < 9000 * 8 + 100
    assert what.programs[0].registers < 20


@in_blender
def test_the_same_shader_twice_in_every_mix_of_many() -> None:
    """2^100 ways through the tree; what comes out is compiled once."""
    import bpy
    from photon_splat.export import export_scene

    tree, shader = _emitting()
    above = shader.outputs[0]
    for _ in range(100):
        mix = tree.nodes.new("ShaderNodeMixShader")
        mix.inputs[0].default_value = 0.25
        for socket in mix.inputs[1:3]:
            tree.links.new(above, socket)
        above = mix.outputs[0]
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(above, output.inputs["Surface"])
    stage.camera()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    assert np.allclose(what.materials[0].front.emission, 1.0)


@in_blender
def test_constants_are_folded_and_equal_parts_stand_once() -> None:
    tree, shader = _emitting()
    total = None
    for _ in range(20):
        chain = tree.nodes.new("ShaderNodeMath")
        chain.operation = "MULTIPLY"
        chain.inputs[0].default_value, chain.inputs[1].default_value = 2.0, 0.25
        joined = tree.nodes.new("ShaderNodeMath")
        tree.links.new(chain.outputs[0], joined.inputs[0])
        joined.inputs[1].default_value = 0.0
        if total is not None:
            tree.links.new(total, joined.inputs[1])
        total = joined.outputs[0]
    tree.links.new(total, shader.inputs["Strength"])
    assert stage.exported().materials[0].front.emission == (10, 10, 10)
    noise = [tree.nodes.new("ShaderNodeTexNoise") for _ in range(8)]
    for node in noise:
        mixed = tree.nodes.new("ShaderNodeMath")
        tree.links.new(node.outputs[0], mixed.inputs[0])
        tree.links.new(total, mixed.inputs[1])
        total = mixed.outputs[0]
    tree.links.new(total, shader.inputs["Strength"])
    what = stage.exported()
    from photon_splat.export.nodes.values import operations

    code = what.programs[0].code.tolist()
    assert code.count(operations()["NoiseTexture"].opcode) == 1


@in_blender
def test_noise_is_computed_together_where_none_needs_another() -> None:
    from photon_splat.export.nodes.values import operations

    made, tree = stage.empty_material("Noisy")
    shader = tree.nodes.new("ShaderNodeEmission")
    noise = [tree.nodes.new("ShaderNodeTexNoise") for _ in range(4)]
    total = None
    for node in noise[:3]:
        added = tree.nodes.new("ShaderNodeMath")
        tree.links.new(node.outputs[0], added.inputs[0])
        if total is not None:
            tree.links.new(total, added.inputs[1])
        total = added.outputs[0]
        node.inputs["Scale"].default_value = 2.0 + len(tree.nodes)
    tree.links.new(total, noise[3].inputs["Scale"])
    tree.links.new(noise[3].outputs[0], shader.inputs["Strength"])
    stage.surface(tree, shader)
    stage.plane("Noisy").data.materials[0] = made
    code = stage.exported().programs[0].code.tolist()
    by_code = {operation.opcode: operation for operation in operations().values()}
    order = []
    while code:
        operation = by_code[code[0]]
        order.append(f"Together {code[1]}" if operation.name == "Together" else operation.name)
        del code[: 1 + len(operation.operands)]
    assert order.count("NoiseTexture") == 4
    first = order.index("Together 3")
    assert order[first + 1 : first + 4] == ["NoiseTexture"] * 3
    assert "NoiseTexture" in order[first + 5 :]
    assert "Together 1" not in order


@in_blender
def test_a_branch_of_weight_zero_is_dropped() -> None:
    made, tree = stage.empty_material("Half")
    mix, kept, dropped = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("MixShader", "Emission", "BsdfHair")
    )
    mix.inputs[0].default_value = 0.0
    tree.links.new(kept.outputs[0], mix.inputs[1])
    tree.links.new(dropped.outputs[0], mix.inputs[2])
    stage.surface(tree, mix)
    stage.plane("Half").data.materials[0] = made
    what = stage.exported()
    assert what.materials[0].front.emission == (1, 1, 1)
    assert what.warnings == []


@in_blender
def test_a_uv_map_without_area_does_no_harm() -> None:
    import bpy
    from photon_splat.core.native import library as native
    from photon_splat.core.native.fill import fill_renderer
    from photon_splat.core.render.settings import RenderSettings

    made, tree = stage.empty_material("Flat")
    shader, normal, tangent = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfPrincipled", "NormalMap", "Tangent")
    )
    normal.uv_map = tangent.uv_map = "Nowhere"
    tangent.direction_type = "UV_MAP"
    input_of(normal, "Color").default_value = (0.9, 0.2, 0.7, 1.0)
    shader.inputs["Anisotropic"].default_value = 0.7
    tree.links.new(normal.outputs[0], shader.inputs["Normal"])
    tree.links.new(tangent.outputs[0], shader.inputs["Tangent"])
    stage.surface(tree, shader)
    ob = stage.plane("Flat")
    ob.data.materials[0] = made
    layer = ob.data.uv_layers.new(name="Nowhere")
    layer.uv.foreach_set("vector", np.full(8, 0.5, np.float32))
    what = stage.exported()
    for said in what.warnings:
        assert re.match(
            r"Material 'Flat', node '.+': no face of the UV map 'Nowhere' has an area, .+ 'Flat'$",
            said,
        ), said
    assert {said.split("'")[3] for said in what.warnings} == {"Tangent", "Normal Map"}
    renderer = native.load().Renderer(1)
    fill_renderer(renderer, what, RenderSettings())
    renderer.build()
    down = np.array([[0, 0, -1]], np.float32)
    found = renderer.shade_rays(np.array([[0.2, 0.3, 4.0]], np.float32), down)
    assert all(np.isfinite(found[name]).all() for name in ("emission", "gather", "albedo"))
    assert bpy.data.materials["Flat"].name == "Flat"
    layer.uv.foreach_set("vector", np.array([0, 0, 1, 0, 1, 1, 0, 1], np.float32))
    ob.data.update_tag()
    bpy.context.view_layer.update()
    assert stage.exported().warnings == []


@in_blender
def test_displacement_bends_normals() -> None:
    made, tree = stage.empty_material("Rough")
    shader, noise, displacement = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "TexNoise", "Displacement")
    )
    tree.links.new(noise.outputs[0], displacement.inputs["Height"])
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(displacement.outputs[0], output.inputs["Displacement"])
    stage.surface(tree, shader)
    stage.plane("Rough").data.materials[0] = made
    made.displacement_method = "BUMP"
    what = stage.exported()
    from photon_splat.export.nodes.values import operations

    assert operations()["Bump"].opcode in what.programs[0].code.tolist()
    assert what.warnings == []
    made.displacement_method = "DISPLACEMENT"
    what = stage.exported()
    assert what.programs == []  # what is left is a Lambertian surface
    assert what.warnings == []
