"""Motion blur without Blender: pictures of what moves against closed forms, and against the mean of
many pictures of it standing still.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import (
    ALL_RAYS,
    CameraMotion,
    LightKind,
    Material,
    MeshMotion,
    Ray,
    Scene,
    Shutter,
    Side,
)

from tests.support import corescene as c
from tests.support.compare import Blocks, block_test, mean_ratio, save_pictures
from tests.support.paths import ROOT
from tests.support.programs import closure

PIXELS, SIZE = 32, 4.0
STILLS = 24
FAILURES = ROOT / "out" / "failures"


def moved(x: float, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, z)
    return matrix


def sliding(scene: Scene, instance: int, by: float, rolling: float = -1.0) -> Scene:
    """`scene` with an instance that goes so far in x while the shutter is open."""
    own = scene.instances.matrix[instance]
    steps = np.stack([moved(by * step) @ own for step in (-0.5, 0.0, 0.5)])
    scene.instances.motion = {instance: steps}
    scene.shutter = Shutter(np.ones(2, np.float32), rolling)
    return scene


def bar(half_width: float = 0.25) -> Scene:
    """A shining bar along y before nothing, seen from above."""
    view = c.ortho_down(2.0, SIZE, PIXELS)
    corners = [(x, y, 0.0) for x, y in ((-1, -9), (1, -9), (1, 9), (-1, 9))]
    thing = c.mesh([(half_width * x, y, z) for x, y, z in corners], [(0, 1, 2, 3)])
    return c.scene(view, [(thing, c.lambert(0.0, 1.0))])


def coverage(travel: float, half_width: float) -> np.ndarray:
    """Share of the time for which the sliding bar covers each column of pixels."""
    x = ((np.arange(PIXELS * 16) + 0.5) / (PIXELS * 16) - 0.5) * SIZE
    first = np.maximum(x - half_width, -travel / 2)
    last = np.minimum(x + half_width, travel / 2)
    return (np.maximum(last - first, 0.0) / travel).reshape(PIXELS, 16).mean(1)


@pytest.mark.parametrize("passes", [1, 16])
def test_a_sliding_bar_covers_its_columns_by_a_trapezoid(passes: int) -> None:
    """After one pass as well: each pixel has times of its own, so that nothing is seen twice."""
    picture = c.picture(sliding(bar(), 0, 2.0), Integrator.REFERENCE, passes=passes)[..., 0]
    expected = coverage(2.0, 0.25)
    sigma = np.sqrt(expected * (1 - expected) / (PIXELS * passes))
    assert (np.abs(picture.mean(0) - expected) <= 4.5 * sigma + 2e-3).all()
    assert abs(picture.mean() / expected.mean() - 1) < 0.3 / passes**0.5


def test_a_rolling_shutter_slants_the_bar() -> None:
    picture = c.picture(sliding(bar(), 0, 2.0, 0.0), Integrator.REFERENCE, passes=32)[..., 0]
    x = ((np.arange(PIXELS) + 0.5) / PIXELS - 0.5) * SIZE
    middle = (picture * x).sum(1) / picture.sum(1)
    down = 1 - np.arange(PIXELS) / PIXELS  # row 0 is the lowest
    assert np.allclose(middle, 2.0 * (down - 0.5), atol=0.02)
    assert np.allclose(picture.sum(1) * SIZE / PIXELS, 0.5, atol=0.02)


def test_a_sliding_camera_sees_what_a_sliding_bar_shows() -> None:
    scene = bar()
    steps = np.stack([moved(x) @ scene.camera.matrix for x in (1.0, 0.0, -1.0)])
    scene.camera.motion = CameraMotion(steps)
    scene.shutter = Shutter(np.ones(2, np.float32))
    picture = c.picture(scene, Integrator.REFERENCE, passes=64)[..., 0]
    assert np.allclose(picture.mean(0), coverage(2.0, 0.25), atol=0.02)


def test_a_mesh_that_grows_covers_more_and_more() -> None:
    scene = bar()
    mesh = scene.meshes[0]
    steps = np.stack([mesh.positions * (f, 1.0, 1.0) for f in (0.0, 1.0, 6.0)]).astype(np.float32)
    scene.meshes[0] = replace(mesh, motion=MeshMotion(steps))
    scene.shutter = Shutter(np.ones(2, np.float32))
    picture = c.picture(scene, Integrator.REFERENCE, passes=64)[..., 0]
    x = np.abs(((np.arange(PIXELS) + 0.5) / PIXELS - 0.5) * SIZE)
    # half widths: .5 t up to .25, then 2.5 t - 1
    expected = np.where(x < 0.25, 1 - 2 * x, np.maximum(0.6 - 0.4 * x, 0.0))
    assert np.allclose(picture.mean(0), expected, atol=0.04)


def glass_ball(x: float = 0.0) -> Scene:
    """A ball of glass over a floor, which the camera does not see but by its caustic."""
    view = c.ortho_down(3.0, 2.0, PIXELS)
    ball = c.globe(0.3, 3, smooth=True)
    lamp = c.lamp(LightKind.POINT, 60.0, (0.0, 0.4, 2.5), radius=0.1)
    glass = Material("glass", Side(), Side(), program=0)
    scene = c.scene(view, [(c.quad(2.0), c.lambert(0.6)), (ball, glass)], [lamp])
    scene.instances.matrix[1] = moved(x, 0.0, 0.55)
    scene.instances.seen_by = np.array([ALL_RAYS, ALL_RAYS & ~Ray.CAMERA], np.uint32)
    scene.programs.append(closure("Glass", color=1.0, roughness=0.0, ior=1.5))
    return scene


def test_a_moving_caustic_is_the_mean_of_many_that_stand_still() -> None:
    travel, settings = 0.8, {"photons_per_pass": 20_000, "denoise": False}
    blurred = np.stack(
        [
            c.picture(sliding(glass_ball(), 1, travel), passes=16, seed=k, **settings)
            for k in range(5)
        ]
    )
    places = ((np.arange(STILLS) + 0.5) / STILLS - 0.5) * travel
    stills = np.stack(
        [
            np.mean(
                [
                    c.picture(glass_ball(x), passes=2, seed=100 * k + i, **settings)
                    for i, x in enumerate(places)
                ],
                axis=0,
            )
            for k in range(4)
        ]
    )
    result = block_test(
        Blocks.of(blurred, 4, independent_pixels=False),
        Blocks.of(stills, 4, independent_pixels=False),
        relative=0.03,
        absolute=0.01 * float(stills.mean()),
    )
    ratio, error = mean_ratio(blurred, stills)
    # The caustic is a streak: without it the test would tell nothing.
    middle = stills.mean(0)[..., 0]
    assert middle.max() > 1.5 * np.median(middle)
    if abs(ratio - 1) > 0.01 + 3 * error or not result.passed:
        save_pictures(FAILURES, "moving_caustic", blurred.mean(0), stills.mean(0))
        pytest.fail(f"mean {ratio:.4f} +- {error:.4f}; {result}")


def test_a_floor_is_lit_right_where_a_box_glides_over_it() -> None:
    """The box covers a place at the very times when no light gets there: the mean light of all
    times is not that of the times when the place is seen.
    """
    wall = [(-1.5, 1.5, 0), (1.5, 1.5, 0), (1.5, 1.5, 2), (-1.5, 1.5, 2)]
    things = [
        (c.quad(1.5), c.lambert(0.6)),
        (c.box((-0.3, -0.3, 0.001), (0.3, 0.3, 0.5)), c.lambert(0.6)),
        (c.mesh(wall, [(0, 1, 2, 3)]), c.lambert(0.8)),
    ]
    lamp = c.lamp(LightKind.AREA, 200.0, (0, 0.8, 1.0), (0, 1.5, 1.0), size=(0.3, 0.3))
    scene = c.scene(c.ortho_down(3.0, 3.0, PIXELS), things, [lamp])
    scene.instances.matrix[1] = moved(0.0, -0.2)
    scene = sliding(scene, 1, 1.6)
    stacks = [
        np.stack([c.picture(scene, by, passes=passes, seed=k) for k in range(runs)])
        for by, passes, runs in ((Integrator.SPLAT, 32, 5), (Integrator.REFERENCE, 200, 2))
    ]
    result = block_test(
        Blocks.of(stacks[0], 4, independent_pixels=False),
        Blocks.of(stacks[1], 4, independent_pixels=True),
        relative=0.03,
        absolute=0.01 * float(stacks[1].mean()),
    )
    assert result.passed, str(result)


def test_both_integrators_agree_on_indirect_light_of_what_moves() -> None:
    """A bright wall slides and turns beside a floor; light reaches that from it alone."""
    view = c.perspective((0.0, -4.0, 2.5), (0.0, 0.0, 0.5), 40, 40, 0.8)
    wall = c.mesh([(-0.8, 0, 0.1), (0.8, 0, 0.1), (0.8, 0, 1.3), (-0.8, 0, 1.3)], [(0, 1, 2, 3)])
    lamp = c.lamp(LightKind.AREA, 60.0, (0.0, -1.2, 1.0), (0.0, 0.0, 0.7), size=(0.3, 0.3))
    things = [(c.quad(2.0), c.lambert(0.6)), (wall, c.lambert((0.9, 0.3, 0.1)))]
    scene = c.scene(view, things, [lamp])
    turns = []
    for angle in (-0.7, 0.0, 0.7):
        matrix = moved(0.6 * angle, 0.3)
        matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        turns.append(matrix)
    scene.instances.matrix[1] = turns[1]
    scene.instances.motion = {1: np.stack(turns)}
    scene.shutter = Shutter(np.ones(2, np.float32))
    stacks = [
        np.stack([c.picture(scene, by, passes=passes, seed=k) for k in range(runs)])
        for by, passes, runs in ((Integrator.SPLAT, 32, 5), (Integrator.REFERENCE, 64, 2))
    ]
    result = block_test(
        Blocks.of(stacks[0], independent_pixels=False),
        Blocks.of(stacks[1], independent_pixels=True),
        relative=0.03,
        absolute=0.01 * float(stacks[1].mean()),
    )
    assert result.passed, str(result)
