"""The one table of pictures that Cycles and Photon Splat must agree on. Read by references.py,
worker.py and the tests.

`build` names the function of stage.py that makes the scene, `options` are its arguments. Sizes are
in pixels, `samples` those of each of the two Cycles halves. `mean_tolerance` is for the whole
picture's mean; `block_bias` the relative bias that an 8x8 block of the splat may show beside its
noise (the kernel's: it blurs indirect light within a patch).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import radians
from typing import Any

TEXTURED = ("kitchen", "perfume", "street")  # as artists make them
SCENES = (
    "cornell_box",
    "cornell_box_1500",
    "cornell_box_100k",
    "interior",
    "light_types",
    "instances",
    *TEXTURED,
)


@dataclass(frozen=True)
class Case:
    name: str
    build: str
    options: dict[str, Any] = field(default_factory=dict)
    width: int = 48
    height: int = 48
    samples: int = 1024
    mean_tolerance: float = 0.02
    photons_less: float = 0.0  # that splatting alone may be off by on top of that
    block_bias: float = 0.02
    reference_bias: float = 0.003
    reference: str = ""  # the case whose Cycles reference this one shares
    alpha: bool = False
    # False: only the path tracer is compared, as all that is new lies before the first hit
    splat: bool = True
    # False: Cycles finds lights by scattered rays alone, see references.py
    light_samples: bool = True
    render_pass: str = ""  # this one is compared instead of Combined
    passes: int = 32
    photons_per_pass: int = 20_000
    reference_passes: int = 256  # of each of the path tracer's two pictures


def _scene(name: str, width: int, height: int, samples: int, **more: Any) -> Case:
    return Case(
        name,
        "open_scene",
        {"name": name},
        width,
        height,
        samples,
        mean_tolerance=0.01,
        reference_passes=96,
        **more,
    )


def _textured(name: str, width: int, height: int, samples: int) -> Case:
    return Case(
        name,
        "open_scene",
        {"name": name},
        width,
        height,
        samples,
        block_bias=0.06,
        reference_bias=0.01,
        photons_per_pass=60_000,
        reference_passes=2000,  # a few paths bring much of their light
    )


def _lamp(name: str, kind: str, energy: float, **options: Any) -> Case:
    return Case(name, "lamp_on_stage", {"kind": kind, "energy": energy, **options})


def _geometry(name: str, **options: Any) -> Case:
    return Case(name, name, options)


def _focus(name: str, *, splat: bool = False, **options: Any) -> Case:
    return Case(name, "depth_of_field", options, splat=splat)


def _world(name: str, build: str, *, splat: bool = False, **options: Any) -> Case:
    return Case(name, build, options, splat=splat)


def _fog(name: str, build: str = "fog", **options: Any) -> Case:
    return Case(name, build, options, samples=512)


PANORAMAS = (
    "EQUIRECTANGULAR",
    "EQUIANGULAR_CUBEMAP_FACE",
    "MIRRORBALL",
    "FISHEYE_EQUIDISTANT",
    "FISHEYE_EQUISOLID",
    "FISHEYE_LENS_POLYNOMIAL",
    "CENTRAL_CYLINDRICAL",
)


def _panorama(
    name: str, width: int = 48, height: int = 48, *, splat: bool = False, **options: Any
) -> Case:
    """A panorama of the kind that `name` begins with, its alpha compared too."""
    kind = next(kind for kind in PANORAMAS if name.upper().startswith(kind))
    return Case(name, "panorama", {"kind": kind, **options}, width, height, alpha=True, splat=splat)


_WIDE = {"spot_size": radians(70.0)}
_LOW = {"location": (0.3, -0.3, 0.9)}
_SLANT = (0.9, -0.5, 2.0)

CASES: tuple[Case, ...] = (
    # Participating media
    _fog("fog_thin", Density=0.2),
    _fog("fog_dense", Density=1.5, Color=(0.9, 0.7, 0.4)),
    _fog("fog_dense_area", lamp="area", Density=1.5, Color=(0.9, 0.7, 0.4)),
    _fog("fog_spot", lamp="spot", Density=0.4),
    _fog("fog_sun", lamp="sun", Density=0.4),
    _fog("fog_sky", lamp="world", Density=0.6),
    _fog("fog_forward", Density=0.6, Anisotropy=0.8),
    _fog("fog_backward", Density=0.6, Anisotropy=-0.5),
    _fog("fog_absorption", node="absorption", Density=0.8, Color=(0.9, 0.5, 0.2)),
    _fog("fog_coloured_light", lamp="area", Density=1.0, Color=(0.2, 0.5, 0.9)),
    _fog("fog_rayleigh", phase="RAYLEIGH", Density=0.6),
    _fog("fog_draine", phase="DRAINE", Density=0.6, Anisotropy=0.5, Alpha=2.0),
    _fog("fog_fournier", phase="FOURNIER_FORAND", Density=0.6, IOR=1.33, Backscatter=0.1),
    _fog("fog_mie_tiny", phase="MIE", Density=0.6, Diameter=0.05),
    _fog("fog_mie_small", lamp="world", phase="MIE", Density=0.6, Diameter=1.0),
    _fog("fog_mie_drops", lamp="world", phase="MIE", Density=0.6, Diameter=4.0),
    _fog("fog_principled", node="principled", Density=0.8, Color=(0.6, 0.4, 0.2)),
    _fog(
        "fog_principled_absorbs",
        node="principled",
        Density=0.8,
        Absorption_Color=(0.8, 0.4, 0.1),
    ),
    _fog(
        "fog_principled_shines",
        node="principled",
        box="cloud",
        Density=0.8,
        Emission_Strength=0.5,
        Emission_Color=(1.0, 0.5, 0.2),
    ),
    _fog(
        "fog_black_body",
        node="principled",
        box="cloud",
        Density=0.8,
        Blackbody_Intensity=1.0,
        Temperature=2200.0,
        Blackbody_Tint=(1.0, 0.8, 0.6),
    ),
    _fog(
        "fog_black_body_twice",
        node="principled",
        box="cloud",
        Density=0.8,
        Blackbody_Intensity=2.0,
        Temperature=2000.0,
    ),
    _fog("fog_emission", node="emission", box="cloud", Strength=0.5, Color=(0.5, 0.8, 1.0)),
    _fog(
        "fog_coefficients",
        node="coefficients",
        Scatter_Coefficients=(0.5, 0.3, 0.2),
        Absorption_Coefficients=(0.1, 0.3, 0.6),
        Emission_Coefficients=(0.01, 0.02, 0.05),
        Anisotropy=0.3,
    ),
    _fog("fog_cloud", box="cloud", lamp="area", Density=8.0),
    _fog("fog_cloud_varies", box="cloud", lamp="area", varies=True, Density=12.0),
    _fog("fog_cloud_sun", box="cloud", lamp="sun", varies=True, Density=12.0),
    _fog("fog_varies", varies=True, Density=1.5),
    _fog("fog_in_glass", box="cloud", lamp="world", surface="glass", Density=3.0),
    _fog("fog_unseen_diffuse", unseen=("diffuse",), Density=0.6),
    _fog("fog_camera_inside", "fog_camera_inside", Density=0.3),
    _fog("fog_world", "fog_world", Density=0.15),
    _fog("fog_world_spot", "fog_world", lamp="spot", Density=0.15),
    _fog("fog_overlapping", "fog_overlapping"),
    _fog("fog_in_instances", "fog_in_instances"),
    # Volume grids
    _fog("grid_cloud", "grid_cloud"),
    _fog("grid_cloud_sun", "grid_cloud", lamp="sun", Density=20.0, Anisotropy=0.5),
    _fog("grid_cloud_fine", "grid_cloud", count=100),
    _fog(
        "grid_cloud_turned",
        "grid_cloud",
        placed={"scale": (1.4, 0.7, 0.9), "rotation_euler": (0.5, 0.3, 0.8)},
    ),
    _fog("grid_cloud_world", "grid_cloud", space="WORLD", placed={"scale": (1.5, 1.2, 0.6)}),
    _fog("grid_cloud_cubic", "grid_cloud", interpolation="CUBIC", count=10),
    _fog("grid_cloud_coarse", "grid_cloud", count=10),
    _fog("grid_color", "grid_color"),
    _fog("grid_fire", "grid_fire"),
    _fog("grid_attribute", "grid_attribute"),
    _fog("grid_info", "grid_info"),
    _fog("grid_bounds", "grid_bounds"),
    _fog("grid_camera_inside", "grid_camera_inside"),
    _fog("grid_instances", "grid_instances"),
    _fog("grid_in_fog", "grid_in_fog"),
    _fog("grid_mesh_to_volume", "grid_mesh_to_volume"),
    _fog("grid_volume_cube", "grid_volume_cube"),
    # Scenes of blend_scenes/
    _scene("cornell_box", 128, 128, 1024, block_bias=0.04),
    _scene("cornell_box_1500", 128, 128, 0, reference="cornell_box", block_bias=0.04),
    _scene("cornell_box_100k", 128, 128, 0, reference="cornell_box", block_bias=0.04),
    _scene("interior", 128, 80, 2500, block_bias=0.05, photons_per_pass=60_000),
    _scene("light_types", 128, 48, 4096, photons_per_pass=60_000),
    _scene("instances", 128, 72, 512, block_bias=0.05),
    _textured("kitchen", 72, 48, 1024),
    _textured("perfume", 80, 96, 4096),
    _textured("street", 72, 48, 1024),
    # Point lights
    _lamp("point", "POINT", 40.0, shadow_soft_size=0.0),
    _lamp("point_soft", "POINT", 40.0, shadow_soft_size=0.25),
    _lamp("point_sphere", "POINT", 40.0, shadow_soft_size=0.25, use_soft_falloff=False),
    _lamp("point_soft_large", "POINT", 20.0, shadow_soft_size=0.8, **_LOW),
    Case("lamp_in_ball", "lamp_in_ball", samples=32768, splat=False, reference_passes=4096),
    _lamp(
        "point_sphere_cuts_floor",
        "POINT",
        20.0,
        shadow_soft_size=1.0,
        use_soft_falloff=False,
        location=(0.3, -0.3, 0.7),
    ),
    _lamp("point_not_normalized", "POINT", 20.0, shadow_soft_size=0.3, normalize=False),
    _lamp("point_object_scaled", "POINT", 40.0, shadow_soft_size=0.25, scale=(2.0, 2.0, 2.0)),
    # Spots
    _lamp("spot_blend_0", "SPOT", 100.0, shadow_soft_size=0.0, spot_blend=0.0, **_WIDE),
    _lamp("spot_blend_015", "SPOT", 100.0, shadow_soft_size=0.0, spot_blend=0.15, **_WIDE),
    _lamp("spot_blend_1", "SPOT", 100.0, shadow_soft_size=0.0, spot_blend=1.0, **_WIDE),
    _lamp("spot_soft", "SPOT", 100.0, shadow_soft_size=0.3, spot_blend=0.3, **_WIDE),
    _lamp(
        "spot_sphere",
        "SPOT",
        100.0,
        shadow_soft_size=0.3,
        spot_blend=0.3,
        use_soft_falloff=False,
        **_WIDE,
    ),
    _lamp(
        "spot_wide", "SPOT", 60.0, shadow_soft_size=0.0, spot_size=radians(165.0), spot_blend=0.5
    ),
    _lamp(
        "spot_scaled",
        "SPOT",
        100.0,
        shadow_soft_size=0.0,
        spot_blend=0.3,
        scale=(2.0, 0.7, 1.0),
        **_WIDE,
    ),
    # Suns
    _lamp("sun_0", "SUN", 3.0, angle=0.0, aim=_SLANT),
    _lamp("sun_half_degree", "SUN", 3.0, angle=radians(0.526), aim=_SLANT),
    _lamp("sun_10", "SUN", 3.0, angle=radians(10.0), aim=_SLANT),
    _lamp("sun_60", "SUN", 3.0, angle=radians(60.0), aim=_SLANT),
    _lamp("sun_150", "SUN", 3.0, angle=radians(150.0), aim=_SLANT),
    _lamp("sun_not_normalized", "SUN", 3.0, angle=radians(60.0), normalize=False, aim=_SLANT),
    # Area lights
    _lamp("area_square", "AREA", 30.0, shape="SQUARE", size=0.8),
    _lamp("area_rectangle", "AREA", 30.0, shape="RECTANGLE", size=1.2, size_y=0.3),
    _lamp("area_disk", "AREA", 30.0, shape="DISK", size=0.8),
    _lamp("area_ellipse", "AREA", 30.0, shape="ELLIPSE", size=1.2, size_y=0.4),
    _lamp(
        "area_tilted", "AREA", 30.0, shape="RECTANGLE", size=1.2, size_y=0.4, aim=(0.6, 0.5, 0.0)
    ),
    _lamp(
        "area_spread_90",
        "AREA",
        20.0,
        shape="RECTANGLE",
        size=1.0,
        size_y=0.6,
        spread=radians(90.0),
    ),
    _lamp("area_spread_30", "AREA", 15.0, shape="DISK", size=1.0, spread=radians(30.0)),
    _lamp("area_spread_5", "AREA", 10.0, shape="SQUARE", size=1.0, spread=radians(5.0)),
    _lamp("area_spread_0", "AREA", 10.0, shape="SQUARE", size=1.0, spread=0.0),
    _lamp("area_scaled", "AREA", 30.0, shape="SQUARE", size=0.4, scale=(3.0, 1.0, 2.0)),
    _lamp(
        "area_mirrored",
        "AREA",
        30.0,
        shape="RECTANGLE",
        size=1.0,
        size_y=0.3,
        scale=(-1.0, 1.0, 1.0),
        aim=(0.6, 0.5, 0.0),
    ),
    _lamp(
        "area_upwards",
        "AREA",
        30.0,
        shape="SQUARE",
        size=0.6,
        scale=(1.0, 1.0, -1.0),
        aim=(0.3, 4.0, 1.6),
    ),
    _lamp("area_not_normalized", "AREA", 20.0, shape="DISK", size=0.5, normalize=False),
    _lamp(
        "area_seen",
        "AREA",
        30.0,
        shape="SQUARE",
        size=0.8,
        visible_camera=True,
        location=(0.3, 0.6, 1.2),
        aim=(0.0, -4.0, 2.0),
    ),
    # What every lamp has
    _lamp("exposure", "POINT", 10.0, shadow_soft_size=0.1, exposure=1.5),
    _lamp(
        "temperature",
        "POINT",
        30.0,
        shadow_soft_size=0.1,
        use_temperature=True,
        temperature=3000.0,
        color=(0.6, 0.9, 1.0),
    ),
    _lamp(
        "light_nodes",
        "AREA",
        10.0,
        shape="SQUARE",
        size=0.5,
        emission=((0.4, 1.0, 0.6), 3.0),
        color=(1.0, 0.7, 0.5),
    ),
    _geometry("many_lamps"),
    _geometry("instanced_lamp"),
    _geometry("linked_lamps"),
    Case("linked_shadows", "linked_shadows", samples=4096),
    *(
        Case(f"light_group_{name}", "light_groups", samples=4096, render_pass=f"Combined_{name}")
        for name in ("key", "glow", "sky")
    ),
    # World and emissive meshes
    _geometry("world", color=(0.5, 0.7, 1.0), strength=1.5),
    Case("environment", "environment", passes=48, photons_per_pass=40_000),
    Case("environment_no_spot", "environment", {"spot": 1.0}),
    _world("environment_turned", "environment", rotation=(0.3, -0.2, 1.0)),
    _world(
        "environment_texture_mapping",
        "environment",
        rotation=(0.3, -0.2, 1.0),
        mapping="TEXTURE",
        location=(0.1, 0.2, -0.1),
    ),
    _world(
        "environment_vector_mapping",
        "environment",
        rotation=(0.0, 0.0, 2.0),
        mapping="VECTOR",
        scale=(1.0, 2.0, -1.0),
    ),
    _world(
        "environment_point_mapping",
        "environment",
        rotation=(0.0, 0.5, 2.0),
        location=(0.3, 0.0, 0.2),
        coordinates="Object",
    ),
    _world("environment_mirror_ball", "environment", projection="MIRROR_BALL", spot=5.0),
    _world("environment_and_lamp", "environment", lamp=True, splat=True),
    Case(
        "sky_single",
        "sky",
        {"kind": "SINGLE_SCATTERING", "sun_elevation": 0.6, "sun_rotation": 2.5},
        passes=48,
        photons_per_pass=40_000,
    ),
    _world(
        "sky_single_low",
        "sky",
        kind="SINGLE_SCATTERING",
        sun_elevation=0.1,
        sun_rotation=-2.0,
        altitude=0.0,
        seen=6.0,
    ),
    _world(
        "sky_single_night",
        "sky",
        kind="SINGLE_SCATTERING",
        sun_elevation=-0.04,
        sun_rotation=4.0,
        strength=1.0,
    ),
    _world(
        "sky_single_dusty",
        "sky",
        kind="SINGLE_SCATTERING",
        sun_elevation=0.8,
        sun_rotation=2.5,
        aerosol_density=5.0,
        air_density=2.0,
        ozone_density=4.0,
        altitude=2000.0,
    ),
    _world(
        "sky_single_no_sun",
        "sky",
        kind="SINGLE_SCATTERING",
        sun_elevation=0.6,
        sun_disc=False,
        seen=6.0,
    ),
    _world(
        "sky_multiple",
        "sky",
        kind="MULTIPLE_SCATTERING",
        sun_elevation=0.6,
        sun_rotation=2.5,
        splat=True,
    ),
    _world(
        "sky_multiple_low",
        "sky",
        kind="MULTIPLE_SCATTERING",
        sun_elevation=0.02,
        sun_rotation=3.3,
        seen=1.6,
        altitude=300.0,
    ),
    _world(
        "sky_multiple_night",
        "sky",
        kind="MULTIPLE_SCATTERING",
        sun_elevation=-0.1,
        sun_rotation=4.0,
        strength=1.0,
        seen=1.6,
    ),
    _world(
        "sky_multiple_wide_sun",
        "sky",
        kind="MULTIPLE_SCATTERING",
        sun_elevation=1.0,
        sun_rotation=2.2,
        sun_size=0.4,
        sun_intensity=0.5,
    ),
    _world(
        "sky_multiple_over_the_top",
        "sky",
        kind="MULTIPLE_SCATTERING",
        sun_elevation=2.4,
        sun_rotation=0.5,
        sun_size=0.05,
    ),
    _world(
        "sky_preetham",
        "sky",
        kind="PREETHAM",
        sun_direction=(0.4, -0.6, 0.5),
        turbidity=3.5,
        seen=1.6,
    ),
    _world(
        "sky_preetham_night",
        "sky",
        kind="PREETHAM",
        sun_direction=(0.4, -0.6, -0.1),
        turbidity=3.5,
        seen=1.6,
    ),
    _world("sky_hosek", "sky", kind="HOSEK_WILKIE", sun_direction=(0.4, -0.6, 0.5), seen=1.6),
    _world(
        "sky_hosek_hazy",
        "sky",
        kind="HOSEK_WILKIE",
        sun_direction=(-0.5, 0.8, 0.1),
        turbidity=7.3,
        ground_albedo=0.8,
        seen=1.6,
        splat=True,
    ),
    _world(
        "sky_hosek_night",
        "sky",
        kind="HOSEK_WILKIE",
        sun_direction=(-0.5, 0.8, -0.2),
        turbidity=10.0,
        seen=1.6,
    ),
    # Cycles draws from a world as no ray sees it, and mixes that with what rays see: its rays alone
    # are compared.
    *(
        Case(
            f"world_by_{name}_ray",
            "world_by_ray",
            {"output": f"Is {name.title()} Ray"},
            light_samples=False,
            passes=48,
        )
        for name in ("camera", "diffuse", "glossy", "transmission")
    ),
    *(
        Case(
            f"world_by_{output.lower().replace(' ', '_')}",
            "world_by_ray",
            {"output": output, "above": above, "lamp": lamp},
            light_samples=False,
        )
        for output, above, lamp in (("Ray Depth", 2.5, False), ("Diffuse Depth", 1.5, True))
    ),
    _geometry("volume_without_surface"),
    _geometry("outputs_for_both"),
    _geometry("emissive_mesh"),
    _geometry("emissive_front_only"),
    _geometry("emissive_texture"),
    # Surfaces
    _geometry("smooth_sphere"),
    _geometry("textured_plane", interpolation="Linear", extension="REPEAT"),
    Case(
        "texture_closest_clip", "textured_plane", {"interpolation": "Closest", "extension": "CLIP"}
    ),
    Case("texture_mirror", "textured_plane", {"interpolation": "Linear", "extension": "MIRROR"}),
    Case(
        "texture_extend_float",
        "textured_plane",
        {"interpolation": "Linear", "extension": "EXTEND", "float_pixels": True},
    ),
    _geometry("mirrored_object"),
    _geometry("several_materials"),
    _geometry("curve_and_text"),
    # Things far away, lamps at surfaces, glass that bends nothing
    Case("far_box_sun", "far_thing", {"kind": "box", "light": "sun"}, photons_per_pass=60_000),
    Case("far_vertex", "far_thing", {"kind": "vertex", "distance": 1e9}),
    Case(
        "far_dome",
        "far_thing",
        {"kind": "bright_dome", "light": "", "distance": 1e4},
        photons_per_pass=60_000,
    ),
    Case("lamp_at_ceiling", "lamp_in_plane", {"offset": 1e-6}),
    Case("lamp_behind_ceiling", "lamp_in_plane", {"offset": 0.01, "behind": 1e-5}),
    Case("clear_pane", "clear_glass", {"kind": "pane"}, samples=2048),
    Case(
        "clear_rough_ball",
        "clear_glass",
        {"kind": "sphere", "node": "principled", "ior": 1.001},
        samples=2048,
    ),
    # Camera and frame
    Case("ortho", "camera_variant", {"kind": "ORTHO"}),
    Case("shift", "camera_variant", {"shift": (0.2, -0.15)}),
    Case("sensor_vertical", "camera_variant", {"sensor_fit": "VERTICAL"}, width=64, height=40),
    Case("tall_frame", "camera_variant", {}, width=40, height=64),
    Case("pixel_aspect", "camera_variant", {"aspect": (1.0, 1.6)}),
    Case("scaled_camera", "camera_variant", {"scale": (2.0, 0.5, 3.0)}),
    Case("clipping", "camera_variant", {"clip": (4.2, 5.6)}),
    Case(
        "border",
        "camera_variant",
        {"border": (0.2, 0.7, 0.3, 0.85), "crop": False},
        width=80,
        height=64,
    ),
    Case(
        "border_crop",
        "camera_variant",
        {"border": (0.2, 0.7, 0.3, 0.85), "crop": True, "shift": (0.1, 0.0)},
        width=80,
        height=64,
    ),
    Case("percentage", "camera_variant", {"percentage": 50}, width=96, height=80),
    Case("film_transparent", "camera_variant", {"transparent": True}, alpha=True),
    Case("wide_pixel_filter", "camera_variant", {"filter_width": 3.0}),
    # Lenses
    _focus("dof", splat=True),
    _focus("dof_blades", blades=5, rotation=0.35, fstop=0.06),
    _focus("dof_ratio", ratio=2.0, blades=3, fstop=0.06),
    _focus("dof_squeezed", ratio=0.6, fstop=0.06),
    _focus("dof_near", distance=2.9, clip_start=2.2),
    _focus("dof_object", target=(0.45, -1.6, 0.75), fstop=0.08),
    _focus("dof_ortho", kind="ORTHO", fstop=2.5, blades=4, rotation=0.2),
    _focus("dof_ortho_clip", kind="ORTHO", fstop=1.5, clip_start=2.0, distance=2.5),
    _focus("dof_ortho_end", kind="ORTHO", fstop=0.5, clip_start=0.5, clip_end=4.6, distance=2.5),
    _focus("dof_clips", fstop=0.02, distance=2.9, clip_start=2.2, clip_end=4.6),
    _panorama("equirectangular", width=64, height=32, splat=True),
    _panorama(
        "equirectangular_limits",
        longitude_min=-1.2,
        longitude_max=2.0,
        latitude_min=-1.0,
        latitude_max=0.6,
    ),
    _panorama("equirectangular_shift", shift=(0.2, 0.1), aspect=(1.0, 1.5), scale=(2.0, 0.5, 3.0)),
    _panorama(
        "equirectangular_dof",
        dof={"focus_distance": 1.0, "aperture_fstop": 0.3, "aperture_blades": 3},
    ),
    _panorama("equiangular_cubemap_face"),
    _panorama("mirrorball"),
    _panorama(
        "mirrorball_dof",
        dof={
            "focus_distance": 1.0,
            "aperture_fstop": 0.3,
            "aperture_ratio": 2.0,
            "aperture_blades": 3,
        },
    ),
    _panorama("fisheye_equidistant", splat=True),
    _panorama("fisheye_equidistant_wide", width=64, height=40, fisheye_fov=radians(240.0)),
    _panorama(
        "fisheye_equidistant_dof",
        dof={"focus_distance": 1.5, "aperture_fstop": 0.3, "aperture_blades": 4},
    ),
    _panorama("fisheye_equisolid", sensor_width=36.0),
    _panorama(
        "fisheye_equisolid_wide", width=64, height=40, fisheye_lens=8.0, fisheye_fov=radians(200.0)
    ),
    _panorama(
        "fisheye_equisolid_vertical",
        width=64,
        height=40,
        sensor_fit="VERTICAL",
        sensor_height=20.0,
        aspect=(1.0, 1.4),
    ),
    _panorama("fisheye_equisolid_shift", shift=(0.15, -0.1)),
    _panorama("fisheye_lens_polynomial", sensor_width=60.0),
    _panorama(
        "fisheye_lens_polynomial_cut",
        width=40,
        height=64,
        sensor_width=100.0,
        fisheye_fov=radians(100.0),
    ),
    _panorama("central_cylindrical"),
    _panorama(
        "central_cylindrical_limits",
        central_cylindrical_range_u_min=-1.0,
        central_cylindrical_range_u_max=2.0,
        central_cylindrical_range_v_min=-0.8,
        central_cylindrical_range_v_max=1.5,
        central_cylindrical_radius=2.0,
    ),
)

SPLAT_CASES = tuple(case for case in CASES if case.splat)
NAMES = tuple(case.name for case in CASES)
CASE = {case.name: case for case in CASES}
