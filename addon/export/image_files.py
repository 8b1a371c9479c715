"""Pixels as files, and Blender's own buffers, hold them."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .color_spaces import is_data

FIRST_TILE = 1001
EXR = b"\x76\x2f\x31\x01"


def image_path(image: Any, node: Any, tile: int) -> str:
    """The image's file for the current frame, or of a UDIM tile; absolute, or "" if it has none."""
    if image.source not in {"FILE", "SEQUENCE", "TILED", "MOVIE"}:
        return ""
    try:
        path = image.filepath_from_user(image_user=node.image_user)
    except (AttributeError, RuntimeError, TypeError):
        path = image.filepath
    if image.source == "TILED":
        row, column = divmod(tile - FIRST_TILE, 10)
        path = image.filepath.replace("<UDIM>", str(tile)).replace(
            "<UVTILE>", f"u{column + 1}_v{row + 1}"
        )
    return bpy.path.abspath(path, library=image.library) if path else ""


RawPixels = tuple[NDArray, int, bool]
"""(height, width, 4) uint8 or float32 as stored in a file, bottom row first; its number of
channels; whether its colours are not times their alpha.
"""


def file_pixels(path: str, layer: str = "") -> RawPixels | None:
    """None: OpenImageIO is not there or cannot. `layer`: its channels, if it is there, instead of
    the first ones.
    """
    try:
        import OpenImageIO as oiio
    except ImportError:
        return None
    if not os.path.isfile(path):
        return None
    config = oiio.ImageSpec()
    config["oiio:UnassociatedAlpha"] = 1
    file = oiio.ImageInput.open(path, config)
    if file is None:
        oiio.geterror()
        return None
    spec = file.spec()
    begin, channels = _channels_of(spec.channelnames, layer)
    straight = bool(spec.get_int_attribute("oiio:UnassociatedAlpha"))
    eight_bit = spec.format.basetype == oiio.UINT8
    pixels = file.read_image(0, 0, begin, begin + channels, oiio.UINT8 if eight_bit else oiio.FLOAT)
    broken = (
        pixels is None
        or spec.depth > 1
        or spec.get_string_attribute("oiio:ColorSpace").upper() == "CMYK"
    )
    file.close()
    if broken:
        oiio.geterror()
        return None
    pixels = np.asarray(pixels).reshape(spec.height, spec.width, channels)
    if channels == 4:
        return np.ascontiguousarray(pixels[::-1]), channels, straight
    rgba = np.empty((spec.height, spec.width, 4), pixels.dtype)
    gray = channels < 3
    rgba[..., :3] = pixels[::-1, :, :1] if gray else pixels[::-1]
    rgba[..., 3] = pixels[::-1, :, 1] if channels == 2 else 255 if eight_bit else 1.0
    return rgba, channels, straight


def _channels_of(names: Sequence[str], layer: str) -> tuple[int, int]:
    """The first of its channels, and how many, four at the most."""
    of_layer = [i for i, name in enumerate(names) if layer and layer in name.split(".")[:-1]]
    if not of_layer:
        return 0, min(len(names), 4)
    return of_layer[0], min(len(of_layer), 4)


def packed_tile_pixels(image: Any, tile: int) -> RawPixels | None:
    """As file_pixels(), of a tile that is packed into the .blend file; None if it is not."""
    packed = next((file for file in image.packed_files if file.tile_number == tile), None)
    if packed is None or packed.packed_file is None or image.is_dirty:
        return None
    return _from_data(packed.packed_file.data, image)


def _from_data(data: bytes, image: Any, layer: str = "") -> RawPixels | None:
    """As file_pixels(), of what a file of the image holds; None as well where no room is for it."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "image" + os.path.splitext(image.filepath)[1])
            with open(path, "wb") as file:
                file.write(data)
            return file_pixels(path, layer)
    except OSError:
        return None


def own_pixels(image: Any) -> NDArray | None:
    """As _from_blender(). The bytes of packed pictures are decoded here, into what Blender's buffer
    would hold: to ask Blender for them takes several times as long.
    """
    packed = image.packed_file
    # To ask for the image's file_format would make Blender decode it
    data = packed.data if packed and not image.is_dirty else b""
    if data.startswith((b"\x89PNG", b"\xff\xd8\xff")):
        found = _from_data(data, image)
        if found is not None and found[0].dtype == np.uint8:
            multiplied = image.alpha_mode == "PREMUL" and not is_data(image)
            return _unmultiplied(found[0]) if multiplied else found[0]
    pixels = _from_blender(image)
    if pixels is None and data.startswith(EXR):  # of layers, which Blender has one by one
        found = _from_data(data, image, "Combined")
        return found[0] if found is not None else None
    return pixels


def _unmultiplied(pixels: NDArray) -> NDArray:
    """Bytes by their alpha, as Blender keeps those of premultiplied pictures."""
    alpha = pixels[..., 3:]
    if alpha.min() == 255:
        return pixels
    partly = np.where(alpha == 0, 255.0, alpha).astype(np.float32)
    pixels[..., :3] = np.minimum(pixels[..., :3] * (255.0 / partly) + 0.5, 255.0)
    return pixels


def _from_blender(image: Any) -> NDArray | None:
    """(height, width, 4) from Blender's own buffer: uint8 as encoded, or float32 linear; None if it
    has no pixels.
    """
    flat = np.empty(len(image.pixels), np.float32)
    width, height = image.size
    if width * height == 0 or len(flat) == 0:
        return None
    image.pixels.foreach_get(flat)
    pixels = flat.reshape(height, width, -1)
    if pixels.shape[2] != 4:
        full = np.ones((height, width, 4), np.float32)
        gray = pixels.shape[2] < 3
        full[..., :3] = pixels[..., :1] if gray else pixels[..., :3]
        pixels = full
    if image.is_float:
        return pixels
    pixels *= 255.0  # in place: large pictures take longer to copy than to compute
    pixels += 0.5
    return pixels.astype(np.uint8)
