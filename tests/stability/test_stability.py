"""The product, with its default settings, on every known failure."""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.scene import LightKind, Mesh, Scene

from tests import corescene as c
from tests.robust.test_degenerate import room
from tests.stability.cases import CASES, Case
from tests.stability.truth import bounced, shoot, worst_block


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
    faces = np.concatenate([np.add(k, (0, 1, cells + 2)), np.add(k, (0, cells + 2, cells + 1))]).astype(np.uint32)
    wall = c.mesh([(-1, 1, 0), (1, 1, 0), (1, 1, 1), (-1, 1, 1)], [(0, 1, 2, 3)])
    lamp = c.lamp(LightKind.SPOT, 100.0, (0.0, -0.5, 1.2), (0.0, 1.0, 0.5), spot_size=0.8, spot_blend=1.0)
    return c.scene(
        c.ortho_down(2.0, 2.2, 24), [(Mesh("floor", grid.astype(np.float32), faces), c.lambert(0.7)), (wall, c.lambert(0.8))], [lamp]
    )


def test_a_plane_is_a_plane_however_it_is_cut() -> None:
    """2 and 20,000 triangles (failure 9): the same photons land, on the same patch."""
    coarse, fine = (c.picture(_floor(n), passes=4, photons_per_pass=40_000, seed=1) for n in (1, 100))
    assert np.abs(coarse - fine).max() < 1e-3 * coarse.mean()


@pytest.mark.parametrize(("size", "away"), [(1e-4, 0.0), (1e5, 0.0), (1.0, 1e5)])
def test_scale_and_place_do_not_matter(size: float, away: float) -> None:
    """Failure 14. Lamps grow with the square of the scale, so that the picture stays."""
    near, far = (c.shoot(room(s, (x, -x, x), pixels=24), passes=16, photons_per_pass=20_000).passes for s, x in ((1.0, 0.0), (size, away)))
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
