"""Determinism, memory, time and cancelling."""

from __future__ import annotations

import subprocess
import sys
import time

import numpy as np
import pytest
from photon_splat.core.render import error_limit
from photon_splat.core.render.ending import Ending
from photon_splat.core.render.error_limit import error_left
from photon_splat.core.render.parts import Part
from photon_splat.core.render.pass_size import PassSize, pass_that_fits
from photon_splat.core.render.result import RenderResult
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import Integrator, RenderSettings
from photon_splat.core.scene import Mesh, Scene

from tests.robustness.test_degenerate import room
from tests.support import corescene as c
from tests.support.clock import Stopwatch
from tests.support.paths import ROOT

integrators = pytest.mark.parametrize("integrator", c.BOTH)

PEAK = """
import sys
from tests.support import corescene as c
from tests.robustness.test_degenerate import room
result = c.shoot(room(pixels=64), passes=1, photons_per_pass=int(sys.argv[1]), threads=2)
print(result.statistics["peak_memory_bytes"], result.statistics["photons"]["traced"])
"""


@integrators
def test_any_number_of_threads_gives_the_same_bits(integrator: Integrator) -> None:
    """The photon's and the sample's index decide its random numbers."""
    pictures = [
        c.shoot(
            room(pixels=48), integrator, passes=3, photons_per_pass=150_000, threads=n, seed=9
        ).passes
        for n in (1, 2, 5)
    ]
    for other in pictures[1:]:
        for name, values in pictures[0].items():
            assert np.array_equal(values, other[name]), name


@integrators
def test_another_seed_is_another_picture_of_the_same_thing(integrator: Integrator) -> None:
    one, two = (
        c.picture(room(pixels=32), integrator, passes=32, photons_per_pass=10_000, seed=s)
        for s in (1, 2)
    )
    assert not np.array_equal(one, two)
    assert one.mean() == pytest.approx(two.mean(), rel=0.02)


def _peak(photons: int) -> int:
    done = subprocess.run(
        [sys.executable, "-c", PEAK, str(photons)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    peak, traced = (int(word) for word in done.stdout.split())
    assert traced == photons
    return peak


def test_memory_does_not_grow_with_photons() -> None:
    """Beyond the batch that they are traced in, which 300,000 fill."""
    few, many = _peak(300_000), _peak(3_000_000)
    assert many < 1.1 * few, (
        f"{few / 1e6:.0f} MB for 300,000 photons, {many / 1e6:.0f} MB for 3 million"
    )


def test_passes_add_up() -> None:
    """Variance falls with the number of like passes, and the first passes of a longer render are
    the same.
    """
    spread = []
    for passes in (4, 16):
        alike = {"passes": passes, "photons_per_pass": 3000, "adaptive_samples": False}
        runs = np.stack([c.picture(room(pixels=16), seed=s, **alike) for s in range(12)])
        spread.append(runs.var(0, ddof=1).mean())
    assert 2.4 < spread[0] / spread[1] < 6.5


def test_the_last_pass_gets_what_fits() -> None:
    # the last pass, and the seconds of it that went with samples and photons; half a second went to
    # the rest
    seconds, last = PassSize(2.0, 0.5), PassSize(4.0, 1.0)
    fits = pass_that_fits
    assert fits(3.0, 3.0, seconds, last, last) == last
    # the same part of samples beyond the first, and of photons
    assert fits(1.75, 3.0, seconds, last, last) == PassSize(2.125, 0.375)
    assert fits(3.0, 3.0, seconds, last, PassSize(8.0, 2.0)) == PassSize(
        pytest.approx(1 + 7 * 4 / 9), pytest.approx(2 * 4 / 9)
    )
    # a quarter of the photons first
    assert fits(1.25, 3.0, seconds, last, last) == PassSize(pytest.approx(1.25), 0.25)
    assert fits(1.2, 3.0, seconds, last, PassSize(1.0, 1.0)) == PassSize(1.0, pytest.approx(0.4))
    assert fits(1.1, 3.0, seconds, last, PassSize(1.0, 1.0)) is None  # too few photons
    assert fits(0.4, 3.0, seconds, last, last) is None  # the rest alone takes longer
    assert fits(-1.0, 3.0, PassSize(0.0, 0.0), last, last) is None
    # samples of some pixels alone
    less = {"may_lack_pixels": True}
    one = PassSize(1.0, 1.0)
    assert fits(1.1, 3.0, seconds, last, one, **less) == PassSize(pytest.approx(0.95), 0.25)
    assert fits(1.2, 3.0, seconds, last, one, **less) == fits(1.2, 3.0, seconds, last, one)
    assert fits(0.65, 3.0, seconds, last, one, **less) is None
    assert fits(0.4, 3.0, seconds, last, one, **less) is None
    # photons cost nothing
    assert fits(2.0, 3.0, PassSize(2.5, 0.0), last, last) == PassSize(
        pytest.approx(2.4), pytest.approx(7 / 15)
    )


class Film:
    """Of even features until they are changed."""

    def __init__(self, error: float, light: float) -> None:
        self.error, self.light = (np.full((20, 50), x, np.float32) for x in (error, light))
        self.albedo, self.normal = (np.full((20, 50, 3), x, np.float32) for x in (0.5, 1.0))

    def film(self, names: list[str]) -> dict[str, np.ndarray]:
        arrays = {
            "error": self.error[..., None],
            "combined": self.light[..., None] * np.ones(4, np.float32),
            "albedo": self.albedo,
            "feature_normal": self.normal,
        }
        return {name: arrays[name] for name in names}


def test_the_error_of_what_is_to_be_denoised() -> None:
    even = Film(0.2, 2.0)
    assert error_left(even) == pytest.approx(0.1 * 0.1)
    even.error[3, 7] = 50.0  # a thousandth of the pixels
    assert error_left(even) == pytest.approx(0.01)
    even.error[:, :10] = 4.0  # a fifth of the picture is no outlier
    assert error_left(even) == pytest.approx(
        0.1 * np.sqrt((0.8 * 0.01 + 0.19 * 4) / 0.99), rel=0.01
    )
    shade, half = Film(0.02, 4.0), np.sqrt(490 / 990)
    shade.light[:10] = 0.1  # a bright sky hides nothing in the shade under it
    assert error_left(shade) == pytest.approx(0.1 * 0.2 * half, rel=0.01)
    shade.light[:10] = 1e-3  # as good as black
    assert error_left(shade) == pytest.approx(0.1 * 0.4 * half, rel=0.01)
    shade.error, shade.light = shade.error * 1e-3, shade.light * 1e-3
    dim = np.sqrt((490 * 0.02**2 + 500 * 0.005**2) / 990)  # where black is half the mean
    assert error_left(shade) == pytest.approx(0.1 * dim, rel=0.01)
    assert error_left(Film(0.2, 0.0)) == 0.0


class Rendered(Film):
    """As a renderer whose raw error is 10 % of the mean."""

    def make_error_estimate(self) -> None:
        pass

    def statistics(self) -> dict[str, dict[str, float]]:
        return {"error": {"relative_rmse": 0.1, "standard_error": 0.1, "bias": 0.0}}


@pytest.mark.parametrize("there", [True, False])
def test_what_no_denoiser_cleans_counts_as_it_is(
    there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(error_limit, "has_denoiser", lambda: there)
    settings = RenderSettings(denoise=True, error_threshold=0.05)
    limit = error_limit.ErrorLimit(settings, Part())
    assert limit.after_pass(Rendered(0.2, 2.0), Ending(50, 20), 8) == there
    assert limit.error == pytest.approx(0.01 if there else 0.1)
    assert limit.fraction == pytest.approx(1.0 if there else 0.25)


def test_denoisers_leave_more_where_there_is_detail() -> None:
    even, papered, leaves = Film(0.2, 2.0), Film(0.2, 2.0), Film(0.2, 2.0)
    papered.albedo[:, ::2] -= 0.04
    leaves.normal[::2, :, 1] = -0.5
    found = [error_left(film) for film in (even, papered, leaves)]
    assert found == pytest.approx([0.1 * 0.1, 0.1 * 0.2, 0.1 * 0.5], rel=1e-3)


def test_time_limit_is_kept() -> None:
    began, watch = time.monotonic(), Stopwatch()
    result = c.shoot(room(pixels=64), passes=1_000_000, photons_per_pass=20_000, time_limit=1.0)
    assert time.monotonic() - began > 0.5
    assert watch.seconds() < 1.3
    assert 1 < result.statistics["passes"] < 1_000_000
    assert not result.cancelled


def test_passes_have_half_of_the_time_limit_however_long_the_scene_took() -> None:
    limit, began, watch = 2.0, time.monotonic(), Stopwatch()
    settings = RenderSettings(passes=1_000_000, photons_per_pass=20_000, time_limit=limit)
    result = render(room(pixels=64), settings, started=began - 10 * limit)
    assert time.monotonic() - began > 0.3 * limit
    assert watch.seconds() < 0.8 * limit
    assert 1 < result.statistics["passes"] < 1_000_000


def cancelled_render(
    what: Scene, settings: RenderSettings, after: float = 0.0
) -> tuple[RenderResult, float]:
    """Cancels `after` seconds into a render; its result, and how long it then went on."""
    began = time.monotonic()
    asked: list[Stopwatch] = []

    def should_cancel() -> bool:
        if time.monotonic() - began < after:
            return False
        asked.append(Stopwatch())
        return True

    result = render(what, settings, started=began, should_cancel=should_cancel)
    assert result.cancelled
    return result, asked[0].seconds()


@integrators
@pytest.mark.parametrize("after", [0.0, 0.5])
def test_cancel_within_a_fifth_of_a_second(integrator: Integrator, after: float) -> None:
    settings = RenderSettings(passes=1000, photons_per_pass=5_000_000, integrator=integrator)
    results, took = zip(
        *(cancelled_render(room(pixels=800), settings, after) for _ in range(3)), strict=True
    )
    assert sorted(took)[0] < 0.2  # the best of three: other programs may hold up one
    for result in results:
        assert all(
            np.isfinite(values).all() for name, values in result.passes.items() if name != "Depth"
        )


def test_a_render_that_is_cancelled_at_once_says_so_however_small_it_is() -> None:
    for _ in range(5):
        done = render(
            room(pixels=2),
            RenderSettings(passes=1, photons_per_pass=10),
            started=time.monotonic(),
            should_cancel=lambda: True,
        )
        assert done.cancelled
        assert done.statistics["passes"] == 0


def test_cancel_while_embree_builds() -> None:
    what = c.scene(c.perspective((0, 0, 4), (0, 0, 0), 8, 8), [(_hills(1000), c.lambert(0.5))])
    assert min(cancelled_render(what, RenderSettings(passes=1))[1] for _ in range(3)) < 0.2


def _hills(side: int) -> Mesh:
    """2 * side^2 triangles."""
    x, y = np.meshgrid(*2 * (np.linspace(-1, 1, side + 1, dtype=np.float32),))
    positions = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)], -1).reshape(-1, 3)
    at = np.arange(side, dtype=np.uint32)
    first = (at[:, None] * (side + 1) + at).ravel()
    corners = [first, first + 1, first + side + 2, first, first + side + 2, first + side + 1]
    return Mesh("hills", positions, np.stack(corners, -1).reshape(-1, 3).astype(np.uint32))


def test_progress_rises_to_one() -> None:
    seen: list[float] = []
    settings = RenderSettings(passes=6, photons_per_pass=100_000)
    render(
        room(pixels=64),
        settings,
        started=time.monotonic(),
        on_progress=lambda progress: seen.append(progress.fraction),
    )
    assert len(seen) > 3
    assert seen == sorted(seen)
    assert 0.0 <= seen[0] <= seen[-1] <= 1.0


def test_an_error_in_a_callback_reaches_the_caller() -> None:
    def broken(_: object) -> None:
        raise ZeroDivisionError("on purpose")

    with pytest.raises(ZeroDivisionError, match="on purpose"):
        render(
            room(pixels=64),
            RenderSettings(passes=1000),
            started=time.monotonic(),
            on_progress=broken,
        )
