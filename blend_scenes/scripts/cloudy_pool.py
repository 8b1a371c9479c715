"""cloudy_pool.blend: under the waves of caustic_pool. Its water is a little cloudy, so that the
light that the waves gather shows on its way to the floor.
"""

from __future__ import annotations

import numpy as np

from . import modelling as m
from .caustic_shapes import Pool

CELLS = 160
BEYOND = 0.04  # the water reaches into the walls


def make() -> None:
    m.new_scene(640, 400)
    a, top = Pool.HALF, Pool.RIM
    corners = [(x, y, z) for z in (0, top) for x, y in ((-a, -a), (a, -a), (a, a), (-a, a))]
    sides = [(0, 1, 2, 3), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
    m.add_mesh(
        "Basin",
        corners,
        sides,
        [m.diffuse("Tiles", Pool.FLOOR_ALBEDO), m.diffuse("Wall", Pool.WALL_ALBEDO)],
        [0, 1, 1, 1, 1],
    )
    _water()
    m.add_light("Sun", "SUN", 6.0, Pool.SUN, (0.0, 0.0, 0.0), angle=Pool.SUN_ANGLE)
    m.set_world((0.0, 0.0, 0.0))
    m.add_camera((-0.1, -0.94, 0.2), (0.02, 0.4, 0.31), lens=20.0)
    m.save("cloudy_pool")


def _water() -> None:
    """Closed: waves above, and sides and a bottom behind those of the basin."""
    half = Pool.HALF + BEYOND
    y, x = (np.mgrid[: CELLS + 1, : CELLS + 1] / CELLS * 2 - 1) * half
    vertices = np.stack([x, y, Pool.height(x, y)], -1).reshape(-1, 3)
    n = CELLS + 1
    first = (np.arange(CELLS)[:, None] * n + np.arange(CELLS)).ravel()
    faces = np.stack([first, first + 1, first + n + 1, first + n], -1).tolist()
    along = np.arange(CELLS + 1)
    rim = np.concatenate(
        [along, along[1:] * n + CELLS, CELLS * n + along[-2::-1], along[-2:0:-1] * n]
    )
    below = len(vertices)
    foot = vertices[rim] * (1.0, 1.0, 0.0) - (0.0, 0.0, BEYOND)
    count = len(rim)
    faces += [
        (int(rim[i]), below + i, below + (i + 1) % count, int(rim[(i + 1) % count]))
        for i in range(count)
    ]
    faces.append(tuple(below + i for i in reversed(range(count))))
    water = m.in_medium(m.glass("Water", Pool.IOR), 0.5, (0.72, 0.92, 0.97), 0.5)
    m.add_mesh("Water", [*vertices.tolist(), *foot.tolist()], faces, water, smooth=True)


if __name__ == "__main__":
    make()
