"""32-bit float OpenEXR files: the Combined pass as plain R, G, B, A, the others as named layers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..core.files import WriteError, real_path, replace_file, try_file
from ..core.image_rows import write_rows
from ..core.render.result import Passes, infos_of
from ..core.scene import Frame

__all__ = ["WriteError", "channels_of", "real_path", "replace_file", "try_file", "write_exr"]


def channels_of(
    passes: Passes, prefix: str = "", *, plain: bool = True
) -> tuple[list[str], list[np.ndarray]]:
    """Channel names of all passes, and the passes (height, width, channels) float32; `plain` leaves
    Combined without a layer name.
    """
    names, planes = [], []
    for info in infos_of(passes):
        layer = "" if plain and info.name == "Combined" else f"{prefix}{info.name}."
        names += [layer + letter for letter in info.channels]
        planes.append(passes[info.name])
    return names, planes


def write_exr(
    path: Path,
    names: list[str],
    planes: Sequence[np.ndarray],
    frame: Frame,
    *,
    crop: bool,
    pixel_aspect: float,
    metadata: dict[str, str | int | float],
) -> None:
    """Writes `planes` (height, width, channels), `names` their channels, row 0 at the bottom, of
    `frame.region`; without `crop` a border is the data window. pixel_aspect: a pixel's width over
    its height.

    Raises WriteError.
    """
    import OpenImageIO as oiio

    height, width, _ = planes[0].shape
    spec = oiio.ImageSpec(width, height, len(names), oiio.FLOAT)
    spec.channelnames = names
    if frame.border is not None and not crop:
        x, y, _, _ = frame.region
        spec.x, spec.y = x, frame.height - y - height
        spec.full_x, spec.full_y, spec.full_width, spec.full_height = (
            0,
            0,
            frame.width,
            frame.height,
        )
    spec.attribute("compression", "zip")
    spec.attribute("PixelAspectRatio", pixel_aspect)
    spec.attribute("oiio:ColorSpace", "lin_rec709")
    for key, value in metadata.items():
        spec.attribute(key, value)

    write_rows(path, spec, planes)
