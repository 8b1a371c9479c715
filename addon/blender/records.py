"""What renders of Blender keep of their sums: parts and checkpoints."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import bpy

from ..core.files import with_number
from ..core.render.data_passes import matte_names
from ..core.render.record import Checkpoint, Record
from ..core.scene import Labels, Scene
from ..export.report import readable
from .properties import render_settings


def _readable(labels: Labels) -> dict[str, list[str]]:
    return {
        name: [readable(thing) for thing in things] for name, things in matte_names(labels).items()
    }


def origin_of(depsgraph: Any, exported: Scene) -> dict[str, Any]:
    """Who renders what, as core.render.sums.picture_of() asks for it."""
    from .. import version

    scene = depsgraph.scene
    return {
        "engine": version(),
        "blender": bpy.app.version_string,
        "file": bpy.path.basename(bpy.data.filepath),
        "scene": scene.name,
        "number": scene.frame_current,
        "layer": depsgraph.view_layer_eval.name,
        "crop": bool(scene.render.use_crop_to_border),
        "pixel_aspect": scene.render.pixel_aspect_x / scene.render.pixel_aspect_y,
        "mattes": _readable(exported.labels) if exported.labels is not None else {},
        "warnings": list(exported.warnings),
    }


def record_of(depsgraph: Any, exported: Scene) -> Record:
    """As the scene's settings have it. Raises ValueError if its checkpoint cannot be read."""
    scene = depsgraph.scene
    settings = scene.photon_splat_farm
    if not settings.use_checkpoint:
        return Record()
    if settings.checkpoint.startswith("//") and not bpy.data.filepath:
        raise ValueError("The checkpoint is beside a file that has not been saved: save the file")
    path = with_number(Path(bpy.path.abspath(settings.checkpoint)), scene.frame_current)
    checkpoint = Checkpoint(path, 60.0 * settings.checkpoint_minutes, resume=settings.resume)
    return Record(checkpoint=checkpoint, origin=origin_of(depsgraph, exported))


def limits_of_parts(scene: Any, parts: int) -> list[str]:
    """Options for each part of a picture with the settings of `scene`."""
    settings = render_settings(scene, scene.view_layers[0])
    limits = ["--passes", str(math.ceil(settings.passes / parts))]
    if settings.error_threshold:
        limits += ["--error", f"{settings.error_threshold:.6g}"]
    if settings.time_limit:
        limits += ["--seconds", f"{settings.time_limit:.6g}"]
    return limits
