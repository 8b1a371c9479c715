"""Caustics through smooth glass with bumps: as bright as in Cycles."""

from __future__ import annotations

from typing import Any

import pytest

from tests.support import stage
from tests.support.corescene import shoot


def _under_water(displacement: float, tilt: float) -> None:
    """A floor below a sheet of smooth glass, lit by a wide sun and the world. displacement: of
    bumps, m. tilt: what is added to the normal, whichever side is seen.
    """
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(16, 16)
    water, tree = stage.empty_material("Water")
    water.displacement_method = "BUMP"
    glass = tree.nodes.new("ShaderNodeBsdfGlass")
    glass.inputs["Color"].default_value = (0.9, 0.95, 1.0, 1.0)
    glass.inputs["Roughness"].default_value = 0.0
    glass.inputs["IOR"].default_value = 1.33
    stage.surface(tree, glass)
    if displacement:
        noise = tree.nodes.new("ShaderNodeTexNoise")
        bump = tree.nodes.new("ShaderNodeDisplacement")
        noise.inputs["Scale"].default_value = 3.0
        bump.inputs["Scale"].default_value = displacement
        tree.links.new(noise.outputs[0], bump.inputs["Height"])
        tree.links.new(bump.outputs[0], tree.nodes["Material Output"].inputs["Displacement"])
    if tilt:
        seen = tree.nodes.new("ShaderNodeNewGeometry")
        sum_ = tree.nodes.new("ShaderNodeVectorMath")
        sum_.inputs[1].default_value = (tilt, 0.0, 0.0)
        tree.links.new(seen.outputs["Normal"], sum_.inputs[0])
        tree.links.new(sum_.outputs[0], glass.inputs["Normal"])
    stage.plane("Floor", 4.0)
    stage.plane("Surface", 4.0, location=(0.0, 0.0, 2.0)).data.materials[0] = water
    stage.lamp("SUN", 3.0).data.angle = 1.0
    stage.world(0.3)
    camera: Any = stage.camera((0.0, 0.0, 1.8))
    camera.data.angle = 1.2
    bpy.context.view_layer.update()


@pytest.mark.parametrize(("displacement", "tilt"), [(0.2, 0.0), (0.0, 0.2)])
def test_bumped_glass_lets_as_much_light_through_as_in_cycles(
    displacement: float, tilt: float
) -> None:
    """Once all of it was lost wherever the two sides' normals differ by half a degree."""
    import bpy
    from photon_splat.export import export_scene

    from tests.reference.cycles.references import render_with_cycles

    _under_water(displacement, tilt)
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    ours = shoot(what, passes=32, photons_per_pass=40_000, seed=1).passes["Combined"][..., :3]
    cycles = render_with_cycles(1024, 21)[..., :3]
    assert ours.mean() == pytest.approx(cycles.mean(), rel=0.02)
