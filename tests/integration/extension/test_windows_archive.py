"""The archive for Windows: what it holds, and what its native module asks of Windows and Blender.
What it does is tested under Wine (make wine-test).
"""

from __future__ import annotations

import os
import re
import subprocess
import tomllib
import zipfile
from pathlib import Path

import pytest

from tests.support.paths import ROOT

ARCHIVES = sorted(
    Path(os.environ.get("PHOTON_SPLAT_DIST", ROOT / "dist")).glob("photon_splat-*-windows_x64.zip")
)
SYSTEM = re.compile(r"(?:KERNEL32|ADVAPI32|api-ms-win-crt-[\w-]+)\.dll")
SHIPPED = ("numpy", "embree", "tbb", "OpenImageIO", "oiio", "bpy")

pytestmark = pytest.mark.skipif(
    not ARCHIVES, reason="there is no archive for Windows in dist/: make extension-all builds it"
)


def wheels() -> list[str]:
    with zipfile.ZipFile(ARCHIVES[-1]) as archive:
        return [name for name in archive.namelist() if name.endswith(".whl")]


def test_it_is_for_windows_alone() -> None:
    with zipfile.ZipFile(ARCHIVES[-1]) as archive:
        names = archive.namelist()
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    assert manifest["platforms"] == ["windows-x64"]
    assert sorted(manifest["wheels"]) == sorted(f"./{name}" for name in wheels())
    assert all(name.endswith("-win_amd64.whl") for name in wheels())
    kinds = {name.removeprefix("wheels/").split("-")[0] for name in wheels()}
    assert kinds == {"photon_splat_native", "moderngl", "glcontext"}
    assert {"__init__.py", "shaders/splat.vert", "LICENSE"} <= set(names)
    assert not [name for name in names if "__pycache__" in name]


def test_every_module_serves_a_python_of_blenders() -> None:
    """The stable one serves Python 3.12 and later; moderngl has one for each."""
    pythons = {
        re.search(r"moderngl-[\d.]+-(cp\d+)-", name)[1] for name in wheels() if "moderngl" in name
    }  # type: ignore[index]
    native = [name for name in wheels() if "photon_splat_native" in name]
    stable = any("-cp312-abi3-" in name for name in native)
    for python in pythons:
        assert any(f"-{python}-{python}-" in name for name in native) or (
            stable and int(python[3:]) >= 12
        ), python
    assert "cp313" in pythons


def test_the_module_asks_for_python_embree_and_windows_alone(tmp_path: Path) -> None:
    for name in wheels():
        if "photon_splat_native" not in name:
            continue
        with zipfile.ZipFile(ARCHIVES[-1]) as archive, archive.open(name) as file:
            inside = zipfile.ZipFile(file)
            (module,) = (entry for entry in inside.namelist() if ".dist-info/" not in entry)
            assert re.fullmatch(r"photon_splat_native_\d+_\d+_\d+\.pyd", module)
            assert not [entry for entry in inside.namelist() for part in SHIPPED if part in entry]
            path = Path(inside.extract(module, tmp_path))
        listing = subprocess.run(
            ["objdump", "-p", path], capture_output=True, text=True, check=True
        ).stdout
        libraries = set(re.findall(r"DLL Name: (\S+)", listing))
        python = "python3.dll" if "-abi3-" in name else "python311.dll"
        others = {library for library in libraries if not SYSTEM.fullmatch(library)}
        assert others == {python, "embree4.dll"}
        exported = re.findall(
            r"\[ +\d+\] (?:\+base\[ +\d+\] +[0-9a-f]+ )?([A-Za-z_]\w*)$", listing, re.MULTILINE
        )
        # What nanobind marks for export is seen by those that link to this module: by nobody.
        ours = [name for name in exported if "8nanobind" not in name]
        assert ours == ["PyInit_photon_splat_native"]
