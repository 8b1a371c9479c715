"""Memory of this process."""

from __future__ import annotations

import sys
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
    return int(getattr(counters, name)) if query(process(), ctypes.byref(counters), counters.cb) else 0
