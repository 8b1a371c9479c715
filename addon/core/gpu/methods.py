"""Two ways to add the photons of an atlas's blocks to its points; rule.py says which is taken. On
the OpenGL thread only.

Both find positions, planes, photons and order bound as TEXTURES. Runs are (R, 3) uint32: block
counted from the atlas's first, first pair, pairs; those of a block follow each other. Both sum up
each run and add the runs in their order, so that a picture does not depend on which of them has
been faster.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from .shaders import source

if TYPE_CHECKING:
    import moderngl

    from .atlas import Atlas

TEXTURES = ("positions", "planes", "photons", "order")
QUADS_NEED, GATHER_NEEDS = 330, 430
"""Versions of OpenGL; the second one has compute shaders."""
MOST_GROUPS = 65535
"""Work groups along one axis, which every driver has."""


class Method(Protocol):
    name: str

    def aim(self, atlas: Atlas) -> None:
        """Adds to this atlas from now on."""

    def add(self, runs: NDArray[np.uint32]) -> None: ...

    def release(self) -> None: ...


class Quads:
    """A quad covers the tile of one block and adds up a run of its photons; additive blending adds
    the runs of a block.

    Runs of one photon are the splatting of Lavignotte & Paulin (2003), one blend per photon and
    point.
    """

    name = "quads"

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        version = GATHER_NEEDS if gl.version_code >= GATHER_NEEDS else QUADS_NEED
        self._program = gl.program(source("splat.vert", version), source("splat.frag", version))
        self._runs: moderngl.Buffer | None = None
        self._quads: moderngl.VertexArray | None = None
        for unit, name in enumerate(TEXTURES):
            self._program[name] = unit

    def aim(self, atlas: Atlas) -> None:
        gl, (width, height) = self._gl, atlas.size
        gl.enable_only(gl.BLEND)
        gl.blend_func = gl.ONE, gl.ONE
        self._program["columns"] = atlas.points.columns
        self._program["texel_size"] = 2.0 / width, 2.0 / height
        atlas.frame.use()

    def add(self, runs: NDArray[np.uint32]) -> None:
        if self._quads is None or self._runs is None or self._runs.size < runs.nbytes:
            release(self._quads, self._runs)
            self._runs = self._gl.buffer(reserve=roomy(runs.nbytes), dynamic=True)
            self._quads = self._gl.vertex_array(self._program, [(self._runs, "3u4/i", "run")])
        self._runs.write(runs)
        self._quads.render(self._gl.TRIANGLE_STRIP, vertices=4, instances=len(runs))

    def release(self) -> None:
        release(self._quads, self._runs, self._program)


class Gather:
    """A work group of a compute shader takes all photons of a block and adds once (Mara, Luebke and
    McGuire 2013).
    """

    name = "gather"

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._shader = gl.compute_shader(source("gather.comp", GATHER_NEEDS))
        self._lists: moderngl.Buffer | None = None
        for unit, name in enumerate(TEXTURES):
            self._shader[name] = unit
        self._shader["sums_image"], self._shader["narrow_image"] = 0, 1

    def aim(self, atlas: Atlas) -> None:
        self._shader["columns"] = atlas.points.columns
        atlas.sums.bind_to_image(0)
        atlas.narrow.bind_to_image(1)

    def add(self, runs: NDArray[np.uint32]) -> None:
        lists = merged(runs)
        if self._lists is None or self._lists.size < lists.nbytes:
            release(self._lists)
            self._lists = self._gl.buffer(reserve=roomy(lists.nbytes), dynamic=True)
        self._lists.write(lists)
        self._lists.bind_to_storage_buffer(0)
        self._shader["list_count"] = len(lists)
        width = min(len(lists), MOST_GROUPS)
        self._shader.run(width, -(-len(lists) // width))
        self._gl.memory_barrier()

    def release(self) -> None:
        release(self._lists, self._shader)


METHODS: dict[str, type[Quads] | type[Gather]] = {Quads.name: Quads, Gather.name: Gather}


def available(gl: moderngl.Context) -> dict[str, type[Quads] | type[Gather]]:
    """The methods that the card's OpenGL version allows."""
    return METHODS if gl.version_code >= GATHER_NEEDS else {Quads.name: Quads}


def merged(runs: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Joins the runs of a block to one."""
    starts = np.flatnonzero(np.diff(runs[:, 0], prepend=runs[:1, 0] + np.uint32(1)))
    return np.column_stack([runs[starts, :2], np.add.reduceat(runs[:, 2], starts)]).astype(
        np.uint32
    )


def release(
    *things: moderngl.Buffer
    | moderngl.VertexArray
    | moderngl.Program
    | moderngl.ComputeShader
    | moderngl.Texture
    | None,
) -> None:
    for thing in things:
        if thing is not None:
            thing.release()


def roomy(size: int) -> int:
    """The next power of two, so that growing is rare."""
    return 1 << max(size - 1, 0).bit_length()
