"""Caustic photons go where a pilot of them has brought light, in the numbers that leave the least
noise.
"""

from __future__ import annotations

import numpy as np
from photon_splat.core.native.bounds import world_bounds
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import LightKind, Material, Mesh, Side

from tests.support import corescene as c
from tests.support.programs import closure

MIRROR, FAINT = 0.9, 0.02
PATHS = 40_000


def _mirror(x: float, program: int) -> tuple[Mesh, Material]:
    """A small square mirror that faces up, which throws the lamp's light at the ceiling."""
    plate = c.mesh(
        [(x - 0.2, -0.2, 0.5), (x + 0.2, -0.2, 0.5), (x + 0.2, 0.2, 0.5), (x - 0.2, 0.2, 0.5)],
        [(0, 1, 2, 3)],
    )
    return plate, Material("mirror", Side(), Side(), program=program)


def test_a_faint_mirror_gets_fewer_photons_than_a_bright_one() -> None:
    """The variance of a sum of strata is least with paths in proportion to the root of the mean
    squared power that each brings: a mirror of 2 % may have a forty-fifth of the other's paths, or
    a twentieth of its natural share, which is the least. By their number alone, photons from either
    count the same, as Russian roulette ends neither's paths.
    """
    ceiling = c.mesh([(-3, -3, 2.0), (-3, 3, 2.0), (3, 3, 2.0), (3, -3, 2.0)], [(0, 1, 2, 3)])
    view = c.perspective((0.0, -2.5, 1.2), (0.0, 0.0, 2.0), 64, 64, 1.6)
    lamp = c.lamp(LightKind.POINT, 20.0, (0.0, 0.0, 1.5))
    scene = c.scene(view, [(ceiling, c.lambert(0.7)), _mirror(-1.0, 0), _mirror(1.0, 1)], [lamp])
    scene.programs += [closure("Glossy", color=color, roughness=0.0) for color in (MIRROR, FAINT)]
    renderer = load().Renderer(0)
    fill_renderer(
        renderer, scene, RenderSettings(passes=1, photons_per_pass=PATHS, adaptive_samples=False)
    )
    renderer.build()
    renderer.trace_camera(0)
    renderer.select_photon_map(1)
    renderer.place_points(0)
    renderer.trace_photons(0, PATHS)
    photons = renderer.photons()
    x = photons["position"][:, 0] + world_bounds(scene).mean(0)[0]
    bright, faint = x < 0, x > 0
    assert bright.sum() > 1000
    assert bright.sum() > 8 * faint.sum() > 0
    power = photons["power"].mean(-1)
    # none is left out
    assert np.isclose(power[faint].sum() / power[bright].sum(), FAINT / MIRROR, rtol=0.25)
