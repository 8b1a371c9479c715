"""Open Image Denoise, as Blender ships it, by its C interface.

The library is looked up by its soname: inside Blender, and after `import bpy`, it is in the process or beside Blender's
other libraries. Nothing is bundled.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .native import bpy_library

LIBRARY = "libOpenImageDenoise.so.2"
DEVICE_CPU = 1
FLOAT3 = 3

_MONITOR = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_double)


class DenoiserMissing(Exception):
    """There is no Open Image Denoise here; the message says what was looked for."""


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    candidates = [LIBRARY]
    beside = bpy_library(LIBRARY)
    if beside is not None:
        candidates.append(str(beside))
    for name in candidates:
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        handle = ctypes.c_void_p
        for function, result, arguments in (
            ("oidnNewDevice", handle, [ctypes.c_int]),
            ("oidnCommitDevice", None, [handle]),
            ("oidnReleaseDevice", None, [handle]),
            ("oidnSetDeviceInt", None, [handle, ctypes.c_char_p, ctypes.c_int]),
            ("oidnSetDeviceBool", None, [handle, ctypes.c_char_p, ctypes.c_bool]),
            ("oidnGetDeviceError", ctypes.c_int, [handle, ctypes.POINTER(ctypes.c_char_p)]),
            ("oidnNewFilter", handle, [handle, ctypes.c_char_p]),
            ("oidnReleaseFilter", None, [handle]),
            ("oidnSetSharedFilterImage", None, [handle, ctypes.c_char_p, handle, ctypes.c_int] + [ctypes.c_size_t] * 5),
            ("oidnSetFilterBool", None, [handle, ctypes.c_char_p, ctypes.c_bool]),
            ("oidnSetFilterProgressMonitorFunction", None, [handle, _MONITOR, handle]),
            ("oidnCommitFilter", None, [handle]),
            ("oidnExecuteFilter", None, [handle]),
        ):
            entry = getattr(library, function)
            entry.restype, entry.argtypes = result, arguments
        return library
    raise DenoiserMissing(f"the denoiser needs {LIBRARY}, which Blender ships and which has not been found here")


def available() -> bool:
    try:
        _library()
    except DenoiserMissing:
        return False
    return True


def denoise(
    color: NDArray[np.float32],
    albedo: NDArray[np.float32],
    normal: NDArray[np.float32],
    *,
    threads: int = 0,
    should_cancel: Callable[[], bool] | None = None,
) -> NDArray[np.float32]:
    """`color` (height, width, 3), linear, without its noise; the features, of the same shape, are taken as free of noise.

    threads: 0 = all. A cancelled run returns `color` as it came. DenoiserMissing, or RuntimeError with the library's message.
    """
    library = _library()
    color, albedo, normal = (np.ascontiguousarray(a, np.float32) for a in (color, np.clip(albedo, 0.0, 1.0), normal))
    output = np.empty_like(color)
    height, width = color.shape[:2]
    cancelled = False

    def monitor(_: int | None, __: float) -> bool:
        nonlocal cancelled
        cancelled = cancelled or (should_cancel is not None and should_cancel())
        return not cancelled

    device = library.oidnNewDevice(DEVICE_CPU)
    if not device:
        raise RuntimeError("Open Image Denoise could not be started")
    monitor_function = _MONITOR(monitor)
    filter_handle = None
    try:
        if threads:
            library.oidnSetDeviceInt(device, b"numThreads", threads)
        library.oidnSetDeviceBool(device, b"setAffinity", False)
        library.oidnCommitDevice(device)
        filter_handle = library.oidnNewFilter(device, b"RT")
        for name, image in ((b"color", color), (b"albedo", albedo), (b"normal", normal), (b"output", output)):
            library.oidnSetSharedFilterImage(filter_handle, name, image.ctypes.data, FLOAT3, width, height, 0, 0, 0)
        library.oidnSetFilterBool(filter_handle, b"hdr", True)
        library.oidnSetFilterBool(filter_handle, b"cleanAux", True)
        library.oidnSetFilterProgressMonitorFunction(filter_handle, monitor_function, None)
        library.oidnCommitFilter(filter_handle)
        library.oidnExecuteFilter(filter_handle)
        message = ctypes.c_char_p()
        if library.oidnGetDeviceError(device, ctypes.byref(message)) and not cancelled:
            raise RuntimeError(f"Open Image Denoise failed: {(message.value or b'unknown error').decode()}")
    finally:
        if filter_handle:
            library.oidnReleaseFilter(filter_handle)
        library.oidnReleaseDevice(device)
    return color if cancelled else output
