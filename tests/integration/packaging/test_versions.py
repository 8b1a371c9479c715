"""The native module of an update beside the older one, which the process has loaded before."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.support.native_versions import file_name, relabelled
from tests.support.paths import ROOT

RunPython = Callable[..., subprocess.CompletedProcess[str]]
pytestmark = pytest.mark.smoke
OLDER = "0.0.9"

BOTH = """
import sys
sys.path.insert(0, {root!r})
sys.path.insert(0, {folder!r})
import bpy
from photon_splat.core.native import library
library.engine_version = lambda: {older!r}
older = library.load()
renderer = older.Renderer(1)
library.engine_version = lambda: {current!r}
newer = library.load()
print(older.__version__, newer.__version__, newer is library.load())
print(isinstance(renderer, newer.Renderer), isinstance(newer.Renderer(1), newer.Renderer))
from tests.robustness.test_degenerate import room
from tests.support import corescene as c
print(c.shoot(room(), passes=1, photons_per_pass=1000).passes["Combined"][..., :3].mean() > .01)
"""


def test_the_new_module_is_loaded_beside_the_older_one(
    run_python: RunPython, module_path: Path, tmp_path: Path
) -> None:
    current = version("photon_splat_native")
    older = tmp_path / module_path.name.replace(file_name(current), file_name(OLDER))
    older.write_bytes(relabelled(module_path.read_bytes(), current, OLDER))
    code = BOTH.format(root=str(ROOT), folder=str(tmp_path), older=OLDER, current=current)
    process = run_python(code)
    assert process.returncode == 0, process.stderr
    assert process.stdout.splitlines() == [f"{OLDER} {current} True", "False True", "True"]
    assert "nanobind" not in process.stderr


AT_ONCE = """
import threading
import bpy
from photon_splat.core.native import library
start, found = threading.Barrier(8), []
def load():
    start.wait()
    found.append(library.load())
threads = [threading.Thread(target=load) for _ in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(len(found), len(set(map(id, found))))
"""


def test_threads_that_load_it_at_once_get_one_module(run_python: RunPython) -> None:
    process = run_python(AT_ONCE)
    assert process.returncode == 0, process.stderr
    assert process.stdout.split() == ["8", "1"]
    assert "nanobind" not in process.stderr
