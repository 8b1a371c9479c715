"""Part files and their merge by the command line; what the sums themselves obey is in
tests/unit/test_sums.py.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.integration.farm.command import call, equal, picture

PASSES = ("--passes", "2")


@pytest.fixture(scope="module")
def parts(scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the three parts p1.exr ... of a scene with a border, two view layers, a light
    group, mattes and a transparent film.
    """
    folder = tmp_path_factory.mktemp("parts")
    for number in (1, 2, 3):
        status, _, errors = call(
            folder,
            "render",
            scenes / "layers.blend",
            "-o",
            f"p{number}.exr",
            "--part",
            f"{number}/3",
            *PASSES,
        )
        assert status == 0, errors
        assert (
            "photon-splat: warning: a part of 2 passes does little beside its export and its "
            "pilot: fewer parts of 16 passes or more take less time\n" in errors
        )
    return folder


def _copy(parts: Path, to: Path, *names: str) -> None:
    for name in names:
        shutil.copy(parts / f"{name}.exr", to / f"{name}.exr")


def test_neither_order_nor_grouping_changes_a_bit(parts: Path, tmp_path: Path) -> None:
    _copy(parts, tmp_path, "p1", "p2", "p3")
    for command in (
        ("p1.exr", "p2.exr", "p3.exr", "-o", "forth.exr"),
        ("p3.exr", "p1.exr", "p2.exr", "-o", "mixed.exr"),
        ("p3.exr", "p1.exr", "-o", "two.exr", "--keep-sums"),
        ("p2.exr", "two.exr", "-o", "grouped.exr"),
        ("two.exr", "p2.exr", "-o", "sums.exr", "--keep-sums"),
        ("sums.exr", "-o", "alone.exr"),
    ):
        status, _, errors = call(tmp_path, "merge", *command)
        assert status == 0, errors
    for other in ("mixed", "grouped", "alone"):
        assert equal(tmp_path / "forth.exr", tmp_path / f"{other}.exr"), other


def test_the_merged_picture_is_one_of_a_render(parts: Path, scenes: Path, tmp_path: Path) -> None:
    """The same channels, about the same values, and data passes that are the same."""
    status, _, errors = call(tmp_path, "merge", parts, "-o", "merged.exr", "--stats", "merged.json")
    assert status == 0, errors
    assert "missing" not in errors
    command = ("render", scenes / "layers.blend", "-o", "whole.exr", "--passes", 6)
    assert call(tmp_path, *command)[0] == 0
    merged, whole = picture(tmp_path / "merged.exr"), picture(tmp_path / "whole.exr")
    assert merged.keys() == whole.keys()
    assert {"Combined_Key.R", "CryptoObject00.r", "Second.Combined.R"} <= merged.keys()
    for name in merged:
        if "Crypto" in name:
            assert np.array_equal(merged[name], whole[name])
        elif name[-2:] == ".R" or name in ("R", "A"):
            noise = 0.05 if name in ("R", "A") else 0.3
            assert merged[name].mean() == pytest.approx(whole[name].mean(), rel=noise), name
    assert (merged["A"] < 0.5).any()  # the film is transparent
    said = json.loads((tmp_path / "merged.json").read_text())
    assert [layer["parts"] for layer in said["layers"]] == [[1, 2, 3]] * 2
    assert [layer["passes"] for layer in said["layers"]] == [6, 6]
    assert 0 < said["layers"][0]["error"]["relative_rmse"] < 1


def test_parts_of_what_moves_in_fog(scenes: Path, tmp_path: Path) -> None:
    """Beams, light along camera rays and the shutter's times: whatever the order of the parts, and
    about the picture of one render of as many passes.
    """
    scene = scenes / "moving_in_fog.blend"
    for number in (1, 2):
        command = ("render", scene, "-o", f"p{number}.exr", "--part", f"{number}/2")
        status, _, errors = call(tmp_path, *command, "--passes", 16)
        assert status == 0, errors
    for name, order in (("forth", ("p1.exr", "p2.exr")), ("back", ("p2.exr", "p1.exr"))):
        assert call(tmp_path, "merge", *order, "-o", f"{name}.exr")[0] == 0
    assert equal(tmp_path / "forth.exr", tmp_path / "back.exr")
    assert call(tmp_path, "render", scene, "-o", "whole.exr", "--passes", 32)[0] == 0
    merged, whole = picture(tmp_path / "forth.exr"), picture(tmp_path / "whole.exr")
    assert merged.keys() == whole.keys()
    for name in ("R", "G", "B", "Volume Direct.R", "Volume Indirect.R"):
        assert 0 < merged[name].mean() == pytest.approx(whole[name].mean(), rel=0.05), name


def test_missing_parts_are_told(parts: Path, tmp_path: Path) -> None:
    _copy(parts, tmp_path, "p1", "p3")
    command = ("merge", "p1.exr", "p3.exr", "-o", "out.exr")
    status, _, errors = call(tmp_path, *command)
    assert status == 0
    warning = "photon-splat: warning: Of {} parts {} are missing ({}): the picture is noisier\n"
    assert warning.format(3, 1, "2") in errors
    assert "missing" not in call(tmp_path, *command, "--expect", 2)[2]
    assert warning.format(5, 3, "2, 4, 5") in call(tmp_path, *command, "--expect", 5)[2]


def test_what_does_not_go_together_is_refused(parts: Path, scenes: Path, tmp_path: Path) -> None:
    _copy(parts, tmp_path, "p1", "p2")
    shutil.copy(tmp_path / "p1.exr", tmp_path / "again.exr")
    others = {
        "seed": ("layers", "--seed", "5"),
        "count": ("layers",),
        "scene": ("layers_brighter",),
    }
    for name, (scene, *options) in others.items():
        part = "2/4" if name == "count" else "2/3"
        command = ("render", scenes / f"{scene}.blend", "-o", f"{name}.exr", "--part", part)
        assert call(tmp_path, *command, *PASSES, *options)[0] == 0
    (tmp_path / "text.exr").write_text("no picture")
    (tmp_path / "out.exr").write_text("of yesterday")
    together = "photon-splat: p1.exr and {}.exr do not go together: {}\n"
    for name, words in {
        "again": "photon-splat: part 1 is in p1.exr and in again.exr\n",
        "p1": "photon-splat: p1.exr is named twice\n",
        "seed": together.format("seed", "seed is 0 and 5"),
        "count": together.format("count", "the picture is planned for 3 parts and for 4"),
        "scene": together.format("scene", "the scene is not the same"),
        "text": "photon-splat: text.exr cannot be read: ",
        "gone": "photon-splat: gone.exr does not exist\n",
    }.items():
        status, _, errors = call(tmp_path, "merge", "p1.exr", f"{name}.exr", "-o", "out.exr")
        assert status == 1
        assert errors.startswith(words), errors
        assert errors.count("\n") == 1
    assert (tmp_path / "out.exr").read_text() == "of yesterday"


def test_a_picture_is_no_part(scenes: Path, tmp_path: Path) -> None:
    assert call(tmp_path, "render", scenes / "room.blend", "-o", "p.exr", *PASSES)[0] == 0
    status, _, errors = call(tmp_path, "merge", "p.exr", "-o", "out.exr")
    assert status == 1
    assert errors == (
        "photon-splat: p.exr is no part file and no checkpoint: it holds no sums of Photon Splat\n"
    )
    status, output, _ = call(tmp_path, "info", "p.exr")
    assert status == 0
    assert output.startswith("picture of Photon Splat ")
    assert "passes          2\n" in output


def test_info_tells_what_a_part_is(parts: Path, tmp_path: Path) -> None:
    status, output, errors = call(tmp_path, "info", parts / "p2.exr")
    assert status == 0, errors
    assert "sums of view layer 'Second', frame 1 of 'layers.blend'\n" in output
    assert "passes       2 of 3 parts planned\n" in output
    assert "  part 2: 2 passes, " in output


def test_a_missing_texture_is_an_error(scenes: Path, tmp_path: Path) -> None:
    scene = scenes / "missing_texture.blend"
    sentence = "gone.png cannot be read; shown in pink\n"
    for option in (("--part", "1/2"), ("--strict",)):
        status, _, errors = call(tmp_path, "render", scene, "-o", "p.exr", *option)
        assert status == 1
        assert errors.endswith(sentence)
        assert not (tmp_path / "p.exr").exists()
    status, _, errors = call(tmp_path, "render", scene, "-o", "p.exr", *PASSES)
    assert status == 0
    assert "photon-splat: warning: " in errors


def test_a_part_beyond_the_planned_ones_is_merged(
    parts: Path, scenes: Path, tmp_path: Path
) -> None:
    _copy(parts, tmp_path, "p1", "p2", "p3")
    command = ("render", scenes / "layers.blend", "-o", "p4.exr", "--part", "4/3", *PASSES)
    assert call(tmp_path, *command)[0] == 0
    status, _, errors = call(tmp_path, "merge", ".", "-o", "out.exr", "--stats", "out.json")
    assert status == 0, errors
    assert json.loads((tmp_path / "out.json").read_text())["layers"][0]["parts"] == [1, 2, 3, 4]
