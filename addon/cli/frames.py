"""Frames of an animation: which ones, under which names, and one after the other."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Iterator
from pathlib import Path

FIRST, LAST = -1048574, 1048574
"""Of the frames that Blender knows."""
_RANGE = re.compile(r"(-?\d+)(?:-(-?\d+)(?::(\d+))?)?")
_HASHES = re.compile(r"#+(?=[^#]*$)")


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


def has_number(path: Path) -> bool:
    """Whether the file's name has a place for the number of a frame."""
    return "#" in path.name


def with_number(path: Path, frame: int) -> Path:
    """The last row of # in the file's name becomes the frame, with zeros in front, as in Blender:
    f_####.exr is f_0007.exr, or f_-007.exr.
    """
    name = _HASHES.sub(lambda hashes: f"{frame:0{len(hashes[0])}d}", path.name)
    return path.with_name(name)


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


NUMBERED = ("output", "stats")
"""Options that name a file of each frame."""
