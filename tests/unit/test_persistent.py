"""Renders one after the other that keep their photons: nothing flickers, and memory stays within
its budget.
"""

from __future__ import annotations

import time

import numpy as np
from photon_splat.core.render.persistent import Persistent
from photon_splat.core.render.session import RenderResult, render
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import LightKind, Scene

from tests.support import corescene as c

SIZE, PIXELS, SHIFT = 1.0, 64, 8


def room(shift: int = 0) -> Scene:
    """The floor of a closed grey room, seen from above by a camera that is `shift` pixels to the
    right.
    """
    view = c.ortho_down(0.9, SIZE, PIXELS, (shift * SIZE / PIXELS, 0.0))
    lamp = c.lamp(LightKind.POINT, 10.0, (0.3, 0.2, 0.8), radius=0.05)
    return c.scene(view, [(c.box((-1, -1, 0), (1, 1, 1), inwards=True), c.lambert(0.6))], [lamp])


def shoot(what: Scene, persistent: Persistent, seed: int = 0, passes: int = 4) -> RenderResult:
    settings = RenderSettings(passes=passes, photons_per_pass=20_000, seed=seed)
    return render(what, settings, started=time.monotonic(), persistent=persistent)


def indirect(result: RenderResult) -> np.ndarray:
    return result.passes["Diffuse Indirect"].mean(axis=2).astype(np.float64)


def test_noise_stays_on_the_walls_while_the_camera_moves() -> None:
    persistent = Persistent()
    first = indirect(shoot(room(), persistent))
    moved = shoot(room(SHIFT), persistent)
    assert moved.statistics["photons"]["traced"] == 0
    other = indirect(shoot(room(), Persistent(), seed=1))
    between_frames = np.std(first[:, SHIFT:] - indirect(moved)[:, :-SHIFT])
    between_seeds = np.std(first - other)
    assert between_frames < 0.35 * between_seeds


def test_photons_beyond_the_budget_are_traced_again_to_the_same_effect() -> None:
    budget = 1 << 20
    little, much = Persistent(budget), Persistent()
    for shift in (0, SHIFT):
        some, every = shoot(room(shift), little), shoot(room(shift), much)
        assert (
            0
            < some.statistics["photons"]["kept_bytes"]
            <= budget
            < every.statistics["photons"]["kept_bytes"]
        )
        assert np.std(indirect(some) - indirect(every)) < 0.01 * np.mean(indirect(every))
    assert 0 < some.statistics["photons"]["traced"] < 4 * 20_000
    assert some.statistics["reused"]["photons"] < every.statistics["reused"]["photons"]


def test_a_render_with_more_passes_takes_up_where_photons_end() -> None:
    persistent = Persistent()
    shoot(room(), persistent, passes=2)
    more = shoot(room(), persistent, passes=5)
    assert more.statistics["photons"]["traced"] == 3 * 20_000
    assert np.array_equal(
        more.passes["Combined"], shoot(room(), Persistent(), passes=5).passes["Combined"]
    )


def test_another_seed_has_other_photons() -> None:
    persistent = Persistent()
    shoot(room(), persistent)
    other = shoot(room(), persistent, seed=1)
    assert other.statistics["reused"] == {"geometry": False, "photons": 0}
    assert np.array_equal(
        other.passes["Combined"], shoot(room(), Persistent(), seed=1).passes["Combined"]
    )


def test_what_denoising_asks_for_does_not_stay_with_the_renderer() -> None:
    """Without denoising photons light what is seen, with it what is met after one more bounce."""

    def noisy(persistent: Persistent, denoise: bool) -> np.ndarray:
        settings = RenderSettings(passes=4, photons_per_pass=20_000, denoise=denoise)
        result = render(room(), settings, started=time.monotonic(), persistent=persistent)
        return result.passes["Combined"][..., :3] if result.noisy is None else result.noisy

    persistent = Persistent()
    for denoise in (False, True, False):
        assert np.array_equal(noisy(persistent, denoise), noisy(Persistent(), denoise))
