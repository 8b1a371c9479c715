"""A floor under one light, against formulas, to 0.5 %."""

from __future__ import annotations

from math import cos, pi, radians, sin

import numpy as np
import pytest
from photon_splat.core.scene import Light, LightKind

from tests.reference.closed_form import irradiance
from tests.support import corescene as c
from tests.support.compare import block_means

ALBEDO, SIZE, PIXELS = 0.5, 1.6, 16
SETTINGS = {"passes": 400, "photons_per_pass": 2000, "seed": 3}
integrators = pytest.mark.parametrize("integrator", c.BOTH)


def floor_picture(
    things: list, lights: list[Light], integrator: object, camera_height: float = 0.2
) -> np.ndarray:
    """Radiance of the floor, (PIXELS, PIXELS), seen from between floor and light."""
    view = c.ortho_down(camera_height, SIZE, PIXELS)
    made = c.scene(view, [(c.quad(), c.lambert(ALBEDO)), *things], lights)
    rgb = c.picture(made, integrator, **SETTINGS)
    assert np.allclose(rgb[..., 0], rgb[..., 1]), "a grey scene came out coloured"
    return rgb[..., 0]


def expect(measured: np.ndarray, irradiance_fine: np.ndarray, tolerance: float = 0.005) -> None:
    """Compare 4x4-pixel blocks, each to `tolerance`; blocks darker than a tenth of the brightest to
    that tenth.
    """
    expected = c.coarsen(irradiance_fine) * ALBEDO / pi
    got, want = (block_means(p[..., None], 4)[..., 0] for p in (measured, expected))
    scale = np.maximum(want, want.max() * 0.1)
    error = np.abs(got - want) / scale
    worst = np.unravel_index(np.argmax(error), error.shape)
    assert error.max() < tolerance, (
        f"block {worst}: {got[worst]:.6g} instead of {want[worst]:.6g} ({error.max():.2%})"
    )
    assert abs(measured.mean() / expected.mean() - 1) < tolerance / 2


@integrators
def test_triangular_emitter(integrator: object) -> None:
    corners = [(-0.7, -0.4, 0.9), (0.2, 0.6, 1.0), (0.8, -0.3, 0.7)]
    emitter = (c.mesh(corners, [(0, 1, 2)]), c.lambert(0.0, 2.5, back_emission=False))
    expect(
        floor_picture([emitter], [], integrator),
        irradiance.polygon(corners, 2.5, *c.pixel_grid(SIZE, PIXELS)),
    )


@integrators
def test_rectangular_emitter_of_many_triangles(integrator: object) -> None:
    corners = irradiance.rectangle_corners(1.0, 0.5, 0.6, turn=0.4)
    a, b, _, d = (np.asarray(p) for p in corners)
    steps = np.linspace(0, 1, 8)
    vertices = [a + (b - a) * u + (d - a) * v for v in steps for u in steps]
    faces = [
        (8 * j + i, 8 * j + i + 8, 8 * j + i + 9, 8 * j + i + 1) for j in range(7) for i in range(7)
    ]
    emitter = (c.mesh(vertices, faces), c.lambert(0.0, 3.0, back_emission=False))
    expect(
        floor_picture([emitter], [], integrator),
        irradiance.polygon(corners, 3.0, *c.pixel_grid(SIZE, PIXELS)),
    )


@integrators
def test_two_sided_emitter_shines_from_its_back(integrator: object) -> None:
    corners = irradiance.rectangle_corners(0.8, 0.8, 0.7)
    emitter = (c.mesh(corners, [(0, 1, 2, 3)]), c.lambert(0.0, 1.0))
    expect(
        floor_picture([emitter], [], integrator),
        irradiance.polygon(corners, 1.0, *c.pixel_grid(SIZE, PIXELS)),
    )


@integrators
def test_point(integrator: object) -> None:
    lamp = c.lamp(LightKind.POINT, 30.0, (0.0, 0.0, 0.8))
    expect(
        floor_picture([], [lamp], integrator),
        irradiance.point(30.0, 0.8, *c.pixel_grid(SIZE, PIXELS)),
    )


@integrators
def test_point_sphere(integrator: object) -> None:
    lamp = c.lamp(LightKind.POINT, 30.0, (0.0, 0.0, 0.8), radius=0.5, soft_falloff=False)
    expect(
        floor_picture([], [lamp], integrator),
        irradiance.sphere(30.0, 0.5, 0.8, *c.pixel_grid(SIZE, PIXELS)),
    )


@integrators
@pytest.mark.parametrize(("radius", "height"), [(0.1, 1.0), (0.7, 0.8), (0.9, 0.5)])
def test_point_with_soft_falloff(integrator: object, radius: float, height: float) -> None:
    """The disc faces the receiver, on axis exactly downwards; a spot of 20 mm about the axis is
    seen.
    """
    lamp = c.lamp(LightKind.POINT, 30.0, (0.0, 0.0, height), radius=radius)
    view = c.ortho_down(0.01, 0.02, 4)
    mean = c.picture(
        c.scene(view, [(c.quad(), c.lambert(ALBEDO))], [lamp]), integrator, **SETTINGS
    ).mean()
    assert mean == pytest.approx(
        irradiance.facing_disk_on_axis(30.0, radius, height) * ALBEDO / pi, rel=0.005
    )


@integrators
@pytest.mark.parametrize("blend", [0.0, 0.15, 1.0])
def test_spot(integrator: object, blend: float) -> None:
    size = radians(70.0)
    lamp = c.lamp(LightKind.SPOT, 30.0, (0.0, 0.0, 0.9), spot_size=size, spot_blend=blend)
    fine = c.pixel_grid(SIZE, PIXELS, 16)
    expected = c.coarsen(irradiance.spot(30.0, size, blend, 0.9, *fine), 4)
    # A hard edge cuts blocks: its position is sampled, not known exactly.
    expect(floor_picture([], [lamp], integrator), expected, 0.02 if blend == 0.0 else 0.005)


@integrators
@pytest.mark.parametrize("degrees", [0.0, 0.526, 10.0, 60.0])
def test_sun(integrator: object, degrees: float) -> None:
    tilt = radians(35.0)
    lamp = c.lamp(
        LightKind.SUN, 3.0, (sin(tilt), 0.0, cos(tilt)), (0.0, 0.0, 0.0), angle=radians(degrees)
    )
    expected = np.full((PIXELS * 4, PIXELS * 4), irradiance.tilted_sun(3.0, radians(degrees), tilt))
    expect(floor_picture([], [lamp], integrator), expected)


@integrators
def test_area_rectangle(integrator: object) -> None:
    lamp = c.lamp(LightKind.AREA, 10.0, (0.0, 0.0, 0.7), size=(1.0, 0.4))
    # look_at turns a lamp that shines straight down so that its x axis lies along y or x; read it
    # off the matrix.
    x_axis = lamp.matrix[:3, 0]
    corners = irradiance.rectangle_corners(
        1.0, 0.4, 0.7, turn=float(np.arctan2(x_axis[1], x_axis[0]))
    )
    expect(
        floor_picture([], [lamp], integrator),
        irradiance.polygon(corners, 10.0 / (pi * 0.4), *c.pixel_grid(SIZE, PIXELS)),
    )


@integrators
@pytest.mark.parametrize("spread", [180.0, 90.0, 40.0])
def test_area_disk_and_spread(integrator: object, spread: float) -> None:
    lamp = c.lamp(
        LightKind.AREA, 10.0, (0.0, 0.0, 0.7), size=(0.6, 0.6), ellipse=True, spread=radians(spread)
    )
    view = c.ortho_down(0.01, 0.01, 4)
    mean = c.picture(
        c.scene(view, [(c.quad(), c.lambert(ALBEDO))], [lamp]), integrator, **SETTINGS
    ).mean()
    if spread == 180.0:
        expected = irradiance.disk_on_axis(10.0, 0.3, 0.7)
    else:
        expected = irradiance.spread_disk_on_axis(10.0, 0.3, 0.7, radians(spread))
    assert mean == pytest.approx(expected * ALBEDO / pi, rel=0.005)


@integrators
def test_narrow_spread_is_a_beam(integrator: object) -> None:
    lamp = c.lamp(LightKind.AREA, 10.0, (0.0, 0.0, 0.7), size=(1.0, 1.0), spread=radians(5.0))
    view = c.ortho_down(0.2, 0.6, 8)
    mean = c.picture(
        c.scene(view, [(c.quad(), c.lambert(ALBEDO))], [lamp]), integrator, **SETTINGS
    ).mean()
    assert mean == pytest.approx(irradiance.spread_beam(10.0, 1.0) * ALBEDO / pi, rel=0.005)


@integrators
def test_world(integrator: object) -> None:
    """An open floor under a constant sky is as bright as albedo times the sky."""
    made = c.scene(c.ortho_down(0.2, SIZE, PIXELS), [(c.quad(), c.lambert(ALBEDO))], world=1.5)
    assert c.picture(made, integrator, **SETTINGS) == pytest.approx(1.5 * ALBEDO, rel=0.02)
    assert c.picture(made, integrator, **SETTINGS).mean() == pytest.approx(1.5 * ALBEDO, rel=0.002)
