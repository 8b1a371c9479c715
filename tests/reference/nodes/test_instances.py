"""Attributes of instances, against Cycles."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.reference.nodes import stage
from tests.support import stage as board
from tests.support.blender import in_blender


def _instances(
    tree: Any,
    points: tuple[int, float],
    instance: Any,
    stored: str,
    divisor: float,
    ids: tuple[float, float] | None = None,
    kind: str = "FLOAT",
) -> Any:
    """A row of instances, each with its number by `divisor` as the attribute `stored` of that
    kind, and, if wanted, with an `id` of its number times `ids[0]` plus `ids[1]`.
    """
    add, link = tree.nodes.new, tree.links.new
    row, onto, store, index, divide = (
        add(kind)
        for kind in (
            *(
                "GeometryNodeMeshLine",
                "GeometryNodeInstanceOnPoints",
                "GeometryNodeStoreNamedAttribute",
            ),
            *("GeometryNodeInputIndex", "ShaderNodeMath"),
        )
    )
    row.inputs["Count"].default_value, row.inputs["Offset"].default_value = (
        points[0],
        (points[1], 0.0, 0.0),
    )
    store.domain, store.data_type, divide.operation = "INSTANCE", kind, "DIVIDE"
    store.inputs["Name"].default_value, divide.inputs[1].default_value = stored, divisor
    if ids is None:
        link(row.outputs["Mesh"], onto.inputs["Points"])
    else:
        named, times = add("GeometryNodeSetID"), add("ShaderNodeMath")
        times.operation = "MULTIPLY_ADD"
        times.inputs[1].default_value, times.inputs[2].default_value = ids
        link(index.outputs[0], times.inputs[0])
        link(times.outputs[0], named.inputs["ID"])
        link(row.outputs["Mesh"], named.inputs["Geometry"])
        link(named.outputs[0], onto.inputs["Points"])
    link(instance, onto.inputs["Instance"])
    link(onto.outputs[0], store.inputs["Geometry"])
    link(index.outputs[0], divide.inputs[0])
    link(
        divide.outputs[0],
        next(socket for socket in store.inputs if socket.name == "Value" and socket.enabled),
    )
    return store.outputs[0]


@in_blender
def test_attributes_that_geometry_nodes_give_to_instances() -> None:
    _check_two_levels(None, None)


@in_blender
def test_attributes_of_instances_that_have_ids() -> None:
    """Points that were distributed on faces have, and those of Set ID; negative and large ones."""
    _check_two_levels((-700_000_000.0, 7.0), (1.0, 1000.0))


@in_blender
def test_attributes_of_instances_that_share_an_id() -> None:
    """As where geometries with the same ids were joined."""
    _check_two_levels((0.0, -5.0), (0.0, 3.0))


@in_blender
def test_attributes_of_instances_of_all_kinds() -> None:
    """Numbers, colours and vectors; a rotation is nothing, as in Cycles."""
    kinds = _kinds_stored()
    assert {"INT8", "BYTE_COLOR", "QUATERNION"} < kinds
    for kind in sorted(kinds - {"FLOAT4X4"}):
        _check_two_levels(None, None, kind)


def _kinds_stored() -> set[str]:
    import bpy

    known = bpy.types.GeometryNodeStoreNamedAttribute.bl_rna.properties["data_type"].enum_items
    stored = {item.identifier for item in known}
    return stored - {"STRING", "INT16_2D", "INT32_2D"}


def _check_two_levels(
    inner_ids: tuple[float, float] | None,
    outer_ids: tuple[float, float] | None,
    kind: str = "FLOAT",
) -> None:
    """Red is stored with the inner of two levels of instances, green with the outer as that kind,
    blue is a property of the object that has them.
    """
    import bpy

    stage.build([])
    made, tree = board.empty_material("Tinted")
    joined, emission, shifted = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("CombineXYZ", "Emission", "VectorMath")
    )
    shifted.inputs[1].default_value = (stage.SHIFT,) * 3
    for k, name in enumerate(("inner", "outer", "own")):
        asked = tree.nodes.new("ShaderNodeAttribute")
        asked.attribute_type, asked.attribute_name = "INSTANCER", name
        tree.links.new(asked.outputs["Fac"], joined.inputs[k])
    tree.links.new(joined.outputs[0], shifted.inputs[0])
    tree.links.new(shifted.outputs[0], emission.inputs["Color"])
    board.surface(tree, emission)

    nodes = bpy.data.node_groups.new("Rows", "GeometryNodeTree")
    nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    cube, colored, output = (
        nodes.nodes.new(kind)
        for kind in ("GeometryNodeMeshCube", "GeometryNodeSetMaterial", "NodeGroupOutput")
    )
    cube.inputs["Size"].default_value = (0.8, 0.8, 0.1)
    colored.inputs["Material"].default_value = made
    nodes.links.new(cube.outputs["Mesh"], colored.inputs["Geometry"])
    inner = _instances(nodes, (3, 1.0), colored.outputs[0], "inner", 4.0, inner_ids)
    outer = _instances(nodes, (2, 3.0), inner, "outer", 2.0, outer_ids, kind)
    nodes.links.new(outer, output.inputs[0])
    ob = bpy.data.objects.new("Rows", bpy.data.meshes.new("Rows"))
    ob.modifiers.new("Rows", "NODES").node_group = nodes
    ob["own"] = 0.375
    scene = bpy.context.scene
    scene.collection.objects.link(ob)
    scene.camera.location, scene.camera.data.ortho_scale = (2.5, 0.0, 5.0), 6.0
    scene.render.resolution_x, scene.render.resolution_y = 60, 10
    bpy.context.view_layer.update()

    reference, positions = stage.cycles()
    ours, warnings = stage.ours(positions)
    assert warnings == []
    middles = reference[5, 5::10]
    if kind == "FLOAT":
        expected = [(k % 3 / 4.0, k // 3 / 2.0, 0.375) for k in range(6)]
        np.testing.assert_allclose(middles, expected, atol=1e-4)
    np.testing.assert_allclose(ours, reference, atol=1e-4)


@in_blender
def test_the_location_of_an_object_to_its_last_bit() -> None:
    """White noise of it is another colour at another bit: plain objects, and such as a parent has
    turned, in a scene whose middle is elsewhere.
    """
    import bpy

    stage.build([])
    made, tree = board.empty_material("Random")
    info, noise, shifted, emission = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("ObjectInfo", "TexWhiteNoise", "VectorMath", "Emission")
    )
    shifted.inputs[1].default_value = (stage.SHIFT,) * 3
    tree.links.new(info.outputs["Location"], noise.inputs["Vector"])
    tree.links.new(noise.outputs["Color"], shifted.inputs[0])
    tree.links.new(shifted.outputs[0], emission.inputs["Color"])
    board.surface(tree, emission)

    scene = bpy.context.scene
    parent = bpy.data.objects.new("Parent", None)
    parent.location, parent.rotation_euler, parent.scale = (2.3, -1.7, 0.9), (0, 0, 0.7), (1.3,) * 3
    scene.collection.objects.link(parent)
    sheet = bpy.data.meshes.new("Sheet")
    sheet.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
    sheet.materials.append(made)
    for k in range(48):
        ob = bpy.data.objects.new(f"Sheet {k}", sheet)
        ob.scale = (0.4,) * 3
        if k % 2:
            ob.parent = parent
        ob.location = (k % 8 + 0.1 * (k % 3), k // 8 * 1.1 + 0.07 * (k % 7), 0.013 * k)
        scene.collection.objects.link(ob)
    far = bpy.data.objects.new("Far", sheet)
    far.location = (151.3, 77.7, 0.0)
    scene.collection.objects.link(far)
    scene.camera.location, scene.camera.data.ortho_scale = (4.1, 3.2, 15.0), 14.0
    scene.render.resolution_x, scene.render.resolution_y = 96, 96
    bpy.context.view_layer.update()

    reference, positions = stage.cycles()
    ours, _ = stage.ours(positions)
    off = (np.abs(ours - reference) > 1e-3).any(axis=-1)
    assert len(np.unique(np.round(reference, 3).reshape(-1, 3), axis=0)) > 30
    assert off.mean() < 0.01, off.mean()
