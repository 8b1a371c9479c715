"""Materials mixed by where they are seen from: photons know who looks back along their way."""

from __future__ import annotations

from typing import Any

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.reference.agreement.room import lit_room, walls
from tests.support import stage


def _mixed(first: tuple[str, float], second: tuple[str, float], node: str, output: str) -> Any:
    """Two closures of a roughness each, mixed by that output of Fresnel or Layer Weight."""
    made, tree = stage.empty_material("Mixed")
    weight, mix = tree.nodes.new(f"ShaderNode{node}"), tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(weight.outputs[output], mix.inputs[0])
    for socket, (kind, roughness) in enumerate((first, second), start=1):
        shader = tree.nodes.new(f"ShaderNodeBsdf{kind}")
        shader.inputs["Roughness"].default_value = roughness
        if kind == "Refraction":
            shader.inputs["IOR"].default_value = weight.inputs["IOR"].default_value = 1.33
        tree.links.new(shader.outputs[0], mix.inputs[socket])
    stage.surface(tree, mix)
    return made


def _grey(albedo: float) -> Any:
    made, tree = stage.empty_material("Grey")
    shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (albedo, albedo, albedo, 1.0)
    stage.surface(tree, shader)
    return made


def _open(width: int) -> None:
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(width, width)


@pytest.mark.parametrize(("node", "output"), [("Fresnel", "Fac"), ("LayerWeight", "Facing")])
def test_a_room_of_plastic_is_as_bright_as_in_cycles(node: str, output: str) -> None:
    _open(64)
    lit_room(_mixed(("Diffuse", 0.0), ("Anisotropic", 0.3), node, output))
    ours, cycles = means_beside_cycles(192, passes=24, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.006)


def test_a_pool_under_water_mixed_by_fresnel_is_as_bright_as_in_cycles() -> None:
    """Light comes in from the walls above, flatter than the critical angle, too."""
    import bpy

    _open(64)
    walls(_grey(0.7), ceiling=False)
    bpy.ops.mesh.primitive_plane_add(size=3.998, location=(0, 0, 1.2))
    bpy.context.object.data.materials.append(
        _mixed(("Refraction", 0.0), ("Anisotropic", 0.0), "Fresnel", "Fac")
    )
    stage.lamp("AREA", 200, (0.3, 0.2, 4.0)).data.size = 3
    stage.camera((0, 0, 6.0)).data.angle = 0.8
    ours, cycles = means_beside_cycles(192, passes=24, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.012)
