"""What other renderers are told of a scene; none of them need be installed."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from photon_splat.core.scene import Instances, Light, LightKind, Material, Scene, Side

from tests.benchmarks.chart.plan import RIVALS as CHARTED
from tests.benchmarks.chart.plan import Method, seeds
from tests.benchmarks.chart.rivals import RIVALS, luxcore, mitsuba3
from tests.benchmarks.chart.rivals.exact import (
    SUN_DISTANCE,
    Exact,
    NoCounterpartError,
    exact,
    with_sun_discs,
)
from tests.benchmarks.chart.rivals.export import described
from tests.support.corescene import globe, lambert, lamp, perspective, quad, scene
from tests.support.programs import closure

VIEW = perspective((0.0, -3.0, 1.0), (0.0, 0.0, 0.0), 40, 30, field=0.8)
TABLE = lambert((0.5, 0.4, 0.3))


def square(size: float = 0.2, **settings: object) -> Light:
    """12 W, from a metre above the camera down to the table; the camera does not see it."""
    return lamp(
        LightKind.AREA, 12.0, (0.0, -3.0, 2.0), (0.0, 0.0, 0.0), size=(size, size), **settings
    )


def glass_scene(*lights: Light) -> Scene:
    ball = Material("Glass", program=0)
    made = scene(VIEW, [(quad(), TABLE), (globe(0.3, 1, smooth=True), ball)], lights or [square()])
    made.programs = [closure("Glass", color=(0.9, 1.0, 0.8), roughness=0.0, ior=1.5)]
    return made


def test_surfaces_and_normals() -> None:
    table, ball, _ = exact(glass_scene()).parts
    assert (table.surface.kind, table.surface.color, table.normals) == (
        "diffuse",
        (0.5, 0.4, 0.3),
        None,
    )
    assert ball.surface.kind == "glass"
    assert ball.surface.ior == 1.5
    np.testing.assert_allclose(ball.surface.color, (0.9, 1.0, 0.8), rtol=1e-6)
    assert ball.normals is not None
    np.testing.assert_allclose(ball.normals, ball.positions / 0.3, atol=1e-5)


def test_a_mirrored_instance_keeps_its_front_and_normals() -> None:
    made = glass_scene()
    matrix = np.stack([np.diag([1.0, 1.0, 1.0, 1.0]), np.diag([-1.0, 2.0, 1.0, 1.0])])
    made.instances = Instances(made.instances.mesh, matrix, made.instances.material_set)
    ball = exact(made).parts[1]
    a, b, c = (ball.positions[ball.triangles[:, k]] for k in range(3))
    outwards = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", outwards, a) > 0).all()
    assert ball.normals is not None
    gradient = ball.positions / np.square([1.0, 2.0, 1.0])
    np.testing.assert_allclose(
        ball.normals, gradient / np.linalg.norm(gradient, axis=1, keepdims=True), atol=1e-5
    )


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_lamp_has_its_power_and_shines_where_it_points(mirrored: bool) -> None:
    light = square(0.2)
    if mirrored:
        light.matrix[:3, 0] *= -1
    part = exact(glass_scene(light)).parts[2]
    np.testing.assert_allclose(np.array(part.surface.emission) * np.pi * 0.04, 12.0, rtol=1e-6)
    a, b, c = part.positions[part.triangles[0]]
    normal = np.cross(b - a, c - a)
    np.testing.assert_allclose(normal / np.linalg.norm(normal), -light.matrix[:3, 2], atol=1e-5)


def test_what_has_no_counterpart_is_named() -> None:
    def reason(made: Scene) -> str:
        with pytest.raises(NoCounterpartError) as error:
            exact(made)
        return str(error.value)

    rough = glass_scene()
    rough.programs = [closure("Glass", roughness=0.2, ior=1.5)]
    assert reason(rough) == "material 'Glass' is rough, mixed, bent or filmed"
    other = glass_scene()
    other.programs = [closure("Principled")]
    assert reason(other) == "material 'Glass' has no counterpart"
    textured = glass_scene()
    textured.materials[0] = Material("Wood", Side(base_color_texture=0), Side(base_color_texture=0))
    assert "Wood" in reason(textured)
    assert "world" in reason(replace(glass_scene(), world=(0.1, 0.1, 0.1)))
    assert "in the picture" in reason(glass_scene(lamp(LightKind.AREA, 1.0, (0.0, 0.0, 0.8))))
    assert "behind" in reason(
        glass_scene(lamp(LightKind.AREA, 1.0, (0.0, -3.0, 2.0), (0.0, -3.0, 3.0)))
    )
    assert "rectangle" in reason(
        glass_scene(lamp(LightKind.POINT, 1.0, (0.0, -3.0, 2.0), radius=0.1))
    )


def test_a_sun_becomes_a_disc_of_its_irradiance() -> None:
    sun = lamp(LightKind.SUN, 3.0, (0.0, 0.0, 0.0), (0.3, 0.2, -1.0), angle=0.01)
    disc = with_sun_discs(exact(glass_scene(sun))).parts[-1]
    a, b, c = (disc.positions[disc.triangles[:, k]].astype(np.float64) for k in range(3))
    towards = sun.matrix[:3, 2] / np.linalg.norm(sun.matrix[:3, 2])
    areas = np.cross(b - a, c - a) / 2
    assert (areas @ -towards > 0).all()
    irradiance = disc.surface.emission[0] * float((areas @ -towards).sum()) / SUN_DISTANCE**2
    assert irradiance == pytest.approx(3.0, rel=1e-3)


def test_mitsuba() -> None:
    said = mitsuba3.describe(exact(glass_scene()), "Mitsuba", 64)
    assert said["integrator"] == {"type": "path", "max_depth": 65}
    sensor = said["sensor"]
    assert sensor["fov"] == pytest.approx(np.degrees(0.8))
    assert (sensor["film"]["width"], sensor["film"]["height"]) == (40, 30)
    camera = sensor["to_world"] @ [0.0, 0.0, 1.0, 0.0]
    np.testing.assert_allclose(camera[:3], np.array([0.0, 3.0, -1.0]) / np.sqrt(10), atol=1e-6)
    kinds = [mesh["bsdf"].get("bsdf", mesh["bsdf"])["type"] for mesh in said["meshes"]]
    assert kinds == ["diffuse", "dielectric", "diffuse"]
    assert [mesh["radiance"] is not None for mesh in said["meshes"]] == [False, False, True]
    with pytest.raises(NoCounterpartError, match="particle"):
        mitsuba3.describe(exact(glass_scene()), "Mitsuba, particle tracer", 64)


def test_the_gaussian_has_the_variance_of_our_filter() -> None:
    x = np.linspace(-1, 1, 20001)
    window = (
        0.35875
        + 0.48829 * np.cos(np.pi * x)
        + 0.14128 * np.cos(2 * np.pi * x)
        + 0.01168 * np.cos(3 * np.pi * x)
    )
    assert (
        pytest.approx(np.sqrt((window * x**2).sum() / window.sum()), rel=1e-3) == mitsuba3.GAUSSIAN
    )


def test_luxcore() -> None:
    said = luxcore.describe(exact(glass_scene()), "LuxCore, PhotonGI", 64)
    properties, config = said["scene"], said["config"]
    assert properties["scene.materials.material_1.type"] == "glass"
    assert properties["scene.materials.material_1.interiorior"] == 1.5
    np.testing.assert_allclose(
        properties["scene.materials.material_2.emission"], 12 / np.pi / 0.04, rtol=1e-6
    )
    left, right, bottom, top = properties["scene.camera.screenwindow"]
    assert (right - left, top - bottom) == pytest.approx((2 * np.tan(0.4), 1.5 * np.tan(0.4)))
    assert config["path.pathdepth.total"] == 64
    assert config["path.photongi.caustic.enabled"]
    assert config["film.filter.width"] == 1.5
    assert [len(mesh["triangles"]) for mesh in said["meshes"]] == [2, 32, 2]
    plain = luxcore.describe(exact(glass_scene()), "LuxCore", 64)["config"]
    assert not any("photongi" in key for key in plain)
    assert (
        luxcore.describe(exact(glass_scene()), "LuxCore, bidirectional", 64)["config"][
            "renderengine.type"
        ]
        == "BIDIRCPU"
    )


def test_every_rival_is_described_or_left_out_with_a_reason() -> None:
    said = described(glass_scene())
    assert set(said) == set(RIVALS) == set(CHARTED)
    assert [method for method, what in said.items() if isinstance(what, str)] == [
        "Mitsuba, particle tracer"
    ]
    assert pickle.loads(pickle.dumps(said)).keys() == said.keys()
    assert set(described(replace(glass_scene(), world=(1.0, 1.0, 1.0))).values()) == {
        "the world shines"
    }
    sunny: Exact = exact(glass_scene(lamp(LightKind.SUN, 3.0, angle=0.01)))
    with pytest.raises(NoCounterpartError, match="sun"):
        luxcore.describe(sunny, "LuxCore", 64)


def test_rivals_get_fewer_seeds() -> None:
    assert len(seeds(3.0, 5, Method.SPLAT)) == 5
    assert len(seeds(3.0, 5, Method.MITSUBA)) == 2
    assert len(seeds(30.0, 5, Method.CYCLES)) == 1
