"""Displacement that moves the surface: what of it reaches the engine, and what is said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from photon_splat.core.scene import Mesh, Scene

from tests.support import stage
from tests.support.blender import in_blender


def _moved(height: Any = 1.0, method: str = "DISPLACEMENT", shader: str = "Diffuse") -> Any:
    """A square of 4 x 4 faces whose material moves it up by `height`, or by what the node of that
    type says; returns the object.
    """
    made, tree = stage.empty_material("Moving")
    node = tree.nodes.new("ShaderNodeDisplacement")
    node.inputs["Midlevel"].default_value, node.inputs["Scale"].default_value = 0.5, 0.4
    if isinstance(height, str):
        given = tree.nodes.new(height)
        tree.links.new(given.outputs[0], node.inputs["Height"])
    else:
        node.inputs["Height"].default_value = height
    output = next(one for one in tree.nodes if one.type == "OUTPUT_MATERIAL")
    tree.links.new(node.outputs[0], output.inputs["Displacement"])
    stage.surface(tree, tree.nodes.new(f"ShaderNodeBsdf{shader}"))
    made.displacement_method = method
    steps = np.linspace(-1.0, 1.0, 5)
    vertices = [(x, y, 0.0) for y in steps for x in steps]
    faces = [
        (5 * y + x, 5 * y + x + 1, 5 * y + x + 6, 5 * y + x + 5) for y in range(4) for x in range(4)
    ]
    ob = stage.add("Sheet", stage.mesh("Sheet", vertices, faces))
    ob.data.materials.append(made)
    return ob


def _mesh(what: Scene) -> Mesh:
    (found,) = what.meshes
    return found


@pytest.mark.smoke
@in_blender
def test_vertices_move() -> None:
    ob = _moved()
    ob.scale = (1.0, 1.0, 2.0)
    what = stage.exported()
    # half of 0.4 along the normal, in the object's own measure
    assert np.allclose(_mesh(what).positions[:, 2], 0.2, atol=1e-6)
    assert what.warnings == []
    ob.active_material.displacement_method = "BUMP"
    assert np.allclose(_mesh(stage.exported()).positions[:, 2], 0.0)


@in_blender
def test_both_keeps_normals_and_bends_them_later() -> None:
    from photon_splat.export.nodes.values import operations

    ob = _moved("ShaderNodeTexNoise", "BOTH")
    ob.data.shade_smooth()
    what = stage.exported()
    mesh = _mesh(what)
    assert np.ptp(mesh.positions[:, 2]) > 0.01
    assert mesh.corner_normals is not None
    assert np.allclose(mesh.corner_normals, (0, 0, 1), atol=1e-6)
    (program,) = what.programs
    assert {operations()[name].opcode for name in ("DisplacementBump", "BentNormal")} <= set(
        program.code.tolist()
    )
    ob.active_material.displacement_method = "DISPLACEMENT"
    alone = _mesh(stage.exported())
    assert np.array_equal(alone.positions, mesh.positions)
    assert alone.corner_normals is not None
    assert np.ptp(alone.corner_normals[..., 0]) > 0.01


@in_blender
def test_each_material_moves_its_own_copy() -> None:
    ob = _moved()
    still = stage.add("Still", ob.data, (3, 0, 0))
    stage.add("Same", ob.data, (6, 0, 0))
    still.material_slots[0].link = "OBJECT"
    still.material_slots[0].material = stage.material("Grey")
    what = stage.exported()
    heights = [what.meshes[m].positions[0, 2] for m in what.instances.mesh]
    assert sorted(heights) == pytest.approx([0.0, 0.2, 0.2])
    assert len(what.meshes) == 2


@in_blender
def test_what_has_not_changed_is_not_moved_again() -> None:
    import bpy
    from photon_splat.export import export_scene
    from photon_splat.export.kept import Kept

    ob, kept = _moved("ShaderNodeTexNoise"), Kept()
    stage.camera()

    def exported() -> Mesh:
        return _mesh(export_scene(bpy.context.evaluated_depsgraph_get(), kept=kept))

    first = exported()
    assert exported().positions is first.positions
    tree = ob.active_material.node_tree
    next(one for one in tree.nodes if one.type == "DISPLACEMENT").inputs["Scale"].default_value = 2
    assert np.ptp(exported().positions[:, 2]) > 2 * np.ptp(first.positions[:, 2])


@in_blender
def test_what_another_program_asks_for_comes_along() -> None:
    """A surface shader that begins to ask for Generated coordinates gets them, though the
    displacement has not changed.
    """
    import bpy
    from photon_splat.core.scene.shading import GENERATED
    from photon_splat.export import export_scene
    from photon_splat.export.kept import Kept

    ob, kept = _moved(), Kept()
    stage.camera()

    def exported() -> Mesh:
        return _mesh(export_scene(bpy.context.evaluated_depsgraph_get(), kept=kept))

    assert GENERATED not in {one.id for one in exported().shading.attributes}
    tree = ob.active_material.node_tree
    where = tree.nodes.new("ShaderNodeTexCoord")
    shader = next(one for one in tree.nodes if one.type == "BSDF_DIFFUSE")
    tree.links.new(where.outputs["Generated"], shader.inputs["Color"])
    assert GENERATED in {one.id for one in exported().shading.attributes}


@in_blender
def test_vertices_without_a_place_stay() -> None:
    ob = _moved("ShaderNodeMath")
    node = next(one for one in ob.active_material.node_tree.nodes if one.type == "MATH")
    node.operation = "MULTIPLY"
    node.inputs[0].default_value = node.inputs[1].default_value = 3e38
    what = stage.exported()
    assert np.allclose(_mesh(what).positions[:, 2], 0.0)
    assert stage.the_one_warning(what) == (
        "Object 'Sheet': its displacement is not a finite number at 25 vertices, which stay where "
        "they are"
    )


@in_blender
def test_a_missing_image_is_told() -> None:
    import bpy

    ob = _moved("ShaderNodeTexImage")
    node = next(one for one in ob.active_material.node_tree.nodes if one.type == "TEX_IMAGE")
    node.image = bpy.data.images.new("Lost", 4, 4)
    node.image.source, node.image.filepath = "FILE", "//nowhere.png"
    what = stage.exported()
    assert "Lost" in stage.the_one_warning(what) or "nowhere.png" in stage.the_one_warning(what)
    assert np.isfinite(_mesh(what).positions).all()


@in_blender
def test_an_empty_mesh_is_no_matter() -> None:
    ob = _moved()
    ob.data.clear_geometry()
    what = stage.exported()
    assert what.meshes == []
    assert what.warnings == []


def _shrink_to_a_point(material: Any) -> None:
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeVectorDisplacement")
    node.space = "OBJECT"
    node.inputs["Scale"].default_value = -1.0
    where = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(where.outputs["Position"], node.inputs["Vector"])
    output = next(one for one in tree.nodes if one.type == "OUTPUT_MATERIAL")
    tree.links.new(node.outputs[0], output.inputs["Displacement"])


@in_blender
def test_what_displacement_leaves_without_area_is_left_out() -> None:
    ob = _moved("ShaderNodeTexImage")
    _shrink_to_a_point(ob.active_material)
    what = stage.exported()
    assert len(_mesh(what).triangles) == 0
    assert "32 without area" in stage.the_one_warning(what)


@in_blender
def test_it_is_rendered_where_nothing_is_left() -> None:
    """A mesh that all moves to one point is not there, and nothing fails."""
    ob = _moved()
    _shrink_to_a_point(ob.active_material)
    import bpy

    stage.room()
    with stage.watched() as results:
        bpy.ops.render.render()
    assert np.isfinite(results[0].passes["Combined"]).all()
    assert results[0].passes["Combined"][..., :3].max() > 0.0


@in_blender
def test_what_scale_flattens_is_not_displaced() -> None:
    ob = _moved()
    ob.scale = (1.0, 1.0, 0.0)
    what = stage.exported()
    assert stage.the_one_warning(what) == (
        "Objects that their scale flattens are not displaced: 'Sheet'"
    )
