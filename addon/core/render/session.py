"""Runs a render: passes of camera samples and photons until passes, time or patience are spent."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Collection
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..gpu import context as gpu_context
from ..gpu.choice import choose_splatter
from ..native.fill import lights_in_surfaces
from ..native.library import load
from ..scene import Scene
from .data_passes import asks_ambient, asks_rays, data_passes
from .denoise import DenoiserMissing, blend, denoise
from .ending import Ending, denoising_runs
from .memory import check_picture_fits, peak_memory_bytes
from .persistent import Persistent, Start, start_anew
from .plan import make_plan, pilot_sentences
from .result import (
    Passes,
    Progress,
    RenderResult,
    black_passes,
    channels_of_arrays,
    film_arrays,
    passes_from_film,
)
from .settings import Backend, Integrator, RenderSettings
from .shadow_catcher import has_catchers, shadow_arrays, split_off_shadow, with_shadow
from .splatter import CpuSplatter, Splatter, SplatterFailed
from .statistics import Statistics

OF_DENOISING = ("Combined", "Normal")
"""Passes that the denoiser reads."""
FOR_DENOISING = ("albedo", "variance", "diffuse_direct")
"""Arrays of the film that the denoiser reads and that are no passes."""
SAMPLES_WORTH_TWO = 8.0
"""Camera samples per pixel from which the diffuse direct light is denoised separately. That takes a
tenth of a second per 100,000 pixels; after 14 samples relMSE is .90 (cornell_box), .95 (kitchen,
street), .99 (interior) times as large.
"""
SAMPLES_OF_NOISY_FEATURES = 32.0
"""Camera samples per pixel up to which the denoiser's features are noisier than it expects, so that
they are denoised first. After 1, 14, 64 samples relMSE of street is .49, .90, .99 times as large.
"""
POLL_SECONDS = 0.05
FEWEST_PHOTONS = 0.25
"""Least share of the photons that a pass wants. Where time is short, a pass gets so many before any
pixel gets a second sample, or is left out.
"""
FEWEST_PASSES_TO_STOP = 8
"""Fewest passes before a render may end by its error: the estimate is too rough before."""


OUTLIERS = 0.01
"""Share of the pixels, those of the greatest error, that do not keep a render going which is to be
denoised: single paths of strong light, which the denoiser takes away. In kitchen they are two
thirds of the error after 16 passes.
"""


def next_estimate(passes: int) -> int:
    """The pass after which the error is estimated again. It depends on the number of passes alone,
    so that a render can be repeated.
    """
    return passes + max(1, passes // 4)


class PassSize(NamedTuple):
    """The size of a pass, or the seconds for it: camera samples per pixel, and photons relative to
    those of the first pass.
    """

    samples: float
    photons: float


def pass_that_fits(
    left: float, took: float, seconds: PassSize, last: PassSize, wanted: PassSize
) -> PassSize | None:
    """What of the pass `wanted` can be done in `left` seconds, if the last one took `took`,
    `seconds` of them for its samples and photons: one sample of each pixel, and the same part of
    all others and of photons, but not too few photons; None if there is no time for that.
    """
    left -= took - sum(seconds)
    of_one = seconds.samples / last.samples  # in each pixel
    of_others = of_one * (wanted.samples - 1.0)
    of_photons = seconds.photons * wanted.photons / last.photons
    if left < of_one + FEWEST_PHOTONS * of_photons:
        return None
    if of_one + of_others + of_photons <= left:
        return wanted
    share = (left - of_one) / (of_others + of_photons)
    if share >= FEWEST_PHOTONS:
        return PassSize(1.0 + share * (wanted.samples - 1.0), share * wanted.photons)
    of_fewest = FEWEST_PHOTONS * of_photons
    share = (left - of_one - of_fewest) / of_others if of_others > 0.0 else 0.0
    return PassSize(1.0 + share * (wanted.samples - 1.0), FEWEST_PHOTONS * wanted.photons)


def share_of_most(error: NDArray[np.float32]) -> float:
    """RMS of all errors but the greatest, OUTLIERS of them, over that of all."""
    squares = np.square(error.ravel(), dtype=np.float64)
    most = max(1, round(squares.size * (1.0 - OUTLIERS)))
    whole = float(squares.mean())
    kept = float(np.partition(squares, most - 1)[:most].mean())
    return math.sqrt(kept / whole) if whole > 0.0 else 1.0


class _Elsewhere:
    """A splatter as render_pass() asks for it: each call says whether it can go on."""

    def __init__(self, splatter: Splatter, failed: Callable[[SplatterFailed], None]) -> None:
        self._splatter = splatter
        self._failed = failed
        self._works = True

    def begin_pass(self) -> bool:
        return self._try(self._splatter.begin_pass)

    def add_photons(self) -> bool:
        return self._try(self._splatter.add_photons)

    def finish_pass(self) -> bool:
        return self._try(self._splatter.finish_pass)

    def _try(self, work: Callable[[], None]) -> bool:
        if self._works:
            try:
                work()
            except SplatterFailed as failure:
                self._works = False
                self._failed(failure)
        return self._works


class _Worker(threading.Thread):
    """Runs the passes on a thread of its own, while the caller's thread reports progress and polls
    for cancellation.
    """

    def __init__(
        self,
        start: Start,
        settings: RenderSettings,
        started: float,
        want_interim: bool,
        wanted: Collection[str] | None,
        scene: Scene,
    ) -> None:
        super().__init__(name="Photon Splat", daemon=True)
        self.renderer = start.renderer
        self.prepare = start.prepare
        self.prepared = False
        self.settings = settings
        self.light_groups = scene.light_groups
        self.started = started
        self.want_interim = want_interim
        self.wanted = wanted
        self.stage = "Building acceleration structure"
        self.passes_done = 0
        self.samples_done = 0.0
        self.next_estimate = 1
        self.relative_error = 0.0
        self.fraction = 0.0
        self.interim: Passes | None = None
        self.error: BaseException | None = None
        self.cancelled = False
        self.cancel_asked = threading.Event()
        self.pass_finished = threading.Event()
        self.finished = False
        self.warnings: list[str] = []
        self.splatter: Splatter = CpuSplatter(self.renderer)
        self.ending = Ending(*scene.frame.region[2:])
        self.scene = scene
        self.data: Passes = {}
        self.film_bytes = 0

    def cancel(self) -> None:
        """May be called from any thread."""
        self.cancel_asked.set()
        self.renderer.cancel()

    def run(self) -> None:
        try:
            self._render()
        except BaseException as error:
            if type(error) is load().Cancelled:
                self.cancelled = True
            else:
                self.error = error
        finally:
            self.splatter.close()
            self.finished = True
            self.pass_finished.set()

    def _render(self) -> None:
        settings = self.settings
        if settings.integrator is Integrator.SPLAT:
            self.splatter = self._choose_splatter()
        elif settings.backend == Backend.GPU:
            self.warnings.append("The reference integrator has been used: it runs on the CPU only.")
        labels = self.scene.labels
        arrays = final_arrays(self.wanted, settings, self.scene)
        self.renderer.keep_film(arrays)
        self.renderer.options.ambient_distance = (
            labels.ambient_distance if labels is not None and asks_ambient(labels) else 0.0
        )
        self.prepare()
        self.prepared = True
        if labels is not None and asks_rays(labels):
            self.stage = "Passes of data"
            self.data = data_passes(self.renderer, self.scene, labels)
        if settings.time_limit and settings.denoise:
            self.stage = "Trying the denoiser"
            self.ending.try_denoiser(settings.threads)
        self.stage = "Rendering"
        while self.passes_done < self.settings.passes:
            began, pilot, before = (
                time.monotonic(),
                self.renderer.pilot_seconds,
                self._stage_seconds(),
            )
            size = PassSize(*self.renderer.next_pass)
            self.stage = f"Pass {self.passes_done + 1}"
            if self.settings.integrator is Integrator.REFERENCE:
                self.renderer.trace_reference(self.passes_done)
            else:
                self._splat_pass(self.passes_done)
            self.passes_done += 1
            self.samples_done += size.samples
            self.film_bytes = max(self.film_bytes, self.renderer.film_bytes)
            converged = self._estimate_error()
            if settings.time_limit and self.passes_done == 1:
                self.ending.try_film(self.renderer, channels_of_arrays(arrays))
            if (
                self.want_interim
                and self.interim is None
                and self.passes_done < self.settings.passes
            ):
                film = self.renderer.film(
                    [
                        *film_arrays(self.wanted, labels),
                        *shadow_arrays(self.scene, denoise=False),
                    ]
                )
                self.interim = passes_from_film(film, self.light_groups)
                split_off_shadow(self.interim, film, self.scene)
            self.pass_finished.set()
            if converged:
                return
            if self.settings.time_limit:
                pilot = self.renderer.pilot_seconds - pilot
                now, took = self._stage_seconds(), time.monotonic() - began - pilot
                photons = min(max(now.photons - before.photons - pilot, 0.0), took)
                seconds = PassSize(min(now.samples - before.samples, took - photons), photons)
                if not self._another_fits(took, seconds, size):
                    return

    def _stage_seconds(self) -> PassSize:
        return PassSize(self.renderer.camera_seconds, self.renderer.photon_seconds)

    def _another_fits(self, took: float, seconds: PassSize, last: PassSize) -> bool:
        """Whether one more pass keeps the time limit, if need be a smaller one, which it then will
        be.
        """
        wanted = PassSize(*self.renderer.next_pass)
        fitting = pass_that_fits(self._seconds_left(wanted.samples), took, seconds, last, wanted)
        if fitting is None:
            return False
        if fitting != wanted:
            self.renderer.limit_pass(*fitting)
        return True

    def _seconds_left(self, samples: float) -> float:
        """For passes, where the next has so many camera samples a pixel; the time limit less what
        comes after them.
        """
        if not self.settings.time_limit:
            return math.inf
        runs = (
            denoising_runs(**self.denoising(self.samples_done + samples)) + has_catchers(self.scene)
            if self.settings.denoise
            else 0.0
        )
        after = self.ending.seconds(self.passes_done + 1, runs)
        return self.started + self.settings.time_limit - time.monotonic() - after

    def denoising(self, samples: float) -> dict[str, bool]:
        """The options of denoise() for a picture of so many camera samples per pixel."""
        return {
            "apart": samples >= SAMPLES_WORTH_TWO,
            "noisy_features": samples <= SAMPLES_OF_NOISY_FEATURES,
        }

    def _choose_splatter(self) -> Splatter:
        if not self.light_groups:
            return choose_splatter(
                self.renderer, self.settings.backend, self.cancel_asked, self.warnings
            )
        if self.settings.backend == Backend.GPU:
            self.warnings.append(
                "Light groups: the CPU splatter has been used, as that of the GPU does not keep "
                "their light apart."
            )
        return CpuSplatter(self.renderer)

    def _splat_pass(self, number: int) -> None:
        seconds = self._seconds_left(self.renderer.next_pass[0])
        if self.splatter.backend == Backend.CPU:
            return self.renderer.render_pass(number, seconds=seconds)

        def failed(failure: SplatterFailed) -> None:
            self.warnings.append(
                f"The GPU splatter failed in pass {number + 1} ({failure}); the CPU splatter has "
                "done the rest."
            )
            self.splatter.close()
            gpu_context.submit(gpu_context.discard)
            self.splatter = CpuSplatter(self.renderer)

        return self.renderer.render_pass(
            number, seconds=seconds, splatter=_Elsewhere(self.splatter, failed)
        )

    def _estimate_error(self) -> bool:
        """Estimates the error now and then. Returns whether it is small enough to end the
        render.
        """
        if self.passes_done < self.next_estimate:
            return False
        threshold = self.settings.error_threshold
        # Without a threshold the estimate is only shown, and few are enough.
        self.next_estimate = (
            next_estimate(self.passes_done) if threshold > 0 else 2 * self.passes_done
        )
        self.ending.estimate(self.renderer.make_error_estimate, self.passes_done)
        self.relative_error = self.renderer.statistics()["error"]["relative_rmse"]
        if threshold <= 0 or self.passes_done < FEWEST_PASSES_TO_STOP:
            return False
        error = self.relative_error
        if self.settings.denoise and error > threshold:
            error *= share_of_most(self.renderer.film(["error"])["error"])
        return error <= threshold

    def progress(self) -> Progress:
        done, settings = self.passes_done, self.settings
        fraction = done / settings.passes
        elapsed = time.monotonic() - self.started
        if settings.time_limit:
            fraction = max(fraction, min(elapsed / settings.time_limit, 1.0))
        message = f"{self.stage} | {done} passes | {elapsed:.1f} s"
        if done:
            message += f" | error {100 * self.relative_error:.2g} %"
        if settings.error_threshold and self.relative_error:
            fraction = max(
                fraction, min((settings.error_threshold / self.relative_error) ** 2, 1.0)
            )
        self.fraction = max(fraction, self.fraction)
        interim, self.interim = self.interim, None
        return Progress(self.fraction, message, done, interim)


def final_arrays(
    wanted: Collection[str] | None, settings: RenderSettings, scene: Scene
) -> list[str]:
    """Names of the film arrays that the result is made of."""
    return [
        *film_arrays(wanted, scene.labels),
        *shadow_arrays(scene, settings.denoise),
        *(FOR_DENOISING if settings.denoise else ()),
    ]


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
    release_textures: bool = False,
    wanted: Collection[str] | None = None,
) -> RenderResult:
    """Renders `scene`. `started` is `time.monotonic()` when the render call began, export included;
    `persistent` holds what the last render has left for this one, and then what this one leaves.
    `release_textures`: nobody renders `scene` again, so that its pixels need not be kept beside
    native code's; not with `persistent`. `wanted`: names of the passes to give back besides those
    of light groups (None: all).

    Both callbacks run on the caller's thread about every 50 ms. A cancelled render returns what is
    there.
    Errors: ValueError for a scene or setting that cannot be rendered, a GPU that is not there among
    them; RuntimeError and MemoryError from native code.
    """
    if wanted is not None and settings.denoise:
        wanted = {*wanted, *OF_DENOISING}
    start = start_anew(scene, settings) if persistent is None else persistent.start(scene, settings)
    renderer = start.renderer
    width, height = scene.frame.region[2:]
    if not start.reused:
        check_picture_fits(width, height)
    if release_textures and persistent is None:
        for texture in scene.textures:
            texture.pixels = np.empty((0, 0, 4), texture.pixels.dtype)
    worker = _Worker(start, settings, started, want_interim, wanted, scene)
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
    film = renderer.film(final_arrays(wanted, settings, scene)) if worker.passes_done else None
    passes = (
        passes_from_film(film, scene.light_groups)
        if film
        else black_passes(width, height, scene.light_groups)
    )
    if film:
        split_off_shadow(passes, film, scene)
    passes |= worker.data
    denoising, noisy = 0.0, None
    if settings.denoise and film and not worker.cancelled:
        noisy = passes["Combined"][..., :3].copy()
        denoising = _denoise(passes, film, worker, should_cancel)
        if scene.light_groups:
            worker.warnings.append(
                "Only Combined is denoised; the passes of light groups are not, so that their sum "
                "is noisier."
            )
    statistics = _statistics(start, worker, scene, started, export_seconds)
    if settings.denoise:
        statistics["seconds"]["denoise"] = denoising
    if persistent is not None and worker.prepared:
        persistent.keep(scene, settings, renderer)
    return RenderResult(passes, worker.cancelled, statistics, noisy, scene.labels)


def _denoise(
    passes: Passes, film: dict[str, Any], worker: _Worker, should_cancel: Callable[[], bool] | None
) -> float:
    """Denoises Combined with the features in `film`; returns the seconds it took. If that cannot be
    done the picture stays as it is, and a warning says why.
    """
    began = time.monotonic()
    catchers = has_catchers(worker.scene)
    noisy = (film["matte"] if catchers else passes["Combined"])[..., :3]
    how = worker.denoising(worker.samples_done)
    try:
        clean = denoise(
            noisy,
            film["albedo"],
            passes["Normal"],
            apart=film["diffuse_direct"] if how["apart"] else None,
            noisy_features=how["noisy_features"],
            threads=worker.settings.threads,
            should_cancel=should_cancel,
        )
        noisy[...] = blend(noisy, clean, film["variance"][..., 0], worker.passes_done)
        if catchers:
            _denoise_shadow(passes, film, worker, should_cancel)
    except (DenoiserMissing, RuntimeError) as error:
        worker.warnings.append(f"The picture has not been denoised: {error}.")
    return time.monotonic() - began


def _denoise_shadow(
    passes: Passes, film: dict[str, Any], worker: _Worker, should_cancel: Callable[[], bool] | None
) -> None:
    """The shadow on catchers has noise of its own. Makes the picture of it and of what has been
    denoised.
    """
    film["shadow_catcher"][...] = denoise(
        film["shadow_catcher"],
        film["albedo"],
        passes["Normal"],
        threads=worker.settings.threads,
        should_cancel=should_cancel,
    )
    if not worker.scene.shadow_pass:
        passes["Combined"][...] = with_shadow(
            film["matte"],
            film["shadow_catcher"],
            film["backdrop"],
            worker.scene.frame.transparent,
        )


def _statistics(
    start: Start, worker: _Worker, scene: Scene, started: float, export_seconds: float
) -> Statistics:
    statistics: Any = start.renderer.statistics()
    statistics["seconds"] |= {"export": export_seconds, "total": time.monotonic() - started}
    statistics |= {
        "passes": worker.passes_done,
        "backend": str(worker.splatter.backend),
        "integrator": str(worker.settings.integrator),
        "cancelled": worker.cancelled,
        "film_bytes": worker.film_bytes,
        "texture_bytes": start.renderer.texture_memory,
        "reused": {"geometry": start.reused, "photons": statistics["photons"]["reused"]},
        "peak_memory_bytes": peak_memory_bytes(),
        "warnings": [*scene.warnings, *worker.warnings, *lights_in_surfaces(start.renderer, scene)],
    } | worker.splatter.statistics()
    if statistics["threads"] < statistics["threads_wanted"]:
        statistics["warnings"].append(
            f"Of {statistics['threads_wanted']} threads the system has started "
            f"{statistics['threads']}: the render has taken longer."
        )
    plan = make_plan(scene, worker.settings)
    statistics["plan"] = {
        "sentences": plan.sentences + pilot_sentences(statistics),
        "flags": plan.flags,
    }
    if statistics["bad_samples"]:
        statistics["warnings"].append(
            f"{statistics['bad_samples']} camera samples were not finite, or far too bright for "
            "any film, and have been left out."
        )
    return statistics
