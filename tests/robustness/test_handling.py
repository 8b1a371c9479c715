"""Limits of time, memory and brightness: what a render does when it meets them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from photon_splat.core.render import (
    denoise_result,
    ending,
    final_statistics,
    memory,
    session,
    worker,
)
from photon_splat.core.render.denoise import Quality, denoising_runs
from photon_splat.core.render.ending import Ending
from photon_splat.core.render.final_film import final_arrays
from photon_splat.core.render.parts import Part
from photon_splat.core.render.pass_size import PassSize
from photon_splat.core.render.persistent import start_anew
from photon_splat.core.render.record import Record
from photon_splat.core.render.result import channels_of_arrays
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Light, LightKind

from tests.robustness.test_promises import room
from tests.support import corescene as c


def test_a_pass_is_cut_where_its_time_ends() -> None:
    """The first pass asks for more photons than there is time for; the picture is as bright as with
    few.
    """
    few = c.shoot(room(pixels=32), passes=8, photons_per_pass=100_000)
    cut = c.shoot(room(pixels=32), passes=4, photons_per_pass=1 << 34, time_limit=1.0)
    assert cut.statistics["passes"] == 1
    assert cut.statistics["photons"]["traced"] < 1 << 30
    assert cut.passes["Combined"][..., :3].mean() == pytest.approx(
        few.passes["Combined"][..., :3].mean(), rel=0.05
    )


def test_photons_that_are_left_out_are_made_up_for() -> None:
    """A pass without time for photons has one batch of them."""
    means, traced = [], []
    for passes, seconds in ((4, math.inf), (32, 0.0)):
        settings = RenderSettings(
            passes=passes, photons_per_pass=400_000, adaptive_samples=False, adaptive_indirect=False
        )
        start = start_anew(room(pixels=32), settings)
        start.prepare()
        for number in range(passes):
            start.renderer.render_pass(number, seconds=seconds)
        means.append(start.renderer.film(["diffuse_indirect"])["diffuse_indirect"].mean())
        traced.append(start.renderer.statistics()["photons"]["traced"])
    assert 0 < traced[1] < traced[0] / 4
    assert means[0] > 0
    assert means[1] == pytest.approx(means[0], rel=0.02)


def test_denoising_is_foreseen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two trial squares of different size tell the seconds per pixel from the seconds per run."""
    monkeypatch.setattr(ending, "_denoise_seconds", lambda side, *_: 0.1 + 1e-5 * side**2)
    foreseen = Ending(960, 540)
    assert foreseen.seconds(1, 1.0) == 0.0
    foreseen.try_denoiser(0, on_card=False)
    assert foreseen.seconds(1, 1.0) / ending.CAUTION == pytest.approx(
        0.1 + 1e-5 * 960 * 540, rel=0.05
    )
    runs = denoising_runs(Quality.BEST, apart=True, noisy_features=True)
    assert foreseen.seconds(1, runs) == pytest.approx(runs * foreseen.seconds(1, 1.0))
    assert foreseen.seconds(1, 0.0) == 0.0


def test_the_denoiser_gets_what_a_better_picture_is_worth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ending, "_denoise_seconds", lambda side, *_: 1e-5 * side**2)
    foreseen = Ending(1000, 1000)
    assert foreseen.worth(1.0, lambda quality: 5.0 * quality) is Quality.BEST  # not tried yet
    foreseen.try_denoiser(0, on_card=False)  # about 11 s a filter, with caution

    def runs(quality: Quality) -> float:
        return denoising_runs(quality, apart=True, noisy_features=True)

    assert [foreseen.worth(limit, runs) for limit in (60, 300, 800)] == list(Quality)
    assert foreseen.worth(math.inf, runs) is Quality.BEST
    fast, quick, best = Quality
    assert [foreseen.best_within(left, runs, fast) for left in (0, 12, 21, 30, 90)] == [
        *(fast, fast, fast, quick, best)
    ]
    assert foreseen.best_within(21, runs, quick) is quick  # 20 s, as foreseen


def test_passes_leave_time_for_denoising(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ending, "_denoise_seconds", lambda side, *_: 10.0 * side**2)
    result = c.shoot(
        room(pixels=32), passes=100, photons_per_pass=1000, time_limit=1000.0, denoise=True
    )
    assert result.statistics["passes"] == 1


class Clock:
    """Seconds that pass by what is done alone, whatever else the machine does."""

    now = 0.0

    def __init__(self) -> None:
        self.qualities: list[Quality] = []

    def monotonic(self) -> float:
        return self.now

    def denoise(self, noisy: np.ndarray, *others: Any, **options: Any) -> np.ndarray:
        apart, features = options.get("apart") is not None, options.get("noisy_features", False)
        quality = options["quality"]
        runs = denoising_runs(quality, apart=apart, noisy_features=features)
        self.qualities.append(quality)
        self.now += runs * (0.2 + 3.6e-4 * noisy.shape[0] * noisy.shape[1])
        return noisy


class TimedRenderer:
    """A renderer whose stages take the time of a clock."""

    def __init__(self, renderer: Any, clock: Clock) -> None:
        self.renderer, self.clock = renderer, clock
        self.camera_seconds = self.photon_seconds = self.pilot_seconds = 0.0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.renderer, name)

    def learn_in_common(self, seconds: float, splatter: None) -> tuple[float, float]:
        """Four passes, small ones if need be; later ones would be large."""
        self.renderer.learn_in_common(0.0)
        took = max(4 * (0.3 + 0.1), min(seconds, 20.0))
        self.pilot_seconds += took
        self.photon_seconds += took
        self.clock.now += took
        return 0.3, 0.4

    def render_pass(self, number: int, seconds: float, splatter: None) -> None:
        """Camera samples in full, of the photons what there is time for."""
        size = PassSize(*self.renderer.next_pass)
        self.renderer.render_pass(number)
        camera = 0.3 * size.samples
        photons = min(0.4 * size.photons, max(seconds - camera, 0.05))
        self.camera_seconds += camera
        self.photon_seconds += photons
        self.clock.now += camera + photons

    def make_error_estimate(self) -> None:
        self.renderer.make_error_estimate()
        self.clock.now += 0.05

    def film(self, arrays: Any) -> Any:
        self.clock.now += 0.0025 * channels_of_arrays(arrays)
        return self.renderer.film(arrays)


@pytest.mark.parametrize("part", [None, Part(2, 3)])
def test_a_time_limit_holds_with_denoising(
    part: Part | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Denoising takes a sixth of the time that is given, as it does of large pictures. A part of a
    picture begins with what parts learn in common, and is not denoised.
    """
    clock = Clock()
    for module in (session, worker, ending, final_statistics):
        monkeypatch.setattr(module, "time", clock)
    for module in (denoise_result, ending):
        monkeypatch.setattr(module, "denoise", clock.denoise)

    def timed_start(*given: Any) -> Any:
        start = start_anew(*given)
        return replace(start, renderer=TimedRenderer(start.renderer, clock))

    monkeypatch.setattr(session, "start_anew", timed_start)
    settings = RenderSettings(
        passes=10_000,
        photons_per_pass=20_000,
        time_limit=20.0,
        denoise=True,
        adaptive_indirect=False,
    )
    record = Record(part, keeps=True) if part else None
    result = session.render(room(pixels=64), settings, started=0.0, record=record)
    assert 0.8 * 20.0 < clock.now <= 20.0
    assert clock.now == result.statistics["seconds"]["total"]
    assert result.statistics["passes"] > 3
    if part:
        assert not clock.qualities
        return
    assert result.statistics["seconds"]["denoise"] > 3.0
    assert Quality.QUICK in clock.qualities
    assert clock.qualities[-1] is Quality.QUICK  # nothing better would have been done in time


# --- memory ---


def test_a_picture_that_does_not_fit_is_refused_before_the_render(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(memory, "free_memory_bytes", lambda: 200_000)
    with pytest.raises(
        MemoryError,
        match=r"a picture of 32 x 32 pixels takes 0.0 GB at the least, and 0.0 GB are free; "
        r"render it smaller",
    ):
        c.shoot(room(pixels=32), passes=1, photons_per_pass=100)
    monkeypatch.setattr(memory, "free_memory_bytes", lambda: None)
    c.shoot(room(pixels=32), passes=1, photons_per_pass=100)


def test_free_memory_is_that_of_the_container(tmp_path: Path) -> None:
    (tmp_path / "meminfo").write_text(
        "MemTotal: 900 kB\nMemAvailable:  300 kB\nSwapFree: 50 kB\nHugePages_Total: 0\n"
    )
    assert memory._linux_free(tmp_path / "meminfo") == 350 * 1024
    assert memory._linux_free(tmp_path / "none") is None
    assert list(memory._group_free(tmp_path)) == [None, None]
    (tmp_path / "memory.max").write_text("1000\n")
    (tmp_path / "memory.current").write_text("700\n")
    (tmp_path / "memory.stat").write_text("anon 600\ninactive_file 100\n")
    assert list(memory._group_free(tmp_path)) == [400, None]
    (tmp_path / "memory.max").write_text("max\n")
    assert list(memory._group_free(tmp_path)) == [None, None]
    assert memory.free_memory_bytes() is None or memory.free_memory_bytes() > 0


def test_the_film_takes_150_bytes_a_pixel_at_most() -> None:
    scene = room(pixels=512)
    start = start_anew(scene, RenderSettings(passes=3, photons_per_pass=1000))
    for arrays, most in (
        (final_arrays({"Combined"}, RenderSettings(), scene), 100),
        (final_arrays(None, RenderSettings(denoise=True), scene), 150),
    ):
        start.renderer.keep_film(arrays)
        start.prepare()
        for number in range(3):
            start.renderer.render_pass(number)
        assert start.renderer.film_bytes < most * 512**2
        assert set(start.renderer.film(arrays)) == set(arrays)
    start.renderer.keep_film(["combined"])
    start.renderer.set_view()
    with pytest.raises(ValueError, match="the film has not been told to keep normal"):
        start.renderer.film(["normal"])


# --- brightness ---


@pytest.mark.parametrize("strength", [1e18, 1e30, 3e38])
def test_no_lamp_is_so_bright_that_pixels_are_no_numbers(strength: float) -> None:
    what = room(pixels=16)
    what.lights.append(Light("Absurd", LightKind.POINT, np.eye(4), (strength, strength, 0.0)))
    for integrator in c.BOTH:
        result = c.shoot(what, passes=3, photons_per_pass=3000, integrator=integrator)
        for name, values in result.passes.items():
            assert np.isfinite(values).all(), f"{name} by {integrator}"
