"""Loads the native module `photon_splat_native`, bound to the Embree 4 that Blender ships.

The module asks the dynamic linker for Embree by its soname alone. In Blender, and after `import
bpy`, that library is in the process already. Without bpy (tests of the core) it is loaded here from
the installed bpy package, which is not imported for that.
"""

from __future__ import annotations

import ctypes
import importlib
import importlib.util
import os
import sys
from pathlib import Path
from types import ModuleType

MODULE = "photon_splat_native"
EMBREE = "libembree4.so.4"


def load() -> ModuleType:
    """The native module. ImportError, with one sentence, where it or a fitting Embree is
    missing.
    """
    if MODULE in sys.modules:
        return sys.modules[MODULE]
    if sys.platform == "linux" and not _is_loaded(EMBREE):
        library = bpy_library(EMBREE)
        if library is not None:
            ctypes.CDLL(str(library))
    try:
        return importlib.import_module(MODULE)
    except ModuleNotFoundError as error:
        if error.name != MODULE:
            raise
        raise ImportError(
            f"Photon Splat's native module {MODULE} is not installed for this Python "
            f"({sys.executable})."
        ) from error
    except ImportError as error:
        if EMBREE in str(error):
            reason = f"neither this process nor an installed bpy package has {EMBREE}"
        elif "undefined symbol: rtc" in str(error):
            reason = f"the {EMBREE} in this process lacks a function of Embree 4"
        else:
            raise
        raise ImportError(
            f"Photon Splat needs the Embree 4 that Blender ships, but {reason}."
        ) from error


def bpy_library(soname: str) -> Path | None:
    """The shared library of that name inside the installed bpy package, which is not imported."""
    try:
        spec = importlib.util.find_spec("bpy")
    except ValueError:  # the bpy inside a Blender executable has no spec
        return None
    if spec is None or spec.origin is None:
        return None
    path = Path(spec.origin).parent / "lib" / soname
    return path if path.is_file() else None


def _is_loaded(soname: str) -> bool:
    try:
        ctypes.CDLL(soname, mode=os.RTLD_NOLOAD | os.RTLD_NOW)
    except OSError:
        return False
    return True
