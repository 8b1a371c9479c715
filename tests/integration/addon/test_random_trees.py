"""Node trees that nobody would make: each is exported and rendered, and what comes out is finite.

What this has found: a circle of reroutes in a world and a hang; a colour of a group linked to a
shader, shaders linked to a Mix Shader's factor or to Displacement, a lamp's output in a material,
and an exception; coordinates of an object in the world's volume, and a crash; a volume with a
texture in a flat mesh, and a pass without end.
"""

from __future__ import annotations

import random
import time

import numpy as np
import pytest

from tests.support import random_trees, stage
from tests.support.blender import in_blender


def _render(seed: int) -> None:
    import bpy
    from photon_splat.core.render.session import render
    from photon_splat.core.render.settings import RenderSettings
    from photon_splat.export import export_scene

    chance = random.Random(seed)
    made = stage.room(pixels=8)
    for ob in made.objects:
        if ob.type == "MESH":
            ob.data.materials.clear()
            ob.data.materials.append(random_trees.material(chance))
        elif ob.type == "LIGHT":
            ob.data = random_trees.lamp(chance)
    made.world = random_trees.world(chance)
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    settings = RenderSettings(passes=1, photons_per_pass=500)
    for name, pixels in render(what, settings, started=time.monotonic()).passes.items():
        assert np.isfinite(pixels).all(), name


def _render_many(first: int, count: int) -> None:
    import bpy

    for seed in range(first, first + count):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        try:
            _render(seed)
        except Exception as error:
            raise AssertionError(f"random trees of seed {seed}") from error


@pytest.mark.parametrize("first", [0, pytest.param(40, marks=pytest.mark.slow)])
@in_blender
def test_any_tree_is_rendered(first: int) -> None:
    _render_many(first, 500 if first else 40)
