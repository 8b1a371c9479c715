"""Light that fog scatters several times, against photons traced by numpy alone: an area lamp in a
black room full of fog, of which Cycles loses 3 %.
"""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import LightKind

from tests.support import corescene as c
from tests.support.programs import closure

HALF, DENSITY, ANISOTROPY = 4.0, 0.3, -0.7
LAMP, SIZE = np.array([0.3, -1.0, 0.0]), np.array([1.5, 0.8])
EYE, WINDOW, CENTRE = 3.9, 1.0, np.array([-1.5, -2.5])
"""Of an orthographic camera that looks down."""
HISTORIES, ORDERS = 1_000_000, 60


def phase(cosine: np.ndarray) -> np.ndarray:
    """Henyey and Greenstein's, over that of isotropic scattering."""
    g = ANISOTROPY
    return (1 - g * g) / (1 + g * g - 2 * g * cosine) ** 1.5


def turned(to: np.ndarray, cosine: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Directions at that cosine from each of `to`."""
    across = np.cross(to, np.where(abs(to[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]]))
    across /= np.linalg.norm(across, axis=1)[:, None]
    sine = np.sqrt(np.maximum(1 - cosine**2, 0))[:, None]
    round_ = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(to, across)
    return cosine[:, None] * to + sine * round_


def seen_after_all_scatterings() -> float:
    """All light that comes from fog to the camera, over that which has been scattered once."""
    chance = np.random.default_rng(2)
    n, g = HISTORIES, ANISOTROPY
    place = LAMP + np.stack(
        [
            chance.uniform(-0.5, 0.5, n) * SIZE[0],
            np.zeros(n),
            chance.uniform(-0.5, 0.5, n) * SIZE[1],
        ],
        1,
    )
    down = np.tile([0.0, -1.0, 0.0], (n, 1))
    direction = turned(down, np.sqrt(chance.random(n)), chance.uniform(0, 2 * pi, n))
    by_order = np.zeros(ORDERS)
    for order in range(ORDERS):
        place = place + direction * chance.exponential(1 / DENSITY, len(place))[:, None]
        inside = (abs(place) < HALF).all(1)
        place, direction = place[inside], direction[inside]
        seen = (abs(place[:, :2] - CENTRE) < WINDOW).all(1) & (place[:, 2] < EYE)
        fades = np.exp(-DENSITY * (EYE - place[seen, 2]))
        by_order[order] = (phase(direction[seen, 2]) * fades).sum()
        q = (1 - g * g) / (1 - g + 2 * g * chance.random(len(place)))
        angle = chance.uniform(0, 2 * pi, len(place))
        direction = turned(direction, (1 + g * g - q * q) / (2 * g), angle)
    return float(by_order.sum() / by_order[0])


def test_light_of_an_area_lamp_that_fog_scatters_again_and_again() -> None:
    room = c.box((-HALF,) * 3, (HALF,) * 3, inwards=True)
    lamp = c.lamp(
        LightKind.AREA, 1000.0, tuple(LAMP), tuple(LAMP - [0, 1, 0]), size=tuple(SIZE.tolist())
    )
    view = c.ortho_down(EYE, 2 * WINDOW, 16, tuple(CENTRE.tolist()))
    what = c.scene(view, [(room, c.lambert(0.0))], [lamp])
    what.programs = [closure("VolumeScatter", color=1.0, density=DENSITY, anisotropy=ANISOTROPY)]
    what.world_volume = 0
    once, all_ = (
        c.picture(what, Integrator.REFERENCE, passes=1000, seed=1, max_bounces=bounces).mean()
        for bounces in (0, 64)
    )
    assert all_ / once == pytest.approx(seen_after_all_scatterings(), rel=0.02)
