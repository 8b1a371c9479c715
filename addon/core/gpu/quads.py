"""Adds the photons of an atlas's blocks to its points: a quad covers the tile of one block and adds
up a run of its photons; additive blending adds the runs of a block. On the OpenGL thread only.

Runs of one photon are the splatting of Lavignotte & Paulin (2003), one blend per photon and point.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .context import EXACT_OPENGL, OPENGL
from .shaders import source

if TYPE_CHECKING:
    import moderngl

    from .atlas import Atlas

TEXTURES = ("positions", "planes", "photons", "order")


class Quads:
    """The shader program, and the runs of one draw call."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        version = EXACT_OPENGL if gl.version_code >= EXACT_OPENGL else OPENGL
        self._program = gl.program(source("splat.vert", version), source("splat.frag", version))
        self._runs: moderngl.Buffer | None = None
        self._quads: moderngl.VertexArray | None = None
        for unit, name in enumerate(TEXTURES):
            self._program[name] = unit

    def aim(self, atlas: Atlas) -> None:
        """Adds to this atlas from now on."""
        gl, (width, height) = self._gl, atlas.size
        gl.enable_only(gl.BLEND)
        gl.blend_func = gl.ONE, gl.ONE
        self._program["columns"] = atlas.points.columns
        self._program["texel_size"] = 2.0 / width, 2.0 / height
        atlas.frame.use()

    def add(self, runs: NDArray[np.uint32]) -> None:
        """runs: (R, 3), block counted from the atlas's first, first pair, pairs; those of a block
        follow each other. Positions, planes, photons and order are bound as TEXTURES.
        """
        if self._quads is None or self._runs is None or self._runs.size < runs.nbytes:
            release(self._quads, self._runs)
            self._runs = self._gl.buffer(reserve=roomy(runs.nbytes), dynamic=True)
            self._quads = self._gl.vertex_array(self._program, [(self._runs, "3u4/i", "run")])
        self._runs.write(runs)
        self._quads.render(self._gl.TRIANGLE_STRIP, vertices=4, instances=len(runs))

    def release(self) -> None:
        release(self._quads, self._runs, self._program)


def release(
    *things: moderngl.Buffer | moderngl.VertexArray | moderngl.Program | moderngl.Texture | None,
) -> None:
    for thing in things:
        if thing is not None:
            thing.release()


def roomy(size: int) -> int:
    """The next power of two, so that growing is rare."""
    return 1 << max(size - 1, 0).bit_length()
