"""One render of one view layer for Blender: export, render, hand over the passes; errors and
warnings reach the user.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np

from ..core.render.data_passes import manifests
from ..core.render.memory import current_memory_bytes, peak_memory_bytes
from ..core.render.record import Record
from ..core.render.result import Progress, RenderResult
from ..core.render.session import render
from ..core.render.settings import RenderSettings
from ..core.render.statistics import Statistics
from ..core.scene import Camera, Frame, Scene
from ..export import export_scene
from ..export.camera import NoCameraError, export_frame
from ..export.cancelled import Cancelled, Watch
from ..export.kept import Kept
from ..export.report import readable
from ..export.views import View, views_of
from .passes import fill_passes, own_name, with_noisy
from .persistent import Held, held_for
from .properties import render_settings
from .records import origin_of, record_of
from .told import told

PREVIEW: dict[str, Any] = {"passes": 16, "photons_per_pass": 20_000, "time_limit": 2.0}
MAX_REPORT = 300  # characters of a warning in Blender's status bar


@dataclass(slots=True)
class LastRender:
    """What the last render of a scene said, for the panel."""

    statistics: Statistics | None = None
    """None after an error."""
    warnings: list[str] = field(default_factory=list)
    error: str = ""


@dataclass(slots=True)
class Observer:
    """A program around Blender (the command line) that watches renders and has the last word on
    their settings.
    """

    started: float | None = None
    settings: Callable[[RenderSettings], RenderSettings] = lambda settings: settings
    on_progress: Callable[[Progress], None] = lambda progress: None
    on_result: Callable[[RenderResult, Frame], None] | None = None
    """Gets all passes; without an observer only the passes that Blender asks for are made."""
    on_error: Callable[[BaseException], None] = lambda error: None
    should_cancel: Callable[[], bool] = lambda: False
    record: Callable[[dict[str, Any]], Record] | None = None
    """What is to be kept of the sums of a view layer, by origin_of(); without it the scene's own
    settings say so.
    """
    needs_files: bool = False
    """A missing file of the scene is an error."""


observer = Observer()
last_renders: dict[str, LastRender] = {}
"""By the name of the scene."""


def render_view_layer(engine: Any, depsgraph: Any) -> None:
    """The body of RenderEngine.render: always begins and ends a result, or Blender saves a blank
    frame or crashes.
    """
    started = observer.started or time.monotonic()
    blender_result = result = None
    failed = True
    # The graph may be gone when the render has ended.
    scene_name, layer_name = depsgraph.scene.name, depsgraph.view_layer_eval.name
    try:
        held = held_for(engine, depsgraph)
        frame = export_frame(depsgraph.scene_eval, depsgraph.view_layer, _settings_of(engine))
        _, _, width, height = frame.region
        blender_result = engine.begin_result(0, 0, width, height, layer=layer_name)
        views = views_of(engine, blender_result, depsgraph.scene)
        kept = Kept() if len(views) > 1 else None
        told_before: set[str] = set()
        for number, view in enumerate(views):
            job = _Job(engine, depsgraph, frame, blender_result, held, kept, view, number)
            result = _render(job, started, last=number + 1 == len(views))
            fill_passes(blender_result, with_noisy(result), number)
            _finish(engine, scene_name, result, told_before)
            if observer.on_result:
                observer.on_result(result, frame)
            if result.cancelled:
                break
            started = time.monotonic()
        failed = False
    except NoCameraError as error:
        if not engine.is_preview:
            _fail(engine, scene_name, error)
    except BaseException as error:
        _fail(engine, scene_name, error)
    finally:
        engine.end_result(blender_result or engine.begin_result(0, 0, 1, 1), cancel=failed)
    if result is not None and result.labels is not None:
        layer, whole = f"{layer_name}.", engine.get_result()
        for key, value in manifests(result.labels, layer).items():
            whole.stamp_data_add_field(key, value)


def _settings_of(engine: Any) -> Any:
    """The bpy.types.RenderSettings of the picture. Where a compositor asks for other scenes too all
    of them are rendered in the size, and with the border, of the one that is rendered.
    """
    # RenderEngine.render, which the method of that name hides
    return engine.path_resolve("render")


@dataclass(frozen=True, slots=True)
class _Job:
    """One view of a view layer. kept: what its views share; number: that of the view."""

    engine: Any
    depsgraph: Any
    frame: Frame
    blender_result: Any
    held: Held | None
    kept: Kept | None
    view: View | None
    number: int


def _render(job: _Job, started: float, last: bool) -> RenderResult:
    """last: of the views of a view layer."""
    engine, depsgraph, frame, held = job.engine, job.depsgraph, job.frame, job.held
    if job.view is not None:
        job.view.enter()
    engine.update_stats("", "Exporting scene")
    settings = observer.settings(render_settings(depsgraph.scene_eval, depsgraph.view_layer))
    if engine.is_preview:
        settings = replace(settings, **PREVIEW)
    began = time.monotonic()

    def should_cancel() -> bool:
        return engine.test_break() or observer.should_cancel()

    try:
        scene = export_scene(
            depsgraph,
            engine.camera_override,
            frame,
            held.kept if held else job.kept,
            Watch(should_cancel),
            None if engine.is_preview else engine.frame_set,
            job.view,
        )
    except Cancelled:  # The result of a render that is cancelled at once, of an empty scene.
        nothing = Scene(Camera(np.eye(4), (-1.0, 1.0, -1.0, 1.0)), frame)
        return render(nothing, settings, started=started, should_cancel=lambda: True)
    if observer.needs_files and scene.missing:
        raise ValueError(scene.missing[0])
    if held:
        held.kept.forget_unused()
    elif job.kept is not None and last:
        job.kept.clear()
    export_seconds = time.monotonic() - began
    record = Record()
    if not engine.is_preview:
        record = (
            observer.record(origin_of(depsgraph, scene))
            if observer.record
            else record_of(depsgraph, scene)
        )
    if record.active and job.view is not None:
        raise ValueError(
            "Parts and checkpoints hold one view: switch Stereoscopy off, or render each camera by "
            "itself"
        )

    # As Cycles does where nobody edits meanwhile: Blender's evaluated copies of the scene.
    if bpy.app.background and held is None and not engine.is_preview and last:
        engine.free_blender_memory()

    def on_progress(progress: Progress) -> None:
        engine.update_progress(progress.fraction)
        engine.update_stats(
            f"Remaining: {remaining(progress, time.monotonic() - started)}", progress.message
        )
        engine.update_memory_stats(
            memory_used=current_memory_bytes() / 2**20, memory_peak=peak_memory_bytes() / 2**20
        )
        if progress.interim is not None:
            fill_passes(job.blender_result, progress.interim, job.number)
            engine.update_result(job.blender_result)
        observer.on_progress(progress)

    result = render(
        scene,
        settings,
        started=started,
        export_seconds=export_seconds,
        on_progress=on_progress,
        should_cancel=should_cancel,
        want_interim=not (bpy.app.background or engine.is_preview),
        persistent=held.persistent if held else None,
        release=last,
        record=record,
        wanted=None
        if observer.on_result
        else {own_name(p.name) for layer in job.blender_result.layers for p in layer.passes},
    )
    if observer.record is None and not result.cancelled:
        record.forget()
    result.statistics["warnings"] = told(result.statistics["warnings"])
    return result


def remaining(progress: Progress, elapsed: float) -> str:
    """Time that is left (minutes:seconds), if the render goes on as in the `elapsed` seconds so
    far.
    """
    if not progress.passes_done or not progress.fraction > 0.0:
        return "--:--"
    seconds = round(elapsed * (1.0 / progress.fraction - 1.0))
    return (
        f"{seconds // 60:02}:{seconds % 60:02}"
        if seconds < 3600
        else f"{seconds // 3600}:{seconds % 3600 // 60:02}:{seconds % 60:02}"
    )


def _finish(engine: Any, scene_name: str, result: RenderResult, told_before: set[str]) -> None:
    """told_before: warnings of earlier views; those of this one are added."""
    if engine.is_preview:
        return
    warnings = list(result.statistics["warnings"])
    last_renders[scene_name] = LastRender(result.statistics, warnings)
    engine.update_progress(1.0)
    for warning in (w for w in warnings if w not in told_before):
        short = (
            warning
            if len(warning) <= MAX_REPORT
            else warning[:MAX_REPORT] + "... (Render Properties > Approximated has all of it)"
        )
        engine.report({"WARNING"}, f"Photon Splat: {short}")
    told_before.update(warnings)


def _fail(engine: Any, scene_name: str, error: BaseException) -> None:
    """`report` makes the operator fail and save nothing; `error_set` shows the message in the
    picture's window.
    """
    if not isinstance(error, ValueError | RuntimeError | MemoryError | ImportError):
        traceback.print_exception(error)
    message = describe(error)
    engine.report({"ERROR"}, f"Photon Splat: {message}")
    engine.error_set(message)
    observer.on_error(error)
    last_renders[scene_name] = LastRender(error=message)


def describe(error: BaseException) -> str:
    """One line that says what went wrong."""
    text = readable(" ".join(str(error).split()))
    if isinstance(error, MemoryError):
        return f"not enough memory{': ' + text if text else ''}"
    if isinstance(error, KeyboardInterrupt):
        return "interrupted"
    if isinstance(error, ValueError | RuntimeError | ImportError) and text:
        return text
    return f"internal error ({type(error).__name__}): {text}"
