"""Denoising: less error, an untouched picture without it, and a word where the library is
missing.
"""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.render import denoise, oidn
from photon_splat.core.render.blend import blend
from photon_splat.core.render.denoise import Quality
from photon_splat.core.render.settings import FinalGather

from tests.support import corescene as c


def test_less_noise_and_the_same_light() -> None:
    reference = c.picture(c.lit_box(64, 64), passes=32, photons_per_pass=20_000, seed=5)
    noisy, clean = (
        c.shoot(
            c.lit_box(64, 64),
            passes=1,
            photons_per_pass=5_000,
            denoise=on,
            final_gather=FinalGather.OFF,
        )
        for on in (False, True)
    )
    error = {
        name: float(((r.passes["Combined"][..., :3] - reference[..., :3]) ** 2).mean())
        for name, r in (("noisy", noisy), ("clean", clean))
    }
    assert error["clean"] < 0.8 * error["noisy"]
    assert clean.passes["Combined"].mean() == pytest.approx(
        noisy.passes["Combined"].mean(), rel=0.02
    )
    assert clean.statistics["seconds"]["denoise"] > 0
    for name, values in noisy.passes.items():
        if name != "Combined":
            assert np.array_equal(values, clean.passes[name]), f"denoising changed {name}"


def test_the_mixture_is_never_much_worse_than_either() -> None:
    """At an edge that the denoiser has blurred the noisy picture counts, on a plain the denoised
    one.
    """
    random = np.random.default_rng(4)
    reference = np.ones((64, 64, 3), np.float32)
    reference[:, 32:] = 3.0
    sigma = 0.1
    noisy = reference + sigma * random.standard_normal((64, 64, 1)).astype(np.float32)
    blurred = reference.copy()
    blurred[:, 30:34] = 2.0
    mixed = blend(noisy, blurred, np.full((64, 64), sigma**2, np.float32), passes=64)
    error = {
        name: ((p - reference) ** 2).mean()
        for name, p in (("noisy", noisy), ("blurred", blurred), ("mixed", mixed))
    }
    assert error["mixed"] < 0.5 * error["noisy"]
    assert error["mixed"] < 0.1 * error["blurred"]
    same = blend(noisy, noisy, np.zeros((64, 64), np.float32), passes=1)
    assert np.array_equal(same, noisy)


def test_a_lone_speck_is_not_brought_back() -> None:
    random = np.random.default_rng(5)
    noisy = 1 + 0.02 * random.standard_normal((32, 32, 1)).astype(np.float32) * np.ones(
        3, np.float32
    )
    noisy[10, 10], noisy[20, 21] = 40.0, -3.0
    mixed = blend(noisy, np.ones_like(noisy), np.full((32, 32), 4e-4, np.float32), passes=64)
    assert np.abs(mixed - 1).max() < 0.005, "neither it nor the noise around it"


def test_a_missing_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(oidn, "DENOISER", "libNoSuchDenoiser.so.2")
    oidn.library.cache_clear()
    try:
        result = c.shoot(
            c.lit_box(64, 64),
            passes=1,
            photons_per_pass=1000,
            denoise=True,
            final_gather=FinalGather.OFF,
        )
        plain = c.shoot(c.lit_box(64, 64), passes=1, photons_per_pass=1000)
    finally:
        oidn.library.cache_clear()
    assert np.array_equal(result.passes["Combined"], plain.passes["Combined"])
    assert any("libNoSuchDenoiser.so.2" in warning for warning in result.statistics["warnings"])


@pytest.mark.parametrize("quality", Quality)
def test_noise_of_the_features_does_not_come_back_in_the_picture(quality: Quality) -> None:
    random = np.random.default_rng(3)
    stripes = np.where((np.arange(96) // 16 % 2)[None, :, None], 0.8, 0.3) * np.ones((96, 96, 3))
    normal = np.tile(np.array([0.0, 0.0, 1.0], np.float32), (96, 96, 1))
    albedo, light = (
        np.clip(stripes + random.normal(0, sigma, stripes.shape), 0, 1) for sigma in (0.15, 0.3)
    )
    error = {}
    for noisy in (False, True):
        clean = denoise.denoise(light, albedo, normal, noisy_features=noisy, quality=quality)
        error[noisy] = float(((clean - stripes) ** 2).mean())
    assert error[True] < 0.5 * error[False], error


def test_a_part_denoised_by_itself_keeps_its_edges() -> None:
    """Denoised together, the shadow's edge in the direct light would be lost in the noise of the
    rest. The part that is denoised alone may be brighter than the picture; the rest then counts as
    black.
    """
    random = np.random.default_rng(6)
    shadow = np.where(np.arange(96) < 48, 0.1, 0.3)[None, :, None] * np.ones(
        (96, 96, 3), np.float32
    )
    flat = np.full_like(shadow, 0.5)
    direct, rest = (
        part + random.normal(0, sigma, shadow.shape).astype(np.float32)
        for part, sigma in ((shadow, 0.01), (1 + 0 * flat, 0.6))
    )
    direct, rest = np.maximum(direct, 0), np.maximum(rest, 0)
    normal = np.tile(np.array([0.0, 0.0, 1.0], np.float32), (96, 96, 1))
    edge = (slice(None), slice(44, 52))
    step = {
        apart is not None: float(
            np.diff(
                denoise.denoise(direct + rest, flat, normal, apart=apart)[edge].mean((0, 2))
            ).max()
        )
        for apart in (None, direct)
    }
    assert step[True] > 1.5 * step[False], step
    dark = denoise.denoise(direct, flat, normal, apart=2 * direct)
    assert np.isfinite(dark).all()


def test_a_part_that_is_mostly_black_keeps_its_highlights() -> None:
    direct = np.zeros((96, 96, 3), np.float32)
    direct[20:30, 20:60] = 6.0
    rest, flat = np.full_like(direct, 0.3), np.full_like(direct, 0.5)
    normal = np.tile(np.array([0.0, 0.0, 1.0], np.float32), (96, 96, 1))
    found = denoise.denoise(direct + rest, flat, normal, apart=direct)
    assert found[23:27, 25:55].mean() == pytest.approx(6.3, rel=0.02)
    assert denoise._exposure(np.zeros((4, 4, 3), np.float32)) < float("inf")


def test_black_stays_black() -> None:
    black, bright = np.zeros((16, 16, 3), np.float32), np.ones((16, 16, 3), np.float32)
    for quality in Quality:
        for noisy in (False, True):
            clean = denoise.denoise(
                black, bright, bright, apart=black, noisy_features=noisy, quality=quality
            )
            assert not clean.any()


def test_a_cancelled_denoiser_leaves_the_picture() -> None:
    light = np.random.default_rng(4).random((64, 64, 3)).astype(np.float32)
    for noisy in (False, True):
        for apart in (None, 0.5 * light):
            same = denoise.denoise(
                light, light, light, apart=apart, noisy_features=noisy, should_cancel=lambda: True
            )
            assert np.array_equal(same, light)
