"""Light that gloss with steep bumps throws onto what is beside it."""

from __future__ import annotations

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.support import stage


@pytest.mark.parametrize("roughness", [0.05, 0.2])
def test_a_floor_is_lit_by_bumped_metal_as_in_cycles(roughness: float) -> None:
    """About a ball that the camera does not see; the sky is the same everywhere."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24, 24)
    stage.world(0.5)
    stage.plane("Floor", 4.0)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, location=(0, 0, 1))
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    ball.visible_camera = False
    made, tree = stage.empty_material("Hammered")
    metal, noise, bump, place = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("BsdfMetallic", "TexNoise", "Bump", "TexCoord")
    )
    metal.inputs["Roughness"].default_value = roughness
    noise.inputs["Scale"].default_value = 6.0
    bump.inputs["Distance"].default_value = 0.5
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], metal.inputs["Normal"])
    stage.surface(tree, metal)
    ball.data.materials.append(made)
    view = stage.camera((0, 0, 5))
    view.data.angle = 0.6
    ours, cycles = means_beside_cycles(512, passes=96, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.01)
