"""A room that neither photons nor camera paths light well, and what the path tracer makes of it."""

from __future__ import annotations

from functools import cache

import numpy as np
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import LightKind, Material, Mesh, Scene, Side

from tests.support import corescene as c
from tests.support.programs import closure


def leaves(roughness: float | None = None) -> Scene:
    """200 triangles of 6 cm in a room whose far wall is a metal of this roughness."""
    random = np.random.default_rng(3)
    middles = random.uniform((-0.6, -0.3, 0.4), (0.6, 0.5, 1.2), (200, 3))
    corners = middles[:, None] + random.normal(0, 0.03, (200, 3, 3))
    leaf = Mesh(
        "leaves",
        corners.reshape(-1, 3).astype(np.float32),
        np.arange(600, dtype=np.uint32).reshape(-1, 3),
    )
    things = [(c.box((-1, -1, 0), (1, 1, 2), inwards=True), c.lambert(0.6)), (leaf, c.lambert(0.7))]
    metal = c.mesh(
        [(-0.9, 0.9, 0.1), (0.9, 0.9, 0.1), (0.9, 0.9, 1.9), (-0.9, 0.9, 1.9)], [(0, 1, 2, 3)]
    )
    if roughness is not None:
        things.append((metal, Material("metal", Side(), Side(), program=0)))
    view = c.perspective((0.0, -0.9, 0.9), (0.0, 0.0, 0.8), 24, 24, 1.0)
    lamp = c.lamp(LightKind.AREA, 40.0, (0.0, -0.5, 1.9), (0.0, 0.6, 0.8), size=(0.6, 0.6))
    what = c.scene(view, things, [lamp])
    if roughness is not None:
        what.programs.append(closure("Glossy", color=0.9, roughness=roughness))
    return what


@cache
def mean_of_leaves(roughness: float | None = None) -> float:
    """Of the path-traced picture, with at most 12 bounces."""
    picture = c.picture(leaves(roughness), Integrator.REFERENCE, passes=800, max_bounces=12, seed=1)
    return float(picture.mean())
