"""Blender images -> core.scene.Texture."""

from __future__ import annotations

import os
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.scene import Extension, Interpolation, Texture
from ..report import Report
from .cancelled import Watch
from .kept import Kept, identity

BLENDER_5 = bpy.app.version >= (5, 0, 0)
FIRST_TILE = 1001
MISSING_RGBA = (255, 0, 255, 255)  # what Cycles shows in place of an image that cannot be read
LINEAR_SPACES = {"Linear Rec.709", "Linear", "Raw", "Non-Color", "Generic Data"}
INTERPOLATIONS = {"Closest": Interpolation.CLOSEST, "Cubic": Interpolation.CUBIC, "Smart": Interpolation.CUBIC}
EXTENSIONS = {"REPEAT": Extension.REPEAT, "EXTEND": Extension.EXTEND, "CLIP": Extension.CLIP, "MIRROR": Extension.MIRROR}


class Textures:
    """The textures of one scene, each image (with its way of reading) once. Indices point into `list`."""

    def __init__(self, report: Report, kept: Kept, watch: Watch | None = None) -> None:
        self.list: list[Texture] = []
        self._report, self._kept, self._watch = report, kept, watch or Watch()
        self._known: dict[tuple[Any, ...], int] = {}
        self._read: dict[tuple[int, str, int], tuple[NDArray, bool]] = {}  # however many ways it is read in

    def add(self, texture: Texture) -> int:
        self.list.append(texture)
        return len(self.list) - 1

    def of_node(self, node: Any, owner: str, tile: int = FIRST_TILE) -> int:
        """Index of the texture that an Image (or Environment) Texture node reads, or one of its UDIM tiles; warnings name `owner`."""
        image = node.image
        interpolation = INTERPOLATIONS.get(node.interpolation, Interpolation.LINEAR)
        extension = EXTENSIONS.get(getattr(node, "extension", "REPEAT"), Extension.REPEAT)
        path = _path(image, node, tile) if image else ""
        key = (image.as_pointer() if image else 0, path, tile, interpolation, extension)
        if key not in self._known:
            pixels, srgb = self._once(image, path, owner, tile)
            self._known[key] = self.add(Texture(image.name if image else "(none)", pixels, srgb, interpolation, extension))
        return self._known[key]

    def _once(self, image: Any, path: str, owner: str, tile: int) -> tuple[NDArray, bool]:
        key = (image.as_pointer() if image else 0, path, tile)
        if key not in self._read:
            self._watch.go_on()
            self._read[key] = self._pixels(image, path, owner, tile)
        return self._read[key]

    def _pixels(self, image: Any, path: str, owner: str, tile: int) -> tuple[NDArray, bool]:
        if image is None or image.is_dirty or image.source == "MOVIE" or tile != FIRST_TILE:
            return _read(image, path, owner, self._report, tile)
        changed = os.stat(path).st_mtime_ns if os.path.isfile(path) else 0
        reading = (image.colorspace_settings.name, image.alpha_mode, image.source)
        key = ("image", identity(image), path, changed, owner, *reading)
        return self._kept.get(key, (identity(image),), self._report, lambda report: _read(image, path, owner, report))


def is_associated(image: Any) -> bool:
    """True if the colours of its texture are times their alpha (which they are not meant to be where a tree asks for the alpha)."""
    return image is not None and image.alpha_mode in {"STRAIGHT", "PREMUL"} and not _is_data(image)


def srgb_to_linear(encoded: NDArray) -> NDArray:
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4).astype(encoded.dtype)


def _read(image: Any, path: str, owner: str, report: Report, tile: int = FIRST_TILE) -> tuple[NDArray, bool]:
    """Pixels, colour times alpha as Cycles has them, and whether they are sRGB-encoded; pink where there is no image."""
    if image is None:
        report.warn(f"{owner}: an image texture has no image; shown in pink")
        return _pink(), True
    named = f"image '{image.name}'"
    if image.source == "MOVIE":
        report.warn(f"{owner}: {named}: movies are not supported; one frame is used")
    raw = _from_file(path) if image.source in {"FILE", "SEQUENCE", "TILED"} and not image.packed_file and not image.is_dirty else None
    from_file = raw is not None
    first = image.source != "TILED" or tile == image.tiles[0].number  # Blender's own buffer is that of the first tile
    pixels = raw if raw is not None or not first else _from_blender(image)
    if pixels is None:
        report.warn(
            f"{owner}: {named}: {path or (f'tile {tile}' if image.source == 'TILED' else 'its file')} cannot be read; shown in pink"
        )
        return _pink(), True
    srgb, is_data = _color_space(image, owner, report)
    if image.alpha_mode == "NONE":
        pixels[..., 3] = 255 if pixels.dtype == np.uint8 else 1.0
    if pixels.dtype != np.uint8:
        if from_file and srgb:
            pixels[..., :3] = srgb_to_linear(pixels[..., :3])
        if not np.isfinite(pixels).all():
            report.warn(f"{owner}: {named} holds values that are not finite numbers; read as 0")
            pixels = np.nan_to_num(pixels, nan=0.0, posinf=0.0, neginf=0.0)
        if image.alpha_mode == "STRAIGHT" and not is_data and (from_file or BLENDER_5):
            pixels[..., :3] *= pixels[..., 3:]
        return pixels, False
    # A byte buffer of Blender is straight whatever the file says (generated ones only before 5.0); a file with premultiplied
    # colours holds what Cycles shows.
    straight_buffer = not from_file and not (BLENDER_5 and image.source == "GENERATED")
    multiply = image.alpha_mode == "STRAIGHT" or (image.alpha_mode == "PREMUL" and straight_buffer)
    if multiply and not is_data and pixels[..., 3].min() < 255:
        alpha = pixels[..., 3:].astype(np.uint16)
        pixels[..., :3] = pixels[..., :3] * alpha // 255
    return pixels, srgb


def _path(image: Any, node: Any, tile: int) -> str:
    """The image's file for the current frame, or of a UDIM tile; absolute, or "" if it has none."""
    if image.source not in {"FILE", "SEQUENCE", "TILED", "MOVIE"}:
        return ""
    try:
        path = image.filepath_from_user(image_user=node.image_user)
    except (AttributeError, RuntimeError, TypeError):
        path = image.filepath
    if image.source == "TILED":
        row, column = divmod(tile - FIRST_TILE, 10)
        path = image.filepath.replace("<UDIM>", str(tile)).replace("<UVTILE>", f"u{column + 1}_v{row + 1}")
    return bpy.path.abspath(path, library=image.library) if path else ""


def _from_file(path: str) -> NDArray | None:
    """(height, width, 4) uint8 or float32 as stored in the file, bottom row first; None if OpenImageIO is not there or cannot."""
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
    channels = min(spec.nchannels, 4)
    eight_bit = spec.format.basetype == oiio.UINT8
    pixels = file.read_image(0, 0, 0, channels, oiio.UINT8 if eight_bit else oiio.FLOAT)
    broken = pixels is None or spec.depth > 1 or spec.get_string_attribute("oiio:ColorSpace").upper() == "CMYK"
    file.close()
    if broken:
        oiio.geterror()
        return None
    pixels = np.asarray(pixels).reshape(spec.height, spec.width, channels)
    rgba = np.full((spec.height, spec.width, 4), 255 if eight_bit else 1.0, np.uint8 if eight_bit else np.float32)
    gray = channels < 3
    rgba[..., :3] = pixels[::-1, :, :1] if gray else pixels[::-1, :, :3]
    if channels in {2, 4}:
        rgba[..., 3] = pixels[::-1, :, -1]
    return rgba


def _from_blender(image: Any) -> NDArray | None:
    """(height, width, 4) from Blender's own buffer: uint8 as encoded, or float32 linear; None if it has no pixels."""
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
    return pixels if image.is_float else np.rint(np.clip(pixels, 0.0, 1.0) * 255.0).astype(np.uint8)


def _color_space(image: Any, owner: str, report: Report) -> tuple[bool, bool]:
    """(sRGB-encoded, not a colour at all)."""
    name = image.colorspace_settings.name
    if _is_data(image):
        return False, True
    if name == "sRGB":
        return True, False
    if name not in LINEAR_SPACES:
        nearest = "Linear Rec.709" if name.startswith(("Linear", "ACEScg", "ACES2065")) else "sRGB"
        report.warn(f"{owner}: image '{image.name}': colour space {name} is not supported; read as {nearest}")
        return nearest == "sRGB", False
    return False, False


def _is_data(image: Any) -> bool:
    settings = image.colorspace_settings
    return bool(getattr(settings, "is_data", False)) or settings.name in {"Non-Color", "Raw", "Generic Data"}


def _pink() -> NDArray[np.uint8]:
    return np.full((1, 1, 4), MISSING_RGBA, np.uint8)
