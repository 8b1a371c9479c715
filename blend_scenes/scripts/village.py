"""A village on a clear afternoon under Blender's own sky: houses of plaster, brick and timber along
a cobbled lane, a church, walls, fences, trees and grass of instanced leaves.
"""

from __future__ import annotations

from math import pi, sin

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.things import scatter, village_plants
from blend_scenes.scripts.things.village_houses import House
from blend_scenes.scripts.things.village_plants import height, lane
from blend_scenes.scripts.things.village_stuff import ground, sky, stuff

Stuff = dict[str, bpy.types.Material]


def _ground() -> None:
    """Finer near the view."""
    xs = np.sign(g := np.linspace(-1, 1, 131)) * np.abs(g) ** 2.2 * 220.0
    ys = -22.0 + np.linspace(0, 1, 141) ** 2.0 * 330.0
    points = [(x, y, height(x, y)) for y in ys for x in xs]
    n = len(xs)
    faces = [(r * n + c, r * n + c + 1, (r + 1) * n + c + 1, (r + 1) * n + c)
             for r in range(len(ys) - 1) for c in range(n - 1)]  # fmt: skip
    thing = m.add_mesh("Ground", points, faces, ground("lane"), smooth=True)
    values = [
        float(np.clip((2.9 - abs(x - lane(y))) / 1.2, 0.0, 1.0)) * float(y < 95)
        for x, y, _ in points
    ]
    thing.data.attributes.new("lane", "FLOAT", "POINT").data.foreach_set("value", values)


def _houses(s: Stuff) -> None:
    white, ochre, rose, cream = (
        (0.82, 0.79, 0.72),
        (0.78, 0.56, 0.28),
        (0.72, 0.42, 0.32),
        (0.84, 0.74, 0.54),
    )
    rows = (
        # side, y, distance, house
        (-1, 1.5, 8.2, {"width": 8.4, "tint": cream, "timber": True, "shutters": "green"}),
        (
            -1,
            14.0,
            8.8,
            {"width": 7.2, "wall": "brick", "roof": "slate", "shutters": "red", "rise": 4.2},
        ),
        (-1, 26.0, 7.4, {"width": 8.0, "tint": rose, "shutters": "blue", "tall": 5.6}),
        (-1, 39.5, 8.4, {"width": 9.0, "tint": white, "roof": "slate", "timber": True}),
        (-1, 53.0, 8.4, {"width": 8.0, "tint": ochre}),
        (1, 6.5, 8.6, {"width": 8.8, "tint": white, "shutters": "blue", "rise": 3.8}),
        (1, 20.5, 7.8, {"width": 7.6, "tint": ochre, "timber": True, "shutters": "red"}),
        (1, 33.0, 8.4, {"width": 8.4, "wall": "rubble", "roof": "slate", "shutters": "green"}),
        (1, 46.0, 8.0, {"width": 7.6, "tint": rose, "shutters": "green"}),
        (1, 59.0, 8.6, {"width": 8.6, "tint": cream, "roof": "slate"}),
    )
    for seed, (side, y, away, more) in enumerate(rows):
        x = lane(y) + side * away
        turn = -side * pi / 2 + 0.12 * sin(5.0 * seed)
        House((x, y, height(x, y) - 0.1), turn, **more).build(s, seed)  # type: ignore[arg-type]
    for k, (x, y) in enumerate(
        ((-26.0, 62.0), (-38.0, 84.0), (24.0, 78.0), (40.0, 66.0), (-16.0, 100.0))
    ):
        more = {"tint": (white, cream, ochre)[k % 3], "roof": ("tiles", "slate")[k % 2]}
        House((x, y, height(x, y) - 0.1), 0.9 * k, **more).build(s, 20 + k)  # type: ignore[arg-type]


def _church(s: Stuff, x: float, y: float) -> None:
    z = height(x, y)
    House((x + 8.0, y + 2.0, z), 0.0, 13.0, 8.0, 6.5, 5.0, "plaster", "slate", floors=1).build(
        s, 40
    )
    a, top = 2.6, z + 17.0
    corners = [(-a, -a), (a, -a), (a, a), (-a, a)]
    around = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    tower = scatter.sheet("Tower", [
        [(x + c, y + d, z - 2.0), (x + e, y + f, z - 2.0), (x + e, y + f, top), (x + c, y + d, top)]
        for (c, d), (e, f) in around], s["plaster"])  # fmt: skip
    tower.color = (0.84, 0.8, 0.72, 1.0)
    b = a + 0.35
    scatter.sheet(
        "Spire",
        [
            [
                (x + b * c / a, y + b * d / a, top),
                (x + b * e / a, y + b * f / a, top),
                (x, y, top + 9.0),
            ]
            for (c, d), (e, f) in around
        ],
        s["slate"],
    )
    p.box("Cornice", (x - b, y - b, top - 0.3), (x + b, y + b, top), s["stone"], 0.04)
    for k in (-0.9, 0.9):
        p.box(
            "Sound hole",
            (x + k - 0.5, y - a - 0.04, top - 3.6),
            (x + k + 0.5, y - a, top - 1.2),
            s["timber"],
            0.02,
        )
    clock = m.add_turned(
        "Clock",
        [(0.95, -0.05), (0.95, 0.05), (0.0, 0.05)],
        s["white"],
        (x, y - a - 0.02, top - 5.4),
        40,
    )
    clock.rotation_euler[0] = pi / 2
    for turn, long in ((0.6, 0.75), (2.4, 0.5)):
        hand = p.box("Hand", (-0.04, -0.1, -0.02), (0.04, long, 0.02), s["iron"])
        hand.location, hand.rotation_euler = (x, y - a - 0.09, top - 5.4), (pi / 2, turn, 0.0)
    m.add_sphere("Finial", 0.25, s["brass"], (x, y, top + 9.1), 16)


def _fence(s: Stuff, x: float, y0: float, y1: float) -> None:
    parts = []
    for y in np.arange(y0, y1, 0.145):
        z = height(x + lane(y), y) - 0.05
        parts.append(
            ((lane(y) + x, y, z), (lane(y) + x + 0.022, y + 0.085, z + 0.95 + 0.05 * sin(9.0 * y)))
        )
    for low in (0.25, 0.7):
        rail = [
            (lane(y) + x - 0.02, y, height(x + lane(y), y) + low) for y in np.linspace(y0, y1, 12)
        ]
        p.tube("Rail", rail, 0.03, s["white"], sides=-2)
    p.boxes("Fence", parts, s["white"], 0.006)


def _wall(s: Stuff, x: float, y0: float, y1: float) -> None:
    parts, caps = [], []
    for y in np.arange(y0, y1, 1.2):
        z = height(x + lane(y), y)
        a, b = lane(y) + x - 0.2, lane(y) + x + 0.2
        parts.append(((a, y, z - 0.5), (b, y + 1.2, z + 0.85)))
        caps.append(((a - 0.05, y, z + 0.85), (b + 0.05, y + 1.18, z + 0.95)))
    p.boxes("Garden wall", parts, s["rubble"], 0.03)
    p.boxes("Wall caps", caps, s["stone"], 0.02)


def make() -> None:
    scene = m.new_scene(960, 540, "AgX")
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.view_settings.exposure = 0.0
    s = stuff()
    _ground()
    _houses(s)
    _church(s, lane(74.0) + 1.5, 76.0)
    _fence(s, -3.05, -9.5, -2.6)
    _wall(s, 3.3, -8.0, -0.5)
    village_plants.plants(s)
    village_plants.things(s)
    sky()
    m.add_camera((-0.6, -14.5, height(0.0, -14.5) + 2.1), (0.9, 8.0, 2.9), lens=28.0)
    m.save("village")


if __name__ == "__main__":
    make()
