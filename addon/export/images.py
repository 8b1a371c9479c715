"""Blender images -> core.scene.Texture."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.scene import Extension, Interpolation, Texture
from .cancelled import Watch
from .color_spaces import LINEAR_SPACES, is_data, srgb_to_linear, to_linear
from .kept import Kept, identity
from .report import Report

BLENDER_5 = bpy.app.version >= (5, 0, 0)
FIRST_TILE = 1001
LEAST_BELOW_ZERO = 0.002  # of an image's light: less nobody sees
MISSING_RGBA = (255, 0, 255, 255)  # what Cycles shows in place of an image that cannot be read
PINK = np.full((1, 1, 4), MISSING_RGBA, np.uint8)
INTERPOLATIONS = {
    "Closest": Interpolation.CLOSEST,
    "Cubic": Interpolation.CUBIC,
    "Smart": Interpolation.CUBIC,
}
EXTENSIONS = {
    "REPEAT": Extension.REPEAT,
    "EXTEND": Extension.EXTEND,
    "CLIP": Extension.CLIP,
    "MIRROR": Extension.MIRROR,
}


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


class Textures:
    """The textures of one scene, each image (with its way of reading) once. Indices point into
    `list`.
    """

    def __init__(self, report: Report, kept: Kept, watch: Watch | None = None) -> None:
        self.list: list[Texture] = []
        self._report, self._kept, self._watch = report, kept, watch or Watch()
        self._known: dict[tuple[Any, ...], int] = {}
        self._below_zero: dict[int, float] = {}
        # however many textures read it
        self._read: dict[tuple[int, str, int], ImagePixels] = {}

    def add(self, texture: Texture) -> int:
        self.list.append(texture)
        return len(self.list) - 1

    def of_node(self, node: Any, owner: str, tile: int = FIRST_TILE) -> int:
        """Index of the texture that an Image (or Environment) Texture node reads, or one of its
        UDIM tiles; warnings name `owner`.
        """
        image = node.image
        interpolation = INTERPOLATIONS.get(node.interpolation, Interpolation.LINEAR)
        extension = EXTENSIONS.get(getattr(node, "extension", "REPEAT"), Extension.REPEAT)
        path = _path(image, node, tile) if image else ""
        found = self._once(image, path, owner, tile)
        if found.pixels is PINK:
            extension = Extension.EXTEND  # the alpha is 1 everywhere
        if found.gray and extension is Extension.CLIP:
            extension = Extension.CLIP_OPAQUE
        key = (
            image.as_pointer() if image else 0,
            path,
            tile,
            interpolation,
            extension,
        )
        if key not in self._known:
            self._known[key] = self.add(
                Texture(
                    image.name if image else "(none)",
                    found.pixels,
                    found.srgb,
                    interpolation,
                    extension,
                )
            )
            self._below_zero[self._known[key]] = found.below_zero
        return self._known[key]

    def report_below_zero(self, index: int, owner: str) -> None:
        """Warn if the texture as a world would take light away in Cycles: here it takes none."""
        share = self._below_zero.get(index, 0.0)
        if share > LEAST_BELOW_ZERO:
            self._report.warn(
                f"{owner}: image '{self.list[index].name}' has light below zero, "
                f"{100.0 * share:.1f} % of that above; taken as none"
            )

    def _once(self, image: Any, path: str, owner: str, tile: int) -> ImagePixels:
        key = (image.as_pointer() if image else 0, path, tile)
        if key not in self._read:
            self._watch.go_on()
            self._read[key] = self._pixels(image, path, owner, tile)
        return self._read[key]

    def _pixels(self, image: Any, path: str, owner: str, tile: int) -> ImagePixels:
        if image is None or image.is_dirty or image.source == "MOVIE" or tile != FIRST_TILE:
            return _read(image, path, owner, self._report, tile)
        changed = os.stat(path).st_mtime_ns if os.path.isfile(path) else 0
        reading = (image.colorspace_settings.name, image.alpha_mode, image.source)
        key = ("image", identity(image), path, changed, owner, *reading)
        return self._kept.get(
            key,
            (identity(image),),
            self._report,
            lambda report: _read(image, path, owner, report),
        )


def is_associated(image: Any) -> bool:
    """True if the colours of its texture are times their alpha (which they are not meant to be
    where a tree asks for the alpha).
    """
    return image is not None and image.alpha_mode in {"STRAIGHT", "PREMUL"} and not is_data(image)


def _read(image: Any, path: str, owner: str, report: Report, tile: int = FIRST_TILE) -> ImagePixels:
    """The image; pink where there is none."""
    if image is None:
        report.warn(f"{owner}: an image texture has no image; shown in pink")
        return ImagePixels(PINK, True)
    named = f"image '{image.name}'"
    if image.source == "MOVIE":
        report.warn(f"{owner}: {named}: movies are not supported; one frame is used")
    raw = (
        _from_file(path)
        if image.source in {"FILE", "SEQUENCE", "TILED"}
        and not image.packed_file
        and not image.is_dirty
        else None
    )
    if raw is None and image.source == "TILED":
        raw = _from_packed_tile(image, tile)
    from_file = raw is not None
    gray = raw is not None and raw[1] == 1 and not image.packed_file
    # Blender's own buffer is that of the first tile
    first = image.source != "TILED" or tile == image.tiles[0].number
    pixels = raw[0] if raw is not None else _own_pixels(image) if first else None
    if pixels is None:
        report.warn(
            f"{owner}: {named}: "
            f"{path or (f'tile {tile}' if image.source == 'TILED' else 'its file')} cannot be "
            "read; shown in pink",
            missing=True,
        )
        return ImagePixels(PINK, True)
    space = "Raw" if is_data(image) else image.colorspace_settings.name
    if pixels.dtype != np.uint8:
        if not from_file:  # Blender has decoded it
            space = "Raw"
        if not np.isfinite(pixels).all():
            report.warn(f"{owner}: {named} holds values that are not finite numbers; read as 0")
            pixels = np.nan_to_num(pixels, nan=0.0, posinf=0.0, neginf=0.0)
    mode, multiplies = "NONE", False
    if image.alpha_mode == "NONE":
        pixels[..., 3] = 255 if pixels.dtype == np.uint8 else 1.0
    elif not is_data(image) and image.alpha_mode in {"STRAIGHT", "PREMUL"}:
        # Cycles takes grey pictures with an alpha as they are
        as_is = raw is not None and raw[1] == 2
        # Before 5.0 it goes by what the file says of itself, not by the image's alpha mode
        own_mode = "STRAIGHT" if raw is not None and raw[2] else "PREMUL"
        # A byte buffer of Blender is straight whatever the file says, which Cycles overlooks from
        # 5.0 on.
        buffer = not from_file and not BLENDER_5 and pixels.dtype == np.uint8
        by_image = image.alpha_mode if BLENDER_5 or not from_file else own_mode
        mode = "PREMUL" if as_is else "STRAIGHT" if buffer else by_image
        multiplies = mode == "STRAIGHT" and (from_file or BLENDER_5 or pixels.dtype == np.uint8)
    if space == "sRGB" or (pixels.dtype == np.uint8 and space in LINEAR_SPACES):
        # decoded after pixels are interpolated, as in Cycles
        if multiplies:
            _multiply(pixels)
        below_zero = 0.0 if pixels.dtype == np.uint8 else _below_zero(pixels[..., :3])
        return ImagePixels(pixels, space == "sRGB", gray, below_zero)
    return _decoded(pixels, space, mode, multiplies, gray, f"{owner}: {named}", report)


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
        path = image.filepath.replace("<UDIM>", str(tile)).replace(
            "<UVTILE>", f"u{column + 1}_v{row + 1}"
        )
    return bpy.path.abspath(path, library=image.library) if path else ""


RawPixels = tuple[NDArray, int, bool]
"""(height, width, 4) uint8 or float32 as stored in a file, bottom row first; its number of
channels; whether its colours are not times their alpha.
"""


def _from_file(path: str) -> RawPixels | None:
    """None: OpenImageIO is not there or cannot."""
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
    straight = bool(spec.get_int_attribute("oiio:UnassociatedAlpha"))
    eight_bit = spec.format.basetype == oiio.UINT8
    pixels = file.read_image(0, 0, 0, channels, oiio.UINT8 if eight_bit else oiio.FLOAT)
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


def _from_packed_tile(image: Any, tile: int) -> RawPixels | None:
    """As _from_file(), of a tile that is packed into the .blend file; None if it is not."""
    packed = next((file for file in image.packed_files if file.tile_number == tile), None)
    if packed is None or packed.packed_file is None or image.is_dirty:
        return None
    return _from_data(packed.packed_file.data, image)


def _from_data(data: bytes, image: Any) -> RawPixels | None:
    """As _from_file(), of what a file of the image holds; None as well where no room is for it."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "image" + os.path.splitext(image.filepath)[1])
            with open(path, "wb") as file:
                file.write(data)
            return _from_file(path)
    except OSError:
        return None


def _own_pixels(image: Any) -> NDArray | None:
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
    return _from_blender(image)


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
