"""Photometric profiles of lamps: IES files (IESNA LM-63) as the tables that native code reads."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import bpy

WATTS_PER_CANDELA = 4.0 * math.pi / 177.83  # of D65, over the sphere, as Cycles has it


def read_profile(node: Any) -> tuple[float, ...]:
    """Table of an IES Texture node; OSError or ValueError where there is none that can be read."""
    if node.mode == "INTERNAL":
        if node.ies is None:
            raise ValueError("no text block")
        return parse(node.ies.as_string())
    if not node.filepath:
        raise ValueError("no file")
    return parse(
        Path(bpy.path.abspath(node.filepath, library=node.id_data.library)).read_text("latin-1")
    )


def parse(text: str) -> tuple[float, ...]:
    """(h, v, h horizontal angles, v vertical ones, h * v intensities): radians, over the full turn
    of the type's symmetry.

    Intensities are candela times WATTS_PER_CANDELA.
    """
    _, mark, rest = text.partition("TILT=")
    if not mark:
        raise ValueError("no TILT line")
    lines = rest.split("\n", 1)
    tilt, rest = lines[0].strip(), lines[1] if len(lines) > 1 else ""
    words = iter(rest.replace(",", " ").split())
    try:
        if tilt == "INCLUDE":
            next(words)
            for _ in range(2 * int(next(words))):
                next(words)
        elif tilt != "NONE":
            raise ValueError(f"TILT={tilt} is not supported")
        next(words)  # lamps
        next(words)  # lumens
        factor = float(next(words))
        vertical_count, horizontal_count = int(next(words)), int(next(words))
        kind = int(next(words))
        for _ in range(4):
            next(words)  # units and size
        factor *= float(next(words)) * float(next(words))  # ballast, ballast-lamp
        next(words)  # watts
        vertical = [float(next(words)) for _ in range(vertical_count)]
        horizontal = [float(next(words)) for _ in range(horizontal_count)]
        values = [
            [factor * float(next(words)) for _ in range(vertical_count)]
            for _ in range(horizontal_count)
        ]
    except StopIteration:
        raise ValueError("it ends too early") from None
    if kind != 1:
        raise ValueError("only profiles of type C are supported")
    if vertical_count < 2 or not values:
        raise ValueError("it has too few angles")
    return _table(*_full_turn(horizontal, values), vertical)


def _full_turn(
    horizontal: list[float], values: list[list[float]]
) -> tuple[list[float], list[list[float]]]:
    """Angles over 0..360 degrees, by the symmetry that the last one tells."""
    first = horizontal[0]
    angles = [angle - first for angle in horizontal]
    if len(angles) == 1:
        return [0.0, 360.0], [values[0], values[0]]
    last = angles[-1]
    if last == 90.0:
        angles, values = [*angles, *(180.0 - a for a in angles[-2::-1])], [*values, *values[-2::-1]]
        last = 180.0
    if last == 180.0:
        angles, values = [*angles, *(360.0 - a for a in angles[-2::-1])], [*values, *values[-2::-1]]
        last = 360.0
    if last < 360.0:  # some files leave out the last angle, which is the first one again
        angles, values = [*angles, 360.0], [*values, values[0]]
    return angles, values


def _table(
    horizontal: list[float], values: list[list[float]], vertical: list[float]
) -> tuple[float, ...]:
    rows = [value * WATTS_PER_CANDELA for row in values for value in row]
    angles = [math.radians(a) for a in (*horizontal, *vertical)]
    return (float(len(horizontal)), float(len(vertical)), *angles, *rows)
