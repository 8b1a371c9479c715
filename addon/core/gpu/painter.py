"""Draws photons over atlases of points. Everything here runs on the OpenGL thread.

The photons that a block may catch come in runs of at most LONGEST_RUN: blending
is then 1/LONGEST_RUN of the work, and a tile of a million photons is shared out as
thousands of quads.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .atlas import Atlas, AtlasPoints
from .quads import TEXTURES, Quads, release, roomy

if TYPE_CHECKING:
    import moderngl

    from .context import Graphics

LONGEST_RUN = 128
PHOTONS_PER_ROW = 1024
"""As in estimate.glsl, and so is PAIRS_PER_ROW."""
PAIRS_PER_ROW = 4096
DRAW_SECONDS = 0.03
"""Seconds that one draw call may take, about: a cancelled render stops soon, and no driver takes
the card for hung.
"""
FEWEST_PAIRS, MOST_PAIRS = 1 << 13, 1 << 22


@dataclass(frozen=True, slots=True)
class Batch:
    """photons (rows of PHOTONS_PER_ROW, 8) float32; order (P,) and runs (R, 3) uint32 as the native
    photon_runs() makes them.
    """

    photons: NDArray[np.float32]
    order: NDArray[np.uint32]
    runs: NDArray[np.uint32]


class Painter:
    """One render's objects on the graphics card. `stop` ends a long splat() early.

    busy_seconds: wall time of all calls; card_seconds: of drawing, by the card's own clock.
    """

    def __init__(self, graphics: Graphics, stop: threading.Event) -> None:
        self._graphics = graphics
        self._stop = stop
        self._atlases: list[Atlas] = []
        self._photons: moderngl.Texture | None = None
        self._order: moderngl.Texture | None = None
        self._pairs_per_draw = 1 << 16
        self.busy_seconds = self.card_seconds = 0.0
        self._quads = Quads(graphics.gl)

    def begin(self, atlases: list[AtlasPoints]) -> None:
        """Takes the points of a pass, all sums at 0."""
        started = time.monotonic()
        self._release_atlases()
        for points in atlases:
            self._atlases.append(Atlas(self._graphics.gl, points))
        self._finish(started)

    def splat(self, batch: Batch) -> None:
        """Adds the photons of `batch` to the sums."""
        started = time.monotonic()
        with self._timed():
            self._photons = self._fitting(
                self._photons, 2 * PHOTONS_PER_ROW, len(batch.photons) // PHOTONS_PER_ROW, 4
            )
            self._photons.write(
                batch.photons, (0, 0, 2 * PHOTONS_PER_ROW, len(batch.photons) // PHOTONS_PER_ROW)
            )
        for atlas in self._atlases:
            self._aim(atlas)
            first = atlas.points.first
            begin, end = np.searchsorted(batch.runs[:, 0], (first, first + atlas.points.count))
            for runs in self._pieces(batch.runs[begin:end]):
                with self._timed():
                    self._draw(runs, batch.order, first)
        self._finish(started)

    def sums(self) -> list[NDArray[np.float32]]:
        """The sums of all atlases, (H, W, 5) each."""
        started = time.monotonic()
        sums = [atlas.read_sums() for atlas in self._atlases]
        self._finish(started)
        return sums

    def release(self) -> None:
        self._release_atlases()
        self._quads.release()
        release(self._order, self._photons)

    def _release_atlases(self) -> None:
        self._graphics.idle.use()
        while self._atlases:
            self._atlases.pop().release()

    def _aim(self, atlas: Atlas) -> None:
        assert self._photons is not None
        for name, texture in (
            ("positions", atlas.position),
            ("planes", atlas.plane),
            ("photons", self._photons),
        ):
            texture.use(TEXTURES.index(name))
        self._quads.aim(atlas)

    @contextmanager
    def _timed(self) -> Iterator[None]:
        """Waits for what is drawn within, and adds the card's time for it to card_seconds. Software
        has wall time instead: the clock of llvmpipe stops before its compute shaders do.
        """
        started = time.monotonic()
        with self._graphics.timer:
            yield
        self._graphics.finish()
        on_card = 1e-9 * self._graphics.timer.elapsed if self._graphics.hardware else 0.0
        self.card_seconds += on_card or time.monotonic() - started

    def _pieces(self, runs: NDArray[np.uint32]) -> Iterator[NDArray[np.uint32]]:
        """Cuts runs so that each piece takes about DRAW_SECONDS, going by the piece before."""
        ends = runs[:, 1].astype(np.int64) + runs[:, 2]
        begin = 0
        while begin < len(runs) and not self._stop.is_set():
            end = max(
                begin + 1,
                int(np.searchsorted(ends, int(runs[begin, 1]) + self._pairs_per_draw, "right")),
            )
            started = time.monotonic()
            yield runs[begin:end]
            pairs = int(ends[end - 1]) - int(runs[begin, 1])
            wanted = pairs * DRAW_SECONDS / max(time.monotonic() - started, 1e-6)
            # The time of a small piece is inexact: the next piece may be half or twice as large,
            # not more.
            wanted = min(max(wanted, self._pairs_per_draw / 2), self._pairs_per_draw * 2)
            self._pairs_per_draw = int(min(max(wanted, FEWEST_PAIRS), MOST_PAIRS))
            begin = end

    def _draw(self, runs: NDArray[np.uint32], order: NDArray[np.uint32], first_block: int) -> None:
        first_pair = int(runs[0, 1])
        pairs = order[first_pair : int(runs[-1, 1]) + int(runs[-1, 2])]
        rows = -(-len(pairs) // PAIRS_PER_ROW)
        padded = np.zeros(rows * PAIRS_PER_ROW, np.uint32)
        padded[: len(pairs)] = pairs
        self._order = self._fitting(self._order, PAIRS_PER_ROW, rows, 1)
        self._order.write(padded, (0, 0, PAIRS_PER_ROW, rows))
        self._order.use(TEXTURES.index("order"))
        self._quads.add(runs - np.array([first_block, first_pair, 0], np.uint32))

    def _fitting(
        self, texture: moderngl.Texture | None, width: int, height: int, components: int
    ) -> moderngl.Texture:
        """`texture`, or a higher one in its place."""
        if texture is not None and texture.height >= height:
            return texture
        release(texture)
        return self._graphics.gl.texture((width, roomy(height)), components, dtype="u4")

    def _finish(self, started: float) -> None:
        self._graphics.finish()
        self.busy_seconds += time.monotonic() - started
        error = self._graphics.gl.error
        if error != "GL_NO_ERROR":
            raise RuntimeError(f"OpenGL says {error}")
