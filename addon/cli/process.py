"""The process that a command runs in: its streams, signals and temporary files."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path


def open_standard_streams() -> None:
    """Opens the standard streams that the caller has closed, on the null device. Otherwise a file
    that is opened later would take a stream's number, and messages for the user would be written
    into it.
    """
    while (number := os.open(os.devnull, os.O_RDWR)) < 3:
        pass
    os.close(number)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115


def silence_blender() -> None:
    """Blender and its libraries print to the descriptors 1 and 2; our own messages keep the real
    standard error.
    """
    sys.stderr = os.fdopen(os.dup(2), "w", buffering=1, encoding="utf-8", errors="backslashreplace")
    quiet = os.open(os.devnull, os.O_WRONLY)
    for descriptor in (1, 2):
        os.dup2(quiet, descriptor)
    os.close(quiet)


def end_at_the_second(number: int) -> None:
    """Makes the next signal of this kind end the process at once, even where Blender or one of its
    libraries hangs and no Python code runs.
    """
    if not sys.platform.startswith("linux") or sys.maxsize < 2**32:
        return
    import ctypes

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


def remove_blenders_folder() -> None:
    """Removes Blender's folder for temporary files of this session; Blender does so only at an
    orderly end.
    """
    bpy = sys.modules.get("bpy")
    if bpy is not None and Path(bpy.app.tempdir).name.startswith("blender_"):
        shutil.rmtree(bpy.app.tempdir, ignore_errors=True)
