"""Runs a render: one thread does passes, the caller's reports progress; then comes the result."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection

import numpy as np

from ..scene import Scene
from .denoise import device_name, has_denoiser
from .denoise_result import denoise_result
from .error_limit import error_left
from .final_film import OF_DENOISING, final_arrays, final_passes
from .final_statistics import final_statistics, still_noisy
from .memory import check_picture_fits, return_freed_memory
from .persistent import Persistent, start_anew
from .record import Record
from .result import Progress, RenderResult, black_passes
from .settings import RenderSettings
from .worker import Worker

POLL_SECONDS = 0.05


def render(
    scene: Scene,
    settings: RenderSettings,
    *,
    started: float,
    export_seconds: float = 0.0,
    on_progress: Callable[[Progress], None] | None = None,
    should_cancel: Callable[[], bool] | None = None,
    want_interim: bool = False,
    persistent: Persistent | None = None,
    release: bool = False,
    wanted: Collection[str] | None = None,
    record: Record | None = None,
) -> RenderResult:
    """Renders `scene`. `started` is `time.monotonic()` when the render call began, export included;
    `persistent` holds what the last render has left for this one, and then what this one leaves.
    `release`: nobody renders `scene` again, so that its pixels and meshes need not be kept beside
    native code's; not with `persistent`. `wanted`: names of the passes to give back besides those
    of light groups (None: all). `record`: what is kept of the film's sums, which are added to those
    of earlier renders; such a render leaves nothing in `persistent`, and finds nothing there.

    Both callbacks run on the caller's thread about every 50 ms. A cancelled render returns what is
    there.
    Errors: ValueError for a scene or setting that cannot be rendered, a GPU that is not there among
    them, or a checkpoint of another picture; RuntimeError and MemoryError from native code.
    """
    record = record or Record()
    if record.active:
        persistent = None
    record.open(scene, settings, started)
    if wanted is not None and settings.denoise:
        wanted = {*wanted, *OF_DENOISING}
    start = start_anew(scene, settings) if persistent is None else persistent.start(scene, settings)
    renderer = start.renderer
    width, height = scene.frame.region[2:]
    if not start.reused:
        check_picture_fits(width, height)
    if release and persistent is None:
        for texture in scene.textures:
            texture.pixels = np.empty((0, 0, 4), texture.pixels.dtype)
        for mesh in scene.meshes:
            mesh.release()
        return_freed_memory()
    worker = Worker(start, settings, started, want_interim, wanted, scene, record)
    if should_cancel is not None and should_cancel():  # a small scene is done before it is asked
        worker.cancel()
    worker.start()
    try:
        while not worker.finished:
            worker.pass_finished.wait(POLL_SECONDS)
            worker.pass_finished.clear()
            if should_cancel is not None and should_cancel():
                worker.cancel()
                break
            if on_progress is not None:
                on_progress(worker.progress())
    except BaseException:
        worker.cancel()
        worker.join()
        raise
    worker.join()
    if worker.error is not None:
        raise worker.error
    if on_progress is not None and not worker.cancelled:
        on_progress(worker.progress())
    if worker.passes_done:
        renderer.end_passes()
        renderer.make_error_estimate()
    source = record.end(renderer, worker.passes_done, worker.samples_done)
    film = source.film(final_arrays(wanted, settings, scene)) if source else None
    passes = final_passes(film, scene) if film else black_passes(width, height, scene.light_groups)
    passes |= worker.data
    denoising, noisy = 0.0, None
    if settings.denoise and film and not worker.cancelled and not record.keeps:
        noisy = passes["Combined"][..., :3].copy()
        began = time.monotonic()
        worker.warnings += denoise_result(
            passes,
            film,
            scene,
            passes_done=record.part.passes_before + worker.passes_done,
            samples=record.samples_before + worker.samples_done,
            quality=worker.denoising_quality(),
            threads=settings.threads,
            on_card=settings.denoises_on_card,
            should_cancel=should_cancel,
        )
        denoising = time.monotonic() - began
    left = error_left(source) if noisy is not None and has_denoiser() else None
    statistics = final_statistics(start, worker, scene, started, export_seconds)
    statistics["error"] = record.error(statistics["error"])
    if left is not None:
        statistics["error"]["denoised"] = left
    statistics["warnings"] += still_noisy(statistics, settings, cancelled=worker.cancelled)
    if settings.denoise:
        statistics["seconds"]["denoise"] = denoising
        statistics["denoiser"] = device_name(settings.denoises_on_card)
    if persistent is not None and worker.prepared:
        persistent.keep(scene, settings, renderer)
    return RenderResult(passes, worker.cancelled, statistics, noisy, scene.labels)
