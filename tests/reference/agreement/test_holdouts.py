"""Holdouts and shadow catchers behind what lets light through: colour and alpha as in Cycles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from photon_splat.export import export_scene

from tests.support import stage
from tests.support.corescene import shoot


def _sheet(alpha: float) -> object:
    made, tree = stage.empty_material("Sheet")
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Alpha"].default_value = alpha
    shader.inputs["Base Color"].default_value = (0.2, 0.7, 0.3, 1)
    stage.surface(tree, shader)
    return made


def _tinted() -> object:
    return stage.material("Tinted", (0.9, 0.4, 0.2), "ShaderNodeBsdfTransparent")


def _glass() -> object:
    made = stage.material("Glass", (1, 1, 1), "ShaderNodeBsdfRefraction")
    made.node_tree.nodes["Refraction BSDF"].inputs["Roughness"].default_value = 0.0
    return made


def _hold_out(floor: object) -> None:
    floor.is_holdout = True


def _hold_out_by_node(floor: object) -> None:
    made, tree = stage.empty_material("Holdout")
    stage.surface(tree, tree.nodes.new("ShaderNodeHoldout"))
    floor.data.materials[0] = made


def _catch(floor: object) -> None:
    floor.is_shadow_catcher = True


def _agree() -> None:
    """The open scene's picture, in 4 x 4 parts and as a whole."""
    import bpy

    from tests.reference.cycles.references import render_with_cycles

    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    ours = shoot(what, passes=1024, photons_per_pass=1000, seed=1).passes["Combined"]
    cycles = render_with_cycles(1024, 21)
    means = [picture.reshape(4, 4, 4, 4, 4).mean((1, 3)) for picture in (ours, cycles)]
    assert np.abs(means[0] - means[1]).max() < 0.02
    assert ours.mean((0, 1)) == pytest.approx(cycles.mean((0, 1)), rel=0.01, abs=0.002)


def _stage(transparent: bool) -> None:
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    render = stage.scene().render
    stage.resize(16, 16)
    stage.camera()
    stage.world(0.5)
    render.film_transparent = transparent
    stage.scene().cycles.film_transparent_glass = True


@pytest.mark.parametrize("behind", [_hold_out, _hold_out_by_node, _catch])
@pytest.mark.parametrize("front", [lambda: _sheet(0.3), lambda: _sheet(0.7), _tinted, _glass])
def test_what_stands_before_a_hole_has_its_own_alpha(
    front: Callable[[], object], behind: Callable[[object], None]
) -> None:
    _stage(transparent=True)
    behind(stage.plane("Floor", 0.8))
    stage.plane("Front", 0.6, location=(0.5, 0, 1)).data.materials[0] = front()
    _agree()


@pytest.mark.parametrize("transparent", [True, False])
def test_a_holdout_that_is_partly_transparent_holds_out_the_rest(transparent: bool) -> None:
    """Over a floor, and over another one."""
    _stage(transparent)
    for place, alpha in (((0.5, 0, 1), 0.32), ((0.2, 0.3, 0.5), 0.5)):
        made = stage.plane("Front", 0.6, location=place)
        made.data.materials[0] = _sheet(alpha)
        made.is_holdout = True
    stage.plane("Floor", 0.8)
    _agree()
