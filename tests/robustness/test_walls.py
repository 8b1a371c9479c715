"""Discs at thin walls: light behind one does not come through at its foot."""

from __future__ import annotations

import numpy as np
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import LightKind, Mesh

from tests.support.corescene import lambert, lamp, mesh, ortho_down, picture, quad, scene

BLACK = lambert(0.0)


def upright(x: float, low: float, high: float, half: float = 2.0) -> Mesh:
    """A sheet in the plane of that x."""
    return mesh(
        [(x, -half, low), (x, half, low), (x, half, high), (x, -half, high)],
        [(0, 1, 2, 3)],
        "sheet",
    )


def test_the_floor_before_a_wall_is_dark_where_all_light_is_behind_it() -> None:
    """A lit board at x = 1 stands behind a taller black wall at x = 0, which shades the floor."""
    view = ortho_down(3.0, 1.6, 128)
    things = [
        (quad(2.0), lambert(0.8)),
        (upright(0.0, 0.0, 0.6), BLACK),
        (upright(1.0, 0.02, 0.3), lambert(0.9)),
    ]
    spot = lamp(
        LightKind.SPOT,
        100.0,
        (0.3, 0.0, 0.5),
        (1.0, 0.0, 0.15),
        spot_size=0.5,
        spot_blend=0.0,
        radius=0.0,
    )
    rows = picture(scene(view, things, [spot]), passes=16, photons_per_pass=40_000)[:, :, 1].mean(0)
    x = ((np.arange(len(rows)) + 0.5) / len(rows) - 0.5) * 1.6
    behind, before = rows[(x > 0.05) & (x < 0.3)].mean(), rows[(x > -0.75) & (x < -0.03)]
    assert behind > 0.01
    assert before.max() < 0.01 * behind, before.max() / behind


def test_the_two_sides_of_a_wall_through_the_middle_keep_their_light() -> None:
    """The same wall, white: discs that keep off it lose none of the light on its lit side."""
    view = ortho_down(3.0, 1.6, 64)
    things = [
        (quad(2.0), lambert(0.8)),
        (upright(0.0, 0.0, 0.6), lambert(0.8)),
        (upright(1.0, 0.02, 0.3), lambert(0.9)),
    ]
    spot = lamp(
        LightKind.SPOT,
        100.0,
        (0.3, 0.0, 0.5),
        (1.0, 0.0, 0.15),
        spot_size=0.5,
        spot_blend=0.0,
        radius=0.0,
    )
    what = scene(view, things, [spot])
    ours = picture(what, passes=24, photons_per_pass=40_000)[:, :, 1].mean(0)
    reference = picture(what, Integrator.REFERENCE, passes=256)[:, :, 1].mean(0)
    x = ((np.arange(len(ours)) + 0.5) / len(ours) - 0.5) * 1.6
    foot = (x > 0.0) & (x < 0.15)
    assert abs(ours[foot].mean() / reference[foot].mean() - 1.0) < 0.03
