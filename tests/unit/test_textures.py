"""What images cost: their pixels once, in the depth that they are stored in."""

from __future__ import annotations

import time
import weakref

import numpy as np
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Extension, Interpolation, Scene, Texture

from tests.support import corescene as c

SIDE = 4096
STORED = 4 * SIDE * SIDE


def papered(pixels: np.ndarray, readings: int = 1) -> Scene:
    """A floor with the first of several readings of one image."""
    material = c.lambert(0.5, 0.1)
    material.front.base_color_texture = 0
    what = c.scene(c.ortho_down(2.0, 1.0, 8), [(c.quad(), material)])
    ways = [Interpolation.LINEAR, Interpolation.CLOSEST, Interpolation.CUBIC]
    what.textures = [
        Texture("image", pixels, True, ways[k], Extension.REPEAT) for k in range(readings)
    ]
    return what


def test_an_eight_bit_image_is_kept_once_in_eight_bits() -> None:
    pixels = np.random.default_rng(1).integers(0, 256, (SIDE, SIDE, 4), np.uint8)
    alive = weakref.ref(pixels)
    what = papered(pixels, 3)
    mesh = weakref.ref(what.meshes[0].positions)
    del pixels
    result = render(
        what,
        RenderSettings(passes=1, photons_per_pass=0),
        started=time.monotonic(),
        release=True,
    )
    assert STORED <= result.statistics["texture_bytes"] <= 1.1 * STORED
    assert alive() is None  # no second copy in Python
    assert mesh() is None


def test_pixels_stay_for_who_renders_again() -> None:
    pixels = np.full((4, 4, 4), 128, np.uint8)
    what = papered(pixels)
    first = c.picture(what, passes=2, photons_per_pass=0)
    assert what.textures[0].pixels is pixels
    assert np.array_equal(first, c.picture(what, passes=2, photons_per_pass=0))


def test_readings_of_one_image_differ_only_in_how_they_read() -> None:
    pixels = np.random.default_rng(2).integers(0, 256, (8, 8, 4), np.uint8)
    shared, own = papered(pixels, 3), papered(pixels.copy(), 3)
    for k, texture in enumerate(own.textures):
        texture.pixels = pixels.copy()  # each an image of its own
        for what in (shared, own):
            what.materials[0].front.base_color_texture = k
        a, b = (c.picture(what, passes=2, photons_per_pass=1000) for what in (shared, own))
        assert np.array_equal(a, b)
