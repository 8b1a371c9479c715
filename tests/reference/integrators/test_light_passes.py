"""Light of caustics by the lobe that sends it to the camera: photons bring what diffuse lobes send,
paths what gloss does.
"""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.export import export_scene

from tests.support import stage
from tests.support.corescene import shoot


def test_gloss_of_caustics_is_glossy_light() -> None:
    """Of a floor of roughness 0.3 under a ball of glass the glossy pass had .72 of its light, and
    the diffuse one 1.16; the picture was right.
    """
    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(32, 18)
    floor = stage.plane("Floor", 12.0)
    made, tree = stage.empty_material("Floor")
    gloss = tree.nodes.new("ShaderNodeBsdfPrincipled")
    gloss.inputs["Roughness"].default_value = 0.3
    stage.surface(tree, gloss)
    floor.data.materials[0] = made
    clear, tree = stage.empty_material("Glass")
    stage.surface(tree, tree.nodes.new("ShaderNodeBsdfGlass"))
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=64, ring_count=32, radius=0.6, location=(0, 0, 0.9)
    )
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(clear)
    lamp = stage.lamp("AREA", 250.0, (0, 3, 3))
    lamp.data.size = 2.0
    lamp.rotation_euler = (-0.876, 0, 0)
    camera = stage.camera((0, -6, 3))
    camera.rotation_euler = (1.144, 0, 0)
    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    splat = shoot(what, seed=1, passes=150, photons_per_pass=50_000).passes
    paths = shoot(what, seed=2, passes=1500, integrator=Integrator.REFERENCE).passes
    for lobes in ("Diffuse", "Glossy", "Transmission"):
        light, expected = (
            np.mean(passes[f"{lobes} Indirect"][..., :3] * passes[f"{lobes} Color"][..., :3])
            for passes in (splat, paths)
        )
        assert light == pytest.approx(expected, rel=0.03), lobes
