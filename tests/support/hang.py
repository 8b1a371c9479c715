"""When a process hangs: not after so many seconds of wall time, which a busy machine may need for a
good test, but when it computes without an end, or does nothing at all for very long.
"""

from __future__ import annotations

import os
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

BUSY_SECONDS = 1200.0
"""Of processor time for one test; the longest takes a twentieth."""
IDLE_SECONDS = 900.0
"""Of wall time in which a test takes less than a second of processor time."""
POLL_SECONDS = 2.0


class HangGuard:
    """Looks at a process and all that descends from it, whenever check() is called."""

    def __init__(
        self, process: int, busy: float = BUSY_SECONDS, idle: float = IDLE_SECONDS
    ) -> None:
        self._process, self._busy, self._idle = process, busy, idle
        self.restart()

    def restart(self) -> None:
        """Another test begins."""
        self._began = self._active = tree_seconds(self._process) or 0.0
        self._active_at = time.monotonic()

    def check(self) -> str | None:
        """Why the process is to be ended, if it is."""
        now, used = time.monotonic(), tree_seconds(self._process)
        if used is None:
            return None
        if used - self._began > self._busy:
            return f"computing for {used - self._began:.0f} s of processor time"
        # less: a child has ended that nobody waited for
        if used > self._active + 1.0 or used < self._active:
            self._active, self._active_at = used, now
        if now - self._active_at > self._idle:
            return f"doing nothing for {now - self._active_at:.0f} s"
        return None


@contextmanager
def killed_if_hung(process: subprocess.Popen[str]) -> Iterator[None]:
    """Ends `process` if what it is asked inside takes for ever."""
    over = threading.Event()
    guard = HangGuard(process.pid, BUSY_SECONDS / 2, IDLE_SECONDS / 2)

    def watch() -> None:
        while not over.wait(POLL_SECONDS):
            if guard.check():
                process.kill()
                return

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        over.set()
        watcher.join()


def tree_seconds(root: int) -> float | None:
    """Processor time of a process and all that descends from it, ended children among them where
    their parent has waited for them; None where the system does not tell.
    """
    children: dict[int, list[int]] = {}
    ticks: dict[int, int] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:  # it has ended
            continue
        children.setdefault(int(fields[1]), []).append(int(folder.name))
        ticks[int(folder.name)] = sum(int(field) for field in fields[11:15])
    if root not in ticks:
        return None
    total, family = 0, [root]
    while family:
        one = family.pop()
        total += ticks[one]
        family += children.get(one, [])
    return total / os.sysconf("SC_CLK_TCK")
