"""What Blender draws over a picture after its engine has ended: grease pencil objects,
and the lines of Freestyle.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..core.render.result import RenderResult
from ..core.scene import Frame
from .progress import say

MOST_PARTS = 10_000
"""Of a file: more than Blender writes."""

Layer = tuple[str, RenderResult, Frame]
"""A view layer by name."""


def has_drawings(scene: Any) -> bool:
    from ..export.objects import PENCILS

    lines = scene.render.use_freestyle and any(
        layer.use and layer.use_freestyle for layer in scene.view_layers
    )
    return lines or any(ob.type in PENCILS and not ob.hide_render for ob in scene.objects)


def take_drawings(scene: Any, layers: Sequence[Layer]) -> None:
    """Replaces Combined of each view layer by that of Blender's render result, which has the
    drawings. Where that fails, as on a full disk, the picture stays as it is, with a warning.
    """
    try:
        _take_all(scene, layers)
    except (OSError, RuntimeError) as error:
        reason = " ".join(str(error).split()).removeprefix("Error: ")
        say(f"photon-splat: warning: grease pencil objects and Freestyle are missing: {reason}\n")


def _take_all(scene: Any, layers: Sequence[Layer]) -> None:
    import OpenImageIO as oiio

    with tempfile.TemporaryDirectory(prefix="photon_splat_") as folder:
        path = Path(folder, "result.exr")
        _save(scene, path)
        file = oiio.ImageInput.open(str(path))
        if file is None:
            raise RuntimeError(f"the render result cannot be read: {oiio.geterror()}")
        try:
            for part in range(MOST_PARTS):
                if not file.seek_subimage(part, 0):
                    break
                _take(file, part, layers)
        finally:
            file.close()


def _take(file: Any, part: int, layers: Sequence[Layer]) -> None:
    names = list(file.spec().channelnames)
    for layer, result, frame in layers:
        letters = [f"{layer}.Combined.{letter}" for letter in "RGBA"]
        if not set(letters) <= set(names):
            continue
        pixels = file.read_image(part, 0, 0, len(names), "float")
        drawn = pixels[::-1, :, [names.index(letter) for letter in letters]]
        x, y, width, height = frame.region
        if drawn.shape[:2] == (frame.height, frame.width):  # all of it, whatever the border
            drawn = drawn[y : y + height, x : x + width]
        if drawn.shape[:2] != (height, width):
            raise RuntimeError(
                f"Blender's render result has {drawn.shape[1]} x {drawn.shape[0]} pixels, "
                f"not {width} x {height}"
            )
        result.passes["Combined"] = np.ascontiguousarray(drawn)


def _save(scene: Any, path: Path) -> None:
    import bpy

    image = bpy.data.images.get("Render Result")
    if image is None:
        raise RuntimeError("Blender has no render result")
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    image.save_render(str(path), scene=scene)
