"""The GPU splatter against the native one on every scene of blend_scenes."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest
from photon_splat.core.gpu import context
from photon_splat.export import export_scene

from tests.support.opengl import compare, need_opengl
from tests.support.paths import ROOT

SCENES = sorted(path for path in (ROOT / "blend_scenes").glob("*.blend"))


@pytest.fixture(scope="module", autouse=True)
def opengl() -> None:
    need_opengl()


def test_there_are_scenes() -> None:
    assert SCENES


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_agreement(path: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(path))
    render = bpy.context.scene.render
    render.resolution_x = render.resolution_y = 64
    render.resolution_percentage = 100
    render.use_border = False
    compare(export_scene(bpy.context.evaluated_depsgraph_get()), photons_per_pass=30_000)
    assert context.submit(lambda: context.graphics().gl.error).result() == "GL_NO_ERROR"
