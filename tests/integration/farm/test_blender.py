"""Checkpoints of renders in Blender, and the panel Farm."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from photon_splat.core.render.sums_file import SumsFile

from tests.support import stage
from tests.support.blender import in_blender


def _made(folder: str) -> Any:
    made = stage.room(pixels=16, passes=6, photons=2000)
    settings = made.photon_splat_farm
    settings.use_checkpoint = True
    settings.checkpoint = f"{folder}/c_##.exr"
    settings.checkpoint_minutes = 0.0
    return made


def _cancelled_after(passes: int) -> None:
    """Renders, and is cancelled when so many passes are done."""
    import bpy
    from photon_splat.blender import job

    done = [0]

    def progress(told: Any) -> None:
        done[0] = told.passes_done

    job.observer.on_progress = progress
    job.observer.should_cancel = lambda: done[0] >= passes
    bpy.ops.render.render()
    job.observer.should_cancel = lambda: False


@in_blender
def test_a_cancelled_render_leaves_a_checkpoint_and_the_next_goes_on() -> None:
    import tempfile

    import bpy

    folder = tempfile.mkdtemp()
    made = _made(folder)
    made.photon_splat.passes = 100_000
    _cancelled_after(2)
    path = Path(folder) / "c_01.exr"
    (there,) = SumsFile(path).headers()
    assert 2 <= there.passes < 100_000
    made.photon_splat.passes = there.passes + 3
    with stage.watched() as results:
        bpy.ops.render.render()
    assert results[-1].statistics["passes"] == there.passes + 3
    assert np.isfinite(results[-1].passes["Combined"]).all()
    assert not path.exists(), "a finished render needs no checkpoint"


@in_blender
def test_a_checkpoint_of_another_scene_is_refused_or_replaced() -> None:
    import tempfile

    import bpy

    folder = tempfile.mkdtemp()
    made = _made(folder)
    made.photon_splat.passes = 100_000
    _cancelled_after(1)
    made.photon_splat.passes = 2
    bpy.data.objects["POINT"].data.energy = 5
    with pytest.raises(RuntimeError, match=r"is not of this render \(the scene is not the same\)"):
        bpy.ops.render.render()
    assert (Path(folder) / "c_01.exr").exists()
    made.photon_splat_farm.resume = False
    with stage.watched() as results:
        bpy.ops.render.render()
    assert results[-1].statistics["passes"] == 2


@in_blender
def test_a_checkpoint_changes_no_picture() -> None:
    import tempfile

    import bpy

    made = _made(tempfile.mkdtemp())
    with stage.watched() as results:
        bpy.ops.render.render()
        made.photon_splat_farm.use_checkpoint = False
        bpy.ops.render.render()
    one, other = (result.passes["Combined"] for result in results)
    assert np.array_equal(one, other)


@in_blender
def test_the_panel_writes_what_the_command_writes() -> None:
    import subprocess
    import tempfile

    import bpy

    from tests.integration.farm.command import COMMAND

    folder = Path(tempfile.mkdtemp())
    made = stage.room(pixels=16, passes=6, photons=2000)
    settings = made.photon_splat_farm
    settings.folder = str(folder / "panel")
    with pytest.raises(RuntimeError, match="Save the file first"):
        bpy.ops.photon_splat.farm()
    made.frame_end = 7
    file = folder / "room.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file), compress=False)
    made = stage.scene()
    settings = made.photon_splat_farm
    settings.folder = str(folder / "panel")
    for kind, options in (("STILL", ["--still", "8"]), ("ANIMATION", ["--animation"])):
        settings.kind = kind
        assert bpy.ops.photon_splat.farm() == {"FINISHED"}
        files = [path.name for path in (folder / "panel").iterdir() if path.is_file()]
        assert "template.json" in files
        results = ["--results", str(folder / "panel/output"), "-o", str(folder / "command")]
        subprocess.run([*COMMAND, "farm", str(file), *options, *results], check=True)
        for name in files:
            one, other = (folder / where / name for where in ("panel", "command"))
            assert one.read_text() == other.read_text(), name
