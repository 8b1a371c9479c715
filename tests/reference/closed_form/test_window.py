"""A room lit through a window by an even sky: the guide that finds it changes the noise, not the
light.
"""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import Mesh, Scene

from tests.support import corescene as c


def _room() -> Scene:
    """A box of 2 m whose ceiling has a hole of 0.4 m, seen from above its floor; radiance 1 comes
    in.
    """
    box = c.box((-1, -1, -1), (1, 1, 1), inwards=True)
    middle = box.positions[box.triangles].mean(1)
    walls = Mesh("walls", box.positions, box.triangles[middle[:, 2] < 0.99])
    low, high = -0.2, 0.2
    ring = [(-1, -1), (1, -1), (1, 1), (-1, 1), (low, low), (high, low), (high, high), (low, high)]
    corners = np.array([(x, y, 1.0) for x, y in ring], np.float32)
    quads = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    ceiling = Mesh(
        "ceiling",
        corners,
        np.array([t for a, b, d, e in quads for t in ((a, d, b), (a, e, d))], np.int32),
    )
    view = c.perspective((0.0, 0.0, 0.9), (0.0, 0.0, -1.0), 48, 48, 1.4)
    what = c.scene(view, [(walls, c.lambert(0.5)), (ceiling, c.lambert(0.5))])
    what.world = (1.0, 1.0, 1.0)
    return what


@pytest.mark.parametrize("bounces", [0, 4])
def test_same_light_less_noise(bounces: int) -> None:
    what = _room()
    runs = {
        integrator: np.stack(
            [
                c.picture(
                    what,
                    passes=32,
                    max_bounces=bounces,
                    seed=seed,
                    integrator=integrator,
                    photons_per_pass=40_000,
                )[..., 0]
                for seed in range(4)
            ]
        ).astype(np.float64)
        for integrator in (Integrator.SPLAT, Integrator.REFERENCE)
    }
    guided, plain = runs[Integrator.SPLAT], runs[Integrator.REFERENCE]
    error = (
        guided.mean((1, 2)).std(ddof=1) ** 2 / 4 + plain.mean((1, 2)).std(ddof=1) ** 2 / 4
    ) ** 0.5
    assert guided.mean() == pytest.approx(plain.mean(), rel=0.004, abs=4 * error)
    assert guided.var(0, ddof=1).mean() < 0.25 * plain.var(0, ddof=1).mean()
