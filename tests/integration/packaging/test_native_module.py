"""The shared object: what it shows to the process, and what it asks of it."""

from __future__ import annotations

import re
import subprocess
from importlib.metadata import files
from pathlib import Path

import pytest
from photon_splat.core.native.library import load

pytestmark = pytest.mark.smoke


def test_exports_the_init_function_only(module_path: Path) -> None:
    listing = subprocess.run(
        ["nm", "-D", "--defined-only", module_path], capture_output=True, text=True, check=True
    ).stdout
    assert [line.split()[-1] for line in listing.splitlines()] == ["PyInit_photon_splat_native"]


def test_asks_for_embree_by_its_soname_and_for_no_other_library_of_blender(
    module_path: Path,
) -> None:
    dynamic = subprocess.run(
        ["readelf", "-d", module_path], capture_output=True, text=True, check=True
    ).stdout
    needed = set(re.findall(r"\(NEEDED\).*\[(.+?)\]", dynamic))
    system = {
        "libstdc++.so.6",
        "libgcc_s.so.1",
        "libm.so.6",
        "libc.so.6",
        "libpthread.so.0",
        "ld-linux-x86-64.so.2",
    }
    assert needed - system == {"libembree4.so.4"}
    assert "RPATH" not in dynamic
    assert "RUNPATH" not in dynamic


def test_the_wheel_holds_the_module_and_its_types_alone(module_path: Path) -> None:
    installed = files("photon_splat_native")
    assert installed is not None
    payload = [file.as_posix() for file in installed if ".dist-info/" not in file.as_posix()]
    assert sorted(payload) == ["photon_splat_native-stubs/__init__.pyi", module_path.name]


def test_every_function_says_what_it_does() -> None:
    """Beyond the signature, which nanobind writes into each docstring."""
    native = load()
    silent = [
        f"{owner.__name__}.{name}"
        for owner in (native, native.Renderer, native.RenderOptions)
        for name, member in vars(owner).items()
        if not name.startswith("_") and (callable(member) or isinstance(member, property))
        if not isinstance(member, type) and not _sentences(member.__doc__)
    ]
    assert silent == []


def _sentences(docstring: str | None) -> str:
    """What follows the line of the signature, if there is one."""
    first, _, rest = (docstring or "").partition("\n")
    return rest.strip() if "->" in first else first
