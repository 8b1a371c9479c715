"""Pictures with shadow catchers, made by native code and by the denoiser's side alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from photon_splat.core.render.persistent import start_anew
from photon_splat.core.render.settings import Integrator, RenderSettings
from photon_splat.core.render.shadow_catcher import OF_PARTS, with_shadow
from photon_splat.core.scene import LightKind, Scene

from tests.support import corescene as c

PIXELS = 24


def yard(transparent: bool, *, empty: bool = False, world: float = 0.5) -> Scene:
    """A block on a floor that catches shadows, in a lamp's and the world's light."""
    view = c.perspective((0.0, -3.0, 2.0), (0.0, 0.0, 0.2), PIXELS, PIXELS, 1.2)
    view = (view[0], replace(view[1], transparent=transparent))
    things = [(c.quad(2.0), c.lambert(0.6))]
    if not empty:
        things.append((c.box((-0.4, -0.4, 0.0), (0.4, 0.4, 0.6)), c.lambert((0.7, 0.3, 0.2))))
    lamp = c.lamp(LightKind.POINT, 100.0, (1.2, -0.4, 1.6), radius=0.1)
    made = c.scene(view, things, [lamp], world=world)
    made.instances.catcher = np.arange(len(things)) == 0
    return made


@pytest.mark.parametrize("transparent", [False, True])
def test_both_ways_make_the_same_picture(transparent: bool) -> None:
    start = start_anew(yard(transparent), RenderSettings(photons_per_pass=500))
    start.prepare()
    for number in range(3):
        start.renderer.render_pass(number)
    film = start.renderer.film(["combined", *OF_PARTS])
    made = with_shadow(*(film[name] for name in OF_PARTS), transparent)
    assert np.allclose(made, film["combined"], rtol=1e-5, atol=1e-6)
    assert np.allclose(start.renderer.picture(), film["combined"], rtol=1e-5, atol=1e-6)
    assert not np.allclose(film["matte"], film["combined"])


@pytest.mark.parametrize("integrator", c.BOTH)
def test_a_floor_alone_shows_no_shadow_and_no_noise(integrator: Integrator) -> None:
    settings = {"passes": 2, "photons_per_pass": 500, "denoise": False}
    clear = c.shoot(yard(True, empty=True), integrator, **settings).passes["Combined"]
    assert not clear.any()
    opaque = c.shoot(yard(False, empty=True), integrator, **settings).passes["Combined"]
    assert opaque == pytest.approx(np.broadcast_to([0.5, 0.5, 0.5, 1.0], opaque.shape), rel=1e-5)


@pytest.mark.parametrize("integrator", c.BOTH)
def test_light_of_catchers_is_in_no_other_pass(integrator: Integrator) -> None:
    passes = c.shoot(
        yard(True, world=0.0), integrator, passes=4, photons_per_pass=500, denoise=False
    ).passes
    alpha = passes["Combined"][..., 3]
    thing = passes["Diffuse Direct"].any(axis=2)
    shadow = (alpha > 0.3) & ~thing
    assert shadow.sum() > 10
    assert not passes["Combined"][shadow][:, :3].any()
    assert (passes["Depth"][shadow] < 10.0).all()
    assert (passes["Diffuse Color"][shadow] > 0.5).all()
    assert thing.sum() > 10
    assert (alpha[thing] > 0.0).all()
    assert (alpha[~thing] < 0.05).mean() > 0.5


def test_the_shadow_is_denoised_by_itself() -> None:
    noisy, clean = (
        c.shoot(
            yard(True, world=1.0), Integrator.SPLAT, passes=2, photons_per_pass=500, denoise=denoise
        ).passes["Combined"]
        for denoise in (False, True)
    )
    reference = c.shoot(
        yard(True, world=1.0), Integrator.SPLAT, passes=128, photons_per_pass=500, denoise=False
    ).passes["Combined"]
    off = [float(np.square(made[..., 3] - reference[..., 3]).mean()) for made in (noisy, clean)]
    assert off[1] < 0.8 * off[0]


def test_a_pass_of_its_own_takes_the_shadow_out_of_the_picture() -> None:
    whole, parted = yard(True), yard(True)
    parted.shadow_pass = True
    settings = {"passes": 4, "photons_per_pass": 500}
    for denoise in (False, True):
        one = c.shoot(whole, Integrator.SPLAT, denoise=denoise, **settings).passes
        two = c.shoot(parted, Integrator.SPLAT, denoise=denoise, **settings).passes
        assert "Shadow Catcher" not in one
        assert (two["Combined"][..., 3] <= one["Combined"][..., 3] + 1e-6).all()
        assert two["Combined"][..., 3].mean() < 0.9 * one["Combined"][..., 3].mean()
        parts = two["Combined"], two["Shadow Catcher"], np.zeros_like(two["Shadow Catcher"])
        assert with_shadow(*parts, True) == pytest.approx(one["Combined"], rel=1e-4, abs=1e-5)
