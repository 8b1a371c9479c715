"""Renders that are ended in the middle, by the command line."""

from __future__ import annotations

import contextlib
import random
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from photon_splat.core.render import sums_file
from photon_splat.core.render.sums_file import SumsFile

from tests.integration.farm.command import call, equal, picture, start


def _until_a_pass_is_done(process: object) -> None:
    for line in process.stderr:  # type: ignore[attr-defined]
        if " % " in line:
            return


def _mean(path: Path) -> np.ndarray:
    read = picture(path)
    return np.stack([read[c] for c in "RGB"], axis=-1)


def test_sigterm_leaves_a_checkpoint_and_the_same_command_goes_on(
    scenes: Path, tmp_path: Path
) -> None:
    command = ("render", scenes / "room.blend", "-o", "out.exr", "--checkpoint", "c.exr")
    process = start(tmp_path, *command, "--passes", 100000)
    try:
        _until_a_pass_is_done(process)
        time.sleep(0.3)
        process.send_signal(signal.SIGTERM)
        _, errors = process.communicate()
    finally:
        process.kill()
    assert process.returncode == 75
    assert errors.splitlines()[-1] == (
        "photon-splat: interrupted; the checkpoint c.exr is written, and the same command goes on "
        "from it"
    )
    assert not (tmp_path / "out.exr").exists()
    (there,) = SumsFile(tmp_path / "c.exr").headers()
    done = there.passes
    assert done >= 1
    status, _, errors = call(tmp_path, *command, "--passes", done + 3)
    assert status == 0, errors
    assert errors.startswith(f"photon-splat: going on from c.exr ({done} passes)\n")
    (after,) = SumsFile(tmp_path / "c.exr").headers()
    assert [film.passes for film in after.films] == [done, 3]
    assert [film.generation for film in after.films] == [0, 1]
    status, output, _ = call(tmp_path, "info", "c.exr")
    assert "  part 1, generation 1: 3 passes, " in output
    # The picture is that of the checkpoint, which is a part like others
    assert call(tmp_path, "merge", "c.exr", "-o", "merged.exr")[0] == 0
    assert equal(tmp_path / "out.exr", tmp_path / "merged.exr")


@pytest.mark.parametrize("name", ["layers", "moving_in_fog"])
def test_checkpoints_change_no_picture(name: str, scenes: Path, tmp_path: Path) -> None:
    """Nor do view layers, light groups and mattes get lost in them."""
    scene = scenes / f"{name}.blend"
    assert call(tmp_path, "render", scene, "-o", "plain.exr", "--passes", 2)[0] == 0
    command = ("render", scene, "-o", "out.exr", "--passes", 2, "--checkpoint", "c.exr")
    for _ in range(2):  # the second time there is nothing left to do
        status, _, errors = call(tmp_path, *command, "--checkpoint-every", 0)
        assert status == 0, errors
        plain, out = picture(tmp_path / "plain.exr"), picture(tmp_path / "out.exr")
        assert plain.keys() == out.keys()
        for channel in plain:
            if not channel.endswith("Error.X"):
                assert plain[channel].tobytes() == out[channel].tobytes(), channel


def _until_written(process: subprocess.Popen[str], file: Path, times: int) -> None:
    """Until the process has written the file so often, however fast the machine is."""
    written = {file.stat().st_mtime_ns} if file.exists() else {0}
    times += len(written)
    while process.poll() is None and len(written) < times:
        with contextlib.suppress(FileNotFoundError):
            written.add(file.stat().st_mtime_ns)
        time.sleep(0.002)


def _killed(kills: int, command: tuple[object, ...], folder: Path) -> int:
    """Starts the command and kills it at a random moment after some passes, `kills` times; the
    passes of the last checkpoint.
    """
    numbers, passes = random.Random(7), 0
    for _ in range(kills):
        process = start(folder, *command, "--passes", 100000)
        try:
            _until_written(process, folder / "c.exr", numbers.randint(1, 5))
            time.sleep(numbers.uniform(0.0, 0.15))
            assert process.poll() is None
        finally:
            process.kill()
            process.communicate()
        (there,) = SumsFile(folder / "c.exr").read()
        assert there.passes > passes
        passes = there.passes
    return passes


@pytest.mark.parametrize(
    ("kills", "at_most"), [(3, 1.25), pytest.param(20, 1.05, marks=pytest.mark.slow)]
)
def test_killed_at_any_moment_no_checkpoint_is_broken(
    kills: int, at_most: float, scenes: Path, tmp_path: Path
) -> None:
    """And the picture's error is that of a render that nobody has killed."""
    options = ("--photons-per-pass", 20000, "--resolution", "48x48")
    render = ("render", scenes / "room.blend", *options, "-o")
    checkpoint = ("--checkpoint", "c.exr", "--checkpoint-every", 0)
    passes = _killed(kills, (*render, "out.exr", *checkpoint), tmp_path) + 1
    status, _, errors = call(tmp_path, *render, "out.exr", *checkpoint, "--passes", passes)
    assert status == 0, errors
    assert call(tmp_path, *render, "whole.exr", "--passes", passes)[0] == 0
    reference = (*render, "reference.exr", "--seed", 90, "--passes", 6 * passes + 16)
    assert call(tmp_path, *reference)[0] == 0
    truth = _mean(tmp_path / "reference.exr")
    out, whole = (
        np.sqrt(np.mean((_mean(tmp_path / f"{name}.exr") - truth) ** 2))
        for name in ("out", "whole")
    )
    print(f"{passes} passes after {kills} kills: RMSE {out / whole:.3f} of that without")
    assert out < at_most * whole


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--checkpoint-every", "5"], "--checkpoint-every needs --checkpoint"),
        (["--checkpoint", "c.png"], "c.png does not end in .exr: checkpoints are OpenEXR"),
        (["--checkpoint", "out.exr"], "--checkpoint and --output name the same file"),
        (["--part", "0/3"], "argument --part: '0/3' is not a part I/N"),
        (["--part", "3"], "argument --part: '3' is not a part I/N"),
    ],
)
def test_options_that_make_no_sense(
    options: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    from photon_splat.cli import main

    monkeypatch.chdir(tmp_path)
    Path("scene.blend").touch()
    assert main(["render", "scene.blend", "-o", "out.exr", *options]) == 1
    assert words in capsys.readouterr().err


def test_a_checkpoint_that_is_none_is_left_alone(scenes: Path, tmp_path: Path) -> None:
    (tmp_path / "c.exr").write_text("of somebody else")
    command = ("render", scenes / "room.blend", "-o", "out.exr", "--checkpoint", "c.exr")
    status, _, errors = call(tmp_path, *command)
    assert status == 1
    assert errors.startswith("photon-splat: c.exr cannot be read: ")
    assert (tmp_path / "c.exr").read_text() == "of somebody else"


def test_a_checkpoint_of_an_older_version_is_refused(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    command = ("render", scenes / "room.blend", "-o", "out.exr", "--checkpoint", "c.exr")
    assert call(tmp_path, *command, "--passes", 1)[0] == 0
    layers = SumsFile(tmp_path / "c.exr").read()
    monkeypatch.setattr(sums_file, "FORMAT", 1)
    sums_file.write_sums(tmp_path / "c.exr", layers)
    before = (tmp_path / "c.exr").read_bytes()
    status, _, errors = call(tmp_path, *command)
    assert status == 1
    assert "c.exr is of version 1 of the format; this is 4" in errors
    assert (tmp_path / "c.exr").read_bytes() == before


def test_a_part_file_is_no_checkpoint(scenes: Path, tmp_path: Path) -> None:
    """It lacks what the next pass is chosen from."""
    room = scenes / "room.blend"
    assert call(tmp_path, "render", room, "-o", "p.exr", "--part", "1/3", "--passes", 1)[0] == 0
    command = ("render", room, "-o", "out.exr", "--part", "1/3", "--checkpoint", "p.exr")
    status, _, errors = call(tmp_path, *command)
    assert status == 1
    assert "The checkpoint p.exr is not of this render (it is a part file)" in errors
