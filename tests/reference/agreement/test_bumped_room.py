"""Rooms of bumps: what photons bring is as bright as what paths do."""

from __future__ import annotations

import numpy as np
import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.reference.agreement.room import lit_room
from tests.support import stage
from tests.support.corescene import BOTH, Integrator

BUMPED_NOISE = 1.5
"""Most of it, over that of even walls."""


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


@pytest.mark.parametrize("integrator", BOTH)
@pytest.mark.parametrize(("orthographic", "specular"), [(True, 0.0), (False, 0.0), (False, 0.5)])
def test_a_room_of_bumps_is_as_bright_as_in_cycles(
    orthographic: bool, specular: float, integrator: Integrator
) -> None:
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(72, 72)
    seen_from = lit_room(_tiles(specular))
    if orthographic:
        seen_from.data.type, seen_from.data.ortho_scale = "ORTHO", 2.8
    ours, cycles = means_beside_cycles(128, integrator, passes=16, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.01)


def test_bumps_add_little_noise_to_what_photons_bring() -> None:
    """1.25 times; with what bumps see otherwise than the wall left to camera paths, 1.76."""
    import bpy
    from photon_splat.export import export_scene

    from tests.support.corescene import shoot

    def noise(steep: float) -> float:
        bpy.ops.wm.read_homefile(use_empty=True)
        stage.scene()
        stage.resize(48, 48)
        tiles = _tiles(0.0)
        bump = tiles.node_tree.nodes["Bump"]
        bump.inputs["Strength"].default_value = steep
        lit_room(tiles)
        bpy.context.view_layer.update()
        what = export_scene(bpy.context.evaluated_depsgraph_get())
        first, second = (
            shoot(what, seed=seed, passes=4, photons_per_pass=50_000).passes["Combined"][..., :3]
            for seed in (1, 2)
        )
        return float(np.median(np.abs(first - second) / (first + second)))

    assert noise(0.5) < BUMPED_NOISE * noise(0.0)
