"""Feeds the graphics card: while it draws one batch of photons, the CPU traces the next.

The CPU finds which blocks of points each photon may reach, with the tree that its own splatter
uses. It does the kernel masses M(x) too, once a pass, while the card waits: measured on two cores,
they are 0.2 to 0.6 % of a render at 1920x1080, and of small pictures 0.4 to 0.7 % with 200,000
photons a pass and 3 to 7 % with 20,000. More could not be gained by M(x) on the card, if it took no
time there, and walks along patch edges that differ in length from point to point are the work that
suits a card least. tests/benchmarks/bench/gpu.py says how much it would be on another machine.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TYPE_CHECKING, Any, TypeVar

from ..native.library import load
from ..render.settings import Backend
from ..render.splatter import SplatterFailed
from ..render.statistics import Gpu
from . import context
from .atlas import AtlasPoints, atlas_ranges
from .painter import LONGEST_RUN, PHOTONS_PER_ROW, Batch, Painter

if TYPE_CHECKING:
    from photon_splat_native import Renderer

Result = TypeVar("Result")

MOST_PAIRS = 1 << 22
"""Pairs per batch, about. A wide kernel reaches so many points that the photons of one trace need
several batches.
"""
BUFFERS = 2
"""Batches handed over and not yet drawn."""
POLL_SECONDS = 0.01


class GpuSplatter:
    """A splatter on a graphics card, or on what OpenGL has instead. `stop` is set when the render
    is cancelled.

    most_texels: widest and highest texture to use, if less than what the card can do. Making one
    raises NoGraphics where there is no OpenGL context to be had, SplatterFailed where the card
    cannot do what it must.
    """

    backend = Backend.GPU

    def __init__(
        self,
        renderer: Renderer,
        stop: threading.Event,
        most_texels: int | None = None,
    ) -> None:
        self._renderer = renderer
        self._stop = stop
        self._pending: deque[Future[None]] = deque()
        self._pairs_per_photon = 64.0
        self._pairs = self._batches = 0
        self._ranges: list[tuple[int, int, int]] = []
        self._waited = 0.0
        self._painter, self.name, limit = self._wait(context.submit(self._make_painter))
        self._wall = self._waited = 0.0
        self._most_texels = min(limit, most_texels or limit)

    def _make_painter(self) -> tuple[Painter, str, int]:
        graphics = context.graphics()
        return (
            Painter(graphics, self._stop),
            graphics.renderer,
            int(graphics.gl.info["GL_MAX_TEXTURE_SIZE"]),
        )

    def begin_pass(self) -> None:
        self._began = time.monotonic()
        renderer = self._renderer
        self._ranges = list(atlas_ranges(renderer.block_count, self._most_texels))
        atlases = [AtlasPoints(*blocks, *renderer.point_atlas(*blocks)) for blocks in self._ranges]
        self._hand_over(self._painter.begin, atlases)

    def add_photons(self) -> None:
        renderer, first = self._renderer, 0
        while first < renderer.photon_count and self._ranges:
            count = min(
                renderer.photon_count - first, max(1, int(MOST_PAIRS / self._pairs_per_photon))
            )
            order, runs = renderer.photon_runs(first, count, LONGEST_RUN)
            # Photons of the next batch may reach more points than those of this one did.
            self._pairs_per_photon = max(2.0 * len(order) / count, 1.0)
            rows = -(-count // PHOTONS_PER_ROW) * PHOTONS_PER_ROW
            self._hand_over(
                self._painter.splat, Batch(renderer.photon_rows(first, count, rows), order, runs)
            )
            self._pairs += len(order)
            self._batches += 1
            first += count

    def finish_pass(self) -> None:
        sums = self._wait(context.submit(self._painter.sums))
        while self._pending:
            self._wait(self._pending.popleft())
        for blocks, values in zip(self._ranges, sums, strict=True):
            self._renderer.set_sums(*blocks, values)
        self._wall += time.monotonic() - self._began

    def close(self) -> None:
        wait([context.submit(self._painter.release)])

    def statistics(self) -> dict[str, Any]:
        return {
            "gpu": Gpu(
                renderer=self.name,
                busy_seconds=self._painter.busy_seconds,
                card_seconds=self._painter.card_seconds,
                cpu_busy_seconds=self._wall - self._waited,
                wall_seconds=self._wall,
                pairs=self._pairs,
                batches=self._batches,
                atlases=len(self._ranges),
            )
        }

    def _hand_over(self, task: Callable[..., None], *args: Any) -> None:
        while len(self._pending) >= BUFFERS:
            self._wait(self._pending.popleft())
        self._pending.append(context.submit(task, *args))

    def _wait(self, task: Future[Result]) -> Result:
        """What `task` returns. Cancelled as soon as the render is; SplatterFailed if the task went
        wrong.
        """
        started = time.monotonic()
        while not wait([task], POLL_SECONDS).done:
            if self._stop.is_set():
                raise load().Cancelled("the render was cancelled")
        self._waited += time.monotonic() - started
        error = task.exception()
        if error is None:
            return task.result()
        if isinstance(error, context.NoGraphics):
            raise error
        raise SplatterFailed(str(error) or type(error).__name__) from error
