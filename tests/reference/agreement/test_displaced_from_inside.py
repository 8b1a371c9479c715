"""Wrinkled balls from inside: bumps that lean the way their surface does."""

from __future__ import annotations

from typing import Any

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.support import stage


def _ball(segments: int) -> Any:
    """Smooth, alone in a new scene."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(48, 36)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2, radius=2.0)
    bpy.ops.object.shade_smooth()
    return bpy.context.object


def _look_around() -> None:
    """A lamp and the camera in the ball."""
    import bpy

    bpy.ops.object.light_add(type="POINT", location=(0.5, 0.3, 0.6))
    bpy.context.object.data.energy = 100.0
    stage.camera((0, 0, 1.2)).data.angle = 1.4


def test_a_displaced_and_bumped_ball_is_lit_inside_as_in_cycles() -> None:
    """With bumps the wrong way it is a sixth darker."""
    ball = _ball(96)
    made, tree = stage.empty_material("Wrinkled")
    made.displacement_method = "BOTH"
    cloth, noise, displacement, place = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("BsdfDiffuse", "TexNoise", "Displacement", "TexCoord")
    )
    noise.inputs["Scale"].default_value = 2.0
    displacement.inputs["Scale"].default_value = 0.3
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], displacement.inputs["Height"])
    tree.links.new(displacement.outputs[0], tree.nodes["Material Output"].inputs["Displacement"])
    stage.surface(tree, cloth)
    ball.data.materials.append(made)
    _look_around()
    ours, cycles = means_beside_cycles(128, passes=24, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.01)


def test_a_wrinkled_ball_of_true_normals_is_lit_inside_as_in_cycles() -> None:
    """Each triangle is a bump on its smooth normals. Taken for bumps that lean to any side, they
    are 5 % too bright.
    """
    import bpy

    ball = _ball(160)
    clouds = bpy.data.textures.new("Clouds", "CLOUDS")
    clouds.noise_scale = 0.5
    wrinkles = ball.modifiers.new("Wrinkles", "DISPLACE")
    wrinkles.texture, wrinkles.strength = clouds, 0.5
    made, tree = stage.empty_material("Flat")
    cloth, place = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "NewGeometry"))
    tree.links.new(place.outputs["True Normal"], cloth.inputs["Normal"])
    stage.surface(tree, cloth)
    ball.data.materials.append(made)
    _look_around()
    ours, cycles = means_beside_cycles(128, passes=16, photons_per_pass=50_000)
    assert ours == pytest.approx(cycles, rel=0.01)
