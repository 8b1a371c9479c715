"""Draws photons over atlases of points. Everything here runs on the OpenGL thread.

A quad covers the tile of one block and adds up a *run* of the photons that the block may catch; additive blending adds the
runs of a block. Runs of one photon are the splatting of Lavignotte & Paulin (2003), one blend per photon and point; runs
longer than any list are tiled gathering (Mara, Luebke and McGuire 2013), one blend per point, but a tile full of photons
then keeps few processors busy for long. LONGEST_RUN lies between: blending is 1/LONGEST_RUN of the work, and a tile of a
million photons is shared out as thousands of quads.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .atlas import Atlas, AtlasPoints
from .shaders import source

if TYPE_CHECKING:
    import moderngl

    from .context import Graphics

LONGEST_RUN = 128
PHOTONS_PER_ROW = 1024
"""As in splat.frag, and so is PAIRS_PER_ROW."""
PAIRS_PER_ROW = 4096
DRAW_SECONDS = 0.03
"""Draws are cut to about this long, so that a cancelled render stops soon and no driver takes the card for hung."""
FEWEST_PAIRS, MOST_PAIRS = 1 << 13, 1 << 22
TEXTURES = ("positions", "planes", "photons", "order")


@dataclass(frozen=True, slots=True)
class Batch:
    """photons (rows of PHOTONS_PER_ROW, 8) float32; order (P,) and runs (R, 3) uint32 as the native photon_runs() makes them."""

    photons: NDArray[np.float32]
    order: NDArray[np.uint32]
    runs: NDArray[np.uint32]


class Painter:
    """One render's objects on the graphics card. `stop` ends a long splat() early."""

    def __init__(self, graphics: Graphics, stop: threading.Event) -> None:
        gl = graphics.gl
        self._graphics = graphics
        self._stop = stop
        self._atlases: list[Atlas] = []
        self._photons: moderngl.Texture | None = None
        self._order: moderngl.Texture | None = None
        self._runs: moderngl.Buffer | None = None
        self._quads: moderngl.VertexArray | None = None
        self._pairs_per_draw = 1 << 16
        self.busy_seconds = 0.0
        self.program = gl.program(source("splat.vert"), source("splat.frag"))
        for unit, name in enumerate(TEXTURES):
            self.program[name] = unit

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
        gl = self._graphics.gl
        self._photons = self._fitting(self._photons, 2 * PHOTONS_PER_ROW, len(batch.photons) // PHOTONS_PER_ROW, 4)
        self._photons.write(batch.photons, (0, 0, 2 * PHOTONS_PER_ROW, len(batch.photons) // PHOTONS_PER_ROW))
        gl.enable_only(gl.BLEND)
        gl.blend_func = gl.ONE, gl.ONE
        for atlas in self._atlases:
            self._bind(atlas)
            first = atlas.points.first
            begin, end = np.searchsorted(batch.runs[:, 0], (first, first + atlas.points.count))
            for runs in self._pieces(batch.runs[begin:end]):
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
        for thing in (self._quads, self._runs, self._order, self._photons, self.program):
            if thing is not None:
                thing.release()

    def _release_atlases(self) -> None:
        self._graphics.idle.use()
        while self._atlases:
            self._atlases.pop().release()

    def _bind(self, atlas: Atlas) -> None:
        width, height = atlas.size
        self.program["columns"] = atlas.points.columns
        self.program["texel_size"] = 2.0 / width, 2.0 / height
        atlas.frame.use()
        for unit, texture in enumerate((atlas.position, atlas.plane)):
            texture.use(unit)

    def _pieces(self, runs: NDArray[np.uint32]) -> Iterator[NDArray[np.uint32]]:
        """Cuts runs so that each piece takes about DRAW_SECONDS, going by the piece before."""
        ends = runs[:, 1].astype(np.int64) + runs[:, 2]
        begin = 0
        while begin < len(runs) and not self._stop.is_set():
            end = max(begin + 1, int(np.searchsorted(ends, int(runs[begin, 1]) + self._pairs_per_draw, "right")))
            started = time.monotonic()
            yield runs[begin:end]
            self._graphics.finish()
            pairs = int(ends[end - 1]) - int(runs[begin, 1])
            wanted = pairs * DRAW_SECONDS / max(time.monotonic() - started, 1e-6)
            # A small piece tells little: it may halve or double the next one, not more.
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
        instances = runs - np.array([first_block, first_pair, 0], np.uint32)
        quads = self._quads_of(instances.nbytes)
        assert self._runs is not None
        assert self._photons is not None
        self._runs.write(instances)
        self._photons.use(TEXTURES.index("photons"))
        self._order.use(TEXTURES.index("order"))
        quads.render(self._graphics.gl.TRIANGLE_STRIP, vertices=4, instances=len(instances))

    def _fitting(self, texture: moderngl.Texture | None, width: int, height: int, components: int) -> moderngl.Texture:
        """`texture`, or a higher one in its place."""
        if texture is not None and texture.height >= height:
            return texture
        if texture is not None:
            texture.release()
        return self._graphics.gl.texture((width, _roomy(height)), components, dtype="u4")

    def _quads_of(self, size: int) -> moderngl.VertexArray:
        if self._quads is None or self._runs is None or self._runs.size < size:
            for thing in (self._quads, self._runs):
                if thing is not None:
                    thing.release()
            self._runs = self._graphics.gl.buffer(reserve=_roomy(size), dynamic=True)
            self._quads = self._graphics.gl.vertex_array(self.program, [(self._runs, "3u4/i", "run")])
        return self._quads

    def _finish(self, started: float) -> None:
        self._graphics.finish()
        self.busy_seconds += time.monotonic() - started
        error = self._graphics.gl.error
        if error != "GL_NO_ERROR":
            raise RuntimeError(f"OpenGL says {error}")


def _roomy(size: int) -> int:
    """The next power of two, so that growing is rare."""
    return 1 << max(size - 1, 0).bit_length()
