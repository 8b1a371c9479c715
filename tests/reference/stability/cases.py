"""The failures of photon density estimation that are known, each as a tiny scene with its right
answer.

What is compared is light that has bounced (and emission with it, in the furnace); numbers are those
of the project's list of failures. `exact` is a number where the answer is known exactly; elsewhere
reference.npz holds a path-traced picture, made by `python -m tests.benchmarks.stability.run
--reference`. `tolerance` bounds the error of means over 4x4 pixels, relative to the reference's
mean (to `unit` where that mean is 0).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from photon_splat.core.scene import LightKind, Material, Mesh, Scene, Side

from tests.support import corescene as c
from tests.support.programs import closure

PIXELS = 24


@dataclass(frozen=True)
class Case:
    name: str
    failure: int
    make: Callable[[], Scene]
    tolerance: float
    exact: float | None = None
    unit: float = 1.0
    passes: int = 24
    photons: int = 40_000
    whole: bool = False  # compares the whole picture
    samples: int = 6000  # of the path-traced reference
    known: str = ""  # why it fails today


def _view(eye: c.Point, aim: c.Point, field: float = 1.0) -> tuple:
    return c.perspective(eye, aim, PIXELS, PIXELS, field)


def _area(power: float, place: c.Point, size: float = 0.5) -> object:
    return c.lamp(LightKind.AREA, power, place, size=(size, size))


def furnace() -> Scene:
    view = _view((-0.8, -0.8, -0.7), (0.7, 0.75, 0.6), 1.6)
    return c.scene(view, [(c.box((-1, -1, -1), (1, 1, 1), inwards=True), c.lambert(0.5, 1.0))])


def free_edge() -> Scene:
    """A table over a bright wall's foot: the light on it falls off towards its free edges."""
    table = c.mesh([(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)], [(0, 1, 2, 3)])
    wall = c.mesh([(-1, 0.7, -0.2), (1, 0.7, -0.2), (1, 0.7, 1.2), (-1, 0.7, 1.2)], [(0, 1, 2, 3)])
    lamp = c.lamp(
        LightKind.SPOT, 100.0, (0.0, -0.5, 1.2), (0.0, 0.7, 0.5), spot_size=0.7, spot_blend=1.0
    )
    return c.scene(
        c.ortho_down(2.0, 1.1, PIXELS), [(table, c.lambert(0.7)), (wall, c.lambert(0.8))], [lamp]
    )


def unequal_corner() -> Scene:
    """A floor and a wall that meet; the wall gets much more bounced light than the floor."""
    floor = c.mesh([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)])
    wall = c.mesh([(-1, 1, 0), (1, 1, 0), (1, 1, 2), (-1, 1, 2)], [(0, 1, 2, 3)])
    facing = c.mesh(
        [(-1, -0.3, 1.0), (1, -0.3, 1.0), (1, -0.3, 2.0), (-1, -0.3, 2.0)], [(0, 1, 2, 3)]
    )
    lamp = c.lamp(
        LightKind.SPOT, 100.0, (0.0, 0.8, 1.6), (0.0, -0.3, 1.5), spot_size=1.0, spot_blend=0.5
    )
    return c.scene(
        _view((0.0, -2.0, 0.8), (0.0, 1.0, 0.4)),
        [(floor, c.lambert(0.5)), (wall, c.lambert(0.5)), (facing, c.lambert(0.8))],
        [lamp],
    )


def _two_rooms(floor_of_one_piece: bool) -> Scene:
    """A lit room and a dark one behind a sheet; seen is the dark one. No light can get there."""
    parts: list[tuple[Mesh, object]] = []
    grey = c.lambert(0.7)
    if floor_of_one_piece:  # outer walls, floor and ceiling run on past the sheet
        parts.append((c.box((-2, -1, 0), (2, 1, 2), inwards=True), grey))
        parts.append((c.mesh([(0, -1, 0), (0, 1, 0), (0, 1, 2), (0, -1, 2)], [(0, 1, 2, 3)]), grey))
    else:  # two boxes, back to back, their walls a millimetre apart
        parts.append((c.box((-2, -1, 0), (-0.0005, 1, 2), inwards=True), grey))
        parts.append((c.box((0.0005, -1, 0), (2, 1, 2), inwards=True), grey))
    return c.scene(
        _view((1.9, -0.9, 1.8), (0.0, 0.2, 0.2), 1.2), parts, [_area(60.0, (-1.0, 0.0, 1.9))]
    )


def thin_wall() -> Scene:
    return _two_rooms(False)


def floor_under_wall() -> Scene:
    return _two_rooms(True)


def box_on_floor() -> Scene:
    room, block = (
        c.box((-1, -1, 0), (1, 1, 2), inwards=True),
        c.box((-0.3, -0.3, 0.0), (0.3, 0.3, 0.5)),
    )
    return c.scene(
        _view((0.0, -0.95, 0.9), (0.0, 0.0, 0.1), 1.0),
        [(room, c.lambert(0.7)), (block, c.lambert(0.3))],
        [_area(40.0, (0, 0, 1.95))],
    )


def dark_side() -> Scene:
    """The underside of a sheet: lit by the floor alone, while the upper side gets far more
    photons.
    """
    room = c.box((-1, -1, 0), (1, 1, 2), inwards=True)
    sheet = c.mesh(
        [(-0.6, -0.6, 1.2), (0.6, -0.6, 1.2), (0.6, 0.6, 1.2), (-0.6, 0.6, 1.2)], [(0, 1, 2, 3)]
    )
    return c.scene(
        _view((0.0, -0.9, 0.3), (0.0, 0.2, 1.2), 1.0),
        [(room, c.lambert(0.7)), (sheet, c.lambert(0.7))],
        [_area(40.0, (0, 0, 1.95))],
    )


def globe() -> Scene:
    wall = c.globe(1.5, 5, inwards=True, smooth=True)
    return c.scene(
        _view((0.3, -0.9, 0.2), (0.0, 1.0, 0.0), 1.2),
        [(wall, c.lambert(0.5))],
        [c.lamp(LightKind.POINT, 50.0, (0, 0, 0))],
    )


def cylinder() -> Scene:
    angles = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    vertices = [(0.4 * np.cos(t), 0.4 * np.sin(t), z) for z in (0.0, 1.2) for t in angles]
    faces = [(k, (k + 1) % 64, 64 + (k + 1) % 64, 64 + k) for k in range(64)]
    room = c.box((-1, -1, 0), (1, 1, 2), inwards=True)
    return c.scene(
        _view((0.0, -0.95, 0.8), (0.0, 0.0, 0.6), 0.8),
        [(room, c.lambert(0.7)), (c.mesh(vertices, faces), c.lambert(0.7))],
        [_area(40.0, (0, 0, 1.95))],
    )


def low_poly_sphere() -> Scene:
    room = c.box((-1, -1, -1), (1, 1, 1), inwards=True)
    ball = c.globe(0.5, 2, smooth=True)
    return c.scene(
        _view((0.0, -0.95, 0.2), (0, 0, 0), 0.9),
        [(room, c.lambert(0.7)), (ball, c.lambert(0.7))],
        [_area(40.0, (0, 0, 0.95))],
    )


def leaves() -> Scene:
    """400 separate triangles of 6 cm in the air."""
    random = np.random.default_rng(3)
    middles = random.uniform((-0.6, -0.4, 0.4), (0.6, 0.6, 1.2), (400, 3))
    corners = middles[:, None] + random.normal(0, 0.03, (400, 3, 3))
    leaf = Mesh(
        "leaves",
        corners.reshape(-1, 3).astype(np.float32),
        np.arange(1200, dtype=np.uint32).reshape(-1, 3),
    )
    room = c.box((-1, -1, 0), (1, 1, 2), inwards=True)
    return c.scene(
        _view((0.0, -0.95, 0.8), (0.0, 0.0, 0.8), 1.0),
        [(room, c.lambert(0.7)), (leaf, c.lambert(0.6))],
        [_area(40.0, (0, 0, 1.95))],
    )


def many_lamps() -> Scene:
    """Fifty lamps in a closed room beside a dim one; seen is the dim one."""
    lit, dim = (
        c.box((2, -1, 0), (4, 1, 2), inwards=True),
        c.box((-1, -1, 0), (1, 1, 2), inwards=True),
    )
    lamps = [
        c.lamp(LightKind.POINT, 50.0, (2.1 + 1.8 * ((7 * k) % 50) / 50, -0.9 + 1.8 * k / 50, 1.0))
        for k in range(50)
    ]
    return c.scene(
        _view((0.0, -0.95, 1.0), (0.0, 0.5, 0.4), 1.2),
        [(lit, c.lambert(0.5)), (dim, c.lambert(0.5))],
        [*lamps, _area(4.0, (0, 0, 1.95))],
    )


def sunny_plane(half: float) -> Scene:
    """A block of a metre under the sun on a large plane."""
    sun = c.lamp(LightKind.SUN, 5.0, (1.0, -0.8, 1.5), (0.0, 0.0, 0.0), angle=0.01)
    things = [
        (c.quad(half), c.lambert(0.5)),
        (c.box((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)), c.lambert(0.7)),
    ]
    return c.scene(_view((1.5, -3.0, 1.5), (0.0, 0.0, 0.4), 0.8), things, [sun])


def two_sides() -> Scene:
    """A sheet seen from its edge's height: bright above, much dimmer below, one mesh."""
    room = c.box((-1, -1, 0), (1, 1, 2), inwards=True)
    angles = np.linspace(-0.6, 0.6, 13)
    vertices = [(x, 0.7 * np.sin(a), 1.0 + 0.5 * np.cos(a)) for x in (-0.7, 0.7) for a in angles]
    sheet = c.mesh(vertices, [(k, k + 1, 14 + k, 13 + k) for k in range(12)])
    spot = c.lamp(
        LightKind.SPOT, 100.0, (0.0, 0.0, 1.8), (0.0, 0.9, 1.9), spot_size=1.2, spot_blend=1.0
    )
    return c.scene(
        _view((0.0, -0.95, 1.2), (0.0, 0.2, 1.25), 1.2),
        [(room, c.lambert(0.6)), (sheet, c.lambert(0.7))],
        [spot],
    )


def _with_program(things: list, view: tuple, lamps: list, name: str, **inputs: object) -> Scene:
    """The last of the things is made of that one closure."""
    things[-1] = (things[-1], Material("sharp", Side(), Side(), program=0))
    what = c.scene(view, things, lamps)
    what.programs.append(closure(name, **inputs))
    return what


def _ball(mirror: bool) -> Scene:
    """A glass ball over a floor, under a lamp wide enough for a path tracer; the caustic seen
    directly or in a mirror.
    """
    lamps = [c.lamp(LightKind.AREA, 30.0, (0.0, 0.0, 2.2), size=(0.5, 0.5))]
    view = _view((0.0, -1.6, 1.3), (0.0, 0.0, 0.1), 0.6)
    things: list = [(c.quad(1.5), c.lambert(0.7))]
    balls = [c.globe(0.3, 5, smooth=True)]
    balls[0].positions[:, 2] += 0.5
    if mirror:
        view = _view((0.0, -0.8, 0.9), (0.0, 1.2, 0.95), 0.7)
        glass = c.mesh(
            [(-1.0, 1.2, 0.05), (1.0, 1.2, 0.05), (1.0, 1.2, 1.6), (-1.0, 1.2, 1.6)], [(0, 1, 2, 3)]
        )
        metal = Material("mirror", Side(), Side(), program=1)
        things.append((glass, metal))
    what = _with_program([*things, balls[0]], view, lamps, "Glass", color=1.0, ior=1.5)
    if mirror:
        what.programs.append(closure("Glossy", color=0.9))
    return what


def caustic_rim() -> Scene:
    return _ball(False)


def mirror_sees_caustic() -> Scene:
    return _ball(True)


def glossy(roughness: float) -> Scene:
    """A metal of that roughness beside a diffuse floor: lit by it, mirrored in it."""
    wall = c.mesh([(-1, 1, 0), (1, 1, 0), (1, 1, 1.5), (-1, 1, 1.5)], [(0, 1, 2, 3)])
    lamps = [_area(40.0, (0.0, -0.3, 1.8), 0.8)]
    view = _view((0.0, -1.8, 1.2), (0.0, 0.6, 0.3), 0.9)
    return _with_program(
        [(c.quad(1.0), c.lambert(0.7)), wall], view, lamps, "Glossy", color=0.9, roughness=roughness
    )


def curtain() -> Scene:
    """A lamp behind a curtain that does not reach the floor."""
    room = c.box((-1, -1, 0), (1, 1, 2), inwards=True)
    cloth = c.mesh([(-1, 0.5, 0.06), (1, 0.5, 0.06), (1, 0.5, 2), (-1, 0.5, 2)], [(0, 1, 2, 3)])
    lamps = [c.lamp(LightKind.POINT, 300.0, (0.0, 0.8, 1.0))]
    return c.scene(
        _view((0.0, -0.95, 1.0), (0.0, 0.5, 0.4), 1.2),
        [(room, c.lambert(0.7)), (cloth, c.lambert(0.5))],
        lamps,
    )


def hidden_light() -> Scene:
    things = [
        (c.box((-1, -1, 0), (1, 1, 2), inwards=True), c.lambert(0.7)),
        (c.box((0.2, 0.2, 0.5), (0.6, 0.6, 0.9)), c.lambert(0.7)),
    ]
    return c.scene(
        _view((0.0, -0.9, 1.0), (0.0, 0.3, 0.6)),
        things,
        [c.lamp(LightKind.POINT, 50.0, (0.4, 0.4, 0.7))],
    )


CASES = (
    Case("furnace", 1, furnace, 0.03, exact=2.0, whole=True),
    Case("free_edge", 2, free_edge, 0.10, passes=48),
    Case("unequal_corner", 3, unequal_corner, 0.15),
    Case("thin_wall", 4, thin_wall, 1e-6, exact=0.0),
    Case("floor_under_wall", 5, floor_under_wall, 0.05, exact=0.0),
    Case("box_on_floor", 5, box_on_floor, 0.10),
    Case("dark_side", 6, dark_side, 0.10),
    # E a/(1 - a) a/pi of the bounced light
    Case("globe", 8, globe, 0.06, exact=50.0 / (4 * np.pi * 1.5**2) * 0.5 / np.pi),
    Case("cylinder", 8, cylinder, 0.10),
    Case("low_poly_sphere", 10, low_poly_sphere, 0.12),
    Case("leaves", 11, leaves, 0.30),
    Case("many_lamps", 15, many_lamps, 0.15),
    Case("plane_of_10_m", 16, lambda: sunny_plane(5.0), 0.5),
    Case("plane_of_1_km", 16, lambda: sunny_plane(500.0), 0.3),
    Case("two_sides", 7, two_sides, 0.12),
    Case("caustic_rim", 12, caustic_rim, 0.35, whole=True, samples=20_000),
    Case("glossy_10", 13, lambda: glossy(0.1), 0.15, whole=True),
    Case("glossy_25", 13, lambda: glossy(0.25), 0.15, whole=True),
    Case("glossy_40", 13, lambda: glossy(0.4), 0.15, whole=True),
    Case("glossy_60", 13, lambda: glossy(0.6), 0.15, whole=True),
    Case("curtain", 16, curtain, 0.5, passes=48),
    Case(
        "mirror_sees_caustic", 20, mirror_sees_caustic, 0.5, passes=48, whole=True, samples=20_000
    ),
    Case("hidden_light", 22, hidden_light, 1e-6, exact=0.0),
)
