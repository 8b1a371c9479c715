"""A room whose walls a lamp without shadow shines through."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.export import export_scene

from tests.support import stage
from tests.support.corescene import shoot


def test_light_behind_walls_is_that_of_light_samples_photons_too() -> None:
    """Rays that find a lamp end at walls, and what they would have brought is not there; photons
    brought it, and this room was 25 % too bright by indirect light.
    """
    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24, 24)
    bpy.ops.mesh.primitive_cube_add(size=1.1)
    bpy.context.object.scale = (1.0, 2.0, 1.0)
    made, tree = stage.empty_material("Wall")
    stage.surface(tree, tree.nodes.new("ShaderNodeBsdfPrincipled"))
    bpy.context.object.data.materials.append(made)
    lamp = stage.lamp("AREA", 40.0, (0, -1.6, 0))
    lamp.rotation_euler, lamp.data.size, lamp.data.use_shadow = (1.5708, 0, 0), 5.0, False
    camera = stage.camera((0, -1.0, 0))
    camera.rotation_euler = (1.5708, 0, 0)
    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    light, expected = (
        np.mean(shoot(what, seed=k, passes=passes, integrator=by).passes["Combined"][..., :3])
        for k, (by, passes) in enumerate(((Integrator.SPLAT, 16), (Integrator.REFERENCE, 400)))
    )
    assert light == pytest.approx(expected, rel=0.05)
