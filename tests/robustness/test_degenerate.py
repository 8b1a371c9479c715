"""Scenes and settings at the edge of sense: a correct picture or one clear sentence, never NaN,
infinity or a crash.
"""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator, RenderSettings
from photon_splat.core.scene import Instances, LightKind, Material, Mesh, Scene, Side, Texture

from tests.support import corescene as c

integrators = pytest.mark.parametrize("integrator", c.BOTH)
SMALL = {"passes": 4, "photons_per_pass": 2000}


def room(
    size: float = 1.0,
    centre: c.Point = (0.0, 0.0, 0.0),
    lights: list | None = None,
    *,
    pixels: int = 16,
    emission: float = 0.0,
) -> Scene:
    """A closed box of half width `size` about `centre`, a block in it, the camera inside, a small
    lamp near the ceiling.
    """
    x, y, z = centre
    eye = (x - 0.8 * size, y - 0.8 * size, z)
    view = c.perspective(eye, (x, y, z - 0.2 * size), pixels, pixels, 1.2)
    view[0].clip_start, view[0].clip_end = 1e-4 * size, 1e4 * size
    walls = c.box((x - size, y - size, z - size), (x + size, y + size, z + size), inwards=True)
    block = c.box((x, y, z - 0.999 * size), (x + 0.4 * size, y + 0.4 * size, z))
    things = [(walls, c.lambert(0.6, emission)), (block, c.lambert((0.7, 0.3, 0.2)))]
    if lights is None:
        lights = [
            c.lamp(
                LightKind.POINT,
                100.0 * size**2,
                (x - 0.2 * size, y + 0.1 * size, z + 0.8 * size),
                radius=0.05 * size,
            )
        ]
    return c.scene(view, things, lights)


def finite(
    what: Scene, integrator: Integrator = Integrator.SPLAT, **settings: object
) -> np.ndarray:
    """Render; every pass must be finite."""
    result = c.shoot(what, integrator, **(SMALL | settings))
    for name, values in result.passes.items():
        if name != "Depth":
            assert np.isfinite(values).all(), f"{name} is not finite"
        assert not np.isnan(values).any(), f"{name} has NaN"
    return result.passes["Combined"]


@integrators
def test_no_light_is_black(integrator: Integrator) -> None:
    picture = finite(room(lights=[]), integrator)
    assert not picture[..., :3].any()
    assert (picture[..., 3] == 1).all()


@integrators
def test_empty_scene_shows_the_world(integrator: Integrator) -> None:
    view = c.perspective((0, 0, 0), (1, 0, 0), 8, 8)
    assert finite(c.scene(view, [], world=0.7), integrator)[..., :3] == pytest.approx(0.7)
    assert not finite(c.scene(view, []), integrator)[..., :3].any()


@integrators
@pytest.mark.parametrize("kind", LightKind)
def test_lamp_without_power_is_black(integrator: Integrator, kind: LightKind) -> None:
    assert not finite(room(lights=[c.lamp(kind, 0.0, (0.0, 0.0, 0.5))]), integrator)[..., :3].any()


@integrators
def test_area_lamp_without_size_is_black(integrator: Integrator) -> None:
    for size in ((0.0, 0.0), (1.0, 0.0)):
        lamp = c.lamp(LightKind.AREA, 10.0, (0.0, 0.0, 0.5), size=size)
        assert not finite(room(lights=[lamp]), integrator)[..., :3].any(), size


@integrators
def test_sun_outside_of_a_closed_room(integrator: Integrator) -> None:
    """The room is closed, so no light gets in."""
    picture = finite(
        room(lights=[c.lamp(LightKind.SUN, 5.0, (0.0, 0.0, 9.0), angle=0.1)]), integrator
    )
    assert picture[..., :3].max() < 1e-6


@integrators
def test_lamp_on_a_surface(integrator: Integrator) -> None:
    finite(
        room(
            lights=[
                c.lamp(LightKind.POINT, 10.0, (0.0, 0.0, 1.0)),
                c.lamp(LightKind.POINT, 10.0, (0.2, 0.2, 0.0), radius=0.1),
            ]
        ),
        integrator,
    )
    finite(
        room(lights=[c.lamp(LightKind.AREA, 10.0, (0.0, 0.0, 1.0), size=(0.5, 0.5))]), integrator
    )


@integrators
def test_camera_inside_a_wall(integrator: Integrator) -> None:
    what = room()
    what.camera.matrix[:3, 3] = (1.0, 0.3, 0.3)
    finite(what, integrator)
    what.camera.matrix[:3, 3] = (0.2, 0.2, -0.5)
    finite(what, integrator)


@integrators
def test_one_pixel(integrator: Integrator) -> None:
    picture = finite(room(pixels=1), integrator, passes=16)
    assert picture.shape == (1, 1, 4)
    assert picture[..., :3].min() > 0


@pytest.mark.parametrize("photons", [0, 1, 2])
def test_few_photons(photons: int) -> None:
    few, direct = finite(room(), photons_per_pass=photons), finite(room(), max_bounces=0)
    assert few[..., :3].mean() >= 0.99 * direct[..., :3].mean()
    if photons == 0:
        assert few[..., :3] == pytest.approx(direct[..., :3], rel=1e-5)


def test_huge_picture_of_few_photons() -> None:
    """Most gather points catch no photon at all."""
    finite(room(pixels=400), passes=1, photons_per_pass=50)


@integrators
@pytest.mark.parametrize("scale", [1e-4, 1e-2, 1e3, 1e5])
def test_scale(integrator: Integrator, scale: float) -> None:
    """A scene scaled together with its lamps' power (by the square) is the same picture."""
    settings = {"passes": 32, "photons_per_pass": 10_000, "seed": 5}
    plain, scaled = (
        finite(room(), integrator, **settings),
        finite(room(scale), integrator, **settings),
    )
    assert scaled.mean() == pytest.approx(plain.mean(), rel=0.01)
    assert np.abs(scaled - plain).mean() < 0.03 * plain.mean()


@integrators
def test_far_from_the_origin(integrator: Integrator) -> None:
    """At 1 km from the origin a metre still has eight thousand float32 steps; the error that is
    left comes from rounded vertices.
    """
    settings = {"passes": 32, "photons_per_pass": 10_000, "seed": 5}
    plain, far = (
        finite(room(), integrator, **settings),
        finite(room(centre=(1e3, -2e3, 500.0)), integrator, **settings),
    )
    assert far.mean() == pytest.approx(plain.mean(), rel=0.02)


@integrators
def test_far_from_the_origin_by_matrix(integrator: Integrator) -> None:
    """Matrices are float64: instances, camera and lamp moved 100 km away together give the same
    picture.
    """
    settings = {"passes": 32, "photons_per_pass": 10_000, "seed": 5}
    plain = finite(room(), integrator, **settings)
    what = room()
    shift = np.array((1e5, -1e5, 5e4))
    what.instances.matrix[:, :3, 3] += shift
    what.camera.matrix[:3, 3] += shift
    what.lights[0].matrix[:3, 3] += shift
    far = finite(what, integrator, **settings)
    assert far.mean() == pytest.approx(plain.mean(), rel=0.01)
    assert np.abs(far - plain).mean() < 0.03 * plain.mean()


@integrators
def test_huge_coordinates_do_not_break_anything(integrator: Integrator) -> None:
    finite(room(1e15), integrator)
    finite(room(centre=(1e12, 0, 0)), integrator)


def _finite_or_refused(what: Scene, integrator: Integrator = Integrator.SPLAT) -> None:
    try:
        finite(what, integrator)
    except ValueError as refusal:
        message = str(refusal)
    else:
        return
    assert "finite" in message, message


@integrators
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_vertices_that_are_not_finite(integrator: Integrator, bad: float) -> None:
    """The exporter drops such vertices. The core must refuse them with one sentence, or leave them
    out, without other damage.
    """
    what = room()
    what.meshes[1].positions[2, 1] = bad
    _finite_or_refused(what, integrator)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_not_finite_elsewhere(bad: float) -> None:
    def spoil_light(what: Scene) -> None:
        what.lights[0].strength = (bad, 1.0, 1.0)

    def spoil_light_matrix(what: Scene) -> None:
        what.lights[0].matrix[0, 3] = bad

    def spoil_instance(what: Scene) -> None:
        what.instances.matrix[1, 0, 3] = bad

    def spoil_material(what: Scene) -> None:
        what.materials[1] = Material("bad", Side((bad, 0.5, 0.5)), Side())

    def spoil_emission(what: Scene) -> None:
        what.materials[1] = Material("bad", Side(emission=(bad, 0.5, 0.5)), Side())

    def spoil_camera(what: Scene) -> None:
        what.camera.matrix[0, 3] = bad

    def spoil_world(what: Scene) -> None:
        what.world = (bad, 0.0, 0.0)

    for spoil in (
        spoil_light,
        spoil_light_matrix,
        spoil_instance,
        spoil_material,
        spoil_emission,
        spoil_camera,
        spoil_world,
    ):
        what = room()
        spoil(what)
        _finite_or_refused(what)


@integrators
def test_texture_with_nan_never_reaches_the_film(integrator: Integrator) -> None:
    pixels = np.full((4, 4, 4), 0.5, np.float32)
    pixels[1, 2, 0] = np.nan
    pixels[2, 1, 1] = np.inf
    what = room()
    count = len(what.meshes[0].triangles)
    what.meshes[0].uv = np.tile(np.array([(0, 0), (1, 0), (1, 1)], np.float32), (count, 1, 1))
    what.textures = [Texture("bad", pixels, srgb=False)]
    what.materials[0] = Material("textured", Side(base_color_texture=0), Side(base_color_texture=0))
    finite(what, integrator)


@integrators
def test_slivers_and_degenerate_triangles(integrator: Integrator) -> None:
    what = room()
    sliver = c.mesh(
        [
            (0, 0, 0.2),
            (0.5, 0, 0.2),
            (0.25, 1e-9, 0.2),
            (0.1, 0.1, 0.3),
            (0.1, 0.1, 0.3),
            (0.2, 0.1, 0.3),
        ],
        [(0, 1, 2), (3, 4, 5)],
    )
    what.meshes[1] = sliver
    finite(what, integrator)


@integrators
def test_mirrored_and_flattened_instances(integrator: Integrator) -> None:
    what = room()
    what.instances = Instances(
        np.array([0, 1, 1], np.uint32),
        np.stack([np.eye(4), np.diag((-1.0, 1, 1, 1)), np.diag((1.0, 1, 0, 1))]),
        np.array([0, 1, 1], np.uint32),
    )
    finite(what, integrator)


@integrators
def test_thousands_of_lamps(integrator: Integrator) -> None:
    rng = np.random.default_rng(1)
    lights = [c.lamp(LightKind.POINT, 0.01, rng.uniform(-0.9, 0.9, 3)) for _ in range(5000)]
    assert finite(room(lights=lights), integrator)[..., :3].mean() > 0


def test_albedo_of_one_ends() -> None:
    what = room()
    what.materials = [c.lambert(1.0), c.lambert(1.0)]
    finite(what, max_bounces=1000)


def test_a_lamp_of_immense_power_stays_finite() -> None:
    finite(room(lights=[c.lamp(LightKind.POINT, 1e30, (0.0, 0.0, 0.5))]))


def test_sheets_thinner_than_a_kernel_do_not_leak() -> None:
    """A lit room over a dark one, 2 mm of plate between them."""
    view = c.perspective((-0.8, -0.8, -0.5), (0.3, 0.3, -0.3), 24, 24, 1.2)
    upper = c.box((-1, -1, 0.001), (1, 1, 1), inwards=True)
    lower = c.box((-1, -1, -1), (1, 1, -0.001), inwards=True)
    lamp = c.lamp(LightKind.POINT, 100.0, (0.0, 0.0, 0.5))
    picture = finite(
        c.scene(view, [(upper, c.lambert(0.7)), (lower, c.lambert(0.7))], [lamp]),
        passes=16,
        photons_per_pass=20_000,
    )
    assert not picture[..., :3].any()


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("passes", 0),
        ("photons_per_pass", -1),
        ("max_bounces", -1),
        ("radius_scale", 0.0),
        ("radius_scale", np.nan),
        ("threads", -1),
        ("time_limit", -1.0),
        ("time_limit", np.nan),
        ("final_gather", "SOMETIMES"),
        ("backend", "TPU"),
        ("integrator", "bidirectional"),
    ],
)
def test_settings_that_make_no_sense_are_named(setting: str, value: float | str) -> None:
    with pytest.raises(ValueError, match=setting):
        RenderSettings(**{setting: value})


@pytest.mark.parametrize(
    "spoil", ["mesh index", "material set", "material", "triangle", "texture", "uv shape"]
)
def test_indices_out_of_range_are_refused(spoil: str) -> None:
    what = room()
    if spoil == "mesh index":
        what.instances.mesh[1] = 9
    elif spoil == "material set":
        what.instances.material_set[1] = 9
    elif spoil == "material":
        what.material_sets[1] = np.array([7], np.int32)
    elif spoil == "triangle":
        what.meshes[1].triangles[0, 0] = 1000
    elif spoil == "texture":
        what.materials[1] = Material("textured", Side(base_color_texture=3), Side())
    else:
        what.meshes[1].uv = np.zeros((2, 3, 2), np.float32)
    with pytest.raises((ValueError, TypeError, IndexError)):
        c.shoot(what, **SMALL)


def test_a_mesh_without_triangles() -> None:
    what = room()
    what.meshes[1] = Mesh("nothing", np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32))
    assert finite(what)[..., :3].mean() > 0


def test_transparent_film_has_no_sky() -> None:
    view = c.perspective((0, 0, 3), (0, 0, 0), 16, 16, 1.2)
    view[1].transparent = True
    picture = finite(c.scene(view, [(c.quad(0.5), c.lambert(0.5))], world=1.0), passes=64)
    assert picture[0, 0] == pytest.approx(0.0, abs=1e-6)
    assert picture[8, 8, 3] == pytest.approx(1.0)
    assert picture[8, 8, :3] == pytest.approx(0.5, rel=0.05)


def test_units_of_the_camera_visible_lamp() -> None:
    """An area lamp of 1 m^2 and pi W that the camera may see has radiance 1; what is behind it
    shines through.
    """
    lamp = c.lamp(LightKind.AREA, pi, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), camera_visible=True)
    view = c.perspective((0, 0, 2), (0, 0, 0), 8, 8, 0.2)
    assert finite(c.scene(view, [], [lamp]))[..., :3] == pytest.approx(1.0, rel=1e-4)
    assert finite(c.scene(view, [], [lamp], world=0.5))[..., :3] == pytest.approx(1.5, rel=1e-4)
