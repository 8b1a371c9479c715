"""Denoising: less error, an untouched picture without it, and a word where the library is missing."""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core import denoise
from photon_splat.core.scene import LightKind, Scene

from tests import corescene as c


def _box() -> Scene:
    what = c.scene(
        c.perspective((0.0, -0.95, 0.0), (0.0, 1.0, 0.0), 64, 64, 2.2), [(c.box((-1, -1, -1), (1, 1, 1), inwards=True), c.lambert(0.7))]
    )
    what.lights = [c.lamp(LightKind.AREA, 10.0, (0.0, 0.0, 0.9), size=(0.8, 0.8))]
    return what


def test_less_noise_and_the_same_light() -> None:
    truth = c.picture(_box(), passes=64, photons_per_pass=30_000, seed=5)
    noisy, clean = (c.shoot(_box(), passes=1, photons_per_pass=5_000, denoise=on) for on in (False, True))
    error = {
        name: float(((r.passes["Combined"][..., :3] - truth[..., :3]) ** 2).mean()) for name, r in (("noisy", noisy), ("clean", clean))
    }
    assert error["clean"] < 0.6 * error["noisy"]
    assert clean.passes["Combined"].mean() == pytest.approx(noisy.passes["Combined"].mean(), rel=0.02)
    assert clean.statistics["seconds"]["denoise"] > 0
    for name, values in noisy.passes.items():
        if name != "Combined":
            assert np.array_equal(values, clean.passes[name]), f"denoising changed {name}"


def test_a_missing_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(denoise, "LIBRARY", "libNoSuchDenoiser.so.2")
    denoise._library.cache_clear()
    try:
        result = c.shoot(_box(), passes=1, photons_per_pass=1000, denoise=True)
        plain = c.shoot(_box(), passes=1, photons_per_pass=1000)
    finally:
        denoise._library.cache_clear()
    assert np.array_equal(result.passes["Combined"], plain.passes["Combined"])
    assert any("libNoSuchDenoiser.so.2" in warning for warning in result.statistics["warnings"])
