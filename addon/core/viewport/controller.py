"""Renders what a viewport shows, on a thread of its own that owns the native renderer. Knows no
Blender.

An edit brings a scene, a move of the camera a view. First comes a picture of few pixels, lit by a
*cache* of photons that serves every view: while the camera moves, no photon is traced. Light that
pictures have found on surfaces is kept there and read again by those that follow. When the camera
rests the cache grows, the picture gets all its pixels, and then passes of a render refine it, whose
pictures are denoised.
"""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..native.camera import place_camera
from ..native.fill import fill_renderer, replace_shading
from ..native.library import load
from ..render.settings import RenderSettings
from ..scene import Scene, same_geometry, same_shading
from .clean import Cleaner
from .pace import Pace
from .view import Picture, View, fitted, scaled

if TYPE_CHECKING:
    from photon_splat_native import Renderer

FIRST_PATHS, FIRST_PHOTONS = 1 << 15, 1 << 15
"""Of the cache before the first picture after an edit: paths at a time, until there are so many
photons.
"""
MOST_FIRST_PATHS = 1 << 18
CACHE_PHOTONS = 1 << 17
"""Photons that the cache gets while the camera rests: it can still be splatted within a frame."""
MOST_CACHE_PATHS = 1 << 22
MOST_CACHE_BYTES = 64 << 20
PHOTONS_PER_BATCH = 1 << 16
CELL = 4
"""Width of the cells that keep the light of surfaces, in pixels of the screen."""
MOST_SAMPLES = 0.05
"""Share of a picture's pixels that sample light for those cells, beside all of unknown places."""
REST = 0.15
"""Seconds without a move after which the camera counts as resting. The time is longer where moves
arrive more slowly, as in a window that is slow to draw.
"""
SLOWEST_MOVES = 0.5
"""Most seconds between two moves of one turn of the camera."""
SHOW_EVERY = 0.1
"""Least seconds between two pictures of the refinement."""


@dataclass(slots=True)
class Counts:
    """What the thread has done so far. builds: of geometry; relights: of the rest on the same
    geometry; seconds: of the last of each.
    """

    builds: int = 0
    relights: int = 0
    frames: int = 0
    passes: int = 0
    photon_paths: int = 0
    seconds: dict[str, float] = field(default_factory=dict)


class Controller:
    """Owns the thread. All methods may be called from any one thread and return at once, but
    close().

    `settings.passes` and `settings.time_limit` say when refinement ends (0 s = no limit).
    step: the width of a moving picture's pixels; None chooses it by the time that pictures take.
    """

    def __init__(self, step: int | None = None) -> None:
        self.counts = Counts()
        self._pace = Pace(step)
        self._cleaner = Cleaner()
        self._changed = threading.Condition()
        self._scene: tuple[Scene, RenderSettings] | None = None
        self._view: View | None = None
        self._moved = 0.0
        self._rest = REST
        self._closing = False
        self._may_cancel = False
        self._picture: Picture | None = None
        self._error: BaseException | None = None
        self._status = ""
        self._progress = 0.0
        self._renderer: Renderer | None = None
        self._loading: tuple[Scene, RenderSettings] | None = None
        self._loaded: tuple[Scene, RenderSettings] | None = None
        self._thread = threading.Thread(target=self._run, name="Photon Splat viewport", daemon=True)
        self._thread.start()

    # --- any thread ---

    def set_scene(self, scene: Scene, settings: RenderSettings) -> None:
        """Shows `scene` from now on; what of it is as before is not built again. Its camera and
        frame do not count.
        """
        with self._changed:
            known = self._scene or self._loading or self._loaded
            if (
                known is not None
                and known[1] == settings
                and same_geometry(known[0], scene)
                and same_shading(known[0], scene)
            ):
                return
            self._scene = (scene, settings)
            self._error = None
            self._interrupt(True)

    def set_view(self, view: View) -> None:
        """Shows the scene in `view` from now on."""
        with self._changed:
            if self._view is not None and self._view == view:
                return
            self._view = view
            now = time.monotonic()
            pause, self._moved = now - self._moved, now
            self._rest = max(REST, 2 * pause) if pause < SLOWEST_MOVES else REST
            self._interrupt(False)

    def picture(self) -> Picture | None:
        """The latest picture."""
        with self._changed:
            return self._picture

    def status(self) -> tuple[str, float, str]:
        """What is going on, how much of it is done (0..1), and what went wrong."""
        with self._changed:
            return (
                self._status,
                self._progress,
                " ".join(str(self._error).split()) if self._error else "",
            )

    @property
    def warning(self) -> str:
        """What the pictures lack, for the user."""
        missing = self._cleaner.missing
        return f"not denoised: {missing}" if missing else ""

    @property
    def idle(self) -> bool:
        """True if nothing is left to do until something changes."""
        with self._changed:
            return self._status == "" and self._scene is None

    def close(self) -> None:
        """Ends the thread, and with it all that it holds."""
        with self._changed:
            self._closing = True
            self._interrupt(True)
        self._thread.join()

    @property
    def alive(self) -> bool:
        return self._thread.is_alive()

    def _interrupt(self, everything: bool) -> None:
        """Wakes the thread up; stops what it does if that is no longer wanted: a moving camera lets
        a picture be finished.
        """
        if self._renderer is not None and (everything or self._may_cancel):
            self._renderer.cancel()
        self._changed.notify_all()

    # --- the thread ---

    def _run(self) -> None:
        while True:
            try:
                if not self._work():
                    return
            except BaseException as error:
                if not (self._renderer is not None and type(error) is load().Cancelled):
                    self._fail(error)

    def _fail(self, error: BaseException) -> None:
        with self._changed:
            self._error = error
            self._status = ""
            self._renderer = self._loaded = self._loading = None
            while not self._closing and self._scene is None:
                self._changed.wait()

    def _work(self) -> bool:
        """Does everything for the present scene and view, then waits for others. Returns False at
        the end.
        """
        with self._changed:
            if self._closing:
                self._renderer = self._loaded = None
                return False
            asked, self._scene = self._scene, None
            self._loading = asked
            if self._renderer is not None:
                self._renderer.resume()
            self._may_cancel = False
        if asked is not None:
            self._load(*asked)
        with self._changed:
            if self._loaded is None or self._view is None:
                self._wait(None)
                return True
            view = self._view
        renderer, (scene, settings) = self._renderer, self._loaded
        assert renderer is not None
        self._fill_cache(renderer, FIRST_PHOTONS, MOST_FIRST_PATHS)
        known = renderer.light_cache()["cells"] > 0
        step = self._pace.step if known else self._pace.first_step
        self._draw_cached(renderer, view, max(step, view.pixel), moving=True)
        with self._changed:
            self._may_cancel = True
            while (
                not self._is_new(view) and (left := self._moved + self._rest - time.monotonic()) > 0
            ):
                self._changed.wait(left)
            if self._is_new(view):
                return True
        self._fill_cache(renderer, CACHE_PHOTONS, MOST_CACHE_PATHS)
        self._draw_cached(renderer, view, view.pixel, moving=False)
        self._refine(renderer, view, scene, settings)
        with self._changed:
            self._wait(view)
        return True

    def _is_new(self, view: View | None) -> bool:
        return self._closing or self._scene is not None or self._view is not view

    def _wait(self, view: View | None) -> None:
        self._say("", 1.0)
        while not self._is_new(view):
            self._changed.wait()

    def _say(self, status: str, progress: float = 0.0) -> None:
        self._status, self._progress = status, progress

    def _load(self, scene: Scene, settings: RenderSettings) -> None:
        """Builds what `scene` needs: nothing, another light on the same geometry, or all."""
        started = time.monotonic()
        loaded, self._loaded = self._loaded, None
        renderer = self._renderer
        if (
            loaded is not None
            and renderer is not None
            and loaded[1] == settings
            and same_geometry(loaded[0], scene)
        ):
            if not same_shading(loaded[0], scene):
                self._say("Lighting")
                replace_shading(renderer, scene)
                self.counts.relights += 1
                self.counts.seconds["relight"] = time.monotonic() - started
        else:
            self._say("Building")
            renderer = load().Renderer(settings.threads)
            with self._changed:
                if self._closing:
                    raise load().Cancelled
                self._renderer = renderer  # from now on it can be cancelled
            fill_renderer(renderer, scene, settings)
            renderer.options.short_passes = True
            renderer.build()
            self._pace.forget()
            self.counts.builds += 1
            self.counts.seconds["build"] = time.monotonic() - started
        with self._changed:
            self._loading, self._loaded = None, (scene, settings)

    def _fill_cache(self, renderer: Renderer, photons: int, most_paths: int) -> None:
        started, traced = time.monotonic(), False
        while True:
            cache = renderer.viewport_photons()
            if cache["full"] or cache["photons"] >= photons or cache["paths"] >= most_paths:
                break
            self._say("Tracing photons", cache["photons"] / photons)
            renderer.trace_viewport_photons(
                min(max(FIRST_PATHS, cache["paths"]), PHOTONS_PER_BATCH), MOST_CACHE_BYTES
            )
            traced = True
        self._count(renderer)
        if traced:
            self.counts.seconds["cache"] = time.monotonic() - started

    def _draw_cached(self, renderer: Renderer, view: View, step: int, moving: bool) -> None:
        started = time.monotonic()
        frame, region = scaled(view.frame, step)
        place_camera(renderer, fitted(view, frame, step), frame)
        renderer.draw_from_cache(CELL / step, MOST_SAMPLES)
        self._publish(renderer.picture(), view, region, step, 1, moving)
        self.counts.frames += 1
        seconds = time.monotonic() - started
        self.counts.seconds["moving" if moving else "still"] = seconds
        if moving:
            self._pace.took(step, seconds)

    def _refine(
        self, renderer: Renderer, view: View, scene: Scene, settings: RenderSettings
    ) -> None:
        """Refines with passes as in a render, but short ones. Their picture is shown once it is
        better than the one from the cache: denoised after one of them.
        """
        frame, region = scaled(view.frame, view.pixel, sharp=False)
        place_camera(renderer, fitted(view, frame, view.pixel), frame)
        renderer.set_view()
        started, shown, taught = time.monotonic(), 0.0, 0
        least = 1 if settings.denoise else 2
        for number in range(settings.passes):
            self._say("Rendering", number / settings.passes)
            began = time.monotonic()
            renderer.render_pass(number, paths_per_batch=PHOTONS_PER_BATCH)
            self.counts.passes += 1
            self._count(renderer)
            now = time.monotonic()
            self.counts.seconds["pass"] = now - began
            late = settings.time_limit > 0 and now + (now - began) > started + settings.time_limit
            last = number + 1 == settings.passes or late
            wait = max(SHOW_EVERY, self._cleaner.wait if settings.denoise else 0.0)
            if (number + 1 >= least and now - shown > wait) or last:
                pixels = self._clean(renderer, view, scene, settings, number + 1, last)
                if self._is_new(view):
                    return
                self._publish(pixels, view, region, view.pixel, number + 1, moving=False)
                if number + 1 >= 2 * taught:
                    new = 1.0 - taught / (number + 1)
                    renderer.teach_light_cache(CELL / view.pixel, new, pixels)
                    taught = number + 1
                shown = time.monotonic()
            if late:
                return

    def _clean(
        self,
        renderer: Renderer,
        view: View,
        scene: Scene,
        settings: RenderSettings,
        samples: int,
        last: bool,
    ) -> NDArray[np.float32]:
        if not settings.denoise:
            return renderer.picture()
        return self._cleaner.clean(
            renderer,
            scene,
            samples,
            last=last,
            threads=settings.threads,
            on_card=settings.denoises_on_card,
            should_cancel=lambda: self._is_new(view),
        )

    def _count(self, renderer: Renderer) -> None:
        photons = renderer.statistics()["photons"]
        self.counts.photon_paths = (
            renderer.viewport_photons()["traced"] + photons["traced"] + photons["pilot"]
        )

    def _publish(
        self,
        pixels: NDArray[np.float32],
        view: View,
        region: tuple[int, int, int, int],
        step: int,
        samples: int,
        moving: bool,
    ) -> None:
        with self._changed:
            number = self._picture.number + 1 if self._picture else 1
            self._picture = Picture(
                pixels, region, view, step, samples, moving, number, time.monotonic()
            )
