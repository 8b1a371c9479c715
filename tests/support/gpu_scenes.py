"""Small scenes with flat, bent and folded surfaces."""

from __future__ import annotations

from photon_splat.core.scene import LightKind, Scene

from tests.support import corescene as c


def room(pixels: int = 48) -> Scene:
    """A closed room with a box and a smooth globe, lit by a lamp and a shining quad."""
    view = c.perspective((-0.9, -0.9, 0.2), (0.3, 0.3, -0.4), pixels, pixels, 1.3)
    things = [
        (c.box((-1, -1, -1), (1, 1, 1), inwards=True), c.lambert((0.7, 0.6, 0.5))),
        (c.box((0.2, 0.2, -1), (0.6, 0.6, -0.3)), c.lambert((0.7, 0.3, 0.2))),
        (c.globe(0.35, 3, smooth=True), c.lambert((0.2, 0.5, 0.8))),
        (c.quad(0.2, 0.99), c.lambert(0.0, 8.0)),
    ]
    return c.scene(view, things, [c.lamp(LightKind.POINT, 20.0, (-0.5, 0.5, 0.6), radius=0.02)])


def floor(pixels: int = 32) -> Scene:
    """A floor and a wall, one lamp: points of few blocks, most of them dark but for the light
    between the two.
    """
    wall = c.mesh([(-1, 1, 0), (1, 1, 0), (1, 1, 1), (-1, 1, 1)], [(0, 1, 2, 3)])
    things = [(c.quad(1.0), c.lambert(0.8)), (wall, c.lambert((0.9, 0.2, 0.1)))]
    return c.scene(
        c.perspective((0, -2, 1), (0, 0.5, 0.2), pixels, pixels),
        things,
        [c.lamp(LightKind.POINT, 30.0, (0, 0, 1.2))],
    )
