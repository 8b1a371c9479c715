"""Curves, point clouds and hair of particles as they are exported."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from photon_splat.core.scene import Strands, StrandShape
from photon_splat.core.scene.shading import Domain

from tests.support import stage
from tests.support.blender import in_blender


def curves(
    keys: Sequence[Sequence[Sequence[float]]], radius: float = 0.1, name: str = "Curves"
) -> Any:
    import bpy

    data = bpy.data.hair_curves.new(name)
    if keys:
        data.add_curves([len(one) for one in keys])
        flat = np.array([key for one in keys for key in one], np.float32)
        data.position_data.foreach_set("vector", flat.ravel())
        made = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
        made.data.foreach_set("value", np.full(len(flat), radius, np.float32))
    return stage.add(name, data)


def points(places: Sequence[Sequence[float]], radius: float = 0.2) -> Any:
    import bpy

    data = bpy.data.pointclouds.new("Points")
    data.resize(len(places))
    if places:
        flat = np.array(places, np.float32).ravel()
        data.attributes["position"].data.foreach_set("vector", flat)
        made = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
        made.data.foreach_set("value", np.full(len(places), radius, np.float32))
    return stage.add("Points", data)


def haired(**settings: Any) -> Any:
    """A square of one face with hair that stands on it."""
    import bpy

    ob = stage.plane()
    hair = bpy.data.particles.new("Hair")
    given = {"type": "HAIR", "count": 20, "hair_length": 0.5, "render_step": 2, "radius_scale": 0.1}
    for name, value in (given | settings).items():
        setattr(hair, name, value)
    ob.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings = hair
    return ob


def strands_of(what: Any) -> Strands:
    found = [mesh.strands for mesh in what.meshes if mesh.strands is not None]
    assert len(found) == 1
    assert found[0] is not None
    return found[0]


def huang_node(material: Any) -> Any:
    node = next(n for n in material.node_tree.nodes if n.bl_idname.endswith("HairPrincipled"))
    node.model = "HUANG"
    return node


LINE = [(0, 0, 0), (0, 0, 1), (0, 1, 1)]


@in_blender
def test_curves_are_what_they_are() -> None:
    ob = curves([LINE, LINE[:2]])
    ob.location = (1, 2, 3)
    data = ob.data
    along = data.attributes.new("map", "FLOAT2", "CURVE")
    along.data.foreach_set("vector", [0.1, 0.2, 0.3, 0.4])
    what = stage.exported()
    strands = strands_of(what)
    assert strands.first is not None
    assert strands.first.tolist() == [0, 3, 5]
    assert strands.keys[:, :3].tolist() == [list(key) for key in [*LINE, *LINE[:2]]]
    assert strands.keys[:, 3] == pytest.approx(0.1)
    assert strands.uv == pytest.approx(np.array([[0.1, 0.2], [0.3, 0.4]]))
    assert strands.shape == StrandShape.RIBBON
    assert strands.subdivisions == 4
    assert what.instances.matrix[0][:3, 3].tolist() == [1, 2, 3]
    assert what.warnings == []


@in_blender
@pytest.mark.parametrize(
    ("setting", "shape"), [("THICK", StrandShape.THICK), ("RIBBONS", StrandShape.RIBBON)]
)
def test_the_scene_says_how_curves_look(setting: str, shape: StrandShape) -> None:
    curves([LINE])
    stage.scene().cycles_curves.shape = setting
    stage.scene().cycles_curves.subdivisions = 3
    strands = strands_of(stage.exported())
    assert strands.shape == shape
    assert strands.subdivisions == 8


@in_blender
def test_points_are_balls() -> None:
    points([(0, 0, 0), (1, 2, 3)])
    strands = strands_of(stage.exported())
    assert strands.first is None
    assert strands.shape == StrandShape.POINT
    assert strands.keys == pytest.approx(np.array([(0, 0, 0, 0.2), (1, 2, 3, 0.2)]))


@in_blender
def test_data_is_exported_once() -> None:
    ob = curves([LINE])
    stage.add("Other", ob.data, (3, 0, 0))
    what = stage.exported()
    assert len([mesh for mesh in what.meshes if mesh.strands]) == 1
    assert len(what.instances.mesh) == 2


@in_blender
def test_empty_strands_are_nothing() -> None:
    curves([])
    points([])
    haired(count=0)
    what = stage.exported()
    assert all(mesh.strands is None for mesh in what.meshes)
    assert what.warnings == []


@in_blender
def test_strands_that_cannot_be_are_left_out() -> None:
    ob = curves([LINE, [(5, 5, 5)], LINE, LINE])
    positions = np.empty(3 * 10, np.float32)
    ob.data.position_data.foreach_get("vector", positions)
    positions[3 * 4] = np.nan
    ob.data.position_data.foreach_set("vector", positions)
    radius = ob.data.attributes["radius"].data
    radius[7].value, radius[8].value = -1.0, 0.0
    tint = ob.data.attributes.new("tint", "FLOAT", "CURVE")
    tint.data.foreach_set("value", [1, 2, 3, 4])
    made, tree = stage.empty_material("Tint")
    shader, asked = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeAttribute")
    asked.attribute_name = "tint"
    tree.links.new(asked.outputs[0], shader.inputs[0])
    stage.surface(tree, shader)
    ob.data.materials.append(made)
    cloud = points([(0, 0, 0), (0, np.inf, 0)])
    what = stage.exported()
    found = {mesh.name: mesh for mesh in what.meshes}
    left = found[ob.data.name]
    assert left.strands is not None
    assert left.strands.first is not None
    assert left.strands.first.tolist() == [0, 3, 6]
    assert left.strands.keys[3:, 3].tolist() == pytest.approx([0.0, 0.0, 0.1])
    (attribute,) = left.shading.attributes
    assert attribute.domain == Domain.FACE
    assert attribute.values.ravel().tolist() == [1, 4]
    assert len(found[cloud.data.name].strands.keys) == 1  # type: ignore[union-attr]
    said = "\n".join(what.warnings)
    assert "curves left out: 1" in said
    assert "points left out: 1" in said


@in_blender
def test_hair_of_particles() -> None:
    ob = haired(root_radius=2.0, tip_radius=1.0, use_close_tip=False)
    ob.location = (0, 0, 5)
    what = stage.exported()
    strands = strands_of(what)
    keys = strands.keys.reshape(20, 5, 4)
    assert np.abs(keys[:, 0, 2]).max() < 1e-4  # in the object's own coordinates
    assert np.abs(keys[:, -1, 2] - 0.5).max() < 0.05
    along = keys[:, :, 2] / keys[:, -1:, 2]
    assert keys[:, :, 3] == pytest.approx(0.5 * 0.1 * (2.0 - along), rel=1e-3)
    assert len(what.instances.mesh) == 2
    assert what.instances.matrix[:, 2, 3].tolist() == [5, 5]


@in_blender
def test_settings_of_hair() -> None:
    ob = haired(
        use_close_tip=True, material=2, tip_radius=1.0, child_type="SIMPLE", rendered_child_count=3
    )
    ob.data.materials.append(stage.material("Second"))
    ob.show_instancer_for_render = False
    what = stage.exported()
    strands = strands_of(what)
    assert strands.count == 60
    assert len(what.instances.mesh) == 1
    keys = strands.keys.reshape(60, 5, 4)
    assert not keys[:, -1, 3].any()
    assert keys[:, 0, 3].min() > 0
    assert strands.slots is not None
    assert set(strands.slots.tolist()) == {1}


@in_blender
def test_hair_that_is_not_shown() -> None:
    ob = haired()
    ob.modifiers["Hair"].show_render = False
    assert all(mesh.strands is None for mesh in stage.exported().meshes)
    ob.modifiers["Hair"].show_render = True
    assert strands_of(stage.exported()).count == 20
    stage.scene().view_layers[0].use_strand = False
    assert all(mesh.strands is None for mesh in stage.exported().meshes)


@in_blender
def test_hair_moves_with_what_it_grows_on() -> None:
    ob = haired()
    for frame, x in ((0, 0.0), (2, 1.0)):
        ob.location.x = x
        ob.keyframe_insert("location", frame=frame)
    stage.scene().render.use_motion_blur = True
    stage.scene().frame_set(1)
    what = stage.exported()
    assert sorted(what.instances.motion) == [0, 1]
    first, second = what.instances.motion.values()
    assert np.array_equal(first, second)


@in_blender
def test_points_with_velocities_are_blurred() -> None:
    ob = points([(0, 0, 0), (1, 0, 0)])
    velocity = ob.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    velocity.data.foreach_set("vector", [24, 0, 0, 0, 0, 0])
    made = stage.scene()
    made.render.use_motion_blur, made.render.motion_blur_shutter = True, 0.5
    made.render.fps = 24
    strands = strands_of(stage.exported())
    assert strands.motion is not None
    assert strands.motion[:, 0, 0] == pytest.approx([-0.25, 0, 0.25])
    assert strands.motion[:, 1, :3].tolist() == [[1, 0, 0]] * 3
    assert strands.motion[:, :, 3] == pytest.approx(0.2)


@in_blender
@pytest.mark.parametrize("ratio", [1.0, 0.5])
def test_elliptical_hair_has_the_axes_of_curves(ratio: float) -> None:
    ob = curves([LINE, [(1, 0, 0)], LINE[:2]])  # the second is no curve
    coat = stage.material("Coat", (0.6, 0.4, 0.2), "ShaderNodeBsdfHairPrincipled")
    huang_node(coat).inputs["Aspect Ratio"].default_value = ratio
    ob.data.materials.append(coat)
    what = stage.exported()
    mesh = next(mesh for mesh in what.meshes if mesh.strands is not None)
    if ratio == 1.0:
        assert not mesh.shading.attributes
        return
    normals = np.array([tuple(one.vector) for one in ob.data.normals], np.float32)
    (found,) = mesh.shading.attributes
    assert found.domain == Domain.POINT
    assert found.values == pytest.approx(normals[[0, 1, 2, 4, 5]])


@in_blender
@pytest.mark.parametrize(
    "material", ["ShaderNodeBsdfHairPrincipled", "huang", "ShaderNodeBsdfHair", "glass"]
)
def test_strands_of_all_kinds_are_rendered(material: str) -> None:
    """While they move, denoised, with some that hardly are."""
    import bpy

    made = stage.room()
    kinds = {"glass": "ShaderNodeBsdfGlass", "huang": "ShaderNodeBsdfHairPrincipled"}
    coat = stage.material("Coat", (0.6, 0.4, 0.2), kinds.get(material, material))
    if material == "huang":
        huang_node(coat)
    ob = haired(material=2, count=200)
    ob.location.z = 0.3
    lines = curves([LINE, [(1, 0, 0)] * 3, [(1, 1, 0), (1, 1, 1e-30)]], radius=0.05)
    nothing = curves([LINE], radius=0.0, name="Thin")
    balls = points([(0.5, 0, 1), (0.5, 0, 1), (-0.5, 0, 1)], radius=0.3)
    for one in (ob, lines, nothing, balls):
        one.data.materials.append(coat)
        for frame, x in ((0, 0.0), (2, 0.5)):
            one.location.x = x
            one.keyframe_insert("location", frame=frame)
    made.render.use_motion_blur, made.photon_splat.denoise = True, True
    made.frame_set(1)
    with stage.watched() as results:
        bpy.ops.render.render()
    combined = results[0].passes["Combined"]
    assert np.isfinite(combined).all()
    assert combined[..., :3].max() > 0.0
    warnings = results[0].statistics["warnings"]
    assert [text for text in warnings if not text.startswith("Hair shaders on ")] == []


@in_blender
def test_hair_shaders_on_other_things_are_named() -> None:
    """Not those of hair that grows on a mesh, whose slots hold them as well."""
    stage.room()
    cloud, ball = points([(0, 0, 0)]), stage.plane("Ball")
    for ob, name in ((cloud, "Dots"), (ball, "Fur")):
        made, tree = stage.empty_material(name)
        shader = tree.nodes.new("ShaderNodeBsdfHairPrincipled")
        tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        ob.data.materials.clear()
        ob.data.materials.append(made)
    warnings = stage.exported().warnings
    assert "Hair shaders on points are black: 'Dots'" in warnings
    [of_meshes] = [warning for warning in warnings if "Hair shaders on meshes" in warning]
    assert of_meshes.endswith(": 'Fur'")
    ball.data.materials[0] = stage.material("Skin")
    ball.data.materials.append(made)
    assert not [warning for warning in stage.exported().warnings if "on meshes" in warning]
