"""Where Blender's own libraries are looked for, on each platform."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from photon_splat.core.native import blender_libraries as libraries
from photon_splat.core.native import library


def test_folders_of_a_blender_are_told_from_its_executable() -> None:
    windows = Path("C:/Blender 5.2/blender.exe")
    assert libraries.folders_beside(windows, "win32") == [
        Path("C:/Blender 5.2/blender.shared"),
        Path("C:/Blender 5.2"),
    ]
    mac = Path("/Applications/Blender.app/Contents/MacOS/Blender")
    assert libraries.folders_beside(mac, "darwin") == [
        Path("/Applications/Blender.app/Contents/Resources/lib")
    ]
    assert libraries.folders_beside(Path("/opt/blender/blender"), "linux") == []
    package = Path("bpy")
    assert libraries.folder_in(package, "win32") == package
    for platform in ("linux", "darwin"):
        assert libraries.folder_in(package, platform) == package / "lib"


@pytest.fixture
def windows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A machine with Windows: Blender's folder, and a bpy package, both without libraries."""
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setattr(libraries, "process_executable", lambda: tmp_path / "blender/blender.exe")
    monkeypatch.setattr(libraries, "bpy_package", lambda: tmp_path / "bpy")
    for folder in ("blender/blender.shared", "bpy"):
        (tmp_path / folder).mkdir(parents=True)
    return tmp_path


def test_what_lies_beside_the_executable_comes_before_the_package(windows: Path) -> None:
    name = "embree4.dll"
    assert list(libraries.places(name)) == []
    package = windows / "bpy" / name
    package.touch()
    assert list(libraries.places(name)) == [package]
    beside = windows / "blender" / name
    beside.touch()
    assert list(libraries.places(name)) == [beside, package]
    shared = windows / "blender" / "blender.shared" / name
    shared.touch()
    assert list(libraries.places(name)) == [shared, beside, package]


@pytest.mark.parametrize(
    ("platform", "message", "said"),
    [
        ("linux", "libembree4.so.4: cannot open shared object file", "neither this process nor"),
        ("linux", "photon_splat_native.so: undefined symbol: rtcNewScene", "lacks a function"),
        ("linux", "photon_splat_native.so: undefined symbol: PyLong_AsInt", None),
        ("darwin", "Symbol not found: _rtcNewScene, expected in x.dylib", "lacks a function"),
        ("win32", "DLL load failed while importing photon_splat_native: (jeder Text)", "neither"),
        ("win32", "dynamic module does not define module export function", None),
    ],
)
def test_what_the_system_says_is_told_as_one_reason(
    monkeypatch: pytest.MonkeyPatch, platform: str, message: str, said: str | None
) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    reason = library._reason(message, embree_is_there=False)
    assert (reason is None) if said is None else (reason is not None and said in reason)
