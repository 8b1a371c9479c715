"""Loads the native module `photon_splat_native`, bound to the Embree 4 that Blender ships.

The module asks the dynamic linker for Embree by its name alone. In Blender, and after `import bpy`,
that library is in the process already. Elsewhere (tests of the core) it is loaded here from where
Blender keeps it.
"""

from __future__ import annotations

import ctypes
import importlib
import sys
from types import ModuleType

from .blender_libraries import EMBREE, is_loaded, places

MODULE = "photon_splat_native"


def load() -> ModuleType:
    """The native module. ImportError, with one sentence, where it or a fitting Embree is
    missing.
    """
    if MODULE in sys.modules:
        return sys.modules[MODULE]
    there = is_loaded(EMBREE)
    if not there:
        for library in places(EMBREE):
            ctypes.CDLL(str(library))
            there = True
            break
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
        reason = _reason(str(error), there)
        if reason is None:
            raise
        raise ImportError(
            f"Photon Splat needs the Embree 4 that Blender ships, but {reason}."
        ) from error


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
