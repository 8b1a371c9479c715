"""photon-splat farm: what it writes is run by what it is for, or by what stands in for that."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from photon_splat.farm import Animation, FarmError, Job, Still, System, write_bundle
from photon_splat.farm.job import ranges

from tests.integration.farm.command import call, picture
from tests.support.paths import environment

COMMAND = Path(sys.executable).with_name("photon-splat")
OPENJD = Path(sys.executable).with_name("openjd")


def test_ranges_of_frames() -> None:
    assert ranges([1, 2, 3, 4, 7]) == "1-4,7"
    assert ranges([5]) == "5"
    assert ranges([-2, -1, 0, 2]) == "-2-0,2"
    assert Animation(tuple(range(1, 8)), 3).chunks == ["1-3", "4-6", "7"]
    assert Animation((1, 3, 5), 2).chunks == ["1,3", "5"]


def test_jobs_that_make_no_sense() -> None:
    with pytest.raises(FarmError, match=r"^0 parts are not between 1 and 1024$"):
        Still(1, 0)
    with pytest.raises(FarmError, match=r"^2000 chunks of frames are more than 1024"):
        Animation(tuple(range(2000)), 1)
    with pytest.raises(FarmError, match=r"^there are no chunks of 0 of 3 frames$"):
        Animation((1, 2, 3), 0)


@pytest.mark.parametrize(
    ("what", "options", "doubts"),
    [
        (Still(1, 4), ("--passes", "8"), True),
        (Still(1, 4), ("--passes=8",), True),
        (Still(1, 4), ("--passes", "16"), False),
        (Still(1, 4), ("--passes", "8", "--seconds", "60"), False),
        (Still(1, 1), ("--passes", "8"), False),
        (Still(1, 4), (), False),
        (Animation((1, 2), 1), ("--passes", "8"), False),
    ],
)
def test_parts_of_few_passes_are_doubted(
    what: Still | Animation, options: tuple[str, ...], doubts: bool
) -> None:
    sentence = Job("s", "s.blend", "out", what, options=options).doubt()
    assert bool(sentence) is doubts
    if doubts:
        assert sentence.startswith("a part of 8 passes does little")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["gone.blend", "--still", "2"], "gone.blend does not exist"),
        (["s.blend"], "one of the arguments --still --animation is required"),
        (["s.blend", "--still", "2", "--frame", "1", "--pases", "3"], "unrecognized arguments"),
        (["s.blend", "--still", "2", "--frames", "1"], "--frames needs --animation"),
        (["s.blend", "--animation", "--frame", "1"], "--frame needs --still"),
        (["s.blend", "--still", "2", "--for", "cron"], "invalid choice: 'cron'"),
    ],
)
def test_commands_that_make_no_sense(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    from photon_splat.cli import main

    monkeypatch.chdir(tmp_path)
    Path("s.blend").touch()
    assert main(["farm", *arguments, "-o", "bundle"]) == 1
    assert words in capsys.readouterr().err
    assert not Path("bundle").exists()


def test_limits_of_the_file_are_those_of_all_parts(scenes: Path, tmp_path: Path) -> None:
    """The file has 4 passes; frames are those of the scene."""
    status, _, errors = call(tmp_path, "farm", scenes / "room.blend", "--still", 3, "-o", "still")
    assert status == 0
    assert "warning: a part of 2 passes does little" in errors
    template = json.loads((tmp_path / "still/template.json").read_text())
    arguments = template["steps"][0]["script"]["actions"]["onRun"]["args"]
    assert arguments[arguments.index("--passes") + 1] == "2"
    assert "--error" not in arguments
    assert call(tmp_path, "farm", scenes / "room.blend", "--animation", "-o", "all")[0] == 0
    template = json.loads((tmp_path / "all/template.json").read_text())
    task = template["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0]
    assert (task["range"][0], task["range"][-1], len(task["range"])) == ("1-5", "246-250", 50)


def test_names_that_the_code_page_lacks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is said there through a pipe is UTF-8."""
    monkeypatch.setenv("PYTHONIOENCODING", "cp1252")
    (tmp_path / "Küche 部屋.blend").touch()
    arguments = ("Küche 部屋.blend", "--animation", "--frames", "1-3", "-o", "Auftrag 光")
    status, output, errors = call(tmp_path, "farm", *arguments)
    assert status == 0, errors
    assert output.startswith("Auftrag 光 is written. Next: ")


# --- Open Job Description, by its own command ---


def _openjd(tmp_path: Path, bundle: str) -> tuple[int, str]:
    done = subprocess.run(
        [
            OPENJD,
            "run",
            f"{bundle}/template.json",
            "-p",
            f"file://{tmp_path}/{bundle}/parameters.json",
        ],
        cwd=tmp_path,
        env=environment(tmp_path / "blender"),
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout + done.stderr


def _write(
    tmp_path: Path, scene: Path, what: Still | Animation, system: System, **more: Any
) -> None:
    job = Job(scene.stem, str(scene), str(tmp_path / "out"), what, str(COMMAND), **more)
    write_bundle(job, system, tmp_path / "bundle")


def test_openjd_renders_and_merges(scenes: Path, tmp_path: Path) -> None:
    _write(tmp_path, scenes / "room.blend", Still(1, 3), System.OPENJD, options=("--passes", "2"))
    status, said = _openjd(tmp_path, "bundle")
    assert status == 0, said
    assert "openjd_progress: 100" in said
    assert picture(tmp_path / "out/room.exr")["R"].mean() > 0
    assert len(list((tmp_path / "out/parts").iterdir())) == 3


def test_one_failing_task_fails_the_job_and_nothing_is_merged(scenes: Path, tmp_path: Path) -> None:
    failing = tmp_path / "failing"
    failing.write_text(f'#!/bin/sh\ncase "$*" in *"--part 2/3"*) exit 3;; esac\n"{COMMAND}" "$@"\n')
    failing.chmod(0o755)
    job = Job("room", str(scenes / "room.blend"), str(tmp_path / "out"), Still(1, 3), str(failing))
    write_bundle(job, System.OPENJD, tmp_path / "bundle")
    status, _ = _openjd(tmp_path, "bundle")
    assert status != 0
    assert not (tmp_path / "out/room.exr").exists()


def test_openjd_renders_frames(scenes: Path, tmp_path: Path) -> None:
    what = Animation((1, 2, 4), 2)
    _write(tmp_path, scenes / "moving.blend", what, System.OPENJD, options=("--passes", "1"))
    status, said = _openjd(tmp_path, "bundle")
    assert status == 0, said
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [
        "moving_0001.exr",
        "moving_0002.exr",
        "moving_0004.exr",
    ]


# --- Flamenco: its job types in a JavaScript engine, with an author that only writes down ---

AUTHOR = """
const tasks = [];
const author = {
  Task: (name, type) => ({
    name, type, commands: [], after: [],
    addCommand(command) { this.commands.push(command); },
    addDependency(task) { this.after.push(task.name); },
  }),
  Command: (name, parameters) => ({ name, parameters }),
};
const job = { settings: SETTINGS, addTask(task) { tasks.push(task); } };
function frameChunker(frames, size) { return CHUNKS; }
SCRIPT
compileJob(job);
console.log(JSON.stringify({ type: JOB_TYPE, tasks }));
"""


def _compiled(bundle: Path, chunks: list[str]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The job type, and the tasks that it makes of job.json."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("there is no node, which would run Flamenco's job types")
    (script,) = bundle.glob("*.js")
    request = json.loads((bundle / "job.json").read_text())
    assert request["type"].replace("-", "_") == script.stem
    text = (
        AUTHOR.replace("SETTINGS", json.dumps(request["settings"]))
        .replace("CHUNKS", json.dumps(chunks))
        .replace("SCRIPT", script.read_text())
    )
    done = subprocess.run([node, "-e", text], capture_output=True, text=True, check=True)
    told = json.loads(done.stdout)
    wanted = {s["key"] for s in told["type"]["settings"] if s["required"]}
    assert wanted <= request["settings"].keys()
    assert request["settings"].keys() <= {s["key"] for s in told["type"]["settings"]}
    return told["type"], told["tasks"]


def _execute(tmp_path: Path, task: dict[str, Any]) -> None:
    for command in task["commands"]:
        assert command["name"] == "exec"
        assert command["parameters"]["exe"] == "{photonSplat}"
        done = subprocess.run(
            [COMMAND, *command["parameters"]["args"]],
            cwd=tmp_path,
            env=environment(tmp_path / "blender"),
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr


def test_flamenco_renders_and_merges(scenes: Path, tmp_path: Path) -> None:
    _write(tmp_path, scenes / "room.blend", Still(1, 2), System.FLAMENCO, options=("--passes", "2"))
    _, tasks = _compiled(tmp_path / "bundle", [])
    assert [task["name"] for task in tasks] == ["part-1", "part-2", "merge"]
    assert tasks[-1]["after"] == ["part-1", "part-2"]
    for task in tasks:
        _execute(tmp_path, task)
    assert picture(tmp_path / "out/room.exr")["R"].mean() > 0


def test_flamenco_renders_frames(scenes: Path, tmp_path: Path) -> None:
    what = Animation((1, 2, 3), 2)
    _write(tmp_path, scenes / "moving.blend", what, System.FLAMENCO, options=("--passes", "1"))
    request = json.loads((tmp_path / "bundle/job.json").read_text())
    assert request["settings"]["frames"] == "1-3"
    _, tasks = _compiled(tmp_path / "bundle", ["1-2", "3"])
    _execute(tmp_path, tasks[1])
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["moving_0003.exr"]


# --- Slurm: the scripts, with commands that stand in for Slurm's. make farm-test has the real ones.


def _stand_in(folder: Path, name: str, text: str) -> None:
    folder.mkdir(exist_ok=True)
    (folder / name).write_text(f"#!/bin/bash\n{text}\n")
    (folder / name).chmod(0o755)


def test_slurm_submits_an_array_and_a_merge_after_it(tmp_path: Path) -> None:
    job = Job("room", "/shared/a room.blend", str(tmp_path / "out put"), Still(7, 4))
    then = write_bundle(job, System.SLURM, tmp_path / "bundle")
    assert then == f"'{tmp_path}/bundle/submit.sh'"
    _stand_in(tmp_path / "bin", "sbatch", 'echo "$PWD $*" >> "$LOG"; echo 41')
    done = subprocess.run(
        [tmp_path / "bundle/submit.sh", "--partition=render"],
        env=os.environ | {"PATH": f"{tmp_path}/bin:{os.environ['PATH']}", "LOG": f"{tmp_path}/log"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "render: 41\nmerge: 41\n"
    assert (tmp_path / "log").read_text().splitlines() == [
        f"{tmp_path}/bundle --parsable --partition=render render.sbatch",
        f"{tmp_path}/bundle --parsable --partition=render --dependency=afterok:41 "
        "--kill-on-invalid-dep=yes merge.sbatch",
    ]
    assert (tmp_path / "out put/logs").is_dir()
    assert "#SBATCH --array=1-4\n" in (tmp_path / "bundle/render.sbatch").read_text()


@pytest.mark.parametrize("what", [Still(7, 4), Animation((1, 2, 3, 9), 2)])
def test_a_task_of_slurm_has_its_arguments(what: Still | Animation, tmp_path: Path) -> None:
    _stand_in(tmp_path / "bin", "photon-splat", 'printf "%s\\n" "$@"')
    job = Job("room", "/shared/a room.blend", "/shared/o", what)
    write_bundle(job, System.SLURM, tmp_path / "bundle")
    done = subprocess.run(
        ["bash", tmp_path / "bundle/render.sbatch"],
        env=os.environ
        | {"PATH": f"{tmp_path}/bin:{os.environ['PATH']}", "SLURM_ARRAY_TASK_ID": "2"},
        capture_output=True,
        text=True,
        check=True,
    )
    expected = (
        job.render("/shared/a room.blend", "/shared/o", "2", "4")
        if isinstance(what, Still)
        else job.render("/shared/a room.blend", "/shared/o", "3,9", "")
    )
    assert done.stdout.splitlines() == expected


@pytest.mark.parametrize(("status", "requeued"), [(75, True), (1, True), (0, False)])
def test_a_task_that_slurm_ends_is_queued_again(
    status: int, requeued: bool, tmp_path: Path
) -> None:
    _stand_in(
        tmp_path / "bin",
        "photon-splat",
        f"trap 'exit {status}' TERM; touch {tmp_path}/began; while :; do sleep 0.05; done",
    )
    _stand_in(tmp_path / "bin", "scontrol", f'echo "$*" > {tmp_path}/requeue; exit 1')
    write_bundle(Job("room", "s.blend", "o", Still(1, 4)), System.SLURM, tmp_path / "bundle")
    process = subprocess.Popen(
        ["bash", tmp_path / "bundle/render.sbatch"],
        env=os.environ
        | {
            "PATH": f"{tmp_path}/bin:{os.environ['PATH']}",
            "SLURM_ARRAY_TASK_ID": "2",
            "SLURM_ARRAY_JOB_ID": "41",
        },
    )
    try:
        while not (tmp_path / "began").exists():
            time.sleep(0.02)
        process.send_signal(signal.SIGTERM)
        assert process.wait() == status
    finally:
        process.kill()
    assert (tmp_path / "requeue").exists() == requeued
    if requeued:
        assert (tmp_path / "requeue").read_text() == "requeue 41_2\n"
