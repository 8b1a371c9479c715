"""The film's arrays: what is asked for, by name, and passes that are made of them."""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.render.persistent import start_anew
from photon_splat.core.render.result import film_arrays, passes_from_film
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Material

from tests.robustness.test_degenerate import room
from tests.support import corescene
from tests.support.programs import closure

LIGHT = ("diffuse", "glossy", "transmission", "volume")
MIRROR, RED = (0.9, 0.8, 0.7), (0.8, 0.2, 0.1)


def test_arrays_by_name_are_those_of_the_whole_film() -> None:
    start = start_anew(room(pixels=20), RenderSettings(photons_per_pass=2000))
    start.prepare()
    renderer = start.renderer
    assert all(not array.any() for array in renderer.film().values())  # before the first pass
    for number in range(3):
        renderer.render_pass(number)
        film = renderer.film()
        parts = [film[f"{kind}_{way}"] for kind in LIGHT for way in ("direct", "indirect")] + [
            film["emission"],
            film["environment"],
        ]
        assert np.allclose(film["combined"][..., :3], sum(parts), rtol=1e-6)
        assert np.array_equal(film["combined"][..., 3:], film["alpha"])
        assert film["diffuse_indirect"].any()
        for way in ("direct", "indirect"):
            light, color = film[f"diffuse_{way}"], film["diffuse_color"]
            expected = np.divide(light, color, out=np.zeros_like(light), where=color > 0)
            assert np.array_equal(film[f"diffuse_{way}_per_albedo"], expected)
        some = renderer.film(film_arrays({"Combined", "Normal"}))
        assert list(some) == ["combined", "normal", "light_groups"]
        assert all(np.array_equal(some[name], film[name]) for name in some)
        assert list(passes_from_film(some)) == ["Combined", "Normal"]
    with pytest.raises(ValueError, match="no array of such a name"):
        renderer.film(["combined", "colour"])


def test_light_has_every_channel_where_the_colour_lacks_some() -> None:
    """Direct passes of Cycles: the light of pure colours is grey, not theirs."""
    for color, light in (((0.8, 0, 0), 1.0), ((0, 0.5, 0.25), 1.0), ((0, 0, 0), 0.0)):
        floor = (corescene.quad(), corescene.lambert(color))
        what = corescene.scene(corescene.ortho_down(2.0, 1.0, 4), [floor], world=1.0)
        start = start_anew(what, RenderSettings(photons_per_pass=0))
        start.prepare()
        for number in range(8):
            start.renderer.render_pass(number)
        film = start.renderer.film(["diffuse_direct", "diffuse_direct_per_albedo"])
        assert np.allclose(film["diffuse_direct_per_albedo"], light, rtol=1e-4), color
        assert np.allclose(film["diffuse_direct"], np.multiply(color, light), rtol=1e-4)


def mirrored(roughness: float) -> dict[str, np.ndarray]:
    """The film of a mirror that shows a red plane above the camera."""
    material = Material("mirror", program=0)
    things = [(corescene.quad(), material), (corescene.quad(4.0, z=5.0), corescene.lambert(RED))]
    what = corescene.scene(corescene.ortho_down(2.0, 1.0, 8), things, world=1.0)
    what.programs = [closure("Glossy", color=MIRROR, roughness=roughness)]
    start = start_anew(what, RenderSettings(photons_per_pass=0))
    start.prepare()
    for number in range(16):
        start.renderer.render_pass(number)
    return start.renderer.film(["albedo", "normal", "feature_normal"])


def test_a_denoiser_is_told_what_a_mirror_shows() -> None:
    film = mirrored(0.0)
    assert np.allclose(film["albedo"], np.multiply(MIRROR, RED), rtol=0.02)
    assert np.allclose(film["feature_normal"], (0.0, 0.0, -1.0), atol=1e-3)
    assert np.allclose(film["normal"], (0.0, 0.0, 1.0), atol=1e-3)


def test_a_rough_surface_shows_itself() -> None:
    film = mirrored(0.5)
    assert film["albedo"].min() > 0.6
    assert np.allclose(film["feature_normal"], (0.0, 0.0, 1.0), atol=1e-3)
