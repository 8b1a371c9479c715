"""Grease pencil, which Blender draws over what an engine has rendered, in what the command line
writes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.integration.farm.command import call, picture
from tests.support.blender import Blender


def _save_drawing(folder: str) -> None:
    """Runs inside Blender: a drawn head before a grey plane, above its lower half."""
    import bpy

    from tests.support import stage

    made = stage.room(pixels=32, passes=2, photons=500)
    bpy.ops.object.grease_pencil_add(type="MONKEY", location=(0.0, 0.0, 1.0))
    made.render.use_border = True
    made.render.border_min_x, made.render.border_max_x = 0.0, 0.75
    made.render.border_min_y, made.render.border_max_y = 0.25, 1.0
    made.view_layers.new("Second")
    for name, crop, hidden in (
        ("drawn", False, False),
        ("crop", True, False),
        ("bare", False, True),
    ):
        made.render.use_crop_to_border = crop
        bpy.context.object.hide_render = hidden
        bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/{name}.blend", compress=False)


def test_grease_pencil_is_drawn_over_every_layer(blender: Blender, tmp_path: Path) -> None:
    blender.call(_save_drawing, {"folder": str(tmp_path)})
    said = {}
    for name in ("drawn", "crop", "bare"):
        status, _, said[name] = call(
            tmp_path, "render", f"{name}.blend", "-o", f"{name}.exr", "--seed", 1
        )
        assert status == 0, said[name]
    assert "Blender draws grease pencil objects over the picture" in said["drawn"]
    assert "grease pencil" not in said["bare"]
    drawn, crop, bare = (picture(tmp_path / f"{name}.exr") for name in ("drawn", "crop", "bare"))
    if all(np.array_equal(drawn[letter], bare[letter]) for letter in "RGB"):
        pytest.skip("this Blender draws nothing: it has no OpenGL")
    for letter in "RGB":
        other = f"Second.Combined.{letter}"
        for channel in (letter, other):
            assert drawn[channel].shape == bare[channel].shape == (24, 24)
            assert np.array_equal(drawn[channel], crop[channel])
            changed = np.abs(drawn[channel] - bare[channel]) > 1e-3
            assert 0.02 < changed.mean() < 0.9
        assert np.allclose(drawn[letter], drawn[other], atol=1e-6)
    for channel in bare:
        if channel not in {*"RGBA"} and not channel.startswith("Second.Combined"):
            assert np.array_equal(drawn[channel], bare[channel]), channel


def _save_lines(folder: str) -> None:
    """Runs inside Blender."""
    import bpy

    from tests.support import stage

    made = stage.room(pixels=32, passes=2, photons=500)
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=(0.0, 0.0, 0.5), rotation=(0.3, 0.2, 0.5))
    made.view_layers[0].freestyle_settings.linesets.new("Lines")
    for lines in (False, True):
        made.render.use_freestyle = made.view_layers[0].use_freestyle = lines
        bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/lines_{lines}.blend", compress=False)


def test_freestyle_is_drawn_over(blender: Blender, tmp_path: Path) -> None:
    blender.call(_save_lines, {"folder": str(tmp_path)})
    for lines in (False, True):
        name = f"lines_{lines}"
        status, _, errors = call(
            tmp_path, "render", f"{name}.blend", "-o", f"{name}.exr", "--seed", 1
        )
        assert status == 0, errors
    plain, drawn = (picture(tmp_path / f"lines_{lines}.exr")["G"] for lines in (False, True))
    if np.array_equal(plain, drawn):
        pytest.skip("this Blender draws nothing: it has no Freestyle")
    assert 0.005 < np.mean(drawn < 0.5 * plain) < 0.5
