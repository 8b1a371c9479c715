"""Closed rooms whose radiance is known: every form factor, cosine and boundary term must be right
at once.
"""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import LightKind

from tests.support import corescene as c
from tests.support.compare import block_means

integrators = pytest.mark.parametrize("integrator", c.BOTH)


def furnace(width: int = 64, height: int = 64) -> object:
    """A closed 2 m box of albedo .5 and emission 1 seen from near a corner towards the opposite
    one: edges and corners in view.
    """
    view = c.perspective((-0.8, -0.8, -0.7), (0.7, 0.75, 0.6), width, height, field=1.6)
    return c.scene(view, [(c.box((-1, -1, -1), (1, 1, 1), inwards=True), c.lambert(0.5, 1.0))])


def test_furnace_is_two_everywhere() -> None:
    rgb = c.picture(furnace(), passes=96, photons_per_pass=40_000, max_bounces=64, seed=1)
    blocks = block_means(rgb, 4)
    worst = np.abs(blocks / 2 - 1).max()
    assert worst < 0.01, f"a 4x4 block is {worst:.2%} off"
    assert rgb.mean() == pytest.approx(2.0, rel=0.002)


def test_furnace_with_the_path_tracer() -> None:
    rgb = c.picture(furnace(32, 32), Integrator.REFERENCE, passes=1024, max_bounces=64, seed=1)
    assert np.abs(block_means(rgb, 8) / 2 - 1).max() < 0.01
    assert rgb.mean() == pytest.approx(2.0, rel=0.002)


def test_without_boundary_correction_edges_are_dark() -> None:
    """Shows that the furnace test can fail: half of a photon's disc hangs over at an edge, three
    quarters at a corner.
    """
    settings = {
        "passes": 24,
        "photons_per_pass": 40_000,
        "max_bounces": 64,
        "seed": 1,
        "adaptive_radius": False,
    }
    dark = block_means(c.picture(furnace(), boundary_correction=False, **settings), 4)
    assert dark.min() < 1.9
    assert dark.max() < 2.05
    bright = block_means(c.picture(furnace(), **settings), 4)
    assert dark.mean() < bright.mean() - 0.01


def test_furnace_does_not_depend_on_tessellation() -> None:
    """Walls of 2 and of 512 triangles are the same patches."""
    vertices, faces = [], []
    low, high, n = -1.0, 1.0, 16
    axis = np.linspace(low, high, n + 1)
    for fixed in range(3):
        for side in (low, high):
            base = len(vertices)
            for v in axis:
                for u in axis:
                    point = [0.0, 0.0, 0.0]
                    point[fixed], point[(fixed + 1) % 3], point[(fixed + 2) % 3] = side, u, v
                    vertices.append(tuple(point))
            for j in range(n):
                for i in range(n):
                    k = base + j * (n + 1) + i
                    face = (k, k + 1, k + n + 2, k + n + 1)
                    faces.append(face if side == low else face[::-1])
    fine = c.mesh(vertices, faces)
    view = c.perspective((-0.8, -0.8, -0.7), (0.7, 0.75, 0.6), 64, 64, field=1.6)
    rgb = c.picture(
        c.scene(view, [(fine, c.lambert(0.5, 1.0))]),
        passes=48,
        photons_per_pass=40_000,
        max_bounces=64,
        seed=1,
    )
    assert np.abs(block_means(rgb, 8) / 2 - 1).max() < 0.01


@integrators
@pytest.mark.parametrize("albedo", [0.3, 0.8])
def test_integrating_sphere(integrator: Integrator, albedo: float) -> None:
    """A point lamp in the middle of a white globe: E = P/(4 pi R^2) / (1 - albedo) all over the
    wall.
    """
    power, radius = 50.0, 1.5
    view = c.perspective((0.3, -0.9, 0.2), (0.0, 1.0, 0.0), 24, 24, field=1.2)
    wall = c.globe(radius, 5, inwards=True, smooth=True)
    made = c.scene(
        view, [(wall, c.lambert(albedo))], [c.lamp(LightKind.POINT, power, (0.0, 0.0, 0.0))]
    )
    passes = 24 if integrator is Integrator.SPLAT else 200
    rgb = c.picture(
        made, integrator, passes=passes, photons_per_pass=10_000, max_bounces=200, seed=2
    )
    expected = power / (4 * pi * radius**2) / (1 - albedo) * albedo / pi
    assert rgb.mean() == pytest.approx(expected, rel=0.005)
    assert np.abs(block_means(rgb, 8) / expected - 1).max() < 0.015


def test_bounces_are_counted_alike() -> None:
    """With max_bounces = n the furnace holds 1 + .5 + ... + .5^(n+1): emission, direct light and n
    bounces.
    """
    for bounces in (0, 1, 3):
        expected = sum(0.5**k for k in range(bounces + 2))
        for integrator in c.BOTH:
            rgb = c.picture(
                furnace(16, 16),
                integrator,
                passes=200,
                photons_per_pass=8_000,
                max_bounces=bounces,
                seed=4,
            )
            assert rgb.mean() == pytest.approx(expected, rel=0.01), (bounces, integrator)
