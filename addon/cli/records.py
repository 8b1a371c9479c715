"""--part and --checkpoint: what the command line keeps of a render's sums."""

from __future__ import annotations

import argparse
from typing import Any

from ..core.render.parts import Part, too_small
from ..core.render.record import SECONDS, Checkpoint, Record
from ..core.render.settings import RenderSettings
from ..core.render.sums_file import SumsFileError, write_sums
from .arguments import CommandError, Interrupted
from .progress import say

INTERRUPTED = 75
"""Exit status after an interrupt that has left a checkpoint: try again (EX_TEMPFAIL)."""


class CheckpointLeft(Interrupted):
    """Interrupted, and a checkpoint holds what there was."""

    status = INTERRUPTED


class Records:
    """Of all view layers of one frame."""

    def __init__(self, options: argparse.Namespace) -> None:
        """Raises CommandError if the checkpoint is none."""
        self.part: Part | None = options.part
        self.made: list[Record] = []
        self.checkpoint: Checkpoint | None = None
        every = options.checkpoint_every
        if options.checkpoint is not None:
            try:
                self.checkpoint = Checkpoint(
                    options.checkpoint, SECONDS if every is None else every
                )
            except SumsFileError as error:
                raise CommandError(str(error)) from error
            self._say_what_is_there()

    def make(self, origin: dict[str, Any]) -> Record:
        """For the next view layer."""
        record = Record(
            self.part, keeps=self.part is not None, checkpoint=self.checkpoint, origin=origin
        )
        self.made.append(record)
        return record

    def interrupted(self) -> Interrupted:
        """What to raise after an interrupt."""
        there = self.checkpoint
        if there is None:
            return Interrupted("interrupted; nothing was written")
        if there.failure:
            return Interrupted(
                f"interrupted; there is no checkpoint of all passes: {there.failure}"
            )
        if not there.layers:
            return Interrupted("interrupted before the first pass; nothing was written")
        return CheckpointLeft(
            f"interrupted; the checkpoint {there.path} is written, and the same command goes on "
            "from it"
        )

    def write_part(self, options: argparse.Namespace) -> None:
        """Instead of the picture. Raises WriteError."""
        totals = [record.total for record in self.made if record.total is not None]
        write_sums(options.output, totals)

    def _say_what_is_there(self) -> None:
        if self.checkpoint is not None and self.checkpoint.layers:
            passes = ", ".join(str(sums.passes) for sums in self.checkpoint.layers.values())
            say(f"photon-splat: going on from {self.checkpoint.path} ({passes} passes)\n")


def warn_of_small_parts(part: Part | None, settings: RenderSettings) -> None:
    """Where the number of passes alone ends the render."""
    if part is None or part.count == 1 or settings.time_limit or settings.error_threshold:
        return
    sentence = too_small(settings.passes)
    if sentence:
        say(f"photon-splat: warning: {sentence}\n")
