"""The Python package: the core stands without Blender, and the wheel holds addon/ and shaders/ and
nothing else.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.support.paths import ROOT

RunPython = Callable[..., subprocess.CompletedProcess[str]]
MODULES = sorted(path.relative_to(ROOT / "addon") for path in (ROOT / "addon").rglob("*.py"))

IMPORT_CORE = """
import importlib, pkgutil, sys
import photon_splat.core
modules = pkgutil.walk_packages(photon_splat.core.__path__, "photon_splat.core.")
names = [module.name for module in modules]
for name in names:
    importlib.import_module(name)
blender = ("bpy", "mathutils", "_bpy")
print(len(names), sorted(name for name in sys.modules if name.split(".")[0] in blender))
"""


def test_the_version_is_stated_once() -> None:
    """By the extension's manifest; everything else reads it there."""
    stated = tomllib.loads((ROOT / "addon/blender_manifest.toml").read_text())["version"]
    for path in (
        "pyproject.toml",
        "setup.py",
        "native/pyproject.toml",
        "native/CMakeLists.txt",
        "README.md",
        "Makefile",
    ):
        assert stated not in (ROOT / path).read_text(), path
    assert version("photon_splat_native") == version("photon-splat") == stated


@pytest.mark.smoke
def test_the_core_imports_no_blender(run_python: RunPython) -> None:
    process = run_python(IMPORT_CORE)
    expected = sum(path.parts[0] == "core" for path in MODULES) - 1
    assert process.stdout.strip() == f"{expected} []", process.stderr


def test_the_wheel_holds_every_module_the_shaders_and_the_manifest(tmp_path: Path) -> None:
    source = tmp_path / "source"
    for name in ("addon", "shaders"):
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "setup.py", "LICENSE"):
        shutil.copy(ROOT / name, source)
    command = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "-q",
        "--no-build-isolation",
        "--no-deps",
        "--disable-pip-version-check",
    ]
    subprocess.run([*command, "-w", tmp_path, source], check=True)
    (wheel,) = tmp_path.glob("photon_splat-*-py3-none-any.whl")
    names = zipfile.ZipFile(wheel).namelist()
    payload = {name for name in names if ".dist-info/" not in name}
    shaders = [path.relative_to(ROOT) for path in (ROOT / "shaders").iterdir()]
    assert payload == {
        f"photon_splat/{path.as_posix()}"
        for path in [*MODULES, *shaders, Path("blender_manifest.toml")]
    }
