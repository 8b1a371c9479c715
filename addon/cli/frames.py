"""Frames of an animation: which ones, under which names, and one after the other."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Iterator

from ..core.files import has_number, with_number

__all__ = ["FIRST", "LAST", "NUMBERED", "frame_list", "has_number", "of_each_frame", "with_number"]

FIRST, LAST = -1048574, 1048574
"""Of the frames that Blender knows."""
_RANGE = re.compile(r"(-?\d+)(?:-(-?\d+)(?::(\d+))?)?")


def frame_list(text: str) -> list[int]:
    """Frames of '1-10,15': numbers and ranges, ':2' after a range for every second one. Each frame
    is there once, in the order of its first place. Raises argparse.ArgumentTypeError.
    """
    frames: dict[int, None] = {}
    for part in text.split(","):
        match = _RANGE.fullmatch(part.strip())
        if match is None:
            raise argparse.ArgumentTypeError(f"'{text}' is not a list of frames like 1-10,15")
        first = int(match[1])
        last = int(match[2]) if match[2] else first
        step = int(match[3]) if match[3] else 1
        if not FIRST <= first <= last <= LAST or step < 1:
            raise argparse.ArgumentTypeError(
                f"'{part.strip()}' is not a range of frames from {FIRST} to {LAST}"
            )
        frames.update(dict.fromkeys(range(first, last + 1, step)))
    return list(frames)


def of_each_frame(options: argparse.Namespace) -> Iterator[argparse.Namespace]:
    """The options of one frame after the other, each with its number and its files; without
    --frames the options as they are. With --skip-existing those whose picture is there are left
    out: a picture is written completely or not at all.
    """
    if options.frames is None:
        if not (options.skip_existing and os.path.isfile(options.output)):
            yield options
        return
    for frame in options.frames:
        one = argparse.Namespace(**vars(options))
        one.frame = frame
        for name in NUMBERED:
            path = getattr(options, name)
            setattr(one, name, None if path is None else with_number(path, frame))
        if not (options.skip_existing and os.path.isfile(one.output)):
            yield one


NUMBERED = ("output", "stats", "checkpoint")
"""Options that name a file of each frame."""
