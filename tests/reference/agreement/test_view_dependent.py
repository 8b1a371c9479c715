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


def _faded(kind: str, ends: tuple[tuple[float, ...], tuple[float, ...]], reach: float) -> Any:
    """A closure of a colour that goes from the first to the second with the Ray Length, m."""
    made, tree = stage.empty_material("Faded")
    shader = tree.nodes.new(f"ShaderNodeBsdf{kind}")
    length, mix = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    scaled = tree.nodes.new("ShaderNodeMapRange")
    scaled.inputs["From Max"].default_value = reach
    tree.links.new(length.outputs["Ray Length"], scaled.inputs["Value"])
    tree.links.new(scaled.outputs["Result"], mix.inputs["Factor"])
    for name, colour in zip("AB", ends, strict=True):
        socket = next(i for i in mix.inputs if i.identifier == f"{name}_Color")
        socket.default_value = (*colour, 1.0)
    mixed = next(o for o in mix.outputs if o.identifier == "Result_Color")
    tree.links.new(mixed, shader.inputs["Color"])
    if "Roughness" in shader.inputs:
        shader.inputs["Roughness"].default_value = 0.0
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


@pytest.mark.parametrize("kind", ["Diffuse", "Anisotropic"])
def test_a_room_whose_colour_fades_with_distance_is_as_bright_as_in_cycles(kind: str) -> None:
    """By Ray Length, which a photon knows when it arrives: the diffuse room was .8 % too dark."""
    import bpy

    _open(64)
    lit_room(
        _faded("Diffuse", ((0.8, 0.8, 0.8), (0.8, 0.1, 0.1)), 3.0)
        if kind == "Diffuse"
        else _grey(0.6)
    )
    if kind == "Anisotropic":  # a mirror that lights the floor
        bpy.ops.mesh.primitive_plane_add(size=2.0, location=(0, 1.5, 1.5), rotation=(1.0, 0, 0))
        mirror = _faded("Anisotropic", ((0.9, 0.9, 0.9), (0.1, 0.2, 0.9)), 2.0)
        bpy.context.object.data.materials.append(mirror)
    ours, cycles = means_beside_cycles(192, passes=24, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.006)


def test_light_through_glass_that_absorbs_by_ray_length_is_as_bright_as_in_cycles() -> None:
    """By what a ray has gone through the glass, to where photons go on: it was 9 % too dark."""
    import bpy

    _open(64)
    bpy.ops.mesh.primitive_plane_add(size=4.0)
    bpy.context.object.data.materials.append(_grey(0.7))
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0, 0, 0.6))
    bpy.context.object.scale = (2.4, 2.4, 0.5)
    bpy.context.object.data.materials.append(
        _faded("Glass", ((1.0, 1.0, 1.0), (0.1, 0.6, 0.2)), 1.5)
    )
    stage.lamp("AREA", 200, (0.3, 0.2, 3.5)).data.size = 3
    stage.camera((0, 0, 6.0)).data.angle = 0.8
    ours, cycles = means_beside_cycles(384, passes=24, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.01)
