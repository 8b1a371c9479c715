"""Where the rivals are installed, and their renders: processes of their own Python, which `make
setup-rivals` makes or --rivals names.
"""

from __future__ import annotations

import functools
import pickle
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.benchmarks.chart.plan import Case
from tests.support.paths import ROOT
from tests.support.processes import environment

python = ROOT / ".venv-rivals" / "bin" / "python"
"""May be set before the first use."""


def run(command: list[str], seconds: float) -> str:
    """What the command says, and its status; it gets ten times `seconds` and some minutes."""
    with tempfile.TemporaryDirectory(prefix="photon_splat_blender_") as folder:
        done = subprocess.run(
            command,
            cwd=ROOT,
            env=environment(folder),
            timeout=10 * seconds + 300,
            check=False,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
    return f"status {done.returncode}\n{done.stdout}"


@functools.cache
def version(method: str) -> str:
    """Of the library that renders it; empty where that is not installed."""
    if not python.exists():
        return ""
    said = run([str(python), "-m", "tests.benchmarks.chart.rivals.shot", "--version", method], 1.0)
    return next(
        (
            line.removeprefix("version: ")
            for line in said.splitlines()
            if line.startswith("version: ")
        ),
        "",
    )


@functools.cache
def _descriptions(scene: str, width: int, height: int) -> dict[str, dict[str, Any] | str]:
    blend = ROOT / "blend_scenes" / f"{scene}.blend"
    with tempfile.TemporaryDirectory() as scratch:
        output = Path(scratch, "scene.pickle")
        said = run(
            [
                sys.executable,
                "-m",
                "tests.benchmarks.chart.rivals.export",
                str(blend),
                str(width),
                str(height),
                str(output),
            ],
            1.0,
        )
        if not output.exists():
            raise RuntimeError(f"{scene} was not exported: {said[-2000:]}")
        return pickle.loads(output.read_bytes())


def description(case: Case, method: str) -> dict[str, Any] | str:
    """The scene in the rival's words, or why it has none for it."""
    return _descriptions(case.scene, case.width, case.height)[method]


def render(case: Case, method: str, seconds: float, seed: int, output: Path) -> str:
    """Writes the npz of tests.benchmarks.chart.rivals.shot, unless that fails; what it said."""
    with tempfile.TemporaryDirectory() as scratch:
        scene = Path(scratch, "scene.pickle")
        scene.write_bytes(pickle.dumps(description(case, method)))
        return run(
            [
                str(python),
                "-m",
                "tests.benchmarks.chart.rivals.shot",
                method,
                str(scene),
                str(seconds),
                str(seed),
                str(output),
            ],
            seconds,
        )
