"""Seconds that a test may hold the program to while others use the machine."""

from __future__ import annotations

import os
import time
from pathlib import Path

PRESSURE = Path("/proc/pressure/cpu")


class Stopwatch:
    """Counts from when it is made.

    seconds(): what this process has taken, whoever else uses the machine. Of two figures the
    larger: processor time over the number of processors, and the wall time in which nobody had to
    wait for a processor. On a quiet machine the second is the wall time; where Linux does not tell
    it (no /proc/pressure) only the first counts, which does not notice a process that sleeps.
    """

    def __init__(self) -> None:
        self._wall, self._cpu, self._waits = time.monotonic(), time.process_time(), _waits()

    def seconds(self) -> float:
        busy = (time.process_time() - self._cpu) / processors()
        return max(busy, time.monotonic() - self._wall - self.waited())

    def waited(self) -> float:
        """Wall time in which some process of the machine waited for a processor."""
        wall, waits = time.monotonic() - self._wall, _waits()
        return wall if waits is None or self._waits is None else min(wall, waits - self._waits)


def processors() -> int:
    """Those that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _waits() -> float | None:
    """Seconds since the machine started in which some process waited for a processor."""
    try:
        some = PRESSURE.read_text().splitlines()[0]
    except OSError:
        return None
    return int(some.rpartition("total=")[2]) * 1e-6
