"""Shared libraries that Blender ships and this engine uses: their names and places by platform.

Inside Blender, and after `import bpy`, a library may be in the process already; then that one is
used. Else it is looked for where Blender keeps it: `blender.shared` beside Blender's executable on
Windows, `../Resources/lib` from it on macOS, and the folder of an installed bpy package, which is
not imported for that.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
import sys
from collections.abc import Iterator
from pathlib import Path

_NAMES = {
    "linux": ("libembree4.so.4", "libOpenImageDenoise.so.2"),
    "win32": ("embree4.dll", "OpenImageDenoise.dll"),
    "darwin": ("libembree4.dylib", "libOpenImageDenoise.dylib"),
}
EMBREE, DENOISER = _NAMES.get(sys.platform, _NAMES["linux"])


def is_loaded(name: str) -> bool:
    """Whether the library is in this process."""
    if sys.platform == "win32":
        return bool(_kernel32().GetModuleHandleW(name))
    try:
        ctypes.CDLL(name, mode=os.RTLD_NOLOAD | os.RTLD_NOW)
    except OSError:
        return False
    return True


def places(name: str) -> Iterator[Path]:
    """Files of that name among Blender's libraries, the first one first."""
    executable = process_executable()
    folders = [] if executable is None else folders_beside(executable, sys.platform)
    package = bpy_package()
    if package is not None:
        folders.append(folder_in(package, sys.platform))
    return (folder / name for folder in folders if (folder / name).is_file())


def folders_beside(executable: Path, platform: str) -> list[Path]:
    """Where a Blender with this executable would keep its libraries. On Linux they are in the
    process.
    """
    if platform == "win32":
        return [executable.parent / "blender.shared", executable.parent]
    if platform == "darwin":
        return [executable.parent.parent / "Resources" / "lib"]
    return []


def folder_in(package: Path, platform: str) -> Path:
    """Where the bpy package in this folder keeps its libraries."""
    return package if platform == "win32" else package / "lib"


def bpy_package() -> Path | None:
    """The folder of the installed bpy package, which is not imported."""
    try:
        spec = importlib.util.find_spec("bpy")
    except ValueError:  # the bpy inside a Blender executable has no spec
        return None
    return None if spec is None or spec.origin is None else Path(spec.origin).parent


def process_executable() -> Path | None:
    """The program that this process runs: Blender or Python. None where that is not asked for."""
    if sys.platform == "win32":
        name = ctypes.create_unicode_buffer(32768)  # the longest path that there is
        length = _kernel32().GetModuleFileNameW(None, name, len(name))
        return Path(name.value) if 0 < length < len(name) else None
    if sys.platform == "darwin":
        size = ctypes.c_uint32(4096)
        path = ctypes.create_string_buffer(size.value)
        if ctypes.CDLL(None)._NSGetExecutablePath(path, ctypes.byref(size)) == 0:
            return Path(os.path.realpath(os.fsdecode(path.value)))
    return None


def _kernel32() -> ctypes.CDLL:
    from ctypes import wintypes

    library = ctypes.WinDLL("kernel32")  # type: ignore[attr-defined, unused-ignore]
    library.GetModuleHandleW.argtypes = [wintypes.LPCWSTR]
    library.GetModuleHandleW.restype = wintypes.HMODULE
    library.GetModuleFileNameW.argtypes = [wintypes.HMODULE, wintypes.LPWSTR, wintypes.DWORD]
    library.GetModuleFileNameW.restype = wintypes.DWORD
    return library  # type: ignore[no-any-return, unused-ignore]
