"""many_lights.blend: a hall of twelve pillars under 1,000 small lamps of all colours, most of them
hidden from any one place.
"""

from __future__ import annotations

import bpy
import numpy as np

from . import modelling as m

HALF_X, HALF_Y, HEIGHT = 6.0, 4.0, 3.0
LAMPS, WATTS = 1000, 0.9


def _hall() -> None:
    corners = [
        (x, y, z)
        for z in (0.0, HEIGHT)
        for x, y in ((-HALF_X, -HALF_Y), (HALF_X, -HALF_Y), (HALF_X, HALF_Y), (-HALF_X, HALF_Y))
    ]
    sides = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
    m.add_mesh("Hall", corners, sides, m.diffuse("Plaster", (0.72, 0.7, 0.66)))
    stone = m.diffuse("Stone", (0.55, 0.5, 0.44))
    places = [(x, y) for x in (-4.5, -1.5, 1.5, 4.5) for y in (-2.4, 0.0, 2.4)]
    m.add_boxes(
        "Pillars",
        [((x - 0.22, y - 0.22, 0.0), (x + 0.22, y + 0.22, HEIGHT)) for x, y in places],
        stone,
    )
    clay = m.diffuse("Clay", (0.6, 0.3, 0.2))
    for number, (x, y) in enumerate(
        [(-3.0, 1.2), (0.0, -1.2), (0.2, 1.3), (3.0, -1.1), (3.1, 1.2)]
    ):
        m.add_sphere(f"Ball {number}", 0.42, clay, (x, y, 0.42))


def _lamps() -> None:
    random = np.random.default_rng(11)
    kinds = []
    for number in range(20):
        color = 0.25 + 0.75 * random.random(3)
        light = bpy.data.lights.new(f"Kind {number}", "POINT")
        light.energy, light.color = (
            WATTS * float(random.uniform(0.3, 1.7)),
            tuple(color / color.max()),
        )
        light.shadow_soft_size = 0.02
        light.use_soft_falloff = False
        kinds.append(light)
    for number in range(LAMPS):
        x, y = random.uniform(-0.97, 0.97, 2) * (HALF_X, HALF_Y)
        m.add_object(
            f"Lamp {number:04}",
            kinds[number % len(kinds)],
            (float(x), float(y), float(random.uniform(0.35, 0.95) * HEIGHT)),
        )


def make() -> None:
    m.new_scene(480, 320)
    _hall()
    _lamps()
    m.set_world((0.0, 0.0, 0.0))
    m.add_camera((-5.4, -3.4, 2.3), (1.0, 0.6, 0.9), lens=22.0)
    m.save("many_lights")


if __name__ == "__main__":
    make()
