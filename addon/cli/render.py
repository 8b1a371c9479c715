"""Opens a scene in Blender, renders frames of its view layers and writes the files."""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Callable
from typing import Any

from ..core.render.data_passes import manifests
from ..core.render.result import RenderResult
from ..core.render.settings import RenderSettings
from ..core.scene import Frame
from .arguments import CommandError, Interrupted, settings_of
from .drawn_over import has_drawings, take_drawings
from .exr import channels_of, replace_file, write_exr
from .frames import of_each_frame
from .opening import open_file
from .progress import OpenJdProgress, ProgressBar, say
from .records import Records, warn_of_small_parts


def render_frames(
    options: argparse.Namespace, started: float, interrupted: Callable[[], bool]
) -> None:
    """Renders and writes one frame after the other. `started`: time.monotonic() when the command
    began. Raises CommandError; frames that have been written stay.
    """
    scene = None
    for one in of_each_frame(options):
        if scene is None:
            scene = open_scene(options)
        if one.frame is not None:
            scene.frame_set(one.frame)
        records = Records(one)
        try:
            results = render_layers(one, scene, interrupted, records)
        except Interrupted as error:
            if options.frames is None or one.checkpoint is not None:
                raise
            raise Interrupted(f"interrupted; frame {one.frame} was not written") from error
        total = results[0][1].statistics["seconds"]["total"]
        if one.part is not None:
            records.write_part(one)
        write_files(one, scene, results, time.monotonic() - started - total)
        if options.frames is not None:
            say(f"photon-splat: frame {one.frame}: {one.output}\n")
        started = time.monotonic()
    if scene is None:
        say("photon-splat: every picture is there, nothing was rendered\n")


def open_scene(options: argparse.Namespace) -> Any:
    scene = open_file(options.scene)
    if options.strict or options.part is not None:
        _check_libraries()
    warn_of_small_parts(options.part, settings_of(options)(_settings(scene)))
    render = scene.render
    render.engine = "PHOTON_SPLAT"
    render.use_compositing = render.use_sequencer = False
    # what is written is raw unless somebody has asked for something else
    if options.denoise is None and not scene.photon_splat.is_property_set("denoise"):
        options.denoise = False
    if options.resolution is not None:
        render.resolution_x, render.resolution_y = options.resolution
        render.resolution_percentage = 100
    if scene.camera is None and not any(marker.camera for marker in scene.timeline_markers):
        raise CommandError(
            f"Scene '{scene.name}' has no camera: add one, or set an object as the scene's active "
            "camera"
        )
    return scene


def _settings(scene: Any) -> RenderSettings:
    from ..blender.properties import render_settings

    return render_settings(scene)


def _check_libraries() -> None:
    import bpy

    for library in bpy.data.libraries:
        path = bpy.path.abspath(library.filepath)
        if not library.packed_file and not os.path.isfile(path):
            raise CommandError(f"the linked file {path} does not exist")


def render_layers(
    options: argparse.Namespace, scene: Any, interrupted: Callable[[], bool], records: Records
) -> list[tuple[str, RenderResult, Frame]]:
    """One result per view layer that is rendered, under its name."""
    import bpy

    from ..blender.job import describe, observer

    results: list[tuple[RenderResult, Frame]] = []
    errors: list[BaseException] = []
    bar = OpenJdProgress() if options.progress == "openjd" else ProgressBar()
    observer.settings = settings_of(options)
    observer.on_progress = bar.show
    observer.on_result = lambda result, frame: results.append((result, frame))
    observer.on_error = errors.append
    observer.should_cancel = interrupted
    observer.record = records.make
    observer.needs_files = options.strict or options.part is not None
    failure = None
    try:
        bpy.ops.render.render(scene=scene.name)
    except RuntimeError as error:
        failure = error
    bar.end()
    if interrupted():
        raise records.interrupted()
    if errors:
        raise CommandError(describe(errors[0]))
    if failure is not None:
        raise CommandError(" ".join(str(failure).split()).removeprefix("Error: "))
    if not results:
        raise CommandError("Blender rendered no view layer; is at least one enabled for rendering?")
    names = _names(scene, len(results))
    layers = [(name, result, frame) for name, (result, frame) in zip(names, results, strict=False)]
    if has_drawings(scene):
        if options.part is not None or scene.render.use_multiview:
            of_what = "parts" if options.part is not None else "stereo pictures"
            say(
                "photon-splat: warning: grease pencil objects and Freestyle are not drawn over "
                f"{of_what}\n"
            )
        else:
            take_drawings(scene, layers)
    return layers


def _names(scene: Any, count: int) -> list[str]:
    """Of `count` results: view layers, and of each its views; the first view is not named."""
    render = scene.render
    views = [""]
    if render.use_multiview:
        used = [view.name for view in render.views if view.use]
        eyes = [name for name in used if name in ("left", "right")]
        views = (eyes if render.views_format == "STEREO_3D" else used) or views
    names = [layer.name for layer in scene.view_layers if layer.use]
    names += [f"Layer {i}" for i in range(len(names), -(-count // len(views)))]
    return [
        f"{name}.{view}" if number else name for name in names for number, view in enumerate(views)
    ][:count]


def write_files(
    options: argparse.Namespace,
    scene: Any,
    results: list[tuple[str, RenderResult, Frame]],
    startup: float,
) -> None:
    from .. import version

    _, first, frame = results[0]
    names, planes = channels_of(first.passes)
    for name, result, _ in results[1:]:
        more, others = channels_of(result.passes, f"{name}.", plain=False)
        names += more
        planes += others
    statistics = first.statistics | {"startup_seconds": startup, "version": version()}
    metadata: dict[str, str | int | float] = {
        "Software": f"Photon Splat {version()}",
        "photon_splat:passes": statistics["passes"],
        "photon_splat:photons": str(statistics["photons"]["traced"]),
        "photon_splat:seconds": float(statistics["seconds"]["total"]),
        "photon_splat:integrator": statistics["integrator"],
        **{
            f"photon_splat:{name}": float(statistics["error"][name])
            for name in ("relative_rmse", "standard_error", "bias")
        },
    }
    for i, (name, result, _) in enumerate(results):
        if result.labels is not None:
            metadata |= manifests(result.labels, f"{name}." if i else "")
    if options.part is None:
        write_exr(
            options.output,
            names,
            planes,
            frame,
            crop=scene.render.use_crop_to_border,
            pixel_aspect=scene.render.pixel_aspect_x / scene.render.pixel_aspect_y,
            metadata=metadata,
        )
    if options.stats is not None:
        replace_file(
            options.stats, lambda path: path.write_text(json.dumps(statistics, indent=2) + "\n")
        )
    for warning in statistics["warnings"]:
        say(f"photon-splat: warning: {warning}\n")
