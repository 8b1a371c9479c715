"""The thread that runs a render's passes until passes, time or patience are spent."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Collection

from ..gpu import context as gpu_context
from ..gpu.choice import choose_splatter
from ..native.library import load
from ..scene import Scene
from .data_passes import asks_ambient, asks_rays, data_passes
from .denoise import Quality
from .denoise_result import runs_of_result
from .ending import Ending
from .error_limit import ErrorLimit
from .final_film import final_arrays, interim_passes
from .pass_size import FEWEST_PHOTONS, PassSize, pass_that_fits
from .persistent import Start
from .record import Record
from .result import Passes, Progress, channels_of_arrays
from .settings import Backend, Integrator, RenderSettings
from .splatter import CpuSplatter, ExternalSplatter, Splatter, SplatterFailed

OF_PASSES = 0.5
"""Of the time limit, for passes and what follows them, however long the scene has taken: a large
one, which nothing could stop, would be left with a sample of each pixel.
"""
OF_LEARNING = 0.15
"""Of the time that is left, for what a part learns before its passes."""
OF_UNEVEN = 0.5
"""Of the time that is left, for a second pass after one that has brought all light by paths: its
samples go where there is noise, and those may take several times as long as the even ones before.
"""


class Worker(threading.Thread):
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
        record: Record,
    ) -> None:
        super().__init__(name="Photon Splat", daemon=True)
        self.renderer = start.renderer
        self.prepare = start.prepare
        self.prepared = False
        self.settings = settings
        self.record = record
        self.denoises = settings.denoise and not record.keeps
        self.started = started - record.seconds_before
        self.end = self.started + settings.time_limit if settings.time_limit else math.inf
        self.want_interim = want_interim
        self.wanted = wanted
        self.stage = "Building acceleration structure"
        self.passes_done = 0
        self.samples_done = 0.0
        self.error_limit = ErrorLimit(settings, record.part)
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
        self.quality_wanted = Quality.BEST
        self.scene = scene
        self.passes_wanted = settings.passes - record.part.passes_before
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
        arrays = final_arrays(self.wanted, self.settings, self.scene)
        self._prepare(arrays)
        self.record.built(self.renderer, self.data)
        if self.settings.integrator is Integrator.SPLAT and not self.record.part.whole:
            self._learn_in_common()
        self.stage = "Rendering"
        more = True
        while more and self.passes_done < self.passes_wanted:
            more = self._do_pass(arrays)

    def _prepare(self, arrays: list[str]) -> None:
        """Builds what passes need, and what does not need passes."""
        settings, labels = self.settings, self.scene.labels
        if settings.integrator is Integrator.SPLAT:
            self.splatter = self._choose_splatter()
        elif settings.backend == Backend.GPU:
            self.warnings.append("The reference integrator has been used: it runs on the CPU only.")
        if not self.record.active:  # its sums may be for passes that are not wanted yet
            self.renderer.keep_film(arrays)
        self.record.set_up(self.renderer)
        self.renderer.options.ambient_distance = (
            labels.ambient_distance if labels is not None and asks_ambient(labels) else 0.0
        )
        self.prepare()
        self.prepared = True
        if labels is not None and asks_rays(labels):
            self.stage = "Passes of data"
            self.data = data_passes(self.renderer, self.scene, labels)
        if not self.record.samples_before:
            self.end = max(self.end, time.monotonic() + OF_PASSES * settings.time_limit)
        if settings.time_limit and self.denoises:
            self.stage = "Trying the denoiser"
            self.ending.try_denoiser(settings.threads, settings.denoises_on_card)
            self.quality_wanted = self.ending.worth(self._seconds_to_limit(), self._runs)

    def _do_pass(self, arrays: list[str]) -> bool:
        """One pass and what is told of it. Returns whether another may follow."""
        began, pilot = time.monotonic(), self.renderer.pilot_seconds
        before, size = self._stage_seconds(), PassSize(*self.renderer.next_pass)
        tried = False
        self.stage = f"Pass {self.passes_done + 1}"
        if self.settings.integrator is Integrator.REFERENCE:
            self.renderer.trace_reference(self.passes_done)
        else:
            self._splat_pass(self.passes_done)
            tried = self.renderer.samples_of_last_pass > size.samples
            size = size._replace(samples=self.renderer.samples_of_last_pass)
        self.passes_done += 1
        self.samples_done += size.samples
        self.film_bytes = max(self.film_bytes, self.renderer.film_bytes)
        converged = self.error_limit.after_pass(self.renderer, self.ending, self.passes_done)
        if self.settings.time_limit and self.passes_done == 1:
            self.ending.try_film(self.renderer, channels_of_arrays(arrays))
        self.record.pass_done(self.renderer, self.passes_done, self.samples_done)
        if self.want_interim and self.interim is None and self.passes_done < self.passes_wanted:
            self.interim = interim_passes(self.renderer, self.wanted, self.scene)
        self.pass_finished.set()
        last = converged or size.samples < 1.0
        if last or not self.settings.time_limit:
            return not last
        pilot = self.renderer.pilot_seconds - pilot
        now, took = self._stage_seconds(), time.monotonic() - began - pilot
        photons = min(max(now.photons - before.photons - pilot, 0.0), took)
        seconds = PassSize(min(now.samples - before.samples, took - photons), photons)
        return self._another_fits(took, seconds, size, OF_UNEVEN if tried else 1.0)

    def _learn_in_common(self) -> None:
        """What a part does before its passes; it tells how much of the first one there is time
        for.
        """
        self.stage = "Learning"
        seconds = PassSize(
            *self.renderer.learn_in_common(
                OF_LEARNING * self._seconds_to_limit(), self._splatter_elsewhere()
            )
        )
        if not self.settings.time_limit:
            return
        if not self._another_fits(sum(seconds), seconds, PassSize(1.0, 1.0)):
            self.renderer.limit_pass(1.0, FEWEST_PHOTONS)

    def _stage_seconds(self) -> PassSize:
        return PassSize(self.renderer.camera_seconds, self.renderer.photon_seconds)

    def _another_fits(
        self, took: float, seconds: PassSize, last: PassSize, share: float = 1.0
    ) -> bool:
        """Whether one more pass keeps the time limit, if need be a smaller one, which it then will
        be. `share`: of the time that is left, for a pass that is not the last one.
        """
        wanted = PassSize(*self.renderer.next_pass)
        left = self._seconds_left(wanted.samples)
        may_lack = (
            self.settings.adaptive_samples
            and self.settings.integrator is Integrator.SPLAT
            and self.passes_done > 0
        )
        fitting = None
        if share < 1.0:
            fitting = pass_that_fits(share * left, took, seconds, last, wanted)
        if fitting is None:
            fitting = pass_that_fits(left, took, seconds, last, wanted, may_lack_pixels=may_lack)
        if fitting is None:
            return False
        if fitting != wanted:
            self.renderer.limit_pass(*fitting)
        return True

    def _seconds_left(self, samples: float) -> float:
        """For passes, where the next has so many camera samples a pixel; the time limit less what
        comes after them.
        """
        runs = self._runs(self.quality_wanted, samples) if self.denoises else 0.0
        return self._seconds_to_limit() - self.ending.seconds(self.passes_done + 1, runs)

    def _seconds_to_limit(self) -> float:
        return self.end - time.monotonic()

    def _runs(self, quality: Quality, more_samples: float = 0.0) -> float:
        """Work of denoising the result after so many more camera samples per pixel."""
        samples = self.record.samples_before + self.samples_done + more_samples
        return runs_of_result(quality, samples, self.scene)

    def denoising_quality(self) -> Quality:
        """What there is time for once the passes are done."""
        return self.ending.best_within(self._seconds_to_limit(), self._runs, self.quality_wanted)

    def _choose_splatter(self) -> Splatter:
        if not self.scene.light_groups:
            return choose_splatter(self.renderer, self.settings.backend, self.cancel_asked)
        if self.settings.backend == Backend.GPU:
            self.warnings.append(
                "Light groups: the CPU splatter has been used, as that of the GPU does not keep "
                "their light apart."
            )
        return CpuSplatter(self.renderer)

    def _splat_pass(self, number: int) -> None:
        seconds = self._seconds_left(self.renderer.next_pass[0])
        self.renderer.render_pass(number, seconds=seconds, splatter=self._splatter_elsewhere())

    def _splatter_elsewhere(self) -> ExternalSplatter | None:
        """The GPU's, for the native side; the CPU's is there."""
        if self.splatter.backend == Backend.CPU:
            return None

        def failed(failure: SplatterFailed) -> None:
            self.warnings.append(
                f"The GPU splatter failed in pass {self.passes_done + 1} ({failure}); the CPU "
                "splatter has done the rest."
            )
            self.splatter.close()
            gpu_context.submit(gpu_context.discard)
            self.splatter = CpuSplatter(self.renderer)

        return ExternalSplatter(self.splatter, failed)

    def progress(self) -> Progress:
        done, settings = self.record.part.passes_before + self.passes_done, self.settings
        fraction = done / settings.passes
        elapsed = time.monotonic() - self.started
        fraction = max(fraction, min(elapsed / (self.end - self.started), 1.0))
        message = f"{self.stage} | {done} passes | {elapsed:.1f} s"
        if done:
            message += f" | error {100 * self.error_limit.error:.2g} %"
        self.fraction = max(fraction, self.fraction, self.error_limit.fraction)
        interim, self.interim = self.interim, None
        return Progress(self.fraction, message, done, interim)
