"""Patterns whose cells end in the surface itself, from afar."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support import stage
from tests.support.corescene import shoot


@pytest.mark.parametrize("location", [(15.0, 15.0, 40.0), (15.0, -15.0, 70.0)])
def test_a_cell_of_a_checker_has_one_colour(location: tuple[float, float, float]) -> None:
    """Generated coordinates of a flat floor are 0.5 across it: by a scale of 2 the border between
    two cells. Once the error of where a ray ends mixed the two, the more the longer it was.
    """
    import bpy
    from photon_splat.export import export_scene

    from tests.reference.cycles.references import render_with_cycles

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(16, 16)
    material, tree = stage.empty_material("Checker")
    checker, emission = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexChecker", "Emission"))
    checker.inputs["Scale"].default_value = 2.0
    tree.links.new(checker.outputs["Color"], emission.inputs["Color"])
    stage.surface(tree, emission)
    stage.plane("Floor", 30.0).data.materials[0] = material
    stage.camera(location).data.angle = 0.2
    bpy.context.view_layer.update()
    ours = shoot(export_scene(bpy.context.evaluated_depsgraph_get()), passes=4, seed=1)
    seen, cycles = ours.passes["Combined"][..., :3], render_with_cycles(4, 21)[..., :3]
    assert (seen == seen[0, 0]).all()
    # from 70 m a few pixels of Cycles' are mixed, too
    assert seen[0, 0] == pytest.approx(np.median(cycles, axis=(0, 1)), abs=1e-5)
