"""Where photons serve badly camera paths go on for the indirect light: the mean is the path
tracer's, caustics are not counted twice.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.reference.integrators.scenes import leaves, mean_of_leaves
from tests.support import corescene as c


@pytest.mark.parametrize(("roughness", "photons"), [(0.05, 50), (0.3, 50), (0.3, 5_000)])
def test_the_mean_is_the_path_tracers(roughness: float, photons: int) -> None:
    """With 50 photons a pass nearly all places fall back, with 5,000 the leaves do."""
    result = c.shoot(
        leaves(roughness),
        passes=125 if photons < 1000 else 100,
        photons_per_pass=photons,
        max_bounces=12,
        seed=2,
    )
    picture = result.passes["Combined"][..., :3].astype(np.float64)
    assert result.statistics["path_traced"]["share"] > (0.8 if photons < 1000 else 0.1)
    assert picture.mean() == pytest.approx(mean_of_leaves(roughness), rel=0.015)


def test_the_share_is_told() -> None:
    assert (
        c.shoot(leaves(), passes=2, photons_per_pass=20_000, adaptive_indirect=False).statistics[
            "path_traced"
        ]["share"]
        == 0
    )
    told = c.shoot(leaves(), passes=2, photons_per_pass=20_000).statistics
    assert 0.05 < told["path_traced"]["share"] < 0.6
    assert any("path" in sentence for sentence in told["plan"]["sentences"])


def test_threads_do_not_matter() -> None:
    one, two = (
        c.picture(leaves(0.3), passes=3, photons_per_pass=20_000, threads=n) for n in (1, 3)
    )
    assert np.array_equal(one, two)
