"""Pictures that are written some rows at a time, so that no second copy of them is made."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .files import replace_file

ROWS = 64
"""Rows that are written at a time."""


def write_rows(
    path: Path, spec: Any, planes: Sequence[NDArray[Any]], *, durable: bool = False
) -> None:
    """Writes `planes`, each (height, width, channels) with row 0 at the bottom, side by side as the
    channels of `spec`, an OpenImageIO.ImageSpec; `path` is replaced when all is written. durable:
    not before it is on the disk. WriteError if that fails.
    """
    import OpenImageIO as oiio

    def write(temporary: Path) -> None:
        output = oiio.ImageOutput.create(str(temporary))
        if output is None:
            raise OSError(oiio.geterror() or "OpenImageIO knows no such format")
        done = output.open(str(temporary), spec)
        for first in range(0, spec.height, ROWS):
            last = min(first + ROWS, spec.height)
            rows = np.concatenate(
                [plane[spec.height - last : spec.height - first][::-1] for plane in planes],
                axis=-1,
                dtype=np.float32,
            )
            done = done and output.write_scanlines(spec.y + first, spec.y + last, spec.z, rows)
        if not (done and output.close()):
            raise OSError(output.geterror() or oiio.geterror() or "OpenImageIO did not say why")
        if durable:
            with open(temporary, "rb+") as file:
                os.fsync(file.fileno())

    replace_file(path, write)
