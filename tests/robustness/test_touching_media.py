"""Fog whose faces lie exactly in other faces: as if they were a little apart."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.export import export_scene

from tests.support import stage
from tests.support.corescene import BOTH, shoot

Blocks = np.ndarray


def _fog(density: float) -> object:
    made, tree = stage.empty_material("Fog")
    medium = tree.nodes.new("ShaderNodeVolumeScatter")
    medium.inputs["Density"].default_value = density
    stage.output(tree, medium, "Volume")
    return made


def _cube(low: stage.Point, high: stage.Point, material: object) -> None:
    corners = [
        (x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])
    ]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    made = stage.add("Cube", stage.mesh("Cube", corners, faces))
    made.data.materials.append(material)


def _on_a_floor(gap: float) -> None:
    stage.plane("Floor", 8)
    _cube((-4, -4, gap), (4, 4, 2.5), _fog(0.15))
    _cube((-0.4, -0.4, 0.0), (0.4, 0.4, 0.8), stage.material("Block", (0.2, 0.6, 0.2)))


def _up_to_walls(gap: float) -> None:
    grey = stage.material("Wall", (0.7, 0.6, 0.5))
    _cube((-3, -4, -0.2), (3, 4, 0), grey)
    _cube((-3, 2, 0), (3, 2.2, 3), grey)
    for x in (-3, 2.8):
        _cube((x, -4, 0), (x + 0.2, 2, 3), grey)
    _cube((-2.8 + gap, -4, gap), (2.8 - gap, 2 - gap, 3), _fog(0.15))


def _side_by_side(gap: float) -> None:
    stage.plane("Floor", 8)
    _cube((-2, -1, 0.1), (-gap, 1, 1.5), _fog(0.3))
    _cube((0, -1, 0.1), (2, 1, 1.5), _fog(2.0))
    _cube((-2, -1, 1.5 + gap), (2, 1, 2.2), _fog(0.8))


def _behind_panes(gap: float) -> None:
    """A sheet that lets a part through, and one of rough glass."""
    stage.plane("Floor", 8)
    _cube((-2, -1 + gap, 0.1), (2, 2, 2), _fog(0.6))
    sheet, tree = stage.empty_material("Sheet")
    clear, grey, mixed = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("BsdfTransparent", "BsdfDiffuse", "MixShader")
    )
    tree.links.new(clear.outputs[0], mixed.inputs[1])
    tree.links.new(grey.outputs[0], mixed.inputs[2])
    stage.surface(tree, mixed)
    glass, tree = stage.empty_material("Glass")
    rough = tree.nodes.new("ShaderNodeBsdfRefraction")
    rough.inputs["Roughness"].default_value = 0.3
    rough.inputs["IOR"].default_value = 1.1
    stage.surface(tree, rough)
    for x, material in ((-1.8, sheet), (0.2, glass)):
        corners = [(x, -1, 0.3), (x + 1.6, -1, 0.3), (x + 1.6, -1, 1.7), (x, -1, 1.7)]
        stage.add("Pane", stage.mesh("Pane", corners, [(0, 1, 2, 3)])).data.materials.append(
            material
        )


def _seen(
    build: Callable[[float], None], gap: float, integrator: Integrator
) -> tuple[Blocks, Blocks]:
    """Light and depth in 4 x 4 parts of the picture."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(32, 32)
    view = stage.camera((0.5, -3.5, 1.4))
    view.rotation_euler = (math.radians(80), 0, 0.1)
    view.data.angle = 1.2
    lamp = stage.lamp("AREA", 150, (1, -1, 2.4))
    lamp.data.size = 3
    stage.world(0.3)
    build(gap)
    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    passes = shoot(what, integrator, passes=128, photons_per_pass=4000, seed=1).passes
    return tuple(
        passes[name].reshape(4, 8, 4, 8, -1)[..., :3].mean((1, 3, 4))
        for name in ("Combined", "Depth")
    )


@pytest.mark.parametrize("integrator", BOTH)
@pytest.mark.parametrize("build", [_on_a_floor, _up_to_walls, _side_by_side, _behind_panes])
def test_fog_that_touches_is_as_fog_a_little_apart(
    build: Callable[[float], None], integrator: Integrator
) -> None:
    touching, depth = _seen(build, 0.0, integrator)
    apart, depth_apart = _seen(build, 0.002, integrator)
    assert touching.mean() == pytest.approx(apart.mean(), rel=0.005)
    assert touching == pytest.approx(apart, rel=0.03)
    assert depth == pytest.approx(depth_apart, rel=0.01)
