"""What stands and hangs along the walls of `classroom`: the blackboard, the teacher's desk, books,
posters, lamps.
"""

from __future__ import annotations

from math import cos, pi, sin

import bpy
import numpy as np
from mathutils import Matrix

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.things import rooms
from blend_scenes.scripts.trees import material

Stuff = dict[str, bpy.types.Material]
WIDE, DEEP, TALL = 7.6, 9.2, 3.2
"""X from the windows; the blackboard is on the wall at y = DEEP."""


def front(s: Stuff) -> None:
    y = DEEP - 0.008
    p.box("Blackboard", (1.5, y - 0.03, 0.95), (5.7, y, 2.35), s["board"], 0.002)
    frame = [((1.42, y - 0.05, 0.87), (5.78, y, 0.95)), ((1.42, y - 0.05, 2.35), (5.78, y, 2.43)),
             ((1.42, y - 0.05, 0.95), (1.5, y, 2.35)), ((5.7, y - 0.05, 0.95), (5.78, y, 2.35)),
             ((1.5, y - 0.14, 0.9), (5.7, y - 0.05, 0.925))]  # fmt: skip
    p.boxes("Board frame", frame, s["dark"], 0.008)
    for k in range(5):
        stick = m.add_lathe(
            "Chalk",
            [(0.0, 0.0), (0.007, 0.0), (0.007, 0.07), (0.0, 0.07)],
            s["chalk"],
            (2.2 + 0.13 * k, y - 0.1, 0.9325),
            12,
        )
        stick.rotation_euler = (pi / 2, 0.0, 1.2 + 0.5 * k)
    p.box("Sponge", (4.6, y - 0.13, 0.926), (4.75, y - 0.06, 0.975), s["tinted"], 0.012).color = (
        0.7,
        0.55,
        0.15,
        1.0,
    )
    upright = Matrix.Rotation(pi / 2, 4, "X")
    for x, z, size, words in (
        (2.9, 2.02, 0.2, "Light"),
        (2.75, 1.66, 0.13, "L = E + T L"),
        (2.85, 1.4, 0.13, "1/r^2   n x l"),
        (4.9, 1.1, 0.09, "p. 20 - 26"),
    ):
        p.text(
            "Writing",
            words,
            size,
            s["chalk"],
            Matrix.Translation((x, y - 0.0305, z)) @ upright,
            0.0002,
        )
    sun = (4.1, 2.05)
    lines = [
        [(sun[0] + 0.12 * cos(a), sun[1] + 0.12 * sin(a)) for a in np.linspace(0, 2 * pi, 25)],
        [(sun[0] + 0.1, sun[1] - 0.1), (4.75, 1.4), (5.3, 1.95)],
        [(4.1, 1.4), (5.45, 1.4)],
        [(4.75, 1.4), (4.75, 2.1)],
    ]
    for line in lines:
        p.tube("Drawing", [(a, y - 0.031, b) for a, b in line], 0.006, s["chalk"], sides=-2)
    top = [
        ((1.0, 7.5, 0.72), (2.5, 8.2, 0.76)),
        ((1.05, 7.55, 0.0), (1.5, 8.15, 0.72)),
        ((2.42, 7.55, 0.0), (2.45, 8.15, 0.72)),
        ((1.5, 8.12, 0.2), (2.42, 8.15, 0.72)),
    ]
    p.boxes("Teacher's desk", top, s["dark"], 0.008)
    rooms.turned(rooms.books((0.0, 0.0, 0.0), 0.3, 4, s["tinted"]), (1.1, 7.95, 0.7605), 0.0)
    ball = m.add_sphere("Globe", 0.16, _globe(), (2.2, 7.9, 0.7605 + 0.26), 48)
    ball.rotation_euler[0] = 0.4
    p.tube(
        "Meridian",
        [
            (2.2, 7.9 + 0.18 * sin(a), 1.0205 + 0.18 * cos(a))
            for a in np.linspace(0.4, pi + 0.4, 24)
        ],
        0.006,
        s["brass"],
        sides=-3,
    )
    m.add_lathe(
        "Globe foot",
        [(0.0, 0.0), (0.1, 0.0), (0.09, 0.015), (0.015, 0.03), (0.012, 0.08), (0.0, 0.08)],
        s["dark"],
        (2.2, 7.9, 0.7605),
        32,
    )
    clock = m.add_turned(
        "Clock",
        [(0.0, 0.0), (0.17, 0.0), (0.17, 0.03), (0.15, 0.03), (0.15, 0.02), (0.0, 0.02)],
        s["white"],
        (3.6, y, 2.78),
        48,
    )
    clock.rotation_euler[0] = pi / 2
    for turn, long in ((0.9, 0.08), (3.0, 0.12)):
        hand = p.box("Hand", (-0.006, -0.02, 0.022), (0.006, long, 0.025), s["rubber"])
        hand.location, hand.rotation_euler = (3.6, y, 2.78), (pi / 2, turn, 0.0)


def _globe() -> bpy.types.Material:
    t = material("Globe")
    land = t.noise(t.coordinates("Object"), 9.0, 6.0)
    color = t.ramp(
        land, [(0.5, (0.1, 0.28, 0.5)), (0.505, (0.35, 0.42, 0.14)), (0.7, (0.55, 0.42, 0.22))]
    )
    return t.principled(Base_Color=color, Roughness=0.2, Coat_Weight=0.5)


def sides(s: Stuff) -> None:
    """Posters, a cupboard with books, lamps."""
    for k, (y, w, h) in enumerate(((3.2, 0.9, 1.2), (4.6, 1.3, 0.9), (6.1, 0.8, 1.1))):
        colors = (
            ((0.8, 0.55, 0.3), (0.95, 0.9, 0.75)),
            ((0.3, 0.55, 0.65), (0.85, 0.93, 0.95)),
            ((0.6, 0.7, 0.35), (0.98, 0.95, 0.8)),
        )[k]
        made = rooms.picture(f"Poster {k}", rooms.landscape(192, 50 + k, *colors), w, h, s["white"])
        rooms.turned(made, (WIDE - 0.001, y, 1.8), pi / 2)
    x = WIDE - 0.45
    parts = [
        ((x, 7.0, z), (WIDE - 0.01, 8.8, z + 0.03)) for z in (0.02, 0.45, 0.85, 1.25, 1.65, 2.05)
    ]
    parts += [((x, y, 0.0), (WIDE - 0.01, y + 0.03, 2.08)) for y in (6.97, 7.9, 8.8)]
    p.boxes(
        "Bookcase", [*parts, ((WIDE - 0.03, 7.0, 0.0), (WIDE - 0.01, 8.8, 2.08))], s["dark"], 0.004
    )
    for k, z in enumerate((0.48, 0.88, 1.28, 1.68)):
        for j, y in enumerate((7.86, 8.76)):
            long = 0.8 - 0.18 * ((3 * k + j) % 4)
            rooms.turned(
                rooms.books((0.0, 0.0, 0.0), long, 10 * k + j, s["tinted"], 0.31),
                (WIDE - 0.18, y, z),
                -pi / 2,
            )
    rooms.pot_plant((0.45, 8.75, 0.0), s, 1.0, 2)
    for x in (2.2, 5.4):
        for y in (2.2, 4.9, 7.6):
            case = [((x - 0.09, y - 0.65, TALL - 0.55), (x + 0.09, y + 0.65, TALL - 0.5))]
            p.boxes("Lamp case", case, s["white"], 0.012)
            tube = p.tube(
                "Lamp tube",
                [(x, y - 0.6, TALL - 0.575), (x, y + 0.6, TALL - 0.575)],
                0.019,
                s["lamp"],
                sides=-4,
            )
            tube.data.use_fill_caps = True
            for k in (-0.5, 0.5):
                p.tube(
                    "Lamp wire",
                    [(x, y + k, TALL - 0.5), (x, y + k, TALL)],
                    0.004,
                    s["steel"],
                    sides=-2,
                )
    p.box("Bin", (-0.13, -0.13, 0.0), (0.13, 0.13, 0.32), s["grey"], 0.02, (6.6, 8.9, 0.0))
    board = p.box(
        "Pin board", (0.0, 1.1, 1.1), (0.03, 2.5, 2.1), s["dark"], 0.006, (WIDE - 0.03, 0.0, 0.0)
    )
    board.name = "Pin board"
