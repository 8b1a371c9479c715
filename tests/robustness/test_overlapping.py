"""Solid things that run into each other: light that glass throws on them."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.export import export_scene

from tests.support import stage
from tests.support.corescene import shoot


@pytest.mark.parametrize("joined", [False, True])
def test_balls_under_a_pane_are_as_bright_as_paths_find_them(joined: bool) -> None:
    """Each stands half in the next; the parts inside get no photons. They had less than half of
    their light, and the picture .9 of its.
    """
    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(48, 36)
    stage.world(0.05)
    stage.plane("Floor", 20.0).data.materials[0] = stage.material("Floor", (0.7, 0.7, 0.7))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=10, radius=0.3)
    ball = bpy.context.object
    ball.location = (-1.5, -1.5, 0.3)
    ball.data.materials.append(stage.material("Ball", (0.8, 0.8, 0.8)))
    for i in range(1, 121):
        stage.add(f"Ball {i}", ball.data, (0.3 * (i % 11) - 1.5, 0.3 * (i // 11) - 1.5, 0.3))
    if joined:
        for thing in bpy.data.objects:
            thing.select_set(thing.name.startswith(("Ball", "Sphere")))
        bpy.context.view_layer.objects.active = ball
        bpy.ops.object.join()
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 1.2))
    bpy.context.object.scale = (6, 6, 0.1)
    made, tree = stage.empty_material("Pane")
    stage.surface(tree, tree.nodes.new("ShaderNodeBsdfGlass"))
    bpy.context.object.data.materials.append(made)
    lamp = stage.lamp("AREA", 1500.0, (1.0, 0.5, 6.0))
    lamp.data.size = 3.0
    camera = stage.camera((0, 0, 1.1))
    camera.data.angle = 2.0
    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    splat = shoot(what, seed=1, passes=16, photons_per_pass=60_000)
    paths = shoot(what, seed=2, passes=400, integrator=Integrator.REFERENCE)
    light, expected = (np.mean(one.passes["Combined"][..., :3]) for one in (splat, paths))
    assert light == pytest.approx(expected, rel=0.02)
