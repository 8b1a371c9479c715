"""photon-splat render --frames: which frames, which files, and that no picture shows its chunk."""

from __future__ import annotations

import argparse
import signal
from pathlib import Path

import pytest
from photon_splat.cli import main
from photon_splat.cli.frames import frame_list, with_number

from tests.integration.farm.command import call, equal, start


@pytest.mark.parametrize(
    ("text", "frames"),
    [
        ("7", [7]),
        ("1-4", [1, 2, 3, 4]),
        ("1-3,15", [1, 2, 3, 15]),
        ("1-9:4", [1, 5, 9]),
        ("-2-1", [-2, -1, 0, 1]),
        ("-3--1", [-3, -2, -1]),
        ("5, 1-5", [5, 1, 2, 3, 4]),
    ],
)
def test_lists_of_frames(text: str, frames: list[int]) -> None:
    assert frame_list(text) == frames


@pytest.mark.parametrize("text", ["", "x", "1-", "1,,2", "3-1", "1-5:0", "1.5", "9999999"])
def test_lists_that_are_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError):
        frame_list(text)


def test_numbers_in_names() -> None:
    assert with_number(Path("a#/f_####.exr"), 7) == Path("a#/f_0007.exr")
    assert with_number(Path("f_##.exr"), 123) == Path("f_123.exr")
    assert with_number(Path("f_####.exr"), -7) == Path("f_-007.exr")
    assert with_number(Path("shot#1_##.exr"), 5) == Path("shot#1_05.exr")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            ["-o", "f.exr"],
            "f.exr has no # for the number of the frame, which --frames needs in --output: "
            "f_####.exr",
        ),
        (
            ["-o", "f_#.exr", "--stats", "s.json"],
            "s.json has no # for the number of the frame, which --frames needs in --stats: "
            "f_####.json",
        ),
        (["-o", "f_#.exr", "--frame", "2"], "argument --frame: not allowed with argument --frames"),
    ],
)
def test_options_that_make_no_sense(
    options: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.blend").touch()
    assert main(["render", "scene.blend", "--frames", "1-3", *options]) == 1
    assert words in capsys.readouterr().err


@pytest.mark.parametrize("scene", ["moving", "persistent"])
def test_a_frame_alone_is_that_of_a_chunk(scene: str, scenes: Path, tmp_path: Path) -> None:
    """Bit for bit, with and without Persistent Data."""
    options = ("--passes", "2")
    file = scenes / f"{scene}.blend"
    status, _, errors = call(
        tmp_path, "render", file, "-o", "f_##.exr", "--frames", "1-3", *options
    )
    assert status == 0, errors
    assert "photon-splat: frame 3: f_03.exr\n" in errors
    assert call(tmp_path, "render", file, "-o", "alone.exr", "--frame", "3", *options)[0] == 0
    assert equal(tmp_path / "f_03.exr", tmp_path / "alone.exr")
    assert not equal(tmp_path / "f_03.exr", tmp_path / "f_02.exr")


def test_what_is_there_is_not_rendered_again(scenes: Path, tmp_path: Path) -> None:
    """A second time not even Blender is loaded."""
    (tmp_path / "f_2.exr").write_text("of yesterday")
    command = ("render", scenes / "moving.blend", "-o", "f_#.exr", "--frames", "1-2", "--passes", 1)
    assert call(tmp_path, *command, "--skip-existing")[0] == 0
    assert (tmp_path / "f_2.exr").read_text() == "of yesterday"
    assert (tmp_path / "f_1.exr").stat().st_size > 1000
    (scenes / "text.blend").write_text("no scene at all")
    command = ("render", scenes / "text.blend", *command[2:])
    status, _, errors = call(tmp_path, *command, "--skip-existing")
    assert (status, errors) == (0, "photon-splat: every picture is there, nothing was rendered\n")


def test_an_interrupt_keeps_the_frames_before(scenes: Path, tmp_path: Path) -> None:
    process = start(
        tmp_path, "render", scenes / "moving.blend", "-o", "f_#.exr", "--frames", "1-500"
    )
    try:
        assert process.stderr is not None
        for line in process.stderr:
            if line.startswith("photon-splat: frame 1: "):
                break
        process.send_signal(signal.SIGTERM)
        _, errors = process.communicate()
    finally:
        process.kill()
    assert process.returncode == 1
    last = errors.splitlines()[-1]
    assert last.startswith("photon-splat: interrupted; frame ")
    assert last.endswith(" was not written")
    assert (tmp_path / "f_1.exr").exists()
    assert not list(tmp_path.glob(".*.partial*"))
