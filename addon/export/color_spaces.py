"""Colour spaces of images: native code decodes sRGB and linear, Blender's own configuration all
others.
"""

from __future__ import annotations

import os
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

LINEAR_SPACES = {"Linear Rec.709", "Linear", "Raw", "Non-Color", "Generic Data", "scene_linear"}
MOST_HALF = 65504.0  # what Cycles keeps of such a colour at most


def is_data(image: Any) -> bool:
    """True if the image holds no colours."""
    settings = image.colorspace_settings
    return bool(getattr(settings, "is_data", False)) or settings.name in {
        "Non-Color",
        "Raw",
        "Generic Data",
    }


def srgb_to_linear(encoded: NDArray) -> NDArray:
    return np.where(
        encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4
    ).astype(encoded.dtype)


def to_linear(colors: NDArray[np.float32], space: str) -> NDArray[np.float32] | None:
    """(height, width, 3) from a colour space of Blender's to linear Rec. 709; None where that
    cannot be done.
    """
    if space in LINEAR_SPACES:
        return colors
    return srgb_to_linear(colors) if space == "sRGB" else _converted(colors, space)


def _converted(colors: NDArray[np.float32], space: str) -> NDArray[np.float32] | None:
    try:
        import OpenImageIO as oiio
    except ImportError:
        return None
    source = oiio.ImageBuf(np.ascontiguousarray(colors, np.float32))
    made = oiio.ImageBufAlgo.colorconvert(
        source, space, "scene_linear", False, "", "", _configuration()
    )
    if made.has_error or not made.initialized:
        made.geterror()
        return None
    linear = np.asarray(made.get_pixels(oiio.FLOAT), np.float32).reshape(colors.shape)
    return np.clip(np.nan_to_num(linear), -MOST_HALF, MOST_HALF)


def _configuration() -> str:
    given = os.environ.get("OCIO", "")
    return given or os.path.join(
        bpy.utils.resource_path("LOCAL"), "datafiles", "colormanagement", "config.ocio"
    )
