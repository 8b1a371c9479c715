"""A hall with a staircase: varnished treads and turned balusters, a floor of polished stone, sun
through tall windows, lamps on the walls.
"""

from __future__ import annotations

from math import pi

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.things import rooms, staircase_stuff

Stuff = dict[str, bpy.types.Material]
WIDE, DEEP, TALL = 5.2, 6.4, 5.4
RISE, RUN, STEPS = 0.172, 0.28, 9
X0, X1, Y0 = 3.55, 4.9, 1.75  # of the first flight: sides and foot
LANDING, Y1 = RISE * STEPS, 1.75 + RUN * 8
"""The second flight goes from the landing towards -X along the back wall."""


def _room(s: Stuff) -> None:
    left = [(0.9, 2.1, 0.9, 4.2), (3.0, 4.2, 0.9, 4.2)]
    made = [rooms.wall(DEEP, TALL, left, s["wallpaper"])]
    for opening in left:
        made += rooms.window(opening, s["white"], s["white"], 2, 5, s["glass"])
    rooms.turned(made, (0.0, DEEP, 0.0), -pi / 2)
    back = [(1.5, 2.7, 3.3, 4.9)]
    made = [rooms.wall(WIDE, TALL, back, s["wallpaper"])]
    made += rooms.window(back[0], s["white"], s["white"], 3, 3, s["glass"])
    rooms.turned(made, (WIDE, DEEP, 0.0), pi)
    rooms.turned([rooms.wall(DEEP, TALL, [], s["wallpaper"])], (WIDE, 0.0, 0.0), pi / 2)
    rooms.turned([rooms.wall(WIDE, TALL, [], s["wallpaper"])], (0.0, 0.0, 0.0), 0.0)
    m.add_boxes("Floor", [((-0.3, -0.3, -0.1), (WIDE + 0.3, DEEP + 0.3, 0.0))], s["floor"])
    m.add_boxes(
        "Ceiling", [((-0.3, -0.3, TALL), (WIDE + 0.3, DEEP + 0.3, TALL + 0.2))], s["ceiling"]
    )
    for z, thick, tall in ((0.0, 0.025, 0.18), (0.86, 0.03, 0.05), (TALL - 0.16, 0.14, 0.16)):
        if z != 0.86:
            p.boxes(
                "Moulding",
                [
                    ((0.0, 0.0, z), (thick, DEEP, z + tall)),
                    ((WIDE - thick, 0.0, z), (WIDE, DEEP, z + tall)),
                    ((thick, DEEP - thick, z), (WIDE - thick, DEEP, z + tall)),
                ],
                s["white"],
                0.012,
            )
    panels = [((0.0, y, 0.26), (0.018, y + 0.55, 0.8)) for y in np.arange(0.2, DEEP - 0.6, 0.68)]
    rail = [((0.0, 0.0, 0.855), (0.035, DEEP, 0.9)), ((0.0, 0.0, 0.18), (0.008, DEEP, 0.855))]
    p.boxes("Wainscot", panels + rail, s["white"], 0.008)
    panels = [((x, DEEP - 0.018, 0.26), (x + 0.55, DEEP, 0.8)) for x in np.arange(0.15, 3.0, 0.68)]
    rail = [
        ((0.035, DEEP - 0.035, 0.855), (WIDE, DEEP, 0.9)),
        ((0.008, DEEP - 0.008, 0.18), (WIDE, DEEP, 0.855)),
    ]
    p.boxes("Wainscot", panels + rail, s["white"], 0.008)


def _baluster(
    s: Stuff, x: float, y: float, z: float, tall: float, shape: dict[str, bpy.types.Mesh]
) -> None:
    if "mesh" not in shape:
        profile = [
            (0.022, 0.0),
            (0.022, 0.12),
            (0.016, 0.13),
            (0.024, 0.16),
            (0.014, 0.2),
            (0.027, 0.36),
            (0.02, 0.5),
            (0.012, 0.66),
            (0.02, 0.7),
            (0.013, 0.73),
            (0.022, 0.76),
            (0.022, 0.9),
        ]
        first = m.add_lathe("Baluster", profile, s["white"], (x, y, z), 20)
        shape["mesh"] = first.data
    else:
        first = m.add_object("Baluster", shape["mesh"], (x, y, z))
    first.scale[2] = tall / 0.9


def _newel(s: Stuff, x: float, y: float, z: float, tall: float = 1.12) -> None:
    p.box("Newel", (x - 0.055, y - 0.055, z), (x + 0.055, y + 0.055, z + tall), s["rail"], 0.01)
    p.box(
        "Newel cap",
        (x - 0.07, y - 0.07, z + tall),
        (x + 0.07, y + 0.07, z + tall + 0.035),
        s["rail"],
        0.01,
    )
    m.add_sphere("Newel ball", 0.058, s["rail"], (x, y, z + tall + 0.085), 32)


def _flights(s: Stuff) -> None:
    treads, risers, carpet = [], [], []
    middle = ((X0 + X1) / 2 - 0.33, (X0 + X1) / 2 + 0.33)
    for k in range(STEPS - 1):
        y, z = Y0 + RUN * k, RISE * (k + 1)
        treads.append(((X0 - 0.03, y - 0.03, z - 0.035), (X1 + 0.3, y + RUN, z)))
        risers.append(((X0, y, z - RISE), (X1 + 0.3, y + RUN, z - 0.0351)))
        carpet.append(((middle[0], y - 0.042, z), (middle[1], y + RUN - 0.04, z + 0.012)))
        carpet.append(((middle[0], y - 0.012, z - RISE + 0.012), (middle[1], y, z - 0.035)))
    carpet.append(
        ((middle[0], Y1 - 0.012, LANDING - RISE + 0.012), (middle[1], Y1, LANDING - 0.035))
    )
    treads.append(((X0 - 0.03, Y1 - 0.03, LANDING - 0.04), (WIDE, DEEP, LANDING)))
    risers.append(((X0, Y1, 0.0), (WIDE, DEEP, LANDING - 0.0401)))
    for k in range(STEPS):
        x, z = X0 - RUN * k, LANDING + RISE * (k + 1)
        treads.append(((x - RUN, 5.1, z - 0.035), (x + 0.03, DEEP, z)))
        risers.append(((x - RUN, 5.13, z - 0.3), (x, DEEP, z - 0.0351)))
    p.boxes("Treads", treads, s["tread"], 0.009)
    m.add_boxes("Risers", risers, s["white"])
    p.boxes("Runner", carpet, s["carpet"], 0.004)
    top = LANDING + RISE * STEPS
    p.box(
        "Gallery", (-0.01, 5.1, top - 0.3), (X0 - RUN * (STEPS - 1), DEEP, top - 0.0005), s["white"]
    )
    shape: dict[str, bpy.types.Mesh] = {}
    for k in range(STEPS - 1):
        for part in (0.25, 0.75):
            _baluster(
                s,
                X0 + 0.05,
                Y0 + RUN * (k + part),
                RISE * (k + 1),
                0.86 + RISE * (part - 0.25),
                shape,
            )
    for k in range(STEPS):
        for part in (0.25, 0.75):
            _baluster(
                s,
                X0 - RUN * (k + part),
                5.18,
                LANDING + RISE * (k + 1),
                0.86 + RISE * (part - 0.25),
                shape,
            )
    for y in np.linspace(Y1 + 0.14, 5.04, 8):
        _baluster(s, X0 + 0.05, y, LANDING, 0.9, shape)
    for x in np.linspace(0.14, X0 - RUN * STEPS - 0.16, 7):
        _baluster(s, x, 5.18, top, 0.9, shape)
    _newel(s, X0 + 0.05, Y0 - 0.08, 0.0, 1.16)
    for x, y, z in (
        (X0 + 0.05, Y1 + 0.02, LANDING),
        (X0 + 0.05, 5.18, LANDING),
        (X0 - RUN * STEPS - 0.05, 5.18, top),
    ):
        _newel(s, x, y, z)
    rise = RISE / RUN
    lines = [
        [(X0 + 0.05, Y0 - 0.05, 1.06), (X0 + 0.05, Y1, 1.06 + rise * (Y1 - Y0) + 0.06)],
        [(X0 + 0.05, Y1 + 0.05, LANDING + 0.92), (X0 + 0.05, 5.15, LANDING + 0.92)],
        [(X0, 5.18, LANDING + 1.04), (X0 - RUN * STEPS, 5.18, top + 0.9)],
        [(X0 - RUN * STEPS - 0.05, 5.18, top + 0.92), (0.0, 5.18, top + 0.92)],
    ]
    for line in lines:
        hand = p.tube("Handrail", line, 0.036, s["rail"], sides=-6)
        hand.data.use_fill_caps = True


def _things(s: Stuff) -> None:
    table, y = 0.36, 4.75
    p.box("Console top", (0.04, y - 0.6, 0.8), (0.04 + table, y + 0.1, 0.835), s["tread"], 0.008)
    legs = [
        ((a, b, 0.0), (a + 0.045, b + 0.045, 0.8))
        for a in (0.06, 0.32)
        for b in (y - 0.57, y + 0.02)
    ]
    p.boxes(
        "Console legs",
        [*legs, ((0.06, y - 0.57, 0.7), (0.365, y + 0.065, 0.795))],
        s["rail"],
        0.006,
    )
    vase = [(0.04, 0.0), (0.06, 0.01), (0.085, 0.12), (0.05, 0.24), (0.035, 0.28), (0.05, 0.31)]
    p.turned("Vase", p.vessel(vase, 0.004, 0.015), s["shade"], (0.22, y - 0.4, 0.836), 40)
    made = rooms.books((0.0, 0.0, 0.0), 0.2, 5, s["book"])
    rooms.turned(made, (0.09, y - 0.15, 0.836), 0.0)
    rooms.pot_plant((0.55, 5.75, 0.0), s, 1.15, 3)
    rooms.pot_plant((3.1, 1.35, 0.0), s, 0.8, 6)
    frames = ((1.2, 1.75, 1.1, 0.8, 3), (2.55, 1.8, 0.55, 0.7, 12))
    for x, z, w, h, seed in frames:
        colors = (
            ((0.55, 0.5, 0.3), (0.8, 0.84, 0.86))
            if seed == 3
            else ((0.35, 0.45, 0.55), (0.95, 0.78, 0.6))
        )
        made = rooms.picture(
            f"Painting {seed}", rooms.landscape(192, seed, *colors), w, h, s["gilt"]
        )
        rooms.turned(made, (x, DEEP - 0.002, z), pi)
    for k, (y, z) in enumerate(((2.3, 2.2), (3.1, 2.7), (4.2, 3.1))):
        made = rooms.picture(
            f"Print {k}",
            rooms.landscape(128, 30 + k, (0.6, 0.55, 0.42), (0.92, 0.89, 0.8)),
            0.42,
            0.54,
            s["rail"],
        )
        rooms.turned(made, (WIDE - 0.002, y, z), pi / 2)
    rug = p.box("Rug", (1.0, 1.6, 0.0005), (2.6, 4.0, 0.012), s["carpet"], 0.003)
    rug.rotation_euler[2] = 0.03


def _lamps(s: Stuff) -> None:
    for x, y, z, turn in (
        (0.0, 2.55, 2.2, -pi / 2),
        (0.0, 4.75, 2.2, -pi / 2),
        (WIDE, 1.6, 1.95, pi / 2),
        (WIDE, 5.2, 3.5, pi / 2),
    ):
        made = [
            m.add_turned(
                "Sconce plate",
                [(0.0, 0.0), (0.07, 0.0), (0.06, 0.02), (0.0, 0.025)],
                s["brass"],
                (0.0, 0.0, 0.0),
                32,
            ),
            p.tube(
                "Sconce arm",
                [(0.0, 0.02, 0.0), (0.0, 0.1, -0.03), (0.0, 0.13, 0.02), (0.0, 0.13, 0.07)],
                0.009,
                s["brass"],
                sides=3,
            ),
            m.add_lathe(
                "Sconce cup",
                [(0.02, 0.06), (0.045, 0.08), (0.04, 0.085)],
                s["brass"],
                (0.0, 0.13, 0.0),
                24,
            ),
            m.add_sphere("Sconce globe", 0.065, s["glow"], (0.0, 0.13, 0.14), 32),
        ]
        made[0].rotation_euler[0] = -pi / 2
        rooms.turned(made, (x, y, z), turn)
    x, y, z = 2.1, 3.1, 3.55
    p.tube("Chain", [(x, y, z + 0.5), (x, y, TALL)], 0.008, s["brass"], sides=-3)
    m.add_sphere("Pendant body", 0.07, s["brass"], (x, y, z + 0.35), 24)
    p.tube("Pendant stem", [(x, y, z + 0.05), (x, y, z + 0.5)], 0.014, s["brass"], sides=-4)
    for k in range(6):
        a = 2 * pi * k / 6
        c, d = np.cos(a), np.sin(a)
        line = [
            (0.0, 0.0, 0.3),
            (0.16 * c, 0.16 * d, 0.18),
            (0.32 * c, 0.32 * d, 0.16),
            (0.36 * c, 0.36 * d, 0.26),
        ]
        p.tube("Pendant arm", line, 0.009, s["brass"], (x, y, z), sides=3)
        m.add_lathe(
            "Pendant cup",
            [(0.015, 0.25), (0.04, 0.28), (0.035, 0.285)],
            s["brass"],
            (x + 0.36 * c, y + 0.36 * d, z),
            20,
        )
        m.add_sphere("Pendant bulb", 0.045, s["glow"], (x + 0.36 * c, y + 0.36 * d, z + 0.325), 24)


def make() -> None:
    scene = m.new_scene(960, 540, "AgX")
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.view_settings.exposure = 1.5
    s = staircase_stuff.stuff()
    _room(s)
    _flights(s)
    _things(s)
    _lamps(s)
    rooms.outside(1.6, 12.0, (-3.3, -0.7, 2.5), (1.0, 0.86, 0.68))
    m.add_camera((1.35, 0.12, 1.55), (2.75, 4.6, 1.85), lens=21.0)
    m.save("staircase")


if __name__ == "__main__":
    make()
