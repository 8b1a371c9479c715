"""caustic_pool.blend: a basin of water with waves under the sun. The floor's caustics are seen
through the same waves.
"""

from __future__ import annotations

import numpy as np

from . import modelling as m
from .caustic_shapes import Pool

CELLS = 128


def make() -> None:
    m.new_scene(640, 400)
    a, top = Pool.HALF, Pool.RIM
    corners = [
        (-a, -a, 0),
        (a, -a, 0),
        (a, a, 0),
        (-a, a, 0),
        (-a, -a, top),
        (a, -a, top),
        (a, a, top),
        (-a, a, top),
    ]
    sides = [(0, 1, 2, 3), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
    m.add_mesh(
        "Basin",
        corners,
        sides,
        [m.diffuse("Floor", Pool.FLOOR_ALBEDO), m.diffuse("Wall", Pool.WALL_ALBEDO)],
        [0, 1, 1, 1, 1],
    )
    _water()
    m.add_light("Sun", "SUN", Pool.STRENGTH, Pool.SUN, (0.0, 0.0, 0.0), angle=Pool.SUN_ANGLE)
    m.set_world((0.0, 0.0, 0.0))
    m.add_camera((0.0, -2.1, 2.3), (0.0, -0.05, 0.2), lens=38.0)
    m.save("caustic_pool")


def _water() -> None:
    """The surface alone: it ends at the walls, so that they and it close the water in."""
    y, x = (np.mgrid[: CELLS + 1, : CELLS + 1] / CELLS * 2 - 1) * Pool.HALF
    vertices = np.stack([x, y, Pool.height(x, y)], -1).reshape(-1, 3)
    first = (np.arange(CELLS)[:, None] * (CELLS + 1) + np.arange(CELLS)).ravel()
    faces = np.stack([first, first + 1, first + CELLS + 2, first + CELLS + 1], -1)
    m.add_mesh("Water", vertices.tolist(), faces.tolist(), m.glass("Water", Pool.IOR), smooth=True)


if __name__ == "__main__":
    make()
