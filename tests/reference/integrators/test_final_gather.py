"""Final gathering: the path tracer's mean, no blur where things touch, and on only where it
pays.
"""

from __future__ import annotations

import time

import numpy as np
import pytest
from photon_splat.core.render.persistent import Persistent
from photon_splat.core.render.plan import make_plan
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import FinalGather, Integrator, RenderSettings
from photon_splat.core.scene import Scene

from tests.reference.integrators.scenes import leaves, mean_of_leaves
from tests.robustness.test_degenerate import room
from tests.support import corescene as c

ON = FinalGather.ON


@pytest.mark.parametrize("roughness", [None, 0.05, 0.3])
def test_the_mean_is_the_path_tracers(roughness: float | None) -> None:
    """Without shiny things, with caustic photons of their own, and with a gloss that both share."""
    picture = c.picture(
        leaves(roughness),
        passes=100,
        photons_per_pass=20_000,
        max_bounces=12,
        seed=2,
        final_gather=ON,
    )
    assert picture.mean() == pytest.approx(mean_of_leaves(roughness), rel=0.01)


@pytest.mark.parametrize("bounces", [1, 2])
def test_bounces_are_counted_as_elsewhere(bounces: int) -> None:
    reference = c.picture(room(), Integrator.REFERENCE, passes=600, max_bounces=bounces, seed=1)
    picture = c.picture(
        room(), passes=100, photons_per_pass=20_000, max_bounces=bounces, seed=2, final_gather=ON
    )
    assert picture.mean() == pytest.approx(reference.mean(), rel=0.01)


def contact() -> Scene:
    """A board of 2 cm that floats 6 cm over a floor under a bright ceiling: what reaches the floor
    below it has bounced.
    """
    board = c.box((-0.5, -0.5, 0.06), (0.5, 0.5, 0.08))
    things = [
        (c.box((-1, -1, 0), (1, 1, 2), inwards=True), c.lambert(0.7)),
        (board, c.lambert(0.7)),
    ]
    return c.scene(
        c.perspective((0.0, -0.95, 0.9), (0.0, 0.0, 0.0), 24, 24, 1.0),
        things,
        [c.lamp(c.LightKind.POINT, 30.0, (0.0, 0.0, 1.5))],
    )


def test_shadows_of_contacts_are_not_blurred() -> None:
    reference = c.picture(contact(), Integrator.REFERENCE, passes=1500, max_bounces=12, seed=1)

    def bias(gather: FinalGather) -> float:
        """Root of the mean square, free of noise, as two pictures of other seeds have none in
        common.
        """
        same = {
            "passes": 40,
            "photons_per_pass": 5_000,
            "max_bounces": 12,
            "adaptive_samples": False,
        }
        one, two = (c.picture(contact(), seed=s, final_gather=gather, **same) for s in (2, 3))
        return float(
            np.sqrt(max(0.0, ((one - reference) * (two - reference)).mean())) / reference.mean()
        )

    assert bias(ON) < 0.5 * bias(FinalGather.OFF)


def board_on_wall() -> Scene:
    """The lower side of a board of 4 cm on a wall, with the wall beside it, both lit by what the
    room reflects: light in the corner changes within centimetres.
    """
    board = c.box((-0.6, 0.96, 0.9), (0.6, 1.0, 1.4))
    things = [
        (c.box((-1, -1, 0), (1, 1, 2), inwards=True), c.lambert(0.7)),
        (board, c.lambert(0.7)),
    ]
    return c.scene(
        c.perspective((0.0, 0.4, 0.5), (0.0, 0.97, 0.88), 32, 32, 0.25),
        things,
        [c.lamp(c.LightKind.POINT, 30.0, (0.0, 0.0, 1.7))],
    )


def test_what_is_closer_than_the_radius_of_discs_is_not_lit_by_them() -> None:
    reference = c.picture(board_on_wall(), Integrator.REFERENCE, passes=2000, max_bounces=12)
    same = {"passes": 60, "photons_per_pass": 3_000, "max_bounces": 12, "final_gather": ON}
    one, two = (c.picture(board_on_wall(), seed=s, **same) for s in (2, 3))
    off = (0.5 * (one + two) / reference - 1).mean(axis=(1, 2))  # row by row: the board is level
    assert np.abs(off).max() < 0.02


@pytest.mark.parametrize(
    ("settings", "decided"),
    [
        ({}, "PHOTONS"),
        ({"time_limit": 5.0}, "ANY"),
        ({"error_threshold": 0.02}, "ANY"),
        ({"time_limit": 5.0, "caustics": False}, "PHOTONS_OR_PATHS"),
        ({"time_limit": 5.0, "final_gather": FinalGather.OFF}, "PHOTONS"),
        ({"denoise": True}, "FINAL_GATHER_OR_PATHS"),
        ({"denoise": True, "error_threshold": 0.02}, "FINAL_GATHER_OR_PATHS"),
        ({"denoise": True, "time_limit": 5.0, "caustics": False}, "PHOTONS"),
        ({"denoise": True, "final_gather": FinalGather.OFF}, "PHOTONS"),
        ({"final_gather": ON}, "FINAL_GATHER"),
        ({"final_gather": ON, "photons_per_pass": 0}, "PHOTONS"),
        ({"final_gather": ON, "integrator": Integrator.REFERENCE}, "PHOTONS"),
    ],
)
def test_the_plan_decides(settings: dict, decided: str) -> None:
    plan = make_plan(room(), RenderSettings(**settings))
    assert plan.indirect_light == decided
    gathers = decided.startswith("FINAL_GATHER")
    assert plan.flags["final_gather"] == gathers
    assert any("Final gathering" in sentence for sentence in plan.sentences) == gathers


@pytest.mark.parametrize("roughness", [None, 0.3])
def test_paths_bring_all_where_photons_would_be_more_work(roughness: float | None) -> None:
    """A small picture: hundreds of photons for each camera path. The picture before it is denoised
    has the path tracer's mean, light from sharp lobes by photons included.
    """
    given = {"max_bounces": 12, "seed": 2, "photons_per_pass": 20_000}
    result = c.shoot(leaves(roughness), passes=60, denoise=True, **given)
    assert result.statistics["path_traced"]["everywhere"]
    assert result.noisy is not None
    assert any(
        "bring all of the indirect light" in sentence
        for sentence in result.statistics["plan"]["sentences"]
    )
    assert result.noisy.mean() == pytest.approx(mean_of_leaves(roughness), rel=0.015)


@pytest.mark.parametrize("roughness", [None, 0.3])
def test_threads_do_not_matter_where_paths_bring_all(roughness: float | None) -> None:
    given = {"passes": 8, "photons_per_pass": 20_000, "max_bounces": 12, "denoise": True}
    one, two = (c.shoot(leaves(roughness), threads=n, **given) for n in (1, 3))
    assert one.statistics["path_traced"]["everywhere"]
    assert one.noisy is not None
    assert two.noisy is not None
    assert np.array_equal(one.noisy, two.noisy)


def test_photons_bring_what_would_be_more_work_for_paths() -> None:
    settings = {"denoise": True, "passes": 2, "photons_per_pass": 50}
    assert not c.shoot(leaves(None), **settings).statistics["path_traced"]["everywhere"]
    assert not c.shoot(
        leaves(None), **(settings | {"photons_per_pass": 20_000, "final_gather": ON})
    ).statistics["path_traced"]["everywhere"]


def test_threads_do_not_matter() -> None:
    one, two = (
        c.picture(leaves(0.3), passes=3, photons_per_pass=20_000, threads=n, final_gather=ON)
        for n in (1, 3)
    )
    assert np.array_equal(one, two)


def test_a_render_that_finds_its_photons_again_is_the_same() -> None:
    what, kept = leaves(0.3), Persistent()
    settings = RenderSettings(passes=3, photons_per_pass=20_000, final_gather=ON)
    first, again = (
        render(what, settings, started=time.monotonic(), persistent=kept) for _ in range(2)
    )
    assert again.statistics["reused"]["photons"] > 0
    assert np.array_equal(first.passes["Combined"], again.passes["Combined"])
