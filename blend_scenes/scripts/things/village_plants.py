"""The lie of the land of `village`, and what grows and stands on it."""

from __future__ import annotations

from math import cos, sin

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.things import scatter

Stuff = dict[str, bpy.types.Material]


def lane(y: float) -> float:
    """x of the lane's middle."""
    return 2.6 * sin(0.055 * y)


def height(x: float, y: float) -> float:
    away = abs(x - lane(y))
    near = 0.035 * max(y, -20.0) + 0.012 * max(away - 4.0, 0.0) ** 1.25
    hills = 26.0 / (1.0 + np.exp(-(y - 150.0) / 26.0)) * (0.7 + 0.3 * sin(0.021 * x + 0.6))
    return near * (1.0 if y < 110.0 else 110.0 / y) + hills + 0.06 * sin(1.3 * x) * sin(1.1 * y)


def plants(s: Stuff) -> None:
    trees = [
        scatter.tree("Oak", 8.5, 3.4, s["bark"], s["leaf"], 4),
        scatter.tree("Lime", 7.0, 2.5, s["bark"], s["lime"], 9),
        scatter.tree("Apple", 4.4, 1.9, s["bark"], s["leaf"], 15, 0.1),
    ]
    rng = np.random.default_rng(5)
    near = [
        (-6.4, -5.6, 0, 0.75),
        (5.2, 13.4, 2, 1.0),
        (-5.4, 7.9, 1, 0.75),
        (-5.0, 20.4, 2, 1.1),
        (5.4, 26.8, 1, 0.9),
        (-5.2, 33.0, 1, 1.0),
        (5.8, 40.0, 0, 0.9),
        (-14.0, 18.0, 0, 1.1),
        (15.0, 24.0, 0, 1.2),
        (-13.0, 44.0, 1, 1.2),
        (14.0, 50.0, 0, 1.1),
        (8.2, -2.6, 1, 0.9),
    ]
    for off, y, kind, size in near:
        x = lane(y) + off
        scatter.placed(trees[kind], (x, y, height(x, y) - 0.05), rng.uniform(0, 6.3), size)
    for _ in range(110):
        x, y = rng.uniform(-90, 90), rng.uniform(68, 200)
        if abs(x) > 12 or y > 110:
            scatter.placed(
                trees[int(rng.integers(0, 2))],
                (x, y, height(x, y) - 0.1),
                rng.uniform(0, 6.3),
                rng.uniform(0.8, 1.4),
            )
    rings = [(0.004 * cos(2.1 * k), 0.004 * sin(2.1 * k), 0.0) for k in range(26)]
    blades = [
        (
            (9 * a, 9 * b, 0.0),
            (cos(2.1 * k), sin(2.1 * k), 1.6 + 0.8 * sin(7.0 * k)),
            0.16 + 0.05 * sin(3.0 * k),
        )
        for k, (a, b, _) in enumerate(rings)
    ]
    tuft = p.leaves("Tuft", blades, s["blade"], 0.09, 0.5, 3)
    places = []
    for _ in range(13000):
        y = -13.0 + 30.0 * rng.uniform() ** 1.7
        off = rng.choice((-1, 1)) * (2.3 + 9.0 * rng.uniform() ** 1.6)
        x = lane(y) + off
        places.append(
            (
                (x, y, height(x, y)),
                (rng.normal(0, 0.15), rng.normal(0, 0.15), 1.0),
                rng.uniform(0.5, 1.2),
            )
        )
    scatter.scattered("Grass", tuft, places)
    for k, (off, y) in enumerate(
        ((-3.6, -2.0), (-3.5, 4.9), (3.4, 2.6), (3.3, 10.9), (-3.6, 17.8), (3.5, 23.6))
    ):
        x = lane(y) + off
        bush = p.leaves(
            "Shrub",
            p.bush(420, 0.7, 0.9, 0.12, 60 + k, 0.7),
            s[("leaf", "lime")[k % 2]],
            0.55,
            0.25,
            2,
        )
        flowers = p.leaves(
            "Blooms", p.bush(60, 0.74, 0.95, 0.06, 80 + k, 0.9), s["bloom"], 0.8, 0.2, 2
        )
        bush.location = flowers.location = (x, y, height(x, y) - 0.05)


def things(s: Stuff) -> None:
    for off, y in ((-2.9, 9.6), (3.0, 15.2), (2.75, -1.0)):
        x = lane(y) + off
        barrel = [
            (0.0, 0.0),
            (0.27, 0.0),
            (0.33, 0.28),
            (0.335, 0.42),
            (0.33, 0.56),
            (0.27, 0.84),
            (0.25, 0.82),
            (0.0, 0.8),
        ]
        p.turned("Barrel", barrel, s["wood"], (x, y, height(x, y)), 28)
        for z, r in ((0.16, 0.312), (0.68, 0.312)):
            m.add_lathe(
                "Hoop",
                [(r, -0.03), (r + 0.012, -0.03), (r + 0.012, 0.03), (r, 0.03)],
                s["iron"],
                (x, y, height(x, y) + z),
                32,
            )
    x, y = lane(9.0) - 2.75, 9.0 - 2.4
    z = height(x, y)
    planks = [((-0.25, -0.8, 0.42), (-0.04, 0.8, 0.46)), ((0.0, -0.8, 0.42), (0.2, 0.8, 0.46)),
              ((-0.32, -0.8, 0.6), (-0.28, 0.8, 0.85))]  # fmt: skip
    p.boxes("Bench", planks, s["door"], 0.01, (x, y, z))
    legs = [((-0.24, k - 0.04, -0.1), (0.18, k + 0.04, 0.42)) for k in (-0.6, 0.6)]
    legs += [((-0.28, k - 0.03, 0.42), (-0.24, k + 0.03, 0.85)) for k in (-0.6, 0.6)]
    p.boxes("Bench legs", legs, s["iron"], 0.01, (x, y, z))
    for off, y in ((2.9, 1.0), (-2.9, 20.0)):
        x = lane(y) + off
        z = height(x, y)
        p.tube("Lamp post", [(x, y, z), (x, y, z + 3.3)], 0.05, s["iron"], sides=-4)
        m.add_lathe("Lamp foot", [(0.14, 0.0), (0.12, 0.3), (0.06, 0.5)], s["iron"], (x, y, z), 16)
        m.add_lathe(
            "Lamp glass", [(0.1, 0.0), (0.16, 0.4), (0.0, 0.4)], s["pane"], (x, y, z + 3.3), 6
        )
        m.add_lathe(
            "Lamp roof", [(0.22, 0.4), (0.05, 0.58), (0.0, 0.7)], s["iron"], (x, y, z + 3.3), 6
        )
