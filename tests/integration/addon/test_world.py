"""Worlds from Blender: what of them is exported, and what is named instead."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import numpy as np
import pytest
from photon_splat.core.scene.shading import Feature

from tests.support import stage
from tests.support.blender import in_blender


def _tree() -> tuple[Any, Any]:
    """The node tree of a new world and its Background node."""
    import bpy

    world = bpy.data.worlds.new("Sky")
    stage.scene().world = world
    world.use_nodes = True
    return world.node_tree, next(
        node for node in world.node_tree.nodes if node.type == "BACKGROUND"
    )


def _image(tree: Any, background: Any) -> Any:
    import bpy

    stage.camera()
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = bpy.data.images.new("Map", 8, 4, float_buffer=True)
    tree.links.new(node.outputs["Color"], background.inputs["Color"])
    return node


def _mapped(tree: Any, node: Any, output: str = "Generated") -> Any:
    mapping, coordinates = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs[output], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    return mapping


@in_blender
def test_an_environment_image_and_its_rotation() -> None:
    tree, background = _tree()
    node = _image(tree, background)
    background.inputs["Strength"].default_value = 2.0
    what = stage.exported()
    assert what.world == (2.0, 2.0, 2.0)
    assert np.allclose(what.world_map.to_lookup, np.eye(4)[:3])
    assert not what.world_map.mirror_ball
    assert what.textures[what.world_map.texture].pixels.shape == (4, 8, 4)
    node.projection = "MIRROR_BALL"
    _mapped(tree, node).inputs["Rotation"].default_value = (0.0, 0.0, 0.5)
    what = stage.exported()
    assert what.world_map.mirror_ball
    assert np.allclose(
        what.world_map.to_lookup[:2, :2], [[cos(0.5), -sin(0.5)], [sin(0.5), cos(0.5)]]
    )
    assert what.warnings == []


@in_blender
def test_an_image_with_light_below_zero_is_named_with_its_share() -> None:
    tree, background = _tree()
    node = _image(tree, background)
    pixels = np.ones((4, 8, 4), np.float32)
    pixels[0, :, :3] = -0.1  # of a quarter
    node.image.pixels.foreach_set(pixels.ravel())
    share = "image 'Map' has light below zero, 3.3 % of that above; taken as none"
    (warning,) = stage.exported().warnings
    assert warning.startswith("World 'Sky', node ")
    assert warning.endswith(share)
    _mapped(tree, node, "Window")
    (warning,) = stage.exported().warnings
    assert warning.endswith(share)
    pixels[0, :, :3] = -0.001
    node.image.pixels.foreach_set(pixels.ravel())
    assert stage.exported().warnings == []


@in_blender
def test_any_other_tree_is_a_program() -> None:
    tree, background = _tree()
    _mapped(tree, _image(tree, background), "Window")
    what = stage.exported()
    assert what.world_map is None
    assert what.programs[what.world_program].features == Feature.EMITS
    assert what.warnings == []


@in_blender
def test_a_tree_that_comes_to_a_constant_is_one() -> None:
    tree, background = _tree()
    color = tree.nodes.new("ShaderNodeMix")
    color.data_type = "RGBA"
    for name, value in (
        ("Factor_Float", 0.5),
        ("A_Color", (0, 0, 1, 1)),
        ("B_Color", (1, 0, 0, 1)),
    ):
        next(socket for socket in color.inputs if socket.identifier == name).default_value = value
    tree.links.new(
        next(socket for socket in color.outputs if socket.identifier == "Result_Color"),
        background.inputs["Color"],
    )
    background.inputs["Strength"].default_value = 2.0
    what = stage.exported()
    assert (what.world, what.world_program) == ((1, 0, 1), -1)


@in_blender
def test_a_mixed_sky_is_looked_up_as_the_sky_alone() -> None:
    """The same sky as the world's only colour, and through a node that does nothing."""
    from photon_splat.core.native import library as native
    from photon_splat.core.native.fill import fill_renderer
    from photon_splat.core.render.settings import RenderSettings

    tree, background = _tree()
    sky, gamma = tree.nodes.new("ShaderNodeTexSky"), tree.nodes.new("ShaderNodeGamma")
    sky.sun_disc = False
    sky.sun_rotation = 0.7
    tree.links.new(sky.outputs[0], gamma.inputs["Color"])
    tree.links.new(gamma.outputs[0], background.inputs["Color"])
    what = stage.exported()
    renderer = native.load().Renderer(1)
    fill_renderer(renderer, what, RenderSettings())
    renderer.build()
    angles = np.linspace(0.1, 6.0, 40)
    directions = np.stack([np.cos(angles), np.sin(angles), np.sin(3 * angles)], axis=1).astype(
        np.float32
    )
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    found = renderer.shade_rays(np.zeros_like(directions), directions)["emission"]
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    alone = stage.exported()
    pixels = alone.textures[alone.world_map.texture].pixels
    looked_up = directions.astype(np.float64) @ alone.world_map.to_lookup[:, :3].T
    u = (np.arctan2(looked_up[:, 1], looked_up[:, 0]) - pi) / (-2 * pi)
    v = np.arcsin(np.clip(looked_up[:, 2], -1, 1)) / pi + 0.5
    row, column = (
        (v * pixels.shape[0]).astype(int),
        (u * pixels.shape[1]).astype(int) % pixels.shape[1],
    )
    expected = pixels[np.minimum(row, pixels.shape[0] - 1), column, :3]
    # The nearest pixel stands for the interpolated ones: at the horizon that is not close.
    assert np.isclose(found, expected, rtol=0.05, atol=0.02).all(axis=1).mean() >= 0.9


@pytest.mark.parametrize("output", ["Is Camera Ray", "Is Diffuse Ray", "Ray Depth"])
@in_blender
def test_light_path_of_a_world_is_that_of_the_ray(output: str) -> None:
    """Native code asks for it."""
    from photon_splat.core.native import library as native
    from photon_splat.core.native.fill import fill_renderer
    from photon_splat.core.render.settings import RenderSettings

    tree, background = _tree()
    path = tree.nodes.new("ShaderNodeLightPath")
    background.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(path.outputs[output], background.inputs["Strength"])
    what = stage.exported()
    assert not what.warnings
    renderer = native.load().Renderer(1)
    fill_renderer(renderer, what, RenderSettings())
    renderer.build()
    up = np.array([[0, 0, 1]], np.float32)
    seen = {
        kind: float(renderer.shade_rays(up * 0, up, kind=kind)["emission"][0, 0])
        for kind in ("camera", "diffuse", "glossy")
    }
    assert (
        seen
        == {
            "Is Camera Ray": {"camera": 1.0, "diffuse": 0.0, "glossy": 0.0},
            "Is Diffuse Ray": {"camera": 0.0, "diffuse": 1.0, "glossy": 0.0},
            "Ray Depth": {"camera": 1.0, "diffuse": 1.0, "glossy": 1.0},
        }[output]
    )


@pytest.mark.parametrize("model", ["SINGLE_SCATTERING", "MULTIPLE_SCATTERING"])
@in_blender
def test_a_sky_and_its_sun(model: str) -> None:
    tree, background = _tree()
    stage.camera()
    node = tree.nodes.new("ShaderNodeTexSky")
    kinds = [item.identifier for item in node.bl_rna.properties["sky_type"].enum_items]
    node.sky_type = model if model in kinds else "NISHITA"
    node.sun_elevation, node.sun_rotation, node.sun_size, node.sun_intensity = 0.5, 0.3, 0.02, 2.0
    background.inputs["Strength"].default_value = 0.5
    tree.links.new(node.outputs["Color"], background.inputs["Color"])
    what = stage.exported()
    (sun,) = what.sun_discs
    assert sun.direction == pytest.approx(
        (sin(0.3) * cos(0.5), cos(0.3) * cos(0.5), sin(0.5)), abs=1e-5
    )
    assert sun.half_angle == pytest.approx(0.01)
    # Strength and intensity cancel. In Blender's units the sun gives some hundreds outside the
    # atmosphere.
    flux = np.mean(sun.top) * pi * 0.01**2
    assert 20.0 < flux < 200.0
    assert np.all(np.asarray(sun.bottom) < sun.top)
    pixels = what.textures[what.world_map.texture].pixels
    assert np.isfinite(pixels).all()
    assert pixels[700].mean() > 0.1
    node.sun_disc = False
    assert stage.exported().sun_discs == []


@in_blender
def test_the_sky_of_hosek_and_wilkie_is_brighter_towards_the_sun_and_over_snow() -> None:
    tree, background = _tree()
    stage.camera()
    node = tree.nodes.new("ShaderNodeTexSky")
    node.sky_type = "HOSEK_WILKIE"
    node.sun_direction = (0.6, 0.0, 0.8)
    tree.links.new(node.outputs["Color"], background.inputs["Color"])
    means = []
    for albedo in (0.0, 1.0):
        node.ground_albedo = albedo
        what = stage.exported()
        assert what.warnings == []
        assert what.sun_discs == []
        pixels = what.textures[what.world_map.texture].pixels[..., :3].mean(axis=2)
        height, width = pixels.shape
        above = pixels[int(0.8 * height)]
        assert above[width // 2] > 1.5 * above[0]
        means.append(pixels.mean())
    assert means[1] > 1.05 * means[0]


@in_blender
def test_what_is_not_read_is_named() -> None:
    import bpy

    stage.room()
    bpy.data.objects["Plane"].shadow_terminator_shading_offset = 0.5
    bpy.data.objects["Plane"].data.materials[0].cycles.use_bump_map_correction = False
    tree, background = _tree()
    gradient = tree.nodes.new("ShaderNodeTexGradient")
    tree.links.new(gradient.outputs["Color"], background.inputs["Color"])
    expected = {
        "Shadow Terminator's Shading Offset is not supported; ignored: 'Plane'",
        "Bump Map Correction cannot be switched off; it is on in: 'Grey'",
    }
    kept = bpy.context.scene.world.cycles
    if hasattr(kept, "use_shadows"):
        kept.use_shadows = False
        expected.add("World 'Sky': Cast Shadow is off, but all of its light casts shadows")
    assert set(stage.exported().warnings) == expected
    if hasattr(kept, "use_shadows"):  # Cycles shadows what it does not sample
        kept.sampling_method = "NONE"
        assert not [warning for warning in stage.exported().warnings if "Cast Shadow" in warning]
        kept.sampling_method = "AUTOMATIC"
        stage.world(0.5)
        bpy.context.scene.world.cycles.use_shadows = False
        assert not [warning for warning in stage.exported().warnings if "Cast Shadow" in warning]


@in_blender
def test_a_sun_past_the_zenith_comes_down_on_the_other_side() -> None:
    from photon_splat.export.sky import _wrapped

    assert _wrapped(2.0, 0.1) == pytest.approx((pi - 2.0, 0.1 + pi))
    assert _wrapped(-2.0, 0.1) == pytest.approx((2.0 - pi, 0.1 + pi))
    assert _wrapped(2 * pi + 0.3, 0.0) == pytest.approx((0.3, 0.0))
