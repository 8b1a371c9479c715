"""Rooms whose walls all scatter below their surface: photons go below them many times."""

from __future__ import annotations

import math

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.support import stage
from tests.support.corescene import BOTH, Integrator


@pytest.mark.parametrize("integrator", BOTH)
def test_a_room_of_bright_wax_is_as_bright_as_in_cycles(integrator: Integrator) -> None:
    """Where photons do not split, few of them have the light of the last bounces: it is a fifth
    darker.
    """
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(32, 24)
    made, tree = stage.empty_material("Wax")
    wax = tree.nodes.new("ShaderNodeBsdfPrincipled")
    wax.inputs["Base Color"].default_value = (0.9, 0.9, 0.9, 1)
    wax.inputs["Subsurface Weight"].default_value = 1.0
    wax.inputs["Subsurface Radius"].default_value = (0.1, 0.1, 0.1)
    wax.inputs["Subsurface Scale"].default_value = 0.2
    wax.subsurface_method = "RANDOM_WALK"
    stage.surface(tree, wax)
    up = math.pi / 2
    for place, turn in (
        ((0, 0, -1), (0, 0, 0)),
        ((0, 0, 1), (math.pi, 0, 0)),
        ((0, 1, 0), (up, 0, 0)),
        ((0, -1, 0), (-up, 0, 0)),
        ((1, 0, 0), (0, -up, 0)),
        ((-1, 0, 0), (0, up, 0)),
    ):
        bpy.ops.mesh.primitive_plane_add(size=2, location=place, rotation=turn)
        bpy.context.object.data.materials.append(made)
    lamp = stage.lamp("AREA", 10, (0, 0, 0.9))
    lamp.data.size = 0.5
    seen_from = stage.camera((0, -0.9, 0))
    seen_from.rotation_euler = (up, 0, 0)
    seen_from.data.angle = 1.5
    ours, cycles = means_beside_cycles(256, integrator, passes=48, photons_per_pass=10_000)
    assert ours == pytest.approx(cycles, rel=0.02)
