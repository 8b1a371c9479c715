"""Memory of this process."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path


def peak_memory_bytes() -> int:
    """Most resident memory that this process has had."""
    if sys.platform == "win32":
        return _windows_counter("PeakWorkingSetSize")
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def current_memory_bytes() -> int:
    """Resident memory now; its peak where the system does not say."""
    if sys.platform == "win32":
        return _windows_counter("WorkingSetSize")
    statm = Path("/proc/self/statm")
    if not statm.exists():
        return peak_memory_bytes()
    import resource

    return int(statm.read_text().split()[1]) * resource.getpagesize()


def return_freed_memory() -> None:
    """Gives the system what has been freed: glibc keeps arrays of up to 32 MB for itself."""
    if sys.platform == "linux":
        import ctypes

        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
        if trim is not None:
            trim(0)


PICTURE_BYTES = 350
"""Bytes per pixel in a diffuse scene. A third is the film and the adaptive sampler's data; the rest
belongs to the pass being rendered.
"""


def check_picture_fits(width: int, height: int) -> None:
    """MemoryError, with one sentence, where there is not even memory for the pixels."""
    needed, free = PICTURE_BYTES * width * height, free_memory_bytes()
    if free is not None and needed > free:
        raise MemoryError(
            f"a picture of {width} x {height} pixels takes {needed / 1e9:,.1f} GB at the least, "
            f"and {max(free, 0) / 1e9:,.1f} GB are free; "
            "render it smaller, or in parts by Render Region"
        )


def free_memory_bytes() -> int | None:
    """What this process may still take, by the system's and the container's limits, swap included;
    None where that is not known.
    """
    if sys.platform == "win32":
        return _windows_free()
    known = [free for free in (_linux_free(), *_group_free()) if free is not None]
    return min(known) if known else None


def _linux_free(file: Path = Path("/proc/meminfo")) -> int | None:
    try:
        kilobytes = {
            name: int(rest.split()[0])
            for name, rest in (line.split(":", 1) for line in file.read_text().splitlines())
        }
        return 1024 * (kilobytes["MemAvailable"] + kilobytes.get("SwapFree", 0))
    except (OSError, ValueError, LookupError):
        return None


def _group_free(root: Path = Path("/sys/fs/cgroup")) -> Iterator[int | None]:
    """Free memory by the limits of control groups, version 2 and 1. Cached files can be dropped and
    count as free.
    """
    for folder, limit, used, files in (
        (root, "memory.max", "memory.current", "inactive_file"),
        (root / "memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
    ):
        try:
            statistics = dict(
                line.split() for line in (folder / "memory.stat").read_text().splitlines()
            )
            now = int((folder / used).read_text()) - int(statistics.get(files, 0))
            yield int((folder / limit).read_text()) - now
        except (OSError, ValueError):  # no such group, or "max"
            yield None


def _windows_free() -> int | None:
    import ctypes

    class Status(ctypes.Structure):
        _fields_ = [("length", ctypes.c_ulong), ("load", ctypes.c_ulong)] + [
            (name, ctypes.c_ulonglong)
            for name in (
                "total_physical",
                "free_physical",
                "total_page_file",
                "free_page_file",
                "total_virtual",
                "free_virtual",
                "extended",
            )
        ]

    status = Status(length=ctypes.sizeof(Status))
    windows = ctypes.windll  # type: ignore[attr-defined, unused-ignore]
    return (
        int(status.free_page_file)
        if windows.kernel32.GlobalMemoryStatusEx(ctypes.byref(status))
        else None
    )


def _windows_counter(name: str) -> int:
    import ctypes
    from ctypes import wintypes

    class Counters(ctypes.Structure):
        _fields_ = [("cb", wintypes.DWORD), ("PageFaultCount", wintypes.DWORD)] + [
            (field, ctypes.c_size_t)
            for field in (
                "PeakWorkingSetSize",
                "WorkingSetSize",
                "QuotaPeakPagedPoolUsage",
                "QuotaPagedPoolUsage",
                "QuotaPeakNonPagedPoolUsage",
                "QuotaNonPagedPoolUsage",
                "PagefileUsage",
                "PeakPagefileUsage",
            )
        ]

    counters = Counters(cb=ctypes.sizeof(Counters))
    windows = ctypes.windll  # type: ignore[attr-defined, unused-ignore]
    process = windows.kernel32.GetCurrentProcess
    process.restype = wintypes.HANDLE
    query = windows.kernel32.K32GetProcessMemoryInfo
    query.argtypes = (wintypes.HANDLE, ctypes.c_void_p, wintypes.DWORD)
    return (
        int(getattr(counters, name)) if query(process(), ctypes.byref(counters), counters.cb) else 0
    )
