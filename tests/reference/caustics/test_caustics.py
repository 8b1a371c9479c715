"""Caustics against the light tracer of tracer.py, which shares nothing with the renderer:
irradiance where the light lands.

The small room's glass: its caustic by formula, all other light by Cycles.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from blend_scenes.scripts.caustic_shapes import Pool
from tests.reference.caustics.reference import PIXELS, load
from tests.reference.caustics.tracer import Rectangle, Sphere, Strip, Surface, fresnel, trace
from tests.reference.cycles.cases import Case
from tests.reference.cycles.worker import Worker
from tests.support.compare import Blocks, block_means, block_test, mean_ratio, save_pictures
from tests.support.paths import ROOT

FAILURES = ROOT / "out" / "failures"
PHOTONS = 40_000
RELATIVE, DARK, REACH = 0.02, 0.01, 3.0
"""Bias allowed to an 8x8 block: relative, in units of the mean, and what a kernel of this radius in
pixels moves (half as much again).
"""


@pytest.fixture(scope="module")
def worker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Worker]:
    worker = Worker(tmp_path_factory.mktemp("caustics"))
    yield worker
    worker.stop()


def view_case(name: str, *, surface_only: bool = True) -> Case:
    return Case(
        f"caustic_{name}{'' if surface_only else '_from_above'}",
        "caustic_view",
        {"name": name, "surface_only": surface_only},
        PIXELS,
        PIXELS,
    )


def blurred(picture: np.ndarray, radius: float) -> np.ndarray:
    """(height, width, 3) under an Epanechnikov kernel, the splat's, which is never narrower than
    two pixels.
    """
    reach = int(np.ceil(radius))
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    weight = np.maximum(1 - (x**2 + y**2) / radius**2, 0.0)
    padded = np.pad(picture, ((reach, reach), (reach, reach), (0, 0)), mode="edge")
    height, width = picture.shape[:2]
    places = np.ndindex(weight.shape)
    return (
        sum(weight[i, j] * padded[i : i + height, j : j + width] for i, j in places) / weight.sum()
    )


def compare(name: str, ours: np.ndarray, reference: np.ndarray) -> None:
    """ours: (K, height, width, 3); reference: (2, height, width, 3)."""
    ratio, error = mean_ratio(ours, reference)
    expected = reference.mean(0)
    moved = np.abs(block_means(blurred(expected, REACH) - expected, 8))
    result = block_test(
        Blocks.of(ours, independent_pixels=False),
        Blocks.of(reference, independent_pixels=True),
        relative=RELATIVE,
        absolute=DARK * float(reference.mean()) + 1.5 * moved,
    )
    if abs(ratio - 1) > 0.02 or not result.passed:
        save_pictures(FAILURES, f"caustic_{name}", ours.mean(0), reference.mean(0))
        pytest.fail(
            f"{name}: mean {ratio:.4f} +- {error:.4f} of the reference's; {result}. Pictures: "
            f"out/failures/caustic_{name}.*.png"
        )


half_or_all = pytest.mark.parametrize("passes", [6, pytest.param(12, marks=pytest.mark.slow)])
"""The comparison knows the noise of both."""


@half_or_all
@pytest.mark.parametrize(
    "name",
    # the pool, quickly: test_pool_seen_through_its_waves, whose light lands on the same floor
    ["glass", "ring", pytest.param("pool", marks=pytest.mark.slow)],
)
def test_light_lands_where_it_should(worker: Worker, name: str, passes: int) -> None:
    ours, _ = worker.render(
        view_case(name),
        "splat",
        list(range(5)),
        passes=passes,
        photons_per_pass=PHOTONS,
        max_bounces=64,
    )
    compare(name, ours[..., :3], load(name))


def test_pool_seen_through_its_waves(worker: Worker) -> None:
    """Light, water, floor, water, eye: the path that no path tracer finds."""
    case = view_case("pool", surface_only=False)
    ours, _ = worker.render(
        case, "splat", list(range(5)), passes=6, photons_per_pass=PHOTONS, max_bounces=64
    )
    compare("pool_from_above", ours[..., :3], load("pool_from_above"))


@half_or_all
def test_small_glass_in_a_big_room(worker: Worker, passes: int) -> None:
    ours, _ = worker.render(
        view_case("small_glass"),
        "splat",
        list(range(5)),
        passes=passes,
        photons_per_pass=PHOTONS,
        max_bounces=64,
    )
    compare("small_glass", ours[..., :3], load("small_glass") + load("small_glass_rest"))


def test_the_comparison_can_fail() -> None:
    reference = load("glass")
    noisy = np.concatenate([reference, reference[::-1] * (1 + 1e-3), reference])
    compare("glass", noisy, reference)
    for broken in (noisy * 1.03, np.roll(noisy, 3, axis=2)):
        with pytest.raises(pytest.fail.Exception):
            compare("glass", broken, reference)


# The tracer itself --------------------------------------------------------------------------------


def _landed(surfaces: list[Surface], origin: np.ndarray, direction: np.ndarray) -> float:
    total = [0.0]

    def land(points: np.ndarray, flux: np.ndarray, bent: np.ndarray) -> None:
        total[0] += float(flux[:, 0].sum())

    flux = np.full((len(origin), 3), 1.0 / len(origin))
    trace(surfaces, origin, direction, flux, np.random.default_rng(3), land)
    return total[0]


def test_tracer_passes_light_through_a_pane_as_the_series_of_reflections_says() -> None:
    """(1 - R)/(1 + R) of normal light passes two parallel surfaces."""
    black = Surface(Rectangle(2, 0.0, (-9, -9), (9, 9)), "diffuse", (0.0, 0.0, 0.0))
    pane = [
        Surface(Strip((4, z), (0, z)) if z > 0.5 else Strip((0, z), (4, z)), "glass", ior=1.5)
        for z in (0.5, 0.6)
    ]
    origin = np.tile([0.1, 0.2, 1.0], (200_000, 1))
    direction = np.tile([0.0, 0.0, -1.0], (200_000, 1))
    assert _landed([black, *pane], origin, direction) == pytest.approx(0.96 / 1.04, abs=0.002)


def test_tracer_focuses_parallel_light_where_a_ball_lens_does() -> None:
    """Paraxial rays through a ball of index n meet n r/(2 (n - 1)) behind its middle."""
    focus = 1.5 * 0.2 / (2 * 0.5)
    black = Surface(Rectangle(2, -focus, (-9, -9), (9, 9)), "diffuse", (0.0, 0.0, 0.0))
    ball = Surface(Sphere((0.0, 0.0, 0.0), 0.2), "glass", ior=1.5)
    origin = np.tile([0.01, 0.0, 1.0], (2000, 1))
    places: list[np.ndarray] = []

    def land(points: np.ndarray, flux: np.ndarray, bent: np.ndarray) -> None:
        places.append(points)

    trace(
        [black, ball],
        origin,
        np.tile([0.0, 0.0, -1.0], (2000, 1)),
        np.ones((2000, 3)),
        np.random.default_rng(1),
        land,
    )
    assert np.abs(np.median(np.concatenate(places)[:, 0])) < 1e-4


def test_fresnel_at_the_brewster_and_critical_angles() -> None:
    brewster = np.cos(np.arctan(1.33))
    reflectance, inner = fresnel(np.array([1.0, brewster, 0.6]), np.array([1.33, 1.33, 1 / 1.5]))
    assert reflectance[0] == pytest.approx((0.33 / 2.33) ** 2)
    across = (brewster - 1.33 * inner[1]) / (brewster + 1.33 * inner[1])
    assert reflectance[1] == pytest.approx(across**2 / 2)
    assert reflectance[2] == 1.0


def test_reference_of_the_pool_keeps_the_energy_of_flat_water() -> None:
    """Waves move light about but, on average, floor light is the sun's through flat water plus what
    floor and surface throw back.

    Flat water, endless: E (1 - F) / n^2 / (1 - a R), R = 1 - (1 - F_out)/n^2 the diffuse
    reflectance from below (basic radiance). Walls that are darker than the floor and shade a border
    take a part; so the mean lies between 80 and 105 % of that.
    """
    towards = np.asarray(Pool.SUN) / np.linalg.norm(Pool.SUN)
    reflectance, _ = fresnel(towards[2:], np.array([Pool.IOR]))
    cosines = (np.arange(20_000) + 0.5) / 20_000
    diffuse, _ = fresnel(cosines, np.full(20_000, 1 / Pool.IOR))
    back = float((2 * cosines * diffuse).mean())
    albedo = np.asarray(Pool.FLOOR_ALBEDO)
    expected = (
        Pool.STRENGTH
        * towards[2]
        * (1 - reflectance[0])
        / Pool.IOR**2
        / (1 - albedo * back)
        * albedo
        / np.pi
    )
    ratio = load("pool").mean((0, 1, 2)) / expected
    assert (ratio > 0.8).all()
    assert (ratio < 1.05).all()
