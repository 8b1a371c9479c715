"""Glass on a floor that is a little glossy itself: photons for caustics are aimed at the glass."""

from __future__ import annotations

import math

import pytest

from tests.support import stage
from tests.support.corescene import shoot


@pytest.mark.parametrize("floor_roughness", [1.0, 0.4])
def test_photons_of_a_caustic_arrive_whatever_the_floor_is_like(floor_roughness: float) -> None:
    """As targets on their own, the floor and the glass differ in what comes of them; aimed at both
    together, eight in a thousand arrived beside a floor of roughness 0.4.
    """
    import bpy
    from photon_splat.export import export_scene

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24, 18)
    floor = stage.plane("Floor", 6.0)
    made, tree = stage.empty_material("Floor")
    gloss = tree.nodes.new("ShaderNodeBsdfPrincipled")
    gloss.inputs["Roughness"].default_value = floor_roughness
    stage.surface(tree, gloss)
    floor.data.materials[0] = made
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=0.7, location=(0, 0, 0.9))
    bpy.ops.object.shade_smooth()
    made, tree = stage.empty_material("Glass")
    stage.surface(tree, tree.nodes.new("ShaderNodeBsdfGlass"))
    bpy.context.object.data.materials.append(made)
    sun = stage.lamp("SUN", 4.0, (3, 2, 4))
    sun.rotation_euler, sun.data.angle = (0.4, -0.5, 0.0), math.radians(10)
    stage.camera((0, 0, 8))
    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    said = shoot(what, seed=1, passes=4).statistics["photons"]["caustic"]
    assert said["stored"] > 0.05 * said["traced"]
