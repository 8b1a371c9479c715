"""Rooms of bumps: what photons bring is as bright as what paths do."""

from __future__ import annotations

import math

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.support import stage
from tests.support.corescene import BOTH, Integrator


def _tiles(specular: float) -> object:
    """Steep bumps, finer than a pixel is wide where the camera sees them."""
    made, tree = stage.empty_material("Tiles")
    place, noise, bump, shader = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("TexCoord", "TexNoise", "Bump", "BsdfPrincipled")
    )
    noise.inputs["Scale"].default_value = 8.0
    bump.inputs["Distance"].default_value = 0.3
    shader.inputs["Base Color"].default_value = (0.8, 0.75, 0.7, 1)
    shader.inputs["Specular IOR Level"].default_value = specular
    shader.inputs["Roughness"].default_value = 0.4
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], shader.inputs["Normal"])
    stage.surface(tree, shader)
    return made


def _room(orthographic: bool, material: object) -> None:
    """4 x 4 x 3 m, lit from the ceiling."""
    import bpy

    up, side = math.pi / 2, (0.0, math.pi / 2, 0.0)
    walls = [((0, 0, 0), (0, 0, 0), (4, 4, 1)), ((0, 0, 3), (math.pi, 0, 0), (4, 4, 1))]
    walls += [((0, y, 1.5), (up, 0, 0), (4, 3, 1)) for y in (-2, 2)]
    walls += [((x, 0, 1.5), side, (3, 4, 1)) for x in (-2, 2)]
    for place, turn, size in walls:
        bpy.ops.mesh.primitive_plane_add(size=1, location=place, rotation=turn)
        wall = bpy.context.object
        wall.scale = size
        wall.data.materials.append(material)
    lamp = stage.lamp("AREA", 80, (0.3, 0.2, 2.9))
    lamp.data.size = 1
    seen_from = stage.camera((0, -1.9, 1.5))
    seen_from.rotation_euler = (up, 0, 0)
    seen_from.data.angle = 1.6
    if orthographic:
        seen_from.data.type, seen_from.data.ortho_scale = "ORTHO", 2.8


@pytest.mark.parametrize("integrator", BOTH)
@pytest.mark.parametrize(("orthographic", "specular"), [(True, 0.0), (False, 0.0), (False, 0.5)])
def test_a_room_of_bumps_is_as_bright_as_in_cycles(
    orthographic: bool, specular: float, integrator: Integrator
) -> None:
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(72, 72)
    _room(orthographic, _tiles(specular))
    ours, cycles = means_beside_cycles(128, integrator, passes=16, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.01)
