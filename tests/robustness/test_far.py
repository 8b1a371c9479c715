"""Things far away change nothing: the picture is that of the same room without them."""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.native.bounds import focus, world_bounds
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import LightKind, Scene

from tests.support import corescene as c

VIEW = {"passes": 16, "photons_per_pass": 20_000}


def stage(extra: list | None = None, *, sun: bool = False) -> Scene:
    """A floor, a wall and a block, the camera before them."""
    view = c.perspective((0.0, -4.0, 2.5), (0.0, 0.2, 0.5), 24, 24)
    view[0].clip_start, view[0].clip_end = 0.01, 1e8
    things = [
        (c.box((-1.6, -1.6, -0.1), (1.6, 1.6, 0.0)), c.lambert((0.7, 0.6, 0.5))),
        (c.box((-1.6, 1.5, 0.0), (1.6, 1.6, 2.2)), c.lambert((0.5, 0.6, 0.7))),
        (c.box((-0.7, -0.2, 0.0), (-0.2, 0.3, 0.7)), c.lambert((0.7, 0.2, 0.2))),
    ]
    lamp = c.lamp(LightKind.POINT, 30.0, (0.3, -0.3, 1.9), radius=0.1)
    if sun:
        lamp = c.lamp(LightKind.SUN, 2.0, (0.0, 0.0, 9.0), angle=0.05)
    return c.scene(view, things + (extra or []), [lamp])


def far_box(distance: float) -> list:
    return [(c.box((distance, distance, 0.0), (distance + 5, distance + 5, 5.0)), c.lambert(0.5))]


def with_loose_vertex(scene: Scene) -> Scene:
    mesh = scene.meshes[0]
    mesh.positions = np.vstack([mesh.positions, np.array([[1e9, -1e9, 1e9]], np.float32)])
    return scene


def picture(scene: Scene, integrator: Integrator) -> np.ndarray:
    return c.shoot(scene, integrator, **VIEW).passes["Combined"][..., :3]


@pytest.mark.parametrize("integrator", c.BOTH)
@pytest.mark.parametrize("sun", [False, True], ids=["lamp", "sun"])
@pytest.mark.parametrize("distance", [1e4, 1e6])
def test_an_object_far_away_changes_nothing(
    integrator: Integrator, sun: bool, distance: float
) -> None:
    alone, beside = (
        picture(stage(sun=sun), integrator),
        picture(stage(far_box(distance), sun=sun), integrator),
    )
    assert beside.mean() == pytest.approx(alone.mean(), rel=0.015)
    assert np.abs(beside - alone).mean() < 0.06 * alone.mean()


@pytest.mark.parametrize("integrator", c.BOTH)
def test_a_loose_vertex_changes_nothing(integrator: Integrator) -> None:
    alone, beside = picture(stage(), integrator), picture(with_loose_vertex(stage()), integrator)
    assert (alone == beside).all()


def test_coordinates_count_from_the_middle_unless_things_are_very_far_off() -> None:
    plain = stage()
    origin, near = focus(plain)
    assert near == 0
    assert origin == pytest.approx(world_bounds(plain).mean(axis=0))
    for distance in (1e3, 1e6):
        moved, radius = focus(stage(far_box(distance)))
        assert moved == pytest.approx(origin)
        assert 2.0 < radius < 4.0
    assert world_bounds(with_loose_vertex(stage())) == pytest.approx(world_bounds(plain))


def test_a_room_in_a_shining_dome_ten_kilometres_wide() -> None:
    """As bright as under a world of the dome's radiance."""
    dome = [(c.box((-1e4, -1e4, -1e4), (1e4, 1e4, 1e4), inwards=True), c.lambert(0.0, 0.8))]
    scene, world = stage(dome), stage()
    scene.lights.clear()
    world.lights.clear()
    world.world = (0.8, 0.8, 0.8)
    expected = picture(world, Integrator.REFERENCE).mean()
    assert picture(scene, Integrator.REFERENCE).mean() == pytest.approx(expected, rel=0.01)
    assert picture(scene, Integrator.SPLAT).mean() == pytest.approx(expected, rel=0.02)
