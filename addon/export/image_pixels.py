"""An image's pixels as Cycles would have them: which buffer, which colour space, which alpha."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .color_spaces import LINEAR_SPACES, is_data, srgb_to_linear, to_linear
from .image_files import FIRST_TILE, RawPixels, file_pixels, own_pixels, packed_tile_pixels
from .report import Report

BLENDER_5 = bpy.app.version >= (5, 0, 0)
MISSING_RGBA = (255, 0, 255, 255)  # what Cycles shows in place of an image that cannot be read
PINK = np.full((1, 1, 4), MISSING_RGBA, np.uint8)


@dataclass(frozen=True, slots=True)
class ImagePixels:
    """(height, width, 4) as core.scene.Texture has them, colour times alpha as Cycles has them, and
    whether they are sRGB-encoded; `gray`: the file has nothing but grey, which Cycles shows opaque
    outside of the picture too; `below_zero`: the sum of the colours below zero over that of those
    above.
    """

    pixels: NDArray
    srgb: bool
    gray: bool = False
    below_zero: float = 0.0


def is_associated(image: Any) -> bool:
    """True if the colours of its texture are times their alpha (which they are not meant to be
    where a tree asks for the alpha).
    """
    return image is not None and image.alpha_mode in {"STRAIGHT", "PREMUL"} and not is_data(image)


def read_image(
    image: Any, path: str, owner: str, report: Report, tile: int = FIRST_TILE
) -> ImagePixels:
    """The image; pink where there is none."""
    if image is None:
        report.warn(f"{owner}: an image texture has no image; shown in pink")
        return ImagePixels(PINK, True)
    named = f"{owner}: image '{image.name}'"
    if image.source == "MOVIE":
        report.warn(f"{named}: movies are not supported; one frame is used")
    raw = _raw_pixels(image, path, tile)
    # Blender's own buffer is that of the first tile
    first = image.source != "TILED" or tile == image.tiles[0].number
    pixels = raw[0] if raw is not None else own_pixels(image) if first else None
    if pixels is None:
        where = f"tile {tile}" if image.source == "TILED" else "its file"
        report.warn(f"{named}: {path or where} cannot be read; shown in pink", missing=True)
        return ImagePixels(PINK, True)
    gray = raw is not None and raw[1] == 1 and not image.packed_file
    space = "Raw" if is_data(image) else image.colorspace_settings.name
    if pixels.dtype != np.uint8:
        if raw is None:  # Blender has decoded it
            space = "Raw"
        if not np.isfinite(pixels).all():
            report.warn(f"{named} holds values that are not finite numbers; read as 0")
            pixels = np.nan_to_num(pixels, nan=0.0, posinf=0.0, neginf=0.0)
    if image.alpha_mode == "NONE":
        pixels[..., 3] = 255 if pixels.dtype == np.uint8 else 1.0
    mode, multiplies = _alpha(image, raw, pixels.dtype == np.uint8)
    if space == "sRGB" or (pixels.dtype == np.uint8 and space in LINEAR_SPACES):
        # decoded after pixels are interpolated, as in Cycles
        if multiplies:
            _multiply(pixels)
        below_zero = 0.0 if pixels.dtype == np.uint8 else _below_zero(pixels[..., :3])
        return ImagePixels(pixels, space == "sRGB", gray, below_zero)
    return _decoded(pixels, space, mode, multiplies, gray, named, report)


def _raw_pixels(image: Any, path: str, tile: int) -> RawPixels | None:
    """What is in the image's file; None where Blender alone can tell."""
    in_files = image.source in {"FILE", "SEQUENCE", "TILED"}
    raw = None
    if in_files and not image.packed_file and not image.is_dirty:
        raw = file_pixels(path)
    if raw is None and image.source == "TILED":
        raw = packed_tile_pixels(image, tile)
    return raw


def _alpha(image: Any, raw: RawPixels | None, are_bytes: bool) -> tuple[str, bool]:
    """How the alpha is meant ("NONE", "STRAIGHT", "PREMUL"), and whether colours are still to be
    multiplied by it.
    """
    if is_data(image) or image.alpha_mode not in {"STRAIGHT", "PREMUL"}:
        return "NONE", False
    if raw is not None and raw[1] == 2:  # Cycles takes grey pictures with an alpha as they are
        mode = "PREMUL"
    elif raw is None and not BLENDER_5 and are_bytes:
        # A byte buffer of Blender is straight whatever the file says, which Cycles overlooks from
        # 5.0 on
        mode = "STRAIGHT"
    elif raw is None or BLENDER_5:
        mode = image.alpha_mode
    else:  # before 5.0 Cycles goes by what the file says of itself, not by the image's alpha mode
        mode = "STRAIGHT" if raw[2] else "PREMUL"
    return mode, mode == "STRAIGHT" and (raw is not None or BLENDER_5 or are_bytes)


def _multiply(pixels: NDArray) -> None:
    """Colours by their alpha."""
    alpha = pixels[..., 3:]
    if pixels.dtype != np.uint8:
        pixels[..., :3] *= alpha
    elif alpha.min() < 255:
        pixels[..., :3] = pixels[..., :3] * alpha.astype(np.uint16) // 255


def _decoded(
    pixels: NDArray,
    space: str,
    mode: str,
    multiplies: bool,
    gray: bool,
    named: str,
    report: Report,
) -> ImagePixels:
    """Linear colours times alpha. As in Cycles, encoded colours are decoded without it."""
    if pixels.dtype == np.uint8:
        pixels = pixels.astype(np.float32) / 255.0
    alpha = pixels[..., 3:]
    after = mode in {"STRAIGHT", "PREMUL"} and space not in LINEAR_SPACES and alpha.min() < 1.0
    if after and mode == "PREMUL":
        pixels[..., :3] = np.divide(
            pixels[..., :3], alpha, out=np.zeros_like(pixels[..., :3]), where=alpha > 0.0
        )
    if multiplies and not after:
        _multiply(pixels)
    linear = to_linear(pixels[..., :3], space)
    if linear is None:
        nearest = "Linear Rec.709" if space.startswith(("Linear", "ACEScg", "ACES2065")) else "sRGB"
        report.warn(f"{named}: colour space {space} is not supported; read as {nearest}")
        linear = pixels[..., :3] if nearest != "sRGB" else srgb_to_linear(pixels[..., :3])
    pixels[..., :3] = linear
    if after:
        pixels[..., :3] *= alpha
    return ImagePixels(pixels, False, gray, _below_zero(linear))


def _below_zero(colors: NDArray) -> float:
    if colors.size == 0 or colors.min() >= 0.0:
        return 0.0
    given = float(np.maximum(colors, 0.0).sum(dtype=np.float64))
    taken = float(-np.minimum(colors, 0.0).sum(dtype=np.float64))
    return taken / given if given > 0.0 else 1.0
