"""The product, with its default settings, on every known failure."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from photon_splat.core.scene import LightKind, Material, Mesh, Scene, Side

from tests.reference.stability.cases import CASES, Case
from tests.reference.stability.reference import bounced, shoot, worst_block
from tests.robustness.test_degenerate import room
from tests.support import corescene as c
from tests.support.programs import closure


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_case(case: Case, request: pytest.FixtureRequest) -> None:
    if case.known:
        request.applymarker(pytest.mark.xfail(reason=case.known, strict=True))
    worst = worst_block(case, shoot(case))
    assert worst < case.tolerance, f"a block of {case.name} is {worst:.1%} off"


def _floor(cells: int) -> Scene:
    axis = np.linspace(-1, 1, cells + 1)
    grid = np.stack([*np.meshgrid(axis, axis), np.zeros((cells + 1, cells + 1))], -1).reshape(-1, 3)
    k = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).reshape(-1, 1)
    faces = np.concatenate(
        [np.add(k, (0, 1, cells + 2)), np.add(k, (0, cells + 2, cells + 1))]
    ).astype(np.uint32)
    wall = c.mesh([(-1, 1, 0), (1, 1, 0), (1, 1, 1), (-1, 1, 1)], [(0, 1, 2, 3)])
    lamp = c.lamp(
        LightKind.SPOT, 100.0, (0.0, -0.5, 1.2), (0.0, 1.0, 0.5), spot_size=0.8, spot_blend=1.0
    )
    return c.scene(
        c.ortho_down(2.0, 2.2, 24),
        [(Mesh("floor", grid.astype(np.float32), faces), c.lambert(0.7)), (wall, c.lambert(0.8))],
        [lamp],
    )


def test_a_plane_is_a_plane_however_it_is_cut() -> None:
    """2 and 20,000 triangles (failure 9): the same photons land, on the same patch."""
    coarse, fine = (
        c.picture(_floor(n), passes=4, photons_per_pass=40_000, seed=1) for n in (1, 100)
    )
    assert np.abs(coarse - fine).max() < 1e-3 * coarse.mean()


@pytest.mark.parametrize(("size", "away"), [(1e-4, 0.0), (1e5, 0.0), (1.0, 1e5)])
def test_scale_and_place_do_not_matter(size: float, away: float) -> None:
    """Failure 14. Lamps grow with the square of the scale, so that the picture stays."""
    near, far = (
        c.shoot(room(s, (x, -x, x), pixels=24), passes=16, photons_per_pass=20_000).passes
        for s, x in ((1.0, 0.0), (size, away))
    )
    plain, other = bounced(near), bounced(far)
    assert other.mean() == pytest.approx(plain.mean(), rel=0.01)
    assert np.sqrt(((other - plain) ** 2).mean()) < 0.06 * plain.mean()


@pytest.mark.parametrize("photons", [0, 1])
def test_hardly_any_photons(photons: int) -> None:
    """Failure 22: no NaN, no crash; without photons nothing but direct light."""
    passes = c.shoot(room(pixels=16), passes=3, photons_per_pass=photons).passes
    assert all(np.isfinite(values).all() for values in passes.values())
    if not photons:
        assert bounced(passes).max() == 0


def _over_floor(shift: int) -> Scene:
    """A camera that looks down on a floor with a block, moved by so many of its pixels."""
    pixels, size = 24, 1.2
    room, block = (
        c.box((-1, -1, 0), (1, 1, 2), inwards=True),
        c.box((0.5, 0.5, 0.0), (0.9, 0.9, 0.6)),
    )
    view = c.ortho_down(0.5, size, pixels, (shift * size / pixels, 0.0))
    return c.scene(
        view,
        [(room, c.lambert(0.7)), (block, c.lambert(0.5))],
        [c.lamp(LightKind.AREA, 40.0, (0, 0, 1.95), size=(0.5, 0.5))],
    )


def test_a_fly_through_does_not_flicker() -> None:
    """Failure 17: what is seen twice differs by no more than Monte Carlo noise between still
    pictures of different seeds.
    """
    settings = {"passes": 8, "photons_per_pass": 15_000}
    frames = [bounced(c.shoot(_over_floor(k), seed=0, **settings).passes) for k in range(4)]
    moved = np.mean([((a[:, 1:] - b[:, :-1]) ** 2).mean() for a, b in pairwise(frames)])
    still = [bounced(c.shoot(_over_floor(0), seed=k, **settings).passes) for k in range(4)]
    noise = np.mean([((a - b) ** 2).mean() for a, b in pairwise(still)])
    assert moved < 1.2 * noise, f"frames differ by {(moved / noise) ** 0.5:.2f} times the noise"


def test_a_pinhead_of_glass_in_a_hall_is_found() -> None:
    """4 cm of glass in a hall of 20 m: the light through it, by how much the floor below gets,
    against Fresnel's formulas.
    """
    radius, height = 0.02, 0.06
    ball = c.globe(radius, 5, smooth=True)
    ball.positions[:, 2] += height
    things = [
        (c.box((-10, -10, 0), (10, 10, 20), inwards=True), c.lambert(0.0)),
        (c.quad(0.5, 1e-4), c.lambert(0.05)),
    ]
    glass = Material("glass", Side(), Side(), program=0)
    lamp = c.lamp(LightKind.POINT, 10_000.0, (0.0, 0.0, 19.0))
    what = c.scene(
        c.ortho_down(height - 1.2 * radius, 12 * radius, 24), [*things, (ball, glass)], [lamp]
    )
    what.programs.append(closure("Glass", color=1.0, ior=1.5))
    result = c.shoot(what, passes=8, photons_per_pass=50_000)
    radiance = bounced(result.passes).mean()
    flux = radiance * np.pi / 0.05 * (12 * radius) ** 2
    s = (np.arange(1000) + 0.5) / 1000  # squared distance from the axis, in radii
    cos_in, cos_out = np.sqrt(1 - s), np.sqrt(1 - s / 2.25)
    reflected = (
        ((cos_in - 1.5 * cos_out) / (cos_in + 1.5 * cos_out)) ** 2
        + ((1.5 * cos_in - cos_out) / (1.5 * cos_in + cos_out)) ** 2
    ) / 2
    expected = (
        10_000.0
        / (4 * np.pi)
        / (19.0 - height) ** 2
        * np.pi
        * radius**2
        * ((1 - reflected) ** 2).mean()
    )
    assert flux == pytest.approx(expected, rel=0.1)
    assert "No mirror" not in " ".join(result.statistics["plan"]["sentences"])
