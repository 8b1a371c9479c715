"""The scene as plain numpy data: what the exporter writes and the native scene reads.

Lengths are in metres, colours in linear Rec. 709, angles in radians. Matrices are row-major 4x4
float64 that map column vectors of local coordinates to world coordinates. Nothing here knows
Blender.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, is_dataclass
from enum import IntFlag, StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .shading import InstanceAttribute, MeshShading, Program

Rgb = tuple[float, float, float]
NO_TEXTURE = -1
NO_PROGRAM = -1


class Interpolation(StrEnum):
    """How a texture is read between its pixels."""

    LINEAR = "linear"
    CLOSEST = "closest"
    CUBIC = "cubic"


class Extension(StrEnum):
    """How a texture continues outside the unit square."""

    REPEAT = "repeat"
    EXTEND = "extend"
    CLIP = "clip"
    MIRROR = "mirror"


@dataclass(slots=True)
class Texture:
    """An image: `pixels` (height, width, 4) uint8 or float32, RGBA, row 0 at v = 0 (bottom).

    `srgb` tells that the RGB of `pixels` is sRGB-encoded and is decoded when read; otherwise it is
    linear.
    """

    name: str
    pixels: NDArray
    srgb: bool = True
    interpolation: Interpolation = Interpolation.LINEAR
    extension: Extension = Extension.REPEAT


@dataclass(slots=True)
class Side:
    """One side of a surface: Lambertian reflectance and Lambertian emission.

    `base_color` is the diffuse albedo, multiplied by the texture's RGB if there is one; `emission`
    is the emitted radiance (W/m^2/sr), multiplied by its texture likewise. Texture indices point
    into `Scene.textures`.
    """

    base_color: Rgb = (0.8, 0.8, 0.8)
    base_color_texture: int = NO_TEXTURE
    emission: Rgb = (0.0, 0.0, 0.0)
    emission_texture: int = NO_TEXTURE


@dataclass(slots=True)
class Material:
    """A surface material; the two sides may differ (a Mix Shader driven by Geometry > Backfacing).

    `program`: index into Scene.programs; then the sides are not read.
    """

    name: str
    front: Side = field(default_factory=Side)
    back: Side = field(default_factory=Side)
    program: int = NO_PROGRAM


@dataclass(slots=True)
class Mesh:
    """A triangle mesh in its own coordinates, in memory once however often it is instanced.

    positions       (V, 3) float32
    triangles       (T, 3) uint32, indices into positions; counter-clockwise seen from the front
    corner_normals  (T, 3, 3) float32 unit shading normals per corner, or None
    vertex_normals  (V, 3) float32 instead, where all corners at a vertex have the same; neither:
    flat everywhere
    uv              (T, 3, 2) float32 of the render-active UV map, or None
    slots           (T,) uint16 material slot per triangle, or None: all 0

    shading         what shader programs read beyond that

    No NaN, no infinity, no triangle of zero area (the exporter drops those and says so).
    """

    name: str
    positions: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    corner_normals: NDArray[np.float32] | None = None
    uv: NDArray[np.float32] | None = None
    slots: NDArray[np.uint16] | None = None
    shading: MeshShading = field(default_factory=MeshShading)
    vertex_normals: NDArray[np.float32] | None = None

    def normals(self) -> NDArray[np.float32] | None:
        """(T, 3, 3) unit shading normals per corner, however they are kept, or None: flat
        everywhere.
        """
        return (
            self.corner_normals
            if self.vertex_normals is None
            else self.vertex_normals[self.triangles]
        )


@dataclass(slots=True)
class Instances:
    """Meshes placed in the world, as arrays over instances (I of them).

    mesh          (I,) uint32 index into Scene.meshes
    matrix        (I, 4, 4) float64 local to world; negative determinants (mirroring) are fine
    material_set  (I,) uint32 index into Scene.material_sets
    attributes    what shader programs read from instances
    group         (I,) uint8 in 0..63, of light linking; None: all 0
    lit_groups    (I,) uint64, bits of the groups that an instance lights if it shines; None: all
    blockers      (I,) uint64, bits of the groups that cast shadows in its light then; None: all
    light_group   (I,) int16 index into Scene.light_groups of its light, -1: none; None: all -1
    seen_by       (I,) uint32, the rays (`Ray`) that meet an instance; None: all rays meet all
    holdout       (I,) bool, a hole in the picture where the camera sees it; None: nowhere
    """

    mesh: NDArray[np.uint32]
    matrix: NDArray[np.float64]
    material_set: NDArray[np.uint32]
    attributes: list[InstanceAttribute] = field(default_factory=list)
    group: NDArray[np.uint8] | None = None
    lit_groups: NDArray[np.uint64] | None = None
    blockers: NDArray[np.uint64] | None = None
    light_group: NDArray[np.int16] | None = None
    seen_by: NDArray[np.uint32] | None = None
    holdout: NDArray[np.bool_] | None = None

    @classmethod
    def empty(cls) -> Instances:
        return cls(np.zeros(0, np.uint32), np.zeros((0, 4, 4)), np.zeros(0, np.uint32))


class Ray(IntFlag):
    """Kinds of ray, as bits; native code has the same order (RayInfo::Kind). Light samples come by
    shadow rays.
    """

    CAMERA = 1
    SHADOW = 2
    DIFFUSE = 4
    GLOSSY = 8
    TRANSMISSION = 16


ALL_RAYS = 0xFFFFFFFF
GROUPS = 64
NO_LIGHT_GROUP = -1
ALL_GROUPS = (1 << GROUPS) - 1


class LightKind(StrEnum):
    POINT = "point"
    SPOT = "spot"
    SUN = "sun"
    AREA = "area"


@dataclass(slots=True)
class Light:
    """A lamp. It shines along the local -Z axis of `matrix`, whose scale is honoured where Blender
    honours it.

    strength      RGB with colour, temperature, exposure, light-node strength and energy already
    multiplied in:
                  radiant power in W as Blender's light setting means it (point, spot, area),
                  irradiance in W/m^2 (sun)
    radius        m; point and spot
    soft_falloff  point and spot: the emitter is a disc that faces the receiver instead of a sphere
    spot_size     full cone angle; spot_blend in 0..1
    angle         full angular diameter of a sun
    size          (x, y) of an area light, m, in local coordinates; `ellipse`: inscribed ellipse
    instead of rectangle
    spread        full angle of an area light's emission; pi = Lambertian
    normalize     area, point, spot: `strength` is total power (True), or does not depend on the
    emitter's area (False)
    camera_visible  seen directly by camera rays
    program       index into Scene.programs: what it emits, per place and direction, is a factor of
    `strength`
    lit_groups    bits of the Instances.group that it lights
    blockers      bits of the Instances.group that cast shadows in its light
    light_group   index into Scene.light_groups; -1: none
    seen_by       the rays (`Ray`) that bring its light; what shadow rays bring is scattered as if
    by one of these
    max_bounces   of a path before it finds the lamp (photons count from the surface that they
    light); None: any
    met_by_rays   False: light samples find it, other rays do not
    casts_shadows False: nothing blocks its light samples
    """

    name: str
    kind: LightKind
    matrix: NDArray[np.float64]
    strength: Rgb
    radius: float = 0.0
    soft_falloff: bool = True
    spot_size: float = np.pi / 4
    spot_blend: float = 0.15
    angle: float = 0.0
    size: tuple[float, float] = (1.0, 1.0)
    ellipse: bool = False
    spread: float = np.pi
    normalize: bool = True
    camera_visible: bool = False
    program: int = NO_PROGRAM
    lit_groups: int = ALL_GROUPS
    blockers: int = ALL_GROUPS
    light_group: int = NO_LIGHT_GROUP
    seen_by: int = ALL_RAYS
    max_bounces: int | None = None
    met_by_rays: bool = True
    casts_shadows: bool = True


@dataclass(slots=True)
class WorldMap:
    """An image of the world. `to_lookup` (3, 4) maps a direction to that which is looked up;
    `mirror_ball`: the image shows the world mirrored in a ball, else it is equirectangular (u
    against the longitude, v from -Z up, its middle at +X).
    """

    texture: int
    to_lookup: NDArray[np.float64]
    mirror_ball: bool = False


@dataclass(slots=True)
class SunDisc:
    """The sun of a sky: radiance (W/m^2/sr) at its lower and upper edge before limb darkening,
    hidden below an elevation.
    """

    direction: tuple[float, float, float]
    half_angle: float
    bottom: Rgb
    top: Rgb
    horizon: float = -np.pi


class PixelFilter(StrEnum):
    BOX = "box"
    GAUSSIAN = "gaussian"
    BLACKMAN_HARRIS = "blackman_harris"


class PanoramaKind(StrEnum):
    EQUIRECTANGULAR = "equirectangular"
    EQUIANGULAR_CUBEMAP_FACE = "equiangular_cubemap_face"
    MIRRORBALL = "mirrorball"
    FISHEYE_EQUIDISTANT = "fisheye_equidistant"
    FISHEYE_EQUISOLID = "fisheye_equisolid"
    FISHEYE_LENS_POLYNOMIAL = "fisheye_lens_polynomial"
    CENTRAL_CYLINDRICAL = "central_cylindrical"


@dataclass(slots=True)
class Panorama:
    """A lens that maps the whole frame to directions; which fields count depends on `kind`. Angles
    in radians.

    longitude, latitude  (min, max), equirectangular
    fov                  full angle of a fisheye, beyond which nothing is seen
    focal_length         mm, equisolid
    sensor               mm, (width, height) of the whole frame, equisolid and polynomial
    polynomial           coefficients of the polynomial fisheye: -(angle to the axis) in powers of
    mm from the centre
    cylinder             (u min, u max, v min, v max): angles about the axis, and heights on a
    cylinder of radius 1
    """

    kind: PanoramaKind
    longitude: tuple[float, float] = (-np.pi, np.pi)
    latitude: tuple[float, float] = (-np.pi / 2, np.pi / 2)
    fov: float = np.pi
    focal_length: float = 10.5
    sensor: tuple[float, float] = (36.0, 36.0)
    polynomial: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    cylinder: tuple[float, float, float, float] = (-np.pi, np.pi, -1.0, 1.0)


@dataclass(slots=True)
class Aperture:
    """A lens of finite size: radius and distance of focus in m, blades (0: round) turned by
    `rotation`, height over width.
    """

    radius: float
    focus: float
    blades: int = 0
    rotation: float = 0.0
    ratio: float = 1.0


@dataclass(slots=True)
class Camera:
    """A camera that looks along its local -Z axis, +Y up (scale and shear of `matrix` already
    removed).

    `screen` is (left, right, bottom, top) of the whole frame: on the plane z = -1 for a perspective
    camera, in metres for an orthographic one; shift, sensor fit, lens and pixel aspect are already
    in it. Points nearer than `clip_start` or beyond `clip_end` (m, along the viewing axis; of a
    panorama: distance) are not seen. With a `panorama`, `screen` is in its coordinates: (0, 1, 0,
    1) unless the camera is shifted. Without `aperture` everything is sharp.
    """

    matrix: NDArray[np.float64]
    screen: tuple[float, float, float, float]
    orthographic: bool = False
    clip_start: float = 0.1
    clip_end: float = 1000.0
    panorama: Panorama | None = None
    aperture: Aperture | None = None


@dataclass(slots=True)
class Frame:
    """The raster: the whole frame in pixels and the part of it that is rendered (`border`: x, y,
    width, height, origin bottom left).
    """

    width: int
    height: int
    border: tuple[int, int, int, int] | None = None
    transparent: bool = False
    pixel_filter: PixelFilter = PixelFilter.BLACKMAN_HARRIS
    filter_width: float = 1.5

    @property
    def region(self) -> tuple[int, int, int, int]:
        return self.border or (0, 0, self.width, self.height)


@dataclass(slots=True)
class Scene:
    """Everything a render needs.

    `world` is the radiance (W/m^2/sr) seen where a ray leaves the scene: constant, or the factor of
    `world_map`; `sun_discs` come on top. `world_program`, an index into `programs`, stands in the
    place of both where it is given. `light_groups` are the names of those whose light gets passes
    of their own. `world_seen_by`: the rays that bring the world's light, as of a lamp.
    """

    camera: Camera
    frame: Frame
    meshes: list[Mesh] = field(default_factory=list)
    instances: Instances = field(default_factory=Instances.empty)
    material_sets: list[NDArray[np.int32]] = field(default_factory=list)
    materials: list[Material] = field(default_factory=list)
    textures: list[Texture] = field(default_factory=list)
    lights: list[Light] = field(default_factory=list)
    programs: list[Program] = field(default_factory=list)
    world: Rgb = (0.0, 0.0, 0.0)
    world_map: WorldMap | None = None
    sun_discs: list[SunDisc] = field(default_factory=list)
    world_program: int = NO_PROGRAM
    light_groups: list[str] = field(default_factory=list)
    world_light_group: int = NO_LIGHT_GROUP
    world_seen_by: int = ALL_RAYS
    warnings: list[str] = field(default_factory=list)


GEOMETRY = ("meshes", "instances", "material_sets")
VIEW = ("camera", "frame", "warnings")
SHADING = tuple(entry.name for entry in fields(Scene) if entry.name not in GEOMETRY + VIEW)


def same_geometry(a: Scene, b: Scene) -> bool:
    """Whether two scenes differ in materials, textures, lights and view at most."""
    return all(same(getattr(a, name), getattr(b, name)) for name in GEOMETRY)


def same_shading(a: Scene, b: Scene) -> bool:
    """Whether two scenes differ in geometry and view at most."""
    return all(same(getattr(a, name), getattr(b, name)) for name in SHADING)


def same(a: Any, b: Any) -> bool:
    """Whether two values of this module are equal, arrays included."""
    if a is b:
        return True
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return (
            isinstance(a, np.ndarray)
            and isinstance(b, np.ndarray)
            and a.dtype == b.dtype
            and np.array_equal(a, b)
        )
    if type(a) is not type(b):
        return False
    if is_dataclass(a):
        return all(same(getattr(a, entry.name), getattr(b, entry.name)) for entry in fields(a))
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    return bool(a == b)
