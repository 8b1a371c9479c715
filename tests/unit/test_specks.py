"""Specks that a few paths of strong light leave are taken out before the denoiser keeps them."""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.render import denoise_result as ending
from photon_splat.core.render.specks import without_specks

from tests.support import corescene as c

Array = np.ndarray
SIDE, SAMPLES = 64, 500.0
PLACE = (30, 31)


def plain(noise: float, seed: int = 3) -> tuple[Array, Array]:
    """A picture of 1 with noise, and its variance."""
    random = np.random.default_rng(seed)
    picture = (1 + noise * random.standard_normal((SIDE, SIDE, 1))) * np.ones(3)
    return picture.astype(np.float32), np.full((SIDE, SIDE), noise**2, np.float32)


def with_paths(paths: int, total: float, noise: float = 0.02) -> tuple[Array, Array]:
    """One pixel of it got `total` more by so many equal paths of very many; as the engine's
    estimate, the variance is a mean over a square of 25 pixels.
    """
    picture, variance = plain(noise)
    picture[PLACE] += total
    row, column = PLACE
    variance[row - 2 : row + 3, column - 2 : column + 3] += total**2 / paths / 25
    return picture, variance


@pytest.mark.parametrize("paths", [1, 2])
def test_what_one_or_two_paths_brought_is_taken_out(paths: int) -> None:
    picture, variance = with_paths(paths, 20.0)
    calm = without_specks(picture, variance, SAMPLES)
    assert calm[PLACE] == pytest.approx(1.0, abs=0.1)
    there = np.ones((SIDE, SIDE), bool)
    there[PLACE] = False
    assert np.array_equal(calm[there], picture[there])
    assert picture[PLACE].min() > 20.0, "the picture that was given has been changed"


def test_what_many_paths_found_stays() -> None:
    for paths, left in ((100, 0.98), (8, 0.75)):
        calm = without_specks(*with_paths(paths, 20.0), SAMPLES)
        assert calm[PLACE].mean() - 1 == pytest.approx(20.0 * left, rel=0.01)


def test_a_highlight_of_several_pixels_stays() -> None:
    picture, variance = with_paths(1, 20.0)
    picture[30:32, 31:33] = 21.0
    assert np.array_equal(without_specks(picture, variance, SAMPLES), picture)


def test_light_that_many_single_paths_bring_stays() -> None:
    """A lamp's streak on a floor, say, of which every twentieth pixel has seen the lamp once."""
    picture, variance = plain(0.02)
    random = np.random.default_rng(5)
    hits = random.random((SIDE, SIDE)) < 0.05
    picture[hits] += 20.0
    variance += 0.05 * 20.0**2
    calm = without_specks(picture, variance, SAMPLES)
    light, left = picture.mean() - 1, calm.mean() - 1
    assert light == pytest.approx(1.0, rel=0.1)
    assert left > 0.55 * light
    alone = np.full_like(picture, 1.0)
    alone[PLACE] += 20.0
    lost = without_specks(alone, variance, SAMPLES)
    assert lost[PLACE] == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("samples", [1.0, 4.0, 16.0, 500.0])
def test_noise_loses_no_light(samples: float) -> None:
    random = np.random.default_rng(8)
    for shape in (16.0, 1.0) if samples < 16.0 else (16.0,):  # nearly normal, and exponential
        picture = (random.gamma(shape, 1 / shape, (SIDE, SIDE, 1)) * np.ones(3)).astype(np.float32)
        variance = np.full((SIDE, SIDE), 1 / shape, np.float32)
        calm = without_specks(picture, variance, samples)
        assert calm.mean() == pytest.approx(picture.mean(), rel=0.002)


def test_pictures_without_noise_light_or_size() -> None:
    star = np.zeros((SIDE, SIDE, 3), np.float32)
    star[PLACE] = 5.0
    star[3, 3] = -1.0  # as control variates may leave it
    none = np.zeros((SIDE, SIDE), np.float32)
    assert np.array_equal(without_specks(star, none, 16.0), star)
    huge, most = star * 1e19, none + np.float32(1e37)  # what the film's estimate ends at
    assert np.isfinite(without_specks(huge, most, 16.0)).all()
    one = np.ones((1, 1, 3), np.float32)
    assert np.array_equal(without_specks(one, none[:1, :1], 16.0), one)


def test_a_denoised_picture_has_none() -> None:
    """A highlight on a thin thing, of which a single path makes a hundred times as much: the
    denoiser by itself keeps it, however little is known of it.
    """
    picture, variance = with_paths(1, 100.0)
    row, column = PLACE
    picture[row, column - 1], picture[row - 1, column - 1] = 15.0, 10.0
    normal = np.zeros_like(picture)
    normal[..., 2] = 1.0
    for y, x in (PLACE, (row, column - 1), (row - 1, column - 1)):
        normal[y, x] = (0.0, 1.0, 0.0)
    film = {
        "albedo": np.full_like(picture, 0.5),
        "feature_normal": normal,
        "diffuse_direct": np.full_like(picture, 0.1),
        "variance": variance[..., None],
    }
    scene = c.lit_box(SIDE, SIDE)

    def denoised() -> float:
        passes = {"Combined": picture.copy()}
        said = ending.denoise_result(
            passes, film, scene, passes_done=64, samples=SAMPLES, threads=0, on_card=False
        )
        assert not said
        return float(passes["Combined"][PLACE].mean())

    assert denoised() < 5.0
    picture[::9, ::7] = 60.0  # too many
    film["variance"][...] = 60.0**2 / 63
    passes = {"Combined": picture.copy()}
    (said,) = ending.denoise_result(
        passes, film, scene, passes_done=64, samples=SAMPLES, threads=0, on_card=False
    )
    assert "taken for specks" in said
    picture[::9, ::7] = 1.0
    film["variance"][...] = 1e-4  # as if very many paths had found it
    assert denoised() > 30.0
