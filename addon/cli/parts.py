"""The argument of --part."""

from __future__ import annotations

import argparse
import re

from ..core.render.parts import Part


def part(text: str) -> Part:
    """3/16: the third of 16 parts. Raises argparse.ArgumentTypeError."""
    match = re.fullmatch(r"(\d+)/(\d+)", text)
    try:
        if match:
            return Part(int(match[1]), int(match[2]))
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(f"'{text}' is not a part I/N with numbers from 1 to 65535")
