"""Loads the native module `photon_splat_native`, bound to the Embree 4 that Blender ships.

The module asks the dynamic linker for Embree by its name alone. In Blender, and after `import bpy`,
that library is in the process already. Elsewhere (tests of the core) it is loaded here from where
Blender keeps it.

The module's file has the engine's version in its name. After an update the process still has the
older module, which no system lets go, and Windows lets nobody replace its file; the new one is
loaded beside it.
"""

from __future__ import annotations

import ctypes
import functools
import importlib.util
import sys
import threading
from types import ModuleType

from ... import version
from .blender_libraries import EMBREE, is_loaded, places

MODULE = "photon_splat_native"
_loading = threading.Lock()


def load() -> ModuleType:
    """The native module. ImportError, with one sentence, where it or a fitting Embree is
    missing.
    """
    with _loading:  # the viewport loads it on a thread of its own
        loaded = sys.modules.get(MODULE)
        if loaded is None or loaded.__version__ != engine_version():
            loaded = sys.modules[MODULE] = _load()
        return loaded


def _load() -> ModuleType:
    file = find()
    if file is None:
        raise ImportError(
            f"Photon Splat's native module {MODULE} {engine_version()} is not installed for this "
            f"Python ({sys.executable})."
        )
    there = is_loaded(EMBREE)
    if not there:
        for library in places(EMBREE):
            ctypes.CDLL(str(library))
            there = True
            break
    spec = importlib.util.spec_from_file_location(MODULE, file)
    assert spec is not None
    assert spec.loader is not None
    try:
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    except ImportError as error:
        reason = _reason(str(error), there)
        if reason is None:
            raise
        raise ImportError(
            f"Photon Splat needs the Embree 4 that Blender ships, but {reason}."
        ) from error
    return module


def find() -> str | None:
    """The file of the native module of the engine's version, in a folder that Python looks in."""
    importlib.invalidate_caches()
    spec = importlib.util.find_spec(f"{MODULE}_{engine_version().replace('.', '_')}")
    return None if spec is None else spec.origin


@functools.cache
def engine_version() -> str:
    return version()


def _reason(message: str, embree_is_there: bool) -> str | None:
    """Why Embree failed the module, by what the system said; None if it was not Embree."""
    missing = f"neither this process nor an installed bpy package has {EMBREE}"
    lacking = f"the {EMBREE} in this process lacks a function of Embree 4"
    if sys.platform == "win32":
        # Windows names neither the library nor the function, and speaks the user's language.
        return None if "DLL load failed" not in message else lacking if embree_is_there else missing
    # dyld names the library that a function was expected in.
    if "symbol: rtc" in message or "Symbol not found: _rtc" in message:
        return lacking
    return missing if EMBREE in message else None
