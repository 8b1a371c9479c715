"""The command line: pictures, statistics, and one line for everything that goes wrong."""

from __future__ import annotations

import json
import os
import resource
import shlex
import shutil
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from photon_splat.cli import main
from photon_splat.cli.exr import WriteError, replace_file
from photon_splat.core.render.result import PASSES

from tests.support import stage
from tests.support.blender import Blender
from tests.support.clock import Stopwatch
from tests.support.paths import environment

HANG_SECONDS = 600.0
"""For what is to end at once."""
RUN = [sys.executable, "-c", "from photon_splat.cli import run; run()", "render"]


def _save_scenes(folder: str) -> None:
    """Runs inside Blender."""
    import bpy

    def save(name: str) -> None:
        bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/{name}.blend", compress=False)

    scene = stage.room(pixels=24, passes=4, photons=3000)
    stage.plane("Lamp shade", 0.5, location=(1, 1, 1))
    save("room")
    scene.render.use_multiview = True
    scene.camera.data.stereo.interocular_distance = 0.8
    save("stereo")
    for view in scene.render.views:
        view.use = False
    save("no_view")
    for view in scene.render.views:
        view.use = True
    scene.render.use_multiview = False
    stage.portal()
    scene.view_layers.new("Second")
    scene.render.use_border = True
    (
        scene.render.border_min_x,
        scene.render.border_max_x,
        scene.render.border_min_y,
        scene.render.border_max_y,
    ) = 0.25, 0.75, 0.5, 0.75
    save("border")
    scene.render.use_crop_to_border = True
    scene.render.pixel_aspect_y = 1.6
    save("crop")
    for layer in scene.view_layers:
        layer.use = False
    save("no_layer")
    scene.camera = None
    scene.view_layers[0].use = True
    save("no_camera")


@pytest.fixture(scope="session")
def scenes(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenes")
    blender.call(_save_scenes, {"folder": str(folder)})
    whole = (folder / "room.blend").read_bytes()
    (folder / "broken.blend").write_bytes(whole[: len(whole) // 3])
    (folder / "text.blend").write_text("no scene at all\n" * 100)
    (folder / "empty.blend").write_bytes(b"")
    # The embedded node tree loses its name, for which Blender reports an error and goes on.
    (folder / "complaint.blend").write_bytes(
        whole.replace(b"NTShader Nodetree", b"\0\0Shader Nodetree")
    )
    return folder


def _start(tmp_path: Path, *arguments: object, **options: Any) -> subprocess.Popen[str]:
    command = [*RUN, *map(str, arguments)]
    pipe = subprocess.PIPE
    return subprocess.Popen(
        command,
        cwd=tmp_path,
        env=environment(tmp_path / "blender"),
        stdout=pipe,
        stderr=pipe,
        text=True,
        **options,
    )


def _render(tmp_path: Path, *arguments: object, **options: Any) -> tuple[int, str]:
    """Exit status and standard error."""
    process = _start(tmp_path, *arguments, **options)
    try:
        output, errors = process.communicate()
    finally:
        process.kill()
    assert output == ""
    return process.returncode, errors


def _picture(path: Path) -> tuple[Any, np.ndarray]:
    """OpenImageIO's description and (height, width, channels) float32, top row first."""
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(str(path))
    spec = file.spec()
    pixels = file.read_image(0, 0, 0, spec.nchannels, oiio.FLOAT)
    file.close()
    return spec, pixels


def _left(folder: Path) -> list[str]:
    return sorted(name for name in os.listdir(folder) if name != "blender")


# --- inputs that are refused before Blender is loaded ---


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--seconds", "nan"], "argument --seconds: 'nan' is not a number 0.001 or more"),
        (["--seconds", "inf"], "--seconds: 'inf' is not a number"),
        (["--seconds", "0"], "--seconds: '0' is not a number"),
        (["--seconds", "-5"], "--seconds"),
        (["--seconds", "soon"], "--seconds: 'soon' is not a number"),
        (["--error", "0"], "argument --error: '0' is not a number 1e-06 or more"),
        (["--passes", "0"], "--passes: '0' is not a number between 1 and 1,073,741,824"),
        (["--passes", "1.5"], "--passes: '1.5' is not a number"),
        (["--passes", "9999999999999"], "--passes: '9999999999999' is not a number between 1 and"),
        (["--photons-per-pass", "-1"], "--photons-per-pass"),
        (
            ["--photons-per-pass", "99999999999999"],
            "--photons-per-pass: '99999999999999' is not a number between 0 and",
        ),
        (["--resolution", "640"], "--resolution: '640' is not WIDTHxHEIGHT"),
        (
            ["--resolution", "2x2"],
            "--resolution: '2x2' is not WIDTHxHEIGHT with sides between 4 and 65536 pixels",
        ),
        (["--resolution", "axb"], "--resolution: 'axb'"),
        (["--seed", "-1"], "--seed"),
        (["--seed", "4294967296"], "--seed: '4294967296' is not a number between 0 and"),
        (["--threads", "many"], "--threads: 'many' is not a number between 0 and 1,024"),
        (["--frame", "x"], "--frame: 'x' is not a number"),
        (["--integrator", "magic"], "--integrator: invalid choice: 'magic'"),
        (["--backend", "magic"], "--backend: invalid choice: 'MAGIC'"),
        (["--point-spacing", "2"], "--point-spacing: '2' is not a number between 0 and 1"),
        (["--colour", "red"], "unrecognized arguments: --colour red"),
        (
            ["--stats", "missing/stats.json"],
            "missing/stats.json cannot be written: the folder missing does not exist",
        ),
        (["--stats", "."], ". is a folder"),
        (["--stats", "./out.exr"], "--stats and --output name the same file"),
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
    _refused(capsys, words, "render", "scene.blend", "-o", "out.exr", *options)
    assert _left(tmp_path) == ["scene.blend"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["render", "gone.blend", "-o", "out.exr"], "gone.blend does not exist"),
        (["render", ".", "-o", "out.exr"], ". is not a file"),
        (["render", "scene.blend"], "the following arguments are required: -o/--output"),
        (["render", "-o", "out.exr"], "the following arguments are required: SCENE.blend"),
        (
            ["render", "scene.blend", "-o", "out.png"],
            "out.png does not end in .exr: pictures are written as OpenEXR",
        ),
        (
            ["render", "scene.blend", "-o", "gone/out.exr"],
            "gone/out.exr cannot be written: the folder gone does not exist",
        ),
        (
            ["render", "scene.blend", "-o", "scene.blend/out.exr"],
            "scene.blend/out.exr cannot be written",
        ),
        (["render", "scene.blend", "-o", "folder.exr"], "folder.exr is a folder"),
        (["paint"], "invalid choice: 'paint'"),
        ([], "the following arguments are required: COMMAND"),
    ],
)
def test_files_that_make_no_sense(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.blend").touch()
    Path("folder.exr").mkdir()
    _refused(capsys, words, *arguments)
    assert _left(tmp_path) == ["folder.exr", "scene.blend"]


def _refused(capsys: pytest.CaptureFixture[str], words: str, *arguments: str) -> None:
    assert main(list(arguments)) == 1
    output, errors = capsys.readouterr()
    assert output == ""
    assert errors.startswith("photon-splat: ")
    assert errors.count("\n") == 1, errors
    assert words in errors


def test_a_folder_without_permission(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The superuser may write everywhere, so that the answer of the system is made up."""
    monkeypatch.chdir(tmp_path)
    Path("scene.blend").touch()
    Path("locked").mkdir()
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != Path("locked"))
    _refused(
        capsys,
        "locked/out.exr cannot be written: no permission in locked",
        "render",
        "scene.blend",
        "-o",
        "locked/out.exr",
    )


# --- what goes wrong in Blender and after it ---


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("broken", "broken.blend cannot be opened: "),
        ("text", "text.blend cannot be opened: "),
        ("empty", "empty.blend cannot be opened: "),
        ("no_camera", "Scene 'Scene' has no camera"),
        ("no_layer", "Blender rendered no view layer; is at least one enabled for rendering?"),
    ],
)
def test_scenes_that_cannot_be_rendered(
    scene: str, words: str, scenes: Path, tmp_path: Path
) -> None:
    status, errors = _render(
        tmp_path, scenes / f"{scene}.blend", "-o", "out.exr", "--stats", "stats.json"
    )
    assert status == 1
    assert words in errors
    assert errors.count("\n") == 1, errors
    assert _left(tmp_path) == []


def test_a_file_that_blender_opens_with_complaints_is_rendered(
    scenes: Path, tmp_path: Path
) -> None:
    assert b"NTShader Nodetree" in (scenes / "room.blend").read_bytes()
    status, errors = _render(tmp_path, scenes / "complaint.blend", "-o", "out.exr")
    assert status == 0, errors
    assert "complaint.blend: Blender reports: Data-block '" in errors
    assert "had an invalid embedded node group" in errors
    assert _left(tmp_path) == ["out.exr"]


def _small_disk() -> None:
    """No file may grow beyond 20 kB."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))


def test_disk_full_leaves_what_was_there(scenes: Path, tmp_path: Path) -> None:
    (tmp_path / "out.exr").write_text("the picture of yesterday")
    options = ("--resolution", "200x200", "--passes", "1", "--photons-per-pass", "10")
    status, errors = _render(
        tmp_path, scenes / "room.blend", "-o", "out.exr", *options, preexec_fn=_small_disk
    )
    assert status == 1
    *_, last = errors.splitlines()
    assert last.startswith("photon-splat: out.exr could not be written: ")
    assert (tmp_path / "out.exr").read_text() == "the picture of yesterday"
    assert _left(tmp_path) == ["out.exr"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupting_writes_nothing(number: signal.Signals, scenes: Path, tmp_path: Path) -> None:
    process = _start(
        tmp_path,
        scenes / "room.blend",
        "-o",
        "out.exr",
        "--passes",
        "1000000",
        "--resolution",
        "64x64",
    )
    try:
        assert process.stderr is not None
        assert " %" in process.stderr.readline()
        time.sleep(0.5)
        watch = Stopwatch()
        process.send_signal(number)
        _, errors = process.communicate(timeout=HANG_SECONDS)
    finally:
        process.kill()
    assert watch.seconds() < 2.0
    assert process.returncode == 1
    assert errors.splitlines()[-1] == "photon-splat: interrupted; nothing was written"
    assert _left(tmp_path) == []


# --- pictures ---


@pytest.mark.smoke
def test_picture_and_statistics(scenes: Path, tmp_path: Path) -> None:
    status, errors = _render(
        tmp_path,
        scenes / "room.blend",
        "-o",
        "out.exr",
        "--stats",
        "stats.json",
        "--passes",
        "3",
        "--threads",
        "2",
        "--photons-per-pass",
        "60000",
        "--no-adaptive-samples",
    )
    assert status == 0, errors
    assert "100 %" in errors
    assert _left(tmp_path) == ["out.exr", "stats.json"]
    spec, pixels = _picture(tmp_path / "out.exr")
    assert (spec.width, spec.height) == (24, 24)
    names = ["R", "G", "B", "A"]
    names += [f"{info.name}.{letter}" for info in PASSES[1:] for letter in info.channels]
    assert sorted(spec.channelnames) == sorted(names)
    assert {str(spec.channelformat(k)) for k in range(spec.nchannels)} == {"float"}
    # The shade near the lamp, at the upper right, is brighter than the floor, and nearer.
    depth = pixels[..., spec.channelnames.index("Depth.Z")]
    assert depth[3, 20] == pytest.approx(3, abs=0.1)
    assert depth[20, 3] == pytest.approx(4, abs=0.1)
    assert np.isfinite(pixels[..., :4]).all()
    assert pixels[..., [spec.channelnames.index(c) for c in "RGB"]].mean() > 0.01

    said = json.loads((tmp_path / "stats.json").read_text())
    assert set(said["seconds"]) >= {
        "export",
        "acceleration",
        "camera",
        "photons",
        "splat",
        "boundary",
        "total",
    }
    assert set(said) >= {
        "photons",
        "rays",
        "peak_memory_bytes",
        "passes",
        "threads",
        "backend",
        "warnings",
        "startup_seconds",
    }
    assert said["photons"]["traced"] == 3 * 60_000
    assert 0 < said["photons"]["stored"] < 10 * 180_000
    assert said["rays"] > 9000
    assert said["passes"] == 3
    assert said["threads"] == 2
    assert said["backend"] in {"CPU", "GPU"}
    assert 0 < said["error"]["relative_rmse"] < 10
    for name, value in said["error"].items():
        assert spec.getattribute(f"photon_splat:{name}") == pytest.approx(value, rel=1e-5)
    assert said["warnings"] == []
    assert said["peak_memory_bytes"] > 50e6
    assert 0 < said["seconds"]["export"] < said["seconds"]["total"]
    assert said["startup_seconds"] > 0.1
    parts = [seconds for name, seconds in said["seconds"].items() if name != "total"]
    assert all(seconds >= 0 for seconds in parts)


def test_options_have_the_last_word(scenes: Path, tmp_path: Path) -> None:
    options = (
        "--resolution",
        "20x12",
        "--passes",
        "2",
        "--photons-per-pass",
        "500",
        "--integrator",
        "reference",
        "--frame",
        "7",
    )
    assert (
        _render(
            tmp_path, scenes / "room.blend", "-o", "out.exr", "--stats", "stats.json", *options
        )[0]
        == 0
    )
    spec, _ = _picture(tmp_path / "out.exr")
    said = json.loads((tmp_path / "stats.json").read_text())
    assert (spec.width, spec.height) == (20, 12)
    assert (said["integrator"], said["passes"], said["photons"]["traced"]) == ("reference", 2, 0)


def test_border_layers_and_warnings(scenes: Path, tmp_path: Path) -> None:
    status, errors = _render(tmp_path, scenes / "border.blend", "-o", "out.exr")
    assert status == 0
    assert "photon-splat: warning: Light portals are not supported; left out: 'Portal'\n" in errors
    spec, _ = _picture(tmp_path / "out.exr")
    assert (spec.x, spec.y, spec.width, spec.height) == (6, 6, 12, 6)
    assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, 24, 24)
    assert {"R", "Depth.Z", "Second.Combined.R", "Second.Depth.Z"} <= set(spec.channelnames)
    assert _render(tmp_path, scenes / "crop.blend", "-o", "crop.exr")[0] == 0
    spec, _ = _picture(tmp_path / "crop.exr")
    assert (spec.x, spec.y, spec.width, spec.height) == (0, 0, 12, 6)
    assert (spec.full_width, spec.full_height) == (12, 6)
    assert spec.getattribute("PixelAspectRatio") == pytest.approx(0.625)


def test_views_are_in_one_file(scenes: Path, tmp_path: Path) -> None:
    assert _render(tmp_path, scenes / "stereo.blend", "-o", "out.exr")[0] == 0
    spec, pixels = _picture(tmp_path / "out.exr")
    names = list(spec.channelnames)
    left, right = (pixels[..., names.index(name)] for name in ("R", "ViewLayer.right.Combined.R"))
    assert left.mean() > 0
    assert not np.array_equal(left, right)
    assert _render(tmp_path, scenes / "no_view.blend", "-o", "none.exr")[0] == 0
    assert _picture(tmp_path / "none.exr")[1].any()
    status, errors = _render(
        tmp_path, scenes / "stereo.blend", "-o", "part.exr", "--part", "1/2", "--seed", "7"
    )
    assert status != 0
    assert "Parts and checkpoints hold one view" in errors


def test_seconds_are_kept(scenes: Path, tmp_path: Path) -> None:
    options = ("--seconds", "2", "--photons-per-pass", "5000", "--resolution", "32x32")
    watch = Stopwatch()
    assert (
        _render(
            tmp_path, scenes / "room.blend", "-o", "out.exr", "--stats", "stats.json", *options
        )[0]
        == 0
    )
    said = json.loads((tmp_path / "stats.json").read_text())
    waited = watch.waited()
    assert 1.6 < said["seconds"]["total"] < 2.4 + waited
    assert said["passes"] > 4 / (1 + waited)


def test_error_ends_the_render(scenes: Path, tmp_path: Path) -> None:
    options = ("--error", "0.05", "--photons-per-pass", "20000")
    status, errors = _render(
        tmp_path, scenes / "room.blend", "-o", "out.exr", "--stats", "stats.json", *options
    )
    assert status == 0
    assert " | error " in errors
    said = json.loads((tmp_path / "stats.json").read_text())
    assert 0 < said["error"]["relative_rmse"] <= 0.05
    assert said["passes"] >= 8


def test_threads_do_not_change_the_picture(scenes: Path, tmp_path: Path) -> None:
    pictures = []
    for threads in (1, 2, 5):
        options = (
            "--threads",
            threads,
            "--passes",
            "2",
            "--seed",
            "5",
            "--photons-per-pass",
            "200000",
        )
        assert _render(tmp_path, scenes / "room.blend", "-o", "out.exr", *options)[0] == 0
        pictures.append(_picture(tmp_path / "out.exr")[1])
    for other in pictures[1:]:
        assert pictures[0].tobytes() == other.tobytes()


def test_an_output_that_exists_is_replaced(scenes: Path, tmp_path: Path) -> None:
    shutil.copy(scenes / "text.blend", tmp_path / "out.exr")
    assert _render(tmp_path, scenes / "room.blend", "-o", "out.exr", "--passes", "1")[0] == 0
    assert _picture(tmp_path / "out.exr")[0].width == 24


# --- a finished picture is not lost ---


def _shell(tmp_path: Path, command: str, **options: Any) -> subprocess.CompletedProcess[str]:
    more = options.pop("env", {})
    run = " ".join(shlex.quote(word) for word in RUN)
    return subprocess.run(
        ["bash", "-c", command.replace("RENDER", run)],
        cwd=tmp_path,
        env=environment(tmp_path / "blender") | more,
        capture_output=True,
        text=True,
        check=False,
        **options,
    )


@pytest.mark.parametrize("stderr", ["2>&-", "2> >(head -c1)", ">&- 2>&-", "<&- >&- 2>&-"])
def test_nobody_reads_the_messages(stderr: str, scenes: Path, tmp_path: Path) -> None:
    done = _shell(
        tmp_path,
        f"RENDER {shlex.quote(str(scenes / 'border.blend'))} -o out.exr --stats stats.json "
        f"--passes 20 {stderr}",
    )
    assert done.returncode == 0
    assert _left(tmp_path) == ["out.exr", "stats.json"]
    assert _picture(tmp_path / "out.exr")[0].width == 12
    assert json.loads((tmp_path / "stats.json").read_text())["warnings"]


def _save_odd_path(folder: str) -> None:
    """Runs inside Blender."""
    import bpy

    stage.room(pixels=16, passes=1, photons=100)
    shade, tree = stage.empty_material("Photo")
    shader, photo = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "TexImage"))
    photo.image = bpy.data.images.new("odd", 1, 1)
    photo.image.source, photo.image.filepath = "FILE", "//gone/\udcff\udce9.png"
    tree.links.new(photo.outputs["Color"], shader.inputs["Color"])
    stage.surface(tree, shader)
    bpy.data.objects["Plane"].data.materials[0] = shade
    bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/odd.blend", compress=False)


def test_a_missing_texture_whose_path_is_no_text(blender: Blender, tmp_path: Path) -> None:
    blender.call(_save_odd_path, {"folder": str(tmp_path)})
    status, errors = _render(
        tmp_path, tmp_path / "odd.blend", "-o", "out.exr", "--stats", "stats.json"
    )
    assert status == 0, errors
    assert "gone/\\xff\\xe9.png cannot be read; shown in pink" in errors
    assert "\\xff" in json.loads((tmp_path / "stats.json").read_text())["warnings"][0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["-o", "out.exr", "--stats", "scene.blend"], "--stats and the scene name the same file"),
        (["-o", "out.exr", "--stats", "link.json"], "--stats and the scene name the same file"),
        (["-o", "picture.exr", "--stats", "same.exr"], "--stats and --output name the same file"),
        (["-o", "itself.exr"], "--output and the scene name the same file"),
        (["-o", "x" * 300 + ".exr"], "cannot be written: File name too long"),
        (["-o", "pipe.exr"], "pipe.exr cannot be written: it is no ordinary file"),
    ],
)
def test_outputs_that_would_be_lost_or_do_harm(
    options: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.blend").write_text("the work of years")
    os.link("scene.blend", "itself.exr")
    os.symlink("scene.blend", "link.json")
    Path("picture.exr").touch()
    os.link("picture.exr", "same.exr")
    os.mkfifo("pipe.exr")
    before = _left(tmp_path)
    _refused(capsys, words, "render", "scene.blend", *options)
    assert Path("scene.blend").read_text() == "the work of years"
    assert _left(tmp_path) == before


def test_links_are_followed_and_the_mode_is_kept(tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    target, link = tmp_path / "far" / "picture.exr", tmp_path / "out.exr"
    link.symlink_to(target)
    replace_file(link, lambda path: path.write_text("one"))
    mask = os.umask(0)
    os.umask(mask)
    assert stat.S_IMODE(target.stat().st_mode) == 0o666 & ~mask
    target.chmod(0o640)
    (tmp_path / "far" / f".picture.{os.getpid()}.partial.exr").write_text("somebody else's")
    replace_file(link, lambda path: path.write_text("two"))
    assert link.is_symlink()
    assert target.read_text() == "two"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert len(os.listdir(tmp_path / "far")) == 2

    def fail(_: Path) -> None:
        raise OSError("no")

    with pytest.raises(WriteError):
        replace_file(link, fail)
    assert target.read_text() == "two"
    assert len(os.listdir(tmp_path / "far")) == 2


def test_a_file_that_cannot_be_replaced_loses_no_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on Windows, while another program has it open."""

    def refuse(*_: object) -> None:
        raise PermissionError(13, "Access is denied")

    (tmp_path / "out.exr").write_text("old")
    (tmp_path / "out.1.exr").write_text("somebody else's")
    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(WriteError) as error:
        replace_file(tmp_path / "out.exr", lambda path: path.write_text("new"))
    kept = tmp_path / "out.2.exr"
    assert str(error.value) == (
        f"{tmp_path / 'out.exr'} could not be written: Access is denied; the new file is {kept}"
    )
    assert kept.read_text() == "new"
    assert (tmp_path / "out.exr").read_text() == "old"
    assert len(os.listdir(tmp_path)) == 3


def test_no_folder_is_left_for_temporary_files(scenes: Path, tmp_path: Path) -> None:
    (tmp_path / "temporary").mkdir()
    environment = {name: str(tmp_path / "temporary") for name in ("TMPDIR", "TMP", "TEMP")}
    done = _shell(
        tmp_path,
        f"RENDER {shlex.quote(str(scenes / 'room.blend'))} -o out.exr --passes 1",
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    assert os.listdir(tmp_path / "temporary") == []


STUCK = """
import ctypes, sys
from photon_splat import cli
def sleep(*arguments):
    sys.stderr.write("here\\n")
    sys.stderr.flush()
    library, mutex = ctypes.PyDLL(None), ctypes.create_string_buffer(64)
    for _ in range(2):  # the second time nobody unlocks it, and no signal wakes us up
        library.pthread_mutex_lock(mutex)
cli.render_frames = sleep
cli.run()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_second_signal_ends_the_process_wherever_it_is(
    number: signal.Signals, tmp_path: Path
) -> None:
    """In a library that waits, without Python's lock given up: no code of ours runs there."""
    (tmp_path / "scene.blend").touch()
    command = [sys.executable, "-c", STUCK, "render", "scene.blend", "-o", "out.exr"]
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        env=environment(tmp_path),
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stderr is not None
        assert process.stderr.readline() == "here\n"
        time.sleep(0.5)
        process.send_signal(number)
        time.sleep(0.2)
        process.send_signal(number)
        assert process.wait(timeout=HANG_SECONDS) == -number
    finally:
        process.kill()


FEW_THREADS = """
import os, resource, sys
if os.getuid() == 0:
    os.setgid(65534), os.setuid(65534)
import bpy
from photon_splat.core.native.library import load
native = load()
processes = [f"/proc/{p}" for p in os.listdir("/proc") if p.isdigit()]
mine = sum(len(os.listdir(f"{p}/task")) for p in processes if os.stat(p).st_uid == os.getuid())
resource.setrlimit(resource.RLIMIT_NPROC, (mine + 2, mine + 2))
print(native.Renderer(16).statistics()["threads"])
os._exit(0)
"""


def test_threads_that_the_system_refuses(tmp_path: Path) -> None:
    tmp_path.chmod(0o777)
    threads = 16
    for _ in range(10):  # processes of the same user that end meanwhile make room for threads
        done = subprocess.run(
            [sys.executable, "-c", FEW_THREADS],
            cwd=tmp_path,
            env=environment(tmp_path),
            capture_output=True,
            text=True,
            check=False,
        )
        if "Permission" in done.stderr or "ModuleNotFound" in done.stderr:
            pytest.skip("an ordinary user cannot read this checkout")
        assert done.returncode == 0, done.stderr
        threads = int(done.stdout.split()[-1])
        if threads < 16:
            break
    assert 1 <= threads < 16
