"""The process that a command runs in: its streams, signals and temporary files."""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import sys
from pathlib import Path
from typing import TextIO


def open_standard_streams() -> None:
    """Opens the standard streams that the caller has closed, on the null device. Otherwise a file
    that is opened later would take a stream's number, and messages for the user would be written
    into it. All are UTF-8: a code page of Windows lacks characters that names of files may have.
    """
    while (number := os.open(os.devnull, os.O_RDWR)) < 3:
        pass
    os.close(number)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
        getattr(sys, name).reconfigure(encoding="utf-8", errors="backslashreplace")


def silence_blender() -> None:
    """Blender and its libraries print to the descriptors 1 and 2; our own messages keep the real
    standard error.
    """
    sys.stderr = os.fdopen(os.dup(2), "w", buffering=1, encoding="utf-8", errors="backslashreplace")
    quiet = os.open(os.devnull, os.O_WRONLY)
    for descriptor in (1, 2):
        os.dup2(quiet, descriptor)
    os.close(quiet)


def stop_signals() -> tuple[signal.Signals, ...]:
    """What asks the command to stop: Ctrl-C, a request to end, and on Windows Ctrl-Break."""
    asked = (signal.SIGINT, signal.SIGTERM)
    if sys.platform == "win32":
        return (*asked, signal.SIGBREAK)
    return asked


def end_at_the_second(number: int) -> None:
    """Makes the next signal of this kind end the process at once, even where Blender or one of its
    libraries hangs and no Python code runs.
    """
    if sys.platform == "win32":
        _end_at_the_second_key()
        return
    if not sys.platform.startswith("linux") or sys.maxsize < 2**32:
        return

    class Action(ctypes.Structure):  # of glibc and musl on 64-bit machines
        _fields_ = [
            ("handler", ctypes.c_void_p),
            ("mask", ctypes.c_ulong * 16),
            ("flags", ctypes.c_int),
            ("restorer", ctypes.c_void_p),
        ]

    library, action = ctypes.CDLL(None), Action()
    if library.sigaction(number, None, ctypes.byref(action)) == 0:
        action.flags |= -0x80000000  # SA_RESETHAND
        library.sigaction(number, ctypes.byref(action), None)


_keys: list[object] = []
"""What Windows calls when Ctrl-C or Ctrl-Break is pressed; it must not be freed."""


def _end_at_the_second_key() -> None:
    """As end_at_the_second(), for Ctrl-C and Ctrl-Break. Windows calls it on a thread of its own;
    it needs Python's lock, which a render gives back while native code works.
    """
    if _keys:
        return
    pressed = 0

    def press(_: int) -> int:
        nonlocal pressed
        pressed += 1
        if pressed > 1:
            os._exit(130)
        return 0  # Python's own handler is next

    handler = ctypes.WINFUNCTYPE(ctypes.c_int, ctypes.c_ulong)(press)  # type: ignore[attr-defined, unused-ignore]
    _keys.append(handler)
    ctypes.WinDLL("kernel32").SetConsoleCtrlHandler(handler, 1)  # type: ignore[attr-defined, unused-ignore]


def understands_escapes(stream: TextIO) -> bool:
    """Whether the stream is a terminal that clears a line when told to. Windows' console is asked
    to; old ones cannot.
    """
    if not stream.isatty():
        return False
    if sys.platform != "win32":
        return True
    import msvcrt

    kernel32 = ctypes.WinDLL("kernel32")
    handle, mode = ctypes.c_void_p(msvcrt.get_osfhandle(stream.fileno())), ctypes.c_ulong()
    terminal_codes = 0x0004  # ENABLE_VIRTUAL_TERMINAL_PROCESSING
    return bool(
        kernel32.GetConsoleMode(handle, ctypes.byref(mode))
        and kernel32.SetConsoleMode(handle, mode.value | terminal_codes)
    )


def remove_blenders_folder() -> None:
    """Removes Blender's folder for temporary files of this session; Blender does so only at an
    orderly end.
    """
    bpy = sys.modules.get("bpy")
    if bpy is not None and Path(bpy.app.tempdir).name.startswith("blender_"):
        shutil.rmtree(bpy.app.tempdir, ignore_errors=True)
