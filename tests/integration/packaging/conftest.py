"""Helpers for tests that look at the native module from outside: each check runs in a Python
process of its own.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from photon_splat.core.native import library

RunPython = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def module_path() -> Path:
    """The shared object of photon_splat_native, which is not imported."""
    file = library.find()
    assert file is not None, "photon_splat_native is not installed"
    return Path(file)


@pytest.fixture(scope="session")
def bpy_lib() -> Path:
    """The folder of shared libraries that Blender ships, in the bpy package."""
    spec = importlib.util.find_spec("bpy")
    assert spec is not None, "bpy is not installed"
    assert spec.origin is not None
    return Path(spec.origin).parent / "lib"


@pytest.fixture
def run_python(tmp_path: Path) -> RunPython:
    """run_python(code, **environment) runs the code in a new process, with a clean Blender user
    folder.
    """

    def run(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
        clean = {key: value for key, value in os.environ.items() if not key.startswith("LD_")}
        return subprocess.run(
            [sys.executable, "-c", code],
            env=clean | {"BLENDER_USER_RESOURCES": str(tmp_path)} | environment,
            capture_output=True,
            text=True,
            check=False,
        )

    return run
