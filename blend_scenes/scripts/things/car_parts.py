"""What is fixed to the bodywork of `car`: wheels, lamps, grille, mirrors, gaps, and the cabin."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, sin

import bpy
import numpy as np
from mathutils import Matrix, Vector

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.things.car_body import AXLES, TRACK, WHEEL

Drape = Callable[..., Vector]
Stuff = dict[str, bpy.types.Material]


def wheels(s: Stuff) -> None:
    """Four, the front ones steered a little. Modelled about Z, the outside up."""
    r, rim = WHEEL, 0.235
    tyre = [(rim, -0.1), (r - 0.035, -0.112), (r - 0.012, -0.1), (r, -0.08), (r, -0.045),
            (r - 0.008, -0.043), (r - 0.008, -0.035), (r, -0.033), (r, 0.033), (r - 0.008, 0.035),
            (r - 0.008, 0.043), (r, 0.045), (r, 0.08), (r - 0.012, 0.1), (r - 0.035, 0.112),
            (rim + 0.02, 0.108), (rim, 0.1)]  # fmt: skip
    barrel = [
        (rim - 0.03, -0.1),
        (rim, -0.1),
        (rim, 0.1),
        (rim + 0.008, 0.108),
        (rim - 0.01, 0.105),
        (rim - 0.03, 0.07),
        (rim - 0.03, -0.1),
    ]
    hub = [(0.03, 0.03), (0.062, 0.035), (0.066, 0.06), (0.05, 0.075), (0.032, 0.078), (0.0, 0.079)]
    disc = [
        (0.0, -0.03),
        (0.165, -0.03),
        (0.165, -0.005),
        (0.09, -0.005),
        (0.085, 0.02),
        (0.0, 0.02),
    ]
    for x in AXLES:
        for side in (-1, 1):
            made = [
                m.add_lathe("Tyre", tyre, s["rubber"], (0.0, 0.0, 0.0), 96),
                m.add_lathe("Barrel", barrel, s["rim"], (0.0, 0.0, 0.0), 64),
                m.add_lathe("Hub", hub, s["rim"], (0.0, 0.0, 0.0), 32),
                m.add_turned("Brake disc", disc, s["steel"], (0.0, 0.0, 0.0), 64),
                p.box("Caliper", (-0.055, 0.1, -0.045), (0.055, 0.185, 0.02), s["red"], 0.012),
            ]
            for k in range(10):
                spoke = _spoke(s["rim"], rim)
                spoke.rotation_euler[2] = 2 * pi * k / 10
                made.append(spoke)
            for k in range(5):
                turn = 2 * pi * (k + 0.25) / 5
                made.append(
                    m.add_lathe(
                        "Bolt",
                        [(0.009, 0.06), (0.009, 0.075), (0.0, 0.077)],
                        s["chrome"],
                        (0.048 * cos(turn), 0.048 * sin(turn), 0.0),
                        6,
                    )
                )
            steer = -0.3 if x > 0 else 0.0
            place = (
                Matrix.Translation((x, side * TRACK, r + 0.001))
                @ Matrix.Rotation(steer, 4, "Z")
                @ Matrix.Rotation(-side * pi / 2, 4, "X")
            )
            bpy.context.view_layer.update()
            for thing in made:
                thing.matrix_world = place @ thing.matrix_world


def _spoke(metal: bpy.types.Material, rim: float) -> bpy.types.Object:
    """One that widens and rises towards the rim."""
    inner, outer = 0.05, rim - 0.012
    ends = ((inner, 0.016, 0.035, 0.066), (0.13, 0.010, 0.045, 0.078), (outer, 0.017, 0.06, 0.1))
    points = [(x, side * y, z) for x, y, low, high in ends for z in (low, high) for side in (-1, 1)]
    faces = [(0, 1, 3, 2), (8, 10, 11, 9)]
    for k in (0, 4):
        faces += [(k, k + 4, k + 5, k + 1), (k + 2, k + 3, k + 7, k + 6), (k, k + 2, k + 6, k + 4),
                  (k + 1, k + 5, k + 7, k + 3)]  # fmt: skip
    return p.rounded(m.add_mesh("Spoke", points, faces, metal), 0.004, 3)


def _patch(
    name: str, drape: Drape, at: tuple[float, float, float], aim: tuple[float, float, float],
    size: tuple[float, float], dome: tuple[float, float], stuff: bpy.types.Material,
    lean: float = 0.0, power: float = 2.6,
) -> bpy.types.Object:  # fmt: skip
    """A rounded plate on the body about the point where `aim` meets it. dome: its distance from the
    body at the rim and in the middle.
    """
    direction = Vector(aim).normalized()
    side = direction.cross(Vector((0.0, 0.0, 1.0))).normalized()
    up = side.cross(direction)
    rings, spokes = 10, 48
    points: list[Vector] = []
    for ring in range(rings + 1):
        r = max(ring / rings, 1e-3)
        for k in range(spokes):
            c, sn = cos(2 * pi * k / spokes), sin(2 * pi * k / spokes)
            u = np.sign(c) * abs(c) ** (2 / power) * size[0] * r
            v = np.sign(sn) * abs(sn) ** (2 / power) * size[1] * r + lean * u
            start = Vector(at) + side * u + up * v - direction
            points.append(drape(start, direction, dome[0] + (dome[1] - dome[0]) * (1 - r * r)))
    faces = [
        (a * spokes + k, a * spokes + (k + 1) % spokes, (a + 1) * spokes + (k + 1) % spokes,
         (a + 1) * spokes + k)
        for a in range(rings) for k in range(spokes)
    ]  # fmt: skip
    return m.add_mesh(name, points, faces, stuff, smooth=True)


def lamps(drape: Drape, s: Stuff) -> None:
    for side in (-1, 1):
        at, aim = (2.05, side * 0.62, 0.615), (-0.9, -side * 0.55, -0.12)
        lean = side * -0.12
        _patch("Lamp housing", drape, at, aim, (0.2, 0.066), (0.001, 0.001), s["dark"], lean)
        lens = _patch("Lens", drape, at, aim, (0.2, 0.066), (0.002, 0.03), s["clear"], lean)
        thick = lens.modifiers.new("Thick", "SOLIDIFY")
        thick.thickness, thick.offset = 0.003, 0.0
        direction = Vector(aim).normalized()
        across = direction.cross(Vector((0.0, 0.0, 1.0))).normalized()
        for k, radius in ((-1, 0.03), (0, 0.032), (1, 0.026)):
            start = Vector(at) + across * (0.1 * k) - direction
            place = drape(start, direction, 0.004)
            bowl = [
                (0.008, -0.012),
                (0.6 * radius, -0.008),
                (radius, 0.004),
                (1.12 * radius, 0.004),
            ]
            ring = m.add_lathe("Reflector", bowl, s["chrome"], (0.0, 0.0, 0.0), 32)
            bulb = m.add_sphere("Bulb", 0.008, s["bulb"], (0.0, 0.0, 0.0), 16)
            for thing in (ring, bulb):
                thing.matrix_world = (
                    Matrix.Translation(place)
                    @ (-direction).to_track_quat("Z", "Y").to_matrix().to_4x4()
                )
        at, aim = (2.1, side * 0.6, 0.36), (-1.0, -side * 0.3, 0.0)
        _patch("Intake", drape, at, aim, (0.13, 0.055), (0.0015, 0.0015), s["dark"], 0.0, 4.0)


def trim(drape: Drape, s: Stuff) -> None:
    """Grille, badge, gaps between panels, handles, mirrors."""
    _patch("Grille", drape, (2.2, 0.0, 0.43), (-1.0, 0.0, 0.0), (0.4, 0.085), (0.0015, 0.0015),
           s["dark"], 0.0, 5.0)  # fmt: skip
    for z in (0.37, 0.40, 0.43, 0.46, 0.49):
        reach = 0.385 - 0.4 * abs(z - 0.43)
        line = [drape((3.0, y, z), (-1, 0, 0), 0.008) for y in np.linspace(-reach, reach, 21)]
        p.tube("Grille bar", line, 0.0055, s["chrome"], sides=-3)
    rim = [(0.4 * np.sign(cos(t)) * abs(cos(t)) ** 0.4,
            0.43 + 0.085 * np.sign(sin(t)) * abs(sin(t)) ** 0.4)
           for t in np.linspace(0.0, 2 * pi, 64, endpoint=False)]  # fmt: skip
    p.tube("Grille frame", [drape((3.0, y, z), (-1, 0, 0), 0.003) for y, z in rim], 0.009,
           s["chrome"], closed=True, sides=-3)  # fmt: skip
    _patch("Badge", drape, (2.1, 0.0, 0.585), (-1.0, 0.0, -0.25), (0.036, 0.036), (0.002, 0.008),
           s["chrome"], 0.0, 2.0)  # fmt: skip
    plate = drape((3.0, 0.0, 0.33), (-1, 0, 0), 0.012)
    p.box("Plate", (-0.006, -0.26, -0.055), (0.006, 0.26, 0.055), s["plate"], 0.004,
          (plate.x, 0.0, 0.315))  # fmt: skip
    front = Matrix.Translation((plate.x + 0.0075, 0.0, 0.295)) @ Matrix(
        ((0, 0, 1, 0), (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 0, 1)))  # fmt: skip
    p.text("Number", "PS 2003", 0.07, s["dark"], front, 0.0004)
    for side in (-1, 1):

        def start(x: float, z: float, side: int = side) -> Vector:
            return drape((x, side * 2.0, z), (0, -side, 0), 0.0005)

        for x0, x1 in ((0.76, 0.80), (-0.41, -0.40), (-1.02, -0.98)):
            line = [start(x0 + (x1 - x0) * t, 0.27 + 0.58 * t) for t in np.linspace(0.0, 1.0, 24)]
            p.tube("Gap", line, 0.0035, s["dark"], sides=-2)
        line = [start(x, 0.275) for x in np.linspace(0.76, -0.98, 40)]
        p.tube("Gap", line, 0.0035, s["dark"], sides=-2)
        line = [drape((1.98 - 1.18 * t, side * (0.60 + 0.05 * t), 2.0), (0, 0, -1), 0.0005)
                for t in np.linspace(0.0, 1.0, 40)]  # fmt: skip
        p.tube("Gap", line, 0.0035, s["dark"], sides=-2)
        line = [start(x, 0.855) for x in np.linspace(0.7, -1.5, 60)]
        p.tube("Chrome strip", line, 0.007, s["chrome"], sides=-3)
        for x in (-0.22, -0.84):
            grip = [
                start(x, 0.78),
                start(x - 0.02, 0.785),
                start(x - 0.15, 0.79),
                start(x - 0.17, 0.785),
            ]
            for point, out in zip(grip, (0.0, 0.028, 0.028, 0.0), strict=True):
                point.y += side * out
            p.tube("Handle", grip, 0.011, s["chrome"], sides=4)
        _mirror(side, s)


def _mirror(side: int, s: Stuff) -> None:
    shell = m.add_sphere("Mirror", 1.0, s["paint"], (0.62, side * 0.99, 0.99), 32)
    shell.scale = (0.075, 0.12, 0.075)
    face = m.add_sphere("Mirror glass", 1.0, s["chrome"], (0.575, side * 0.99, 0.99), 32)
    face.scale = (0.04, 0.1, 0.06)
    p.tube(
        "Mirror arm",
        [(0.64, side * 0.8, 0.905), (0.64, side * 0.87, 0.92), (0.63, side * 0.95, 0.96)],
        0.02,
        s["dark"],
        sides=4,
    )


def cabin(s: Stuff) -> None:
    """Floor, seats, dashboard, steering wheel."""
    p.box("Cabin floor", (-1.5, -0.66, 0.3), (0.72, 0.66, 0.34), s["dark"])
    dash = [(0.72, 0.9), (0.46, 0.92), (0.36, 0.86), (0.4, 0.72), (0.72, 0.7)]
    points = [(x, y, z) for y in (-0.68, 0.68) for x, z in dash]
    faces = [
        (0, 1, 2, 3, 4),
        (9, 8, 7, 6, 5),
        *((k, 5 + k, 5 + (k + 1) % 5, (k + 1) % 5) for k in range(5)),
    ]
    p.rounded(m.add_mesh("Dashboard", points, faces, s["trim"]), 0.02, 3)
    for x, y in ((-0.1, -0.37), (-0.1, 0.37), (-0.88, -0.37), (-0.88, 0.37)):
        p.box("Seat", (-0.26, -0.25, 0.36), (0.27, 0.25, 0.52), s["leather"], 0.05, (x, y, 0.0))
        back = p.box("Seat back", (-0.07, -0.24, 0.0), (0.07, 0.24, 0.55), s["leather"], 0.05)
        back.location, back.rotation_euler = (x - 0.25, y, 0.5), (0.0, -0.25, 0.0)
        head = p.box("Head rest", (-0.05, -0.13, 0.0), (0.05, 0.13, 0.15), s["leather"], 0.04)
        high = 1.03 if x > -0.5 else 0.96
        head.location, head.rotation_euler = (x - 0.39, y, high), (0.0, -0.15, 0.0)
    wheel = p.tube("Steering wheel", p.circle(0.18), 0.016, s["trim"], closed=True)
    wheel.location, wheel.rotation_euler = (0.26, 0.37, 0.9), (0.0, -1.1, 0.0)
