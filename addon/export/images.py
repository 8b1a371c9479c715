"""Blender images -> core.scene.Texture."""

from __future__ import annotations

import os
from typing import Any

from ..core.scene import Extension, Interpolation, Texture
from .cancelled import Watch
from .image_files import FIRST_TILE, image_path
from .image_pixels import PINK, ImagePixels, read_image
from .kept import Kept, identity
from .report import Report

LEAST_BELOW_ZERO = 0.002  # of an image's light: less nobody sees
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
        path = image_path(image, node, tile) if image else ""
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
            return read_image(image, path, owner, self._report, tile)
        changed = os.stat(path).st_mtime_ns if os.path.isfile(path) else 0
        reading = (image.colorspace_settings.name, image.alpha_mode, image.source)
        key = ("image", identity(image), path, changed, owner, *reading)
        return self._kept.get(
            key,
            (identity(image),),
            self._report,
            lambda report: read_image(image, path, owner, report),
        )
