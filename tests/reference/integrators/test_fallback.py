"""Where photons serve badly camera paths go on for the indirect light: the mean is the path
tracer's, caustics are not counted twice.
"""

from __future__ import annotations

import numpy as np
import pytest
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


@pytest.mark.parametrize(("roughness", "photons"), [(0.05, 50), (0.3, 50), (0.3, 5_000)])
def test_the_mean_is_the_path_tracers(roughness: float, photons: int) -> None:
    """With 50 photons a pass nearly all places fall back, with 5,000 the leaves do."""
    reference = c.picture(
        leaves(roughness), Integrator.REFERENCE, passes=800, max_bounces=12, seed=1
    )
    result = c.shoot(
        leaves(roughness),
        passes=250 if photons < 1000 else 100,
        photons_per_pass=photons,
        max_bounces=12,
        seed=2,
    )
    picture = result.passes["Combined"][..., :3].astype(np.float64)
    assert result.statistics["fallback"]["share"] > (0.8 if photons < 1000 else 0.1)
    assert picture.mean() == pytest.approx(reference.mean(), rel=0.015)


def test_the_share_is_told() -> None:
    assert (
        c.shoot(leaves(), passes=2, photons_per_pass=20_000, fallback=False).statistics["fallback"][
            "share"
        ]
        == 0
    )
    told = c.shoot(leaves(), passes=2, photons_per_pass=20_000).statistics
    assert 0.05 < told["fallback"]["share"] < 0.6
    assert any("path" in sentence for sentence in told["plan"]["sentences"])


def test_threads_do_not_matter() -> None:
    one, two = (
        c.picture(leaves(0.3), passes=3, photons_per_pass=20_000, threads=n) for n in (1, 3)
    )
    assert np.array_equal(one, two)
