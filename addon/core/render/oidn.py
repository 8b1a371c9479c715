"""The C interface of Open Image Denoise, as Blender ships it: devices, and filters run on them.

The library is looked up by its name: inside Blender, and after `import bpy`, it is in the process
or beside Blender's other libraries. Nothing is bundled.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..native.blender_libraries import DENOISER, places

CPU = 1
FLOAT3 = 3
QUALITY_FAST, QUALITY_BALANCED = 4, 5

_HANDLE, _TEXT, _INT, _SIZE = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_size_t
_MONITOR = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_double)
_FUNCTIONS: tuple[tuple[str, Any, list[Any]], ...] = (
    ("oidnGetNumPhysicalDevices", _INT, []),
    ("oidnGetPhysicalDeviceInt", _INT, [_INT, _TEXT]),
    ("oidnGetPhysicalDeviceString", _TEXT, [_INT, _TEXT]),
    ("oidnNewDevice", _HANDLE, [_INT]),
    ("oidnNewDeviceByID", _HANDLE, [_INT]),
    ("oidnCommitDevice", None, [_HANDLE]),
    ("oidnReleaseDevice", None, [_HANDLE]),
    ("oidnSetDeviceInt", None, [_HANDLE, _TEXT, _INT]),
    ("oidnSetDeviceBool", None, [_HANDLE, _TEXT, ctypes.c_bool]),
    ("oidnGetDeviceError", _INT, [_HANDLE, ctypes.POINTER(_TEXT)]),
    ("oidnNewBuffer", _HANDLE, [_HANDLE, _SIZE]),
    ("oidnReleaseBuffer", None, [_HANDLE]),
    ("oidnWriteBuffer", None, [_HANDLE, _SIZE, _SIZE, _HANDLE]),
    ("oidnReadBuffer", None, [_HANDLE, _SIZE, _SIZE, _HANDLE]),
    ("oidnNewFilter", _HANDLE, [_HANDLE, _TEXT]),
    ("oidnReleaseFilter", None, [_HANDLE]),
    ("oidnSetFilterImage", None, [_HANDLE, _TEXT, _HANDLE, _INT] + [_SIZE] * 5),
    ("oidnSetSharedFilterImage", None, [_HANDLE, _TEXT, _HANDLE, _INT] + [_SIZE] * 5),
    ("oidnSetFilterBool", None, [_HANDLE, _TEXT, ctypes.c_bool]),
    ("oidnSetFilterInt", None, [_HANDLE, _TEXT, _INT]),
    ("oidnSetFilterFloat", None, [_HANDLE, _TEXT, ctypes.c_float]),
    ("oidnSetFilterProgressMonitorFunction", None, [_HANDLE, _MONITOR, _HANDLE]),
    ("oidnCommitFilter", None, [_HANDLE]),
    ("oidnExecuteFilter", None, [_HANDLE]),
)


class DenoiserMissing(Exception):
    """There is no Open Image Denoise here; the message says what was looked for."""


class DeviceFailed(RuntimeError):
    """What a device says of itself."""


@lru_cache(maxsize=1)
def library() -> ctypes.CDLL:
    for name in (DENOISER, *map(str, places(DENOISER))):
        try:
            found = ctypes.CDLL(name)
        except OSError:
            continue
        for function, result, arguments in _FUNCTIONS:
            entry = getattr(found, function)
            entry.restype, entry.argtypes = result, arguments
        return found
    raise DenoiserMissing(
        f"the denoiser needs {DENOISER}, which Blender ships and which has not been found here"
    )


class Device:
    """What runs filters. card: the graphics card's name, empty for the processor.

    A card has memory of its own, so that images go to and fro.
    """

    def __init__(self, handle: int | None, card: str = "") -> None:
        self.card = card
        self._handle = handle
        self._library = library()
        if not handle:
            raise DeviceFailed("Open Image Denoise could not be started")

    def commit(self) -> None:
        self._library.oidnCommitDevice(self._handle)

    def set_threads(self, threads: int) -> None:
        """0 = all."""
        if threads:
            self._library.oidnSetDeviceInt(self._handle, b"numThreads", threads)
        self._library.oidnSetDeviceBool(self._handle, b"setAffinity", False)

    def check(self) -> None:
        """DeviceFailed, with its own message, if anything has gone wrong since the last check."""
        message = ctypes.c_char_p()
        if self._library.oidnGetDeviceError(self._handle, ctypes.byref(message)):
            raise DeviceFailed(
                f"Open Image Denoise failed: {(message.value or b'unknown error').decode()}"
            )

    def release(self) -> None:
        self._library.oidnReleaseDevice(self._handle)

    @contextmanager
    def filter(self) -> Iterator[Filter]:
        made = Filter(self._library, self._handle, copies=bool(self.card))
        try:
            yield made
        finally:
            made.release()


class Filter:
    """One run of a filter for colors or features. copies: into buffers of the device and back."""

    def __init__(self, lib: ctypes.CDLL, device: int | None, copies: bool) -> None:
        self._library, self._device, self._copies = lib, device, copies
        self._handle = lib.oidnNewFilter(device, b"RT")
        self._buffers: list[int | None] = []  # None: there was no memory, as check() will tell
        self._monitor = _MONITOR()

    def set(self, name: bytes, value: bool | int | float) -> None:
        kind = "Bool" if isinstance(value, bool) else type(value).__name__.capitalize()
        getattr(self._library, f"oidnSetFilter{kind}")(self._handle, name, value)

    def set_image(self, name: bytes, image: NDArray[np.float32], given: bool = True) -> None:
        """image: (height, width, 3), contiguous; it must outlive run(). given: it has values."""
        height, width = image.shape[:2]
        place = image.ctypes.data
        if not self._copies:
            self._library.oidnSetSharedFilterImage(
                self._handle, name, place, FLOAT3, width, height, 0, 0, 0
            )
            return
        buffer = self._library.oidnNewBuffer(self._device, image.nbytes)
        self._buffers.append(buffer)
        if not buffer:
            return
        if given:
            self._library.oidnWriteBuffer(buffer, 0, image.nbytes, place)
        self._library.oidnSetFilterImage(self._handle, name, buffer, FLOAT3, width, height, 0, 0, 0)

    def run(self, output: NDArray[np.float32], goes_on: Callable[[], bool]) -> None:
        """output: (height, width, 3), contiguous; undefined once goes_on() has said no."""
        self._monitor = _MONITOR(lambda _, __: goes_on())
        self.set_image(b"output", output, given=False)
        self._library.oidnSetFilterProgressMonitorFunction(self._handle, self._monitor, None)
        self._library.oidnCommitFilter(self._handle)
        self._library.oidnExecuteFilter(self._handle)
        if self._copies and self._buffers[-1]:
            place = output.ctypes.data
            self._library.oidnReadBuffer(self._buffers[-1], 0, output.nbytes, place)

    def release(self) -> None:
        self._library.oidnReleaseFilter(self._handle)
        for buffer in filter(None, self._buffers):
            self._library.oidnReleaseBuffer(buffer)
        self._buffers.clear()


@contextmanager
def processor(threads: int = 0) -> Iterator[Device]:
    """The processor, as a device for a while."""
    device = Device(library().oidnNewDevice(CPU))
    try:
        device.set_threads(threads)
        device.commit()
        yield device
    finally:
        device.release()


@lru_cache(maxsize=1)
def graphics_card() -> Device | None:
    """The first graphics card that Open Image Denoise can use, if any: it lists the fastest first.
    Made once, as making one takes longer than a filter.
    """
    lib = library()
    for number in range(lib.oidnGetNumPhysicalDevices()):
        if lib.oidnGetPhysicalDeviceInt(number, b"type") == CPU:
            continue
        name = (lib.oidnGetPhysicalDeviceString(number, b"name") or b"a graphics card").decode()
        try:
            device = Device(lib.oidnNewDeviceByID(number), name)
        except DeviceFailed:
            continue
        device.commit()
        try:
            device.check()
        except DeviceFailed:  # a driver too old for it; the next one may do
            device.release()
            continue
        return device
    return None
