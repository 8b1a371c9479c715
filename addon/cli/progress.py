"""What the user reads on standard error while a render runs."""

from __future__ import annotations

import contextlib
import sys

from ..core.render.result import Progress
from .process import understands_escapes


def say(text: str) -> None:
    """Writes to standard error. If nobody reads it any more, the render goes on."""
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(text)
        sys.stderr.flush()


class ProgressBar:
    """Shows a bar that redraws itself on a terminal, and a line at each tenth elsewhere."""

    def __init__(self) -> None:
        self.terminal = understands_escapes(sys.stderr)
        self.tenth = -1

    def show(self, progress: Progress) -> None:
        if self.terminal:
            filled = int(30 * progress.fraction)
            say(
                f"\r[{'#' * filled}{'.' * (30 - filled)}] {100 * progress.fraction:3.0f} %  "
                f"{progress.message}\x1b[K"
            )
        elif int(10 * progress.fraction) > self.tenth:
            self.tenth = int(10 * progress.fraction)
            say(f"{10 * self.tenth:3d} %  {progress.message}\n")

    def end(self) -> None:
        if self.terminal:
            say("\r\x1b[K")


class OpenJdProgress:
    """Lines that programs which run jobs of Open Job Description read from what a command says."""

    def __init__(self) -> None:
        self._shown = -1

    def show(self, progress: Progress) -> None:
        percent = int(100 * progress.fraction)
        if percent > self._shown:
            self._shown = percent
            say(f"openjd_progress: {percent}\nopenjd_status: {progress.message}\n")

    def end(self) -> None:
        """Nothing is left on the screen."""
