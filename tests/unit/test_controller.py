"""The thread behind a viewport: what it builds, traces and shows when scenes and views change. No
Blender, no window.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from photon_splat.core.render.denoise import DenoiserMissing
from photon_splat.core.render.settings import FinalGather, Integrator, RenderSettings
from photon_splat.core.scene import LightKind, Scene
from photon_splat.core.viewport import clean
from photon_splat.core.viewport.controller import Controller
from photon_splat.core.viewport.pace import STEPS, Pace
from photon_splat.core.viewport.view import Picture, View, fitted, scaled

from tests.support import corescene
from tests.support.clock import Stopwatch

SETTINGS = RenderSettings(passes=3, photons_per_pass=5000, threads=2)
SECONDS = 600.0
"""After which it is taken for hung."""


def room(strength: float = 100.0, albedo: float = 0.5, moved: float = 0.0) -> Scene:
    """A box in a box with a lamp, seen from inside."""
    eye = corescene.perspective((-1.5, -1.5, 1.5), (1.0, 1.0, 0.5), 64, 36)
    things = [
        (corescene.box((-2, -2, 0), (2, 2, 2), inwards=True), corescene.lambert(albedo)),
        (corescene.box((moved, 0, 0), (moved + 0.5, 0.5, 0.5)), corescene.lambert((0.8, 0.2, 0.2))),
    ]
    return corescene.scene(
        eye, things, [corescene.lamp(LightKind.POINT, strength, (0.5, -0.5, 1.8))]
    )


def view(x: float = -1.5, width: int = 64, height: int = 36, **frame: object) -> View:
    camera, raster = corescene.perspective((x, -1.5, 1.5), (1.0, 1.0, 0.5), width, height)
    return View(camera, replace(raster, **frame))  # type: ignore[arg-type]


@pytest.fixture
def controller() -> Iterator[Controller]:
    made = Controller(step=2)
    yield made
    made.close()
    assert not made.alive


def wait(controller: Controller, until: Callable[[Picture], bool]) -> Picture:
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline:
        picture = controller.picture()
        if picture is not None and until(picture):
            return picture
        assert not controller.status()[2], controller.status()[2]
        time.sleep(0.001)
    raise AssertionError(
        f"no such picture within {SECONDS} s: {controller.status()}, {controller.picture()}"
    )


def settle(controller: Controller, wanted: View) -> Picture:
    """The last picture of a view."""
    return wait(controller, lambda p: p.view == wanted and p.samples == SETTINGS.passes)


def moving(controller: Controller, wanted: View) -> Picture:
    return wait(controller, lambda p: p.view == wanted and p.moving)


class Recorder(Controller):
    """Keeps every picture."""

    def __init__(self, step: int) -> None:
        self.seen: list[Picture] = []
        super().__init__(step)

    def _publish(self, *given: Any, **named: Any) -> None:
        super()._publish(*given, **named)
        picture = self.picture()
        assert picture is not None
        self.seen.append(picture)


def test_pictures_come_coarse_then_full_then_refined() -> None:
    recorder = Recorder(2)
    recorder.set_view(view())
    recorder.set_scene(room(), replace(SETTINGS, passes=2))
    wait(recorder, lambda p: p.samples == 2)
    recorder.close()
    assert [(p.step, p.samples, p.moving) for p in recorder.seen] == [
        (2, 1, True),
        (1, 1, False),
        (1, 2, False),
    ]
    assert [p.number for p in recorder.seen] == [1, 2, 3]
    for picture in recorder.seen:
        height, width = picture.pixels.shape[:2]
        assert (width * picture.step, height * picture.step) == picture.region[2:] == (64, 36)
        assert np.isfinite(picture.pixels).all()
        assert picture.pixels[..., 3].min() == 1.0
    assert recorder.counts.builds == 1


def test_the_refined_picture_is_that_of_a_render(controller: Controller) -> None:
    """Bit for bit, where no choice depends on the view."""
    from photon_splat.core.render.session import render

    scene = room()
    controller.set_scene(scene, SETTINGS)
    controller.set_view(View(scene.camera, scene.frame))
    picture = settle(controller, View(scene.camera, scene.frame))
    passes = render(scene, SETTINGS, started=time.monotonic()).passes
    assert picture.pixels == pytest.approx(passes["Combined"], rel=1e-5, abs=1e-7)


def test_moving_traces_no_photon_and_a_view_that_comes_again_looks_the_same(
    controller: Controller,
) -> None:
    """But for what the pictures between have added to what is known of its light."""
    controller.set_scene(room(), SETTINGS)
    controller.set_view(view())
    settle(controller, view())
    traced = controller.counts.photon_paths
    assert traced > 0
    first: dict[float, Picture] = {}
    for x in (-1.4, -1.3, -1.2, -1.3, -1.4):
        picture = moving(controller, show(controller, view(x)))
        before = first.setdefault(x, picture)
        assert unlikeness(before, picture) < 0.01
    assert unlikeness(first[-1.4], first[-1.2]) > 0.02
    assert controller.counts.photon_paths == traced
    assert controller.counts.builds == 1
    assert controller.counts.relights == 0


def unlikeness(one: Picture, other: Picture) -> float:
    """Mean absolute difference over the mean."""
    return float(np.abs(one.pixels - other.pixels).mean() / one.pixels.mean())


def test_a_moving_picture_is_like_the_finished_one(controller: Controller) -> None:
    """Its middles of pixels are what it shows; the finished one has all of them."""
    controller.set_scene(room(), replace(SETTINGS, passes=64))
    for x in (-1.4, -1.3, -1.2, -1.3, -1.4):
        picture = moving(controller, show(controller, view(x)))
    finished = wait(controller, lambda p: p.view == view(-1.4) and p.samples == 64)
    height, width = picture.pixels.shape[:2]
    shown = finished.pixels.reshape(height, 2, width, 2, 4).mean((1, 3))
    assert picture.pixels.mean() == pytest.approx(shown.mean(), rel=0.02)
    assert np.abs(picture.pixels - shown).mean() / shown.mean() < 0.05


def show(controller: Controller, wanted: View) -> View:
    controller.set_view(wanted)
    return wanted


def test_indirect_light_does_not_flicker_while_moving() -> None:
    """Seen from all around, the light on a white floor that only the ceiling lights is the same to
    a fraction of its noise.
    """
    floor = (corescene.quad(1.0), corescene.lambert(0.8))
    ceiling = (
        corescene.mesh([(-1, -1, 1), (-1, 1, 1), (1, 1, 1), (1, -1, 1)], [(0, 1, 2, 3)]),
        corescene.lambert(0.8),
    )
    lamp = corescene.lamp(LightKind.SPOT, 50.0, (0, 0, 0.5), (0, 0, 1), spot_size=1.5)
    scene = corescene.scene(corescene.ortho_down(0.9, 0.2, 8), [floor, ceiling], [lamp])
    controller = Controller(step=1)
    try:
        controller.set_scene(scene, SETTINGS)
        means = []
        for step in range(30):
            x = 0.004 * step
            camera, frame = corescene.ortho_down(0.9, 0.4, 32, (x, 0.0))
            picture = moving(controller, show(controller, View(camera, frame)))
            # The same spot of the floor in each picture, with whole pixels.
            centre = 16 - x / 0.4 * 32
            columns = picture.pixels[14:18, round(centre) - 2 : round(centre) + 2, :3]
            means.append(columns.mean())
        assert min(means) > 0
        assert np.std(means) / np.mean(means) < 0.02
    finally:
        controller.close()


def test_edits_build_only_what_they_change(controller: Controller) -> None:
    scene = room()
    controller.set_view(view())
    controller.set_scene(scene, SETTINGS)
    before = settle(controller, view()).pixels
    done = []
    lamp, paint, move = room(strength=200.0), room(albedo=0.3), room(moved=0.4)
    lamp.meshes = paint.meshes = scene.meshes
    for edited in (scene, lamp, paint, move):
        number = controller.picture().number  # type: ignore[union-attr]
        controller.set_scene(edited, SETTINGS)
        if edited is not scene:
            wait(
                controller,
                lambda p, number=number: p.number > number and p.samples == SETTINGS.passes,
            )  # type: ignore[misc]
        done.append((controller.counts.builds, controller.counts.relights))
    assert done == [(1, 0), (1, 1), (1, 2), (2, 2)]
    assert not np.array_equal(controller.picture().pixels, before)  # type: ignore[union-attr]


def test_twice_the_light_is_twice_as_bright(controller: Controller) -> None:
    controller.set_view(view())
    controller.set_scene(room(), SETTINGS)
    dim = settle(controller, view())
    controller.set_scene(room(strength=200.0), SETTINGS)
    bright = wait(controller, lambda p: p.number > dim.number and p.samples == SETTINGS.passes)
    assert bright.pixels[..., :3].mean() == pytest.approx(2 * dim.pixels[..., :3].mean(), rel=1e-3)


def test_scenes_and_views_that_follow_fast_end_with_the_last(controller: Controller) -> None:
    for k in range(30):
        controller.set_view(view(-1.5 + 0.01 * k))
        if k % 3 == 0:
            controller.set_scene(room(strength=100.0 + k, moved=0.01 * (k % 2)), SETTINGS)
        time.sleep(0.002 * (k % 5))
    wanted = view(-1.5 + 0.01 * 29)
    picture = settle(controller, wanted)
    again = Controller(step=2)
    again.set_view(wanted)
    again.set_scene(room(strength=127.0, moved=0.01), SETTINGS)
    assert np.array_equal(picture.pixels, settle(again, wanted).pixels)
    again.close()


def test_a_scene_that_cannot_be_rendered_says_so_and_the_next_one_is(
    controller: Controller,
) -> None:
    broken = room()
    broken.meshes[1].positions[0, 0] = np.nan
    controller.set_view(view())
    controller.set_scene(broken, SETTINGS)
    deadline = time.monotonic() + SECONDS
    while not controller.status()[2] and time.monotonic() < deadline:
        time.sleep(0.001)
    assert "not finite" in controller.status()[2]
    controller.set_scene(room(), SETTINGS)
    settle(controller, view())
    assert controller.status()[2] == ""


@pytest.mark.parametrize("delay", [0.0, 0.005, 0.03, 0.2])
def test_closing_ends_the_thread_at_once(delay: float) -> None:
    before = threading.active_count()
    controller = Controller()
    controller.set_view(view(width=640, height=360))
    controller.set_scene(room(), replace(SETTINGS, passes=1000, photons_per_pass=200_000))
    time.sleep(delay)
    watch = Stopwatch()
    controller.close()
    assert watch.seconds() < 0.5
    assert threading.active_count() == before


def test_a_time_limit_ends_refinement(controller: Controller) -> None:
    controller.set_view(view())
    controller.set_scene(room(), replace(SETTINGS, passes=1_000_000, time_limit=1.0))
    wait(controller, lambda p: p.samples >= 1)
    deadline = time.monotonic() + SECONDS
    while controller.status()[0] and time.monotonic() < deadline:
        time.sleep(0.01)
    passes = controller.counts.passes
    time.sleep(0.2)
    assert controller.counts.passes == passes


def test_nothing_lit_and_nothing_there_are_black(controller: Controller) -> None:
    empty = corescene.scene(corescene.perspective((0, 0, 1), (0, 1, 1), 8, 8), [])
    dark = room()
    dark.lights = []
    for scene in (empty, dark):
        controller.set_view(view())
        controller.set_scene(scene, SETTINGS)
        number = controller.picture().number if controller.picture() else 0  # type: ignore[union-attr]
        picture = wait(
            controller, lambda p, number=number: p.number > number and p.samples == SETTINGS.passes
        )  # type: ignore[misc]
        assert picture.pixels[..., :3].max() == 0


def test_a_border_is_rendered_as_part_of_the_whole(controller: Controller) -> None:
    controller.set_scene(room(), SETTINGS)
    whole = settle(controller, show(controller, view()))
    part = settle(controller, show(controller, view(border=(10, 5, 21, 13))))
    assert part.region == (10, 5, 21, 13)
    inside = whole.pixels[5:18, 10:31]
    assert part.pixels[..., :3].mean() == pytest.approx(inside[..., :3].mean(), rel=0.05)


@pytest.mark.parametrize("step", STEPS)
def test_wide_pixels_keep_the_view(step: int) -> None:
    wanted = view(width=101, height=57, border=(7, 3, 50, 31))
    frame, region = scaled(wanted.frame, step)
    camera = fitted(wanted, frame, step)
    x, y, width, height = region
    assert x <= 7
    assert y <= 3
    assert x + width >= 57
    assert y + height >= 34
    assert x > 7 - step
    assert x + width < 57 + step
    assert frame.region == (x // step, y // step, width // step, height // step)
    # A pixel of the screen stands for the same direction.
    left, right, bottom, top = wanted.camera.screen
    assert (camera.screen[1] - camera.screen[0]) / (frame.width * step) == pytest.approx(
        (right - left) / 101
    )
    assert (camera.screen[3] - camera.screen[2]) / (frame.height * step) == pytest.approx(
        (top - bottom) / 57
    )
    assert camera.screen[::2] == (left, bottom)


@pytest.mark.parametrize(
    ("fixed", "per_pixel", "expected"),
    [(0.0, 1e-7, 1), (0.03, 1e-7, 2), (0.05, 1e-7, 4), (0.0, 1e-5, 8), (0.2, 0.0, 8)],
)
def test_the_width_of_pixels_follows_the_time_they_take(
    fixed: float, per_pixel: float, expected: int
) -> None:
    """Pictures take less than a fifteenth of a second where that can be had, with as many pixels as
    that allows.
    """
    pace = Pace()
    late = 0
    steps = []
    for _ in range(200):
        steps.append(pace.step)
        seconds = fixed + per_pixel * 960 * 540 / pace.step**2
        late += seconds > 1 / 15
        pace.took(pace.step, seconds)
    assert max(set(steps[100:]), key=steps[100:].count) == expected
    assert late < 20 or expected == 8


def test_a_fixed_width_stays() -> None:
    pace = Pace(3)
    for seconds in (0.001, 1.0):
        pace.took(3, seconds)
        assert pace.step == 3


def test_performance_of_moving_pictures_is_told(controller: Controller) -> None:
    controller.set_scene(room(), SETTINGS)
    settle(controller, show(controller, view()))
    assert {"build", "cache", "moving", "still", "pass"} <= controller.counts.seconds.keys()
    assert controller.counts.frames >= 2


def test_what_rests_is_denoised() -> None:
    recorder = Recorder(2)
    recorder.set_view(view())
    recorder.set_scene(room(), replace(SETTINGS, denoise=True))
    wait(recorder, lambda p: p.samples == SETTINGS.passes)
    recorder.close()
    assert recorder.warning == ""
    assert not [p for p in recorder.seen if p.moving and p.samples > 1]
    reference = corescene.picture(
        room(), Integrator.REFERENCE, passes=512, photons_per_pass=0, seed=3
    )
    noisy = corescene.picture(
        room(), passes=SETTINGS.passes, final_gather=FinalGather.ON, adaptive_samples=False
    )
    error = [
        float(((pixels[..., :3] - reference) ** 2).mean())
        for pixels in (recorder.seen[-1].pixels, noisy)
    ]
    assert error[0] < 0.7 * error[1]


def test_a_viewport_without_a_denoiser_says_so(
    controller: Controller, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(*given: object, **named: object) -> None:
        raise DenoiserMissing("there is none")

    monkeypatch.setattr(clean, "denoise", missing)
    controller.set_view(view())
    controller.set_scene(room(), replace(SETTINGS, denoise=True))
    picture = settle(controller, view())
    assert np.isfinite(picture.pixels).all()
    assert controller.warning == "not denoised: there is none"
