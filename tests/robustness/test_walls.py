"""Discs at thin walls: light behind one does not come through at its foot."""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import Light, LightKind, Mesh

from tests.support.corescene import (
    Point,
    box,
    lambert,
    lamp,
    mesh,
    ortho_down,
    picture,
    quad,
    scene,
)

BLACK = lambert(0.0)


def upright(x: float, low: float, high: float, half: float = 2.0) -> Mesh:
    """A sheet in the plane of that x."""
    return mesh(
        [(x, -half, low), (x, half, low), (x, half, high), (x, -half, high)],
        [(0, 1, 2, 3)],
        "sheet",
    )


def spot_at_the_board(place: Point, aim: Point, size: float) -> Light:
    """Shines from between wall and board on the board alone; size in radians."""
    return lamp(LightKind.SPOT, 100.0, place, aim, spot_size=size, spot_blend=0.0, radius=0.0)


def test_the_floor_before_a_wall_is_dark_where_all_light_is_behind_it() -> None:
    """A lit board at x = 1 stands behind a taller black wall at x = 0, which shades the floor."""
    view = ortho_down(3.0, 1.6, 128)
    things = [
        (quad(2.0), lambert(0.8)),
        (upright(0.0, 0.0, 0.6), BLACK),
        (upright(1.0, 0.02, 0.3), lambert(0.9)),
    ]
    spot = spot_at_the_board((0.3, 0.0, 0.5), (1.0, 0.0, 0.15), 0.5)
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
    spot = spot_at_the_board((0.3, 0.0, 0.5), (1.0, 0.0, 0.15), 0.5)
    what = scene(view, things, [spot])
    ours = picture(what, passes=24, photons_per_pass=40_000)[:, :, 1].mean(0)
    reference = picture(what, Integrator.REFERENCE, passes=256)[:, :, 1].mean(0)
    x = ((np.arange(len(ours)) + 0.5) / len(ours) - 0.5) * 1.6
    foot = (x > 0.0) & (x < 0.15)
    assert abs(ours[foot].mean() / reference[foot].mean() - 1.0) < 0.03


def test_the_foot_of_a_wall_is_not_much_noisier_than_the_floor_before_it() -> None:
    """With few photons discs are as wide as the strip: what is left of them beside the wall, beyond
    which the floor goes on, still takes in enough of the photons."""
    view = ortho_down(3.0, 1.6, 64)
    things = [
        (quad(2.0), lambert(0.8)),
        (upright(0.0, 0.0, 1.5), lambert(0.8)),
        (upright(1.2, 0.02, 1.5), lambert(0.9)),
    ]
    spot = spot_at_the_board((0.3, 0.0, 1.2), (1.0, 0.0, 0.0), 1.0)
    what = scene(view, things, [spot])
    pictures = [
        picture(what, passes=2, photons_per_pass=4000, seed=seed)[:, :, 1] for seed in range(12)
    ]
    mean = np.mean(pictures, 0)
    x = ((np.arange(mean.shape[1]) + 0.5) / mean.shape[1] - 0.5) * 1.6
    foot, floor = (x > 0.0) & (x < 0.1), (x > 0.15) & (x < 0.25)
    noise = np.std(pictures, 0)[:, foot] / mean[:, foot]
    assert 0.0 < noise.mean() < 0.25, noise.mean()
    reference = picture(what, Integrator.REFERENCE, passes=256)[:, :, 1].mean(0)
    for strip, most in ((foot, 0.06), (floor, 0.03)):
        ratio = mean.mean(0)[strip].mean() / reference[strip].mean()
        assert abs(ratio - 1.0) < most, ratio


@pytest.mark.parametrize("gap", [0.01, 0.02])
def test_what_comes_under_a_thick_wall_stays_where_it_comes_in(gap: float) -> None:
    """A wall that hovers, its gap lit from behind: discs wider than the gap is high keep the light
    of its two sides apart.
    """
    view = ortho_down(3.0, 1.6, 64)
    things = [
        (quad(2.0), lambert(0.8)),
        (box((-0.2, -2.0, gap), (0.0, 2.0, 1.5)), lambert(0.8)),
        (upright(1.0, 0.02, 0.6), lambert(0.9)),
    ]
    spot = spot_at_the_board((0.3, 0.0, 0.5), (1.0, 0.0, 0.15), 0.5)
    what = scene(view, things, [spot])
    pictures = [picture(what, passes=4, photons_per_pass=4000, seed=seed) for seed in range(8)]
    ours = np.mean(pictures, 0)[:, :, 1].mean(0)
    reference = picture(what, Integrator.REFERENCE, passes=1024)[:, :, 1].mean(0)
    x = ((np.arange(len(ours)) + 0.5) / len(ours) - 0.5) * 1.6
    lit, dark = (x > 0.01) & (x < 0.2), (x > -0.5) & (x < -0.21)
    bright = reference[lit].mean()
    assert abs(ours[lit].mean() / bright - 1.0) < 0.03
    assert ours[dark].mean() - reference[dark].mean() < 0.004 * bright
