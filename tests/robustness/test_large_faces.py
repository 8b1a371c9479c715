"""Large faces that stand askew: rays that leave them do not meet them again."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import LightKind

from tests.support import corescene as c


def turned(about: tuple[float, float, float]) -> np.ndarray:
    """A rotation by three angles, radians."""
    out = np.eye(3)
    for axis, angle in enumerate(about):
        cosine, sine = np.cos(angle), np.sin(angle)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = cosine, -sine, sine, cosine
        out = turn @ out
    return out


ASKEW = turned((0.35, 0.23, 0.4))


@pytest.mark.parametrize("integrator", c.BOTH)
@pytest.mark.parametrize("half", [20.0, 100.0, 3000.0])
def test_a_slope_under_the_sun_is_as_bright_as_its_cosine(
    half: float, integrator: Integrator
) -> None:
    """albedo E cos / pi everywhere, seen from a few metres above the middle of two triangles."""
    slope = c.quad(half)
    slope.positions = (slope.positions @ ASKEW.T).astype(np.float32)
    view = c.perspective(tuple(ASKEW @ (0.0, -6.0, 6.0)), (0.0, 0.0, 0.0), 48, 32)
    sun = c.lamp(LightKind.SUN, 3.0, (0.0, 0.0, 5.0))
    what = c.scene(view, [(slope, c.lambert(0.7))], [sun])
    seen = c.picture(what, integrator, passes=4, photons_per_pass=5000)
    assert seen == pytest.approx(0.7 * 3.0 * ASKEW[2, 2] / pi, rel=1e-4)


@pytest.mark.parametrize("integrator", c.BOTH)
def test_a_wide_room_is_as_bright_askew(integrator: Integrator) -> None:
    """A low hall, 400 m wide, and light that its walls send on."""

    def mean(turn: np.ndarray) -> float:
        hall = c.box((-200.0, -200.0, -1.5), (200.0, 200.0, 1.5), inwards=True)
        hall.positions = (hall.positions @ turn.T).astype(np.float32)
        view = c.perspective((0.0, -4.0, 0.0), (0.0, 4.0, 0.3), 32, 24)
        view[0].matrix[:3] = turn @ view[0].matrix[:3]
        lamp = c.lamp(LightKind.POINT, 300.0, tuple(turn @ (0.4, 1.0, 0.7)), radius=0.05)
        what = c.scene(view, [(hall, c.lambert(0.8))], [lamp])
        passes = 16 if integrator is Integrator.SPLAT else 256
        return float(c.picture(what, integrator, passes=passes, photons_per_pass=100_000).mean())

    assert mean(ASKEW) == pytest.approx(mean(np.eye(3)), rel=0.01)


@pytest.mark.parametrize("integrator", c.BOTH)
@pytest.mark.parametrize("far", [100.0, 3000.0])
def test_instances_of_a_mesh_far_from_its_own_origin(far: float, integrator: Integrator) -> None:
    """Linked duplicates of what was modelled away from the origin of its object."""
    slope = c.quad(2.0)
    place = np.array((far, -0.7 * far, 0.2 * far))
    slope.positions = (slope.positions @ ASKEW.T + place).astype(np.float32)
    view = c.perspective((0.0, -6.0, 6.0), (0.0, 0.0, 0.0), 48, 32, 0.3)
    sun = c.lamp(LightKind.SUN, 3.0, (0.0, 0.0, 5.0))
    what = c.scene(view, [(slope, c.lambert(0.7))] * 2, [sun])
    what.instances.mesh[:] = 0
    what.instances.matrix[:, :3, 3] = -place, -place - (0.0, 0.0, 30.0)
    seen = c.picture(what, integrator, passes=4, photons_per_pass=5000)
    assert seen == pytest.approx(0.7 * 3.0 * ASKEW[2, 2] / pi, rel=1e-4)


@pytest.mark.parametrize("integrator", c.BOTH)
def test_lamps_that_are_such_instances_shine_as_others(integrator: Integrator) -> None:
    """Two panels over a floor, modelled in their place or 1000 m off their own origin."""

    def mean(place: np.ndarray) -> float:
        panel = c.quad(0.5)
        panel.positions = (panel.positions @ ASKEW.T + place).astype(np.float32)
        view = c.perspective((0.0, -4.0, 3.0), (0.0, 0.0, 0.3), 32, 24)
        lamp, floor = c.lambert(0.5, 4.0), c.lambert(0.7)
        what = c.scene(view, [(panel, lamp), (panel, lamp), (c.quad(3.0), floor)])
        what.instances.mesh[1] = 0
        what.instances.matrix[:2, :3, 3] = np.array(((-1, 0, 1), (1, 0, 1))) - place
        passes = 16 if integrator is Integrator.SPLAT else 256
        return float(c.picture(what, integrator, passes=passes, photons_per_pass=50_000).mean())

    far = mean(np.array((1000.0, -700.0, 200.0)))
    assert far == pytest.approx(mean(np.zeros(3)), rel=0.01)
