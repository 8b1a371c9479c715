"""32-bit float OpenEXR files: the Combined pass as plain R, G, B, A, the others as named layers."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import numpy as np

from .core.result import Passes, infos_of
from .core.scene import Frame


class WriteError(Exception):
    """The file could not be written; the message is one sentence that names it."""


def replace_file(path: Path, write: object) -> None:
    """Calls write(temporary path) and puts the file in the place of `path`: whole, or not at all. Raises WriteError."""
    temporary = path.with_name(f".{path.stem}.{os.getpid()}.partial{path.suffix}")
    try:
        write(temporary)  # type: ignore[operator]
        os.replace(temporary, path)
    except OSError as error:
        raise WriteError(f"{path} could not be written: {error.strerror or error}") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def channels_of(passes: Passes, prefix: str = "", *, plain: bool = True) -> tuple[list[str], np.ndarray]:
    """Channel names and (height, width, C) float32 of all passes; `plain` leaves Combined without a layer name."""
    names, planes = [], []
    for info in infos_of(passes):
        layer = "" if plain and info.name == "Combined" else f"{prefix}{info.name}."
        names += [layer + letter for letter in info.channels]
        planes.append(passes[info.name])
    return names, np.concatenate(planes, axis=-1)


def write_exr(
    path: Path, names: list[str], pixels: np.ndarray, frame: Frame, *, crop: bool, metadata: dict[str, str | int | float]
) -> None:
    """Writes `pixels` (height, width, C), row 0 at the bottom, of `frame.region`; without `crop` a border is the data window.

    Raises WriteError.
    """
    import OpenImageIO as oiio

    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, oiio.FLOAT)
    spec.channelnames = names
    if frame.border is not None and not crop:
        x, y, _, _ = frame.region
        spec.x, spec.y = x, frame.height - y - height
        spec.full_x, spec.full_y, spec.full_width, spec.full_height = 0, 0, frame.width, frame.height
    spec.attribute("compression", "zip")
    spec.attribute("oiio:ColorSpace", "lin_rec709")
    for key, value in metadata.items():
        spec.attribute(key, value)
    rows = np.ascontiguousarray(pixels[::-1], np.float32)

    def write(temporary: Path) -> None:
        output = oiio.ImageOutput.create(str(temporary))
        if output is None:
            raise OSError(oiio.geterror() or "OpenImageIO knows no such format")
        if not (output.open(str(temporary), spec) and output.write_image(rows) and output.close()):
            raise OSError(output.geterror() or oiio.geterror() or "OpenImageIO did not say why")

    replace_file(path, write)
