"""The error estimate: in every result, true within its tolerance, and good to stop by."""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator

from tests.robustness.test_degenerate import room
from tests.support import corescene as c
from tests.support.compare import LUMINANCE


@pytest.mark.parametrize("integrator", c.BOTH)
def test_the_pass_and_the_figures_say_the_same(integrator: Integrator) -> None:
    result = c.shoot(room(pixels=32), integrator, passes=16, photons_per_pass=5000)
    error, figures = result.passes["Error"], result.statistics["error"]
    luminance = result.passes["Combined"][..., :3] @ LUMINANCE
    assert error.shape == (32, 32, 1)
    assert np.isfinite(error).all()
    assert (error >= 0).all()
    assert figures["relative_rmse"] == pytest.approx(
        np.sqrt((error**2).mean()) / luminance.mean(), rel=1e-3
    )
    assert figures["relative_rmse"] ** 2 == pytest.approx(
        figures["standard_error"] ** 2 + figures["bias"] ** 2, rel=1e-6
    )
    assert (figures["bias"] > 0) == (integrator is Integrator.SPLAT)


@pytest.fixture(scope="module")
def halves() -> np.ndarray:
    """Luminance of two independent path-traced pictures of the room, (2, 24, 24): products with
    both are free of their noise.
    """
    return np.stack(
        [
            c.picture(room(pixels=24), Integrator.REFERENCE, passes=2000, seed=s) @ LUMINANCE
            for s in (5, 6)
        ]
    )


@pytest.mark.parametrize("passes", [8, 32])
def test_the_estimate_is_the_error(halves: np.ndarray, passes: int) -> None:
    """For the picture as a whole, and for the pixels in which it is small and those in which it is
    large: small in the mean over the seeds, because one seed's small estimates are small by chance.
    """
    measured, estimated = [], []
    for seed in range(8):
        result = c.shoot(room(pixels=24), passes=passes, photons_per_pass=6_000, seed=seed)
        luminance = result.passes["Combined"][..., :3] @ LUMINANCE
        measured.append((luminance - halves[0]) * (luminance - halves[1]))
        estimated.append(result.passes["Error"][..., 0] ** 2)
    true, said = np.mean(measured, axis=0).ravel(), np.mean(estimated, axis=0).ravel()
    whole = np.sqrt(true.mean() / said.mean())
    assert 0.7 < whole < 1.5, whole
    for part in np.array_split(np.argsort(said), 4):
        ratio = np.sqrt(max(true[part].mean(), 0.0) / said[part].mean())
        assert 0.65 < ratio < 1.45, ratio


def test_a_render_stops_when_the_error_is_small_enough(halves: np.ndarray) -> None:
    asked = 0.02
    result = c.shoot(room(pixels=24), passes=4096, photons_per_pass=20_000, error_threshold=asked)
    assert 8 <= result.statistics["passes"] < 2000
    assert 0 < result.statistics["error"]["relative_rmse"] <= asked
    luminance = result.passes["Combined"][..., :3] @ LUMINANCE
    assert (
        np.sqrt(((luminance - halves[0]) * (luminance - halves[1])).mean()) / halves.mean()
        < 1.3 * asked
    )


def test_a_denoised_render_stops_by_what_the_denoiser_leaves() -> None:
    asked = 0.02
    shot = {"photons_per_pass": 20_000, "error_threshold": asked, "denoise": True}
    result = c.shoot(room(pixels=48), passes=4096, **shot)
    assert 8 <= result.statistics["passes"] < 2000
    error = result.statistics["error"]
    assert 0 < error["denoised"] <= asked < error["relative_rmse"]
    raw = c.shoot(room(pixels=24), passes=9)
    assert "denoised" not in raw.statistics["error"]


def test_without_a_threshold_every_pass_is_rendered() -> None:
    assert c.shoot(room(pixels=16), passes=20, photons_per_pass=1000).statistics["passes"] == 20
