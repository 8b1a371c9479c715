"""Closures that lose no light, in rooms of uniform light: whatever stands there must vanish in it.

In a closed room whose walls emit e = 1 - albedo the radiance is 1 everywhere and in every
direction. Photons that are refracted, reflected or scattered by what stands in the room must keep
it so: the flux adjoint of every closure, the split between caustic and indirect photons, and the
camera's paths through the closure are all in this one number.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import Material, Scene, Side

from tests.support import corescene as c
from tests.support.programs import closure

WHITE = (1.0, 1.0, 1.0)
LOSSLESS: dict[str, tuple[str, dict[str, Any]]] = {
    "mirror": ("Glossy", {"color": WHITE, "roughness": 0.0, "distribution": "GGX"}),
    "gloss": ("Glossy", {"color": WHITE, "roughness": 0.3, "distribution": "MULTI_GGX"}),
    "rough gloss": ("Glossy", {"color": WHITE, "roughness": 0.9, "distribution": "MULTI_GGX"}),
    "glass": ("Glass", {"color": WHITE, "roughness": 0.0, "ior": 1.5, "distribution": "GGX"}),
    "rough glass": (
        "Glass",
        {"color": WHITE, "roughness": 0.35, "ior": 1.5, "distribution": "MULTI_GGX"},
    ),
    "diamond": ("Glass", {"color": WHITE, "roughness": 0.0, "ior": 2.4, "distribution": "GGX"}),
    "diffuse": ("Diffuse", {"color": WHITE, "roughness": 0.0}),
    "rough diffuse": ("Diffuse", {"color": WHITE, "roughness": 1.0}),
    "translucent": ("Translucent", {"color": WHITE}),
    "transparent": ("Transparent", {"color": WHITE}),
}


def room(kind: str) -> Scene:
    """A box of albedo 1/2 that emits 1/2, and a ball of the closure in it."""
    half = (0.5, 0.5, 0.5)
    wall = Material("wall", Side(half, emission=half), Side(half, emission=half))
    ball = c.globe(0.4, 3)
    ball.positions += np.array((0.0, 0.2, -0.3), np.float32)
    operation, inputs = LOSSLESS[kind]
    what = c.scene(
        c.perspective((0.0, -0.9, 0.3), (0.0, 0.2, -0.2), 32, 32, 1.2),
        [(c.box((-1, -1, -1), (1, 1, 1), inwards=True), wall), (ball, Material("ball", program=0))],
    )
    what.programs = [closure(operation, **inputs)]
    return what


@pytest.mark.parametrize("kind", LOSSLESS)
@pytest.mark.parametrize("integrator", [Integrator.SPLAT, Integrator.REFERENCE])
def test_it_vanishes(kind: str, integrator: Integrator) -> None:
    settings = (
        {"passes": 24, "photons_per_pass": 50_000}
        if integrator is Integrator.SPLAT
        else {"passes": 96}
    )
    picture = c.picture(room(kind), integrator, max_bounces=256, **settings)
    assert np.isfinite(picture).all()
    assert picture.mean() == pytest.approx(1.0, abs=0.01)
    blocks = picture.reshape(4, 8, 4, 8, 3).mean(axis=(1, 3, 4))
    assert blocks == pytest.approx(1.0, abs=0.06)
