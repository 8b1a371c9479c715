"""The gather points of a pass as textures, in several atlases where one texture cannot hold
them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import moderngl

TILE = 8
"""Side of the square of texels that holds the 64 points of a block."""
MOST_COLUMNS = 256


@dataclass(frozen=True, slots=True)
class AtlasPoints:
    """Blocks [first, first + count) as tiles. position (H, W, 4) float32, plane (H, W, 4) uint32:
    see the native point_atlas().
    """

    first: int
    count: int
    columns: int
    position: NDArray[np.float32]
    plane: NDArray[np.uint32]


def atlas_ranges(blocks: int, most_texels: int) -> Iterator[tuple[int, int, int]]:
    """(first block, blocks, columns) of the atlases that hold `blocks` blocks, none wider or higher
    than `most_texels`.
    """
    most = most_texels // TILE
    columns = min(most, MOST_COLUMNS)
    for first in range(0, blocks, columns * most):
        yield first, min(columns * most, blocks - first), columns


class Atlas:
    """The textures of one atlas, with the sums that drawing adds up: 52 bytes a point. On the
    OpenGL thread only.
    """

    def __init__(self, gl: moderngl.Context, points: AtlasPoints) -> None:
        height, width = points.position.shape[:2]
        self.points = points
        self.size = width, height
        self.position = gl.texture(self.size, 4, points.position, dtype="f4")
        self.plane = gl.texture(self.size, 4, points.plane, dtype="u4")
        self.sums = gl.texture(self.size, 4, dtype="f4")
        self.narrow = gl.texture(self.size, 1, dtype="f4")
        self.frame = gl.framebuffer([self.sums, self.narrow])
        self.frame.clear()

    def read_sums(self) -> NDArray[np.float32]:
        """(H, W, 5) float32: red, green, blue, count, narrow."""
        width, height = self.size
        planes = [
            np.frombuffer(t.read(), np.float32).reshape(height, width, -1)
            for t in (self.sums, self.narrow)
        ]
        return np.concatenate(planes, axis=-1)

    def release(self) -> None:
        """Releases the textures. Their framebuffer must not be bound."""
        for thing in (self.frame, self.narrow, self.sums, self.plane, self.position):
            thing.release()
