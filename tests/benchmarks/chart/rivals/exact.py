"""Our exported scene as what other renderers can say exactly, or the reason why they cannot.

Diffuse, smooth glass and mirrors; surfaces that shine from their front; rectangular lamps and suns;
a perspective pinhole camera.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from photon_splat.core.scene import Light, Material, Mesh, Program, Scene

Rgb = tuple[float, float, float]
Array = np.ndarray
SUN_DISTANCE = 1e5
"""m: parallax over a metre is then a thousandth of the sun's radius."""


class NoCounterpartError(ValueError):
    """Says what of a scene cannot be had exactly."""


@dataclass(frozen=True)
class Surface:
    """kind: "diffuse", "glass" or "mirror"; `emission`: radiance of the front, W/m^2/sr."""

    kind: str
    color: Rgb
    ior: float = 1.0
    emission: Rgb = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Part:
    """Triangles (T, 3) counter-clockwise from the front; positions and normals (V, 3) float32 in
    world space, normals None: flat.
    """

    name: str
    positions: Array
    triangles: Array
    normals: Array | None
    surface: Surface


@dataclass(frozen=True)
class Sun:
    """`towards`: unit vector to it; `radiance` in W/m^2/sr over a disc of `half_angle` radians."""

    towards: Rgb
    half_angle: float
    radiance: Rgb


@dataclass(frozen=True)
class View:
    """matrix (4, 4): camera to world, looks along -Z; screen: (left, right, bottom, top) at z = -1;
    filter: of Blackman and Harris, its half width in pixels.
    """

    matrix: Array
    screen: tuple[float, float, float, float]
    width: int
    height: int
    filter_radius: float


@dataclass(frozen=True)
class Exact:
    parts: list[Part]
    suns: list[Sun]
    view: View


def exact(scene: Scene) -> Exact:
    """The scene's counterpart; NoCounterpartError if there is none."""
    view = _view(scene)
    if (
        any(scene.world)
        or scene.world_map is not None
        or scene.world_program >= 0
        or scene.sun_discs
    ):
        raise NoCounterpartError("the world shines")
    parts = [part for i in range(len(scene.instances.mesh)) for part in _parts(scene, i)]
    suns = [_sun(light) for light in scene.lights if light.kind == "sun"]
    lamps = [light for light in scene.lights if light.kind != "sun"]
    if len(lamps) > 16:
        raise NoCounterpartError(f"{len(lamps)} lamps that the camera does not see")
    corners = np.concatenate([part.positions for part in parts])
    return Exact(parts + [_lamp(light, corners, view) for light in lamps], suns, view)


def _view(scene: Scene) -> View:
    camera, frame = scene.camera, scene.frame
    if (
        camera.orthographic
        or camera.panorama is not None
        or camera.aperture is not None
        or frame.transparent
    ):
        raise NoCounterpartError("the camera is no pinhole")
    if frame.pixel_filter != "blackman_harris" or frame.border is not None:
        raise NoCounterpartError("the pixel filter or a border")
    left, right, bottom, top = camera.screen
    if (
        abs(left + right) > 1e-6
        or abs(bottom + top) > 1e-6
        or abs(right / top - frame.width / frame.height) > 1e-4
    ):
        raise NoCounterpartError("the camera is shifted, or its pixels are not square")
    return View(
        np.asarray(camera.matrix, np.float64),
        camera.screen,
        frame.width,
        frame.height,
        frame.filter_width,
    )


def _parts(scene: Scene, instance: int) -> list[Part]:
    """One for each material of the mesh; vertices not shared where they have normals of their own
    in each corner.
    """
    mesh: Mesh = scene.meshes[scene.instances.mesh[instance]]
    matrix = scene.instances.matrix[instance]
    materials = scene.material_sets[scene.instances.material_set[instance]]
    slots = (
        np.zeros(len(mesh.triangles), int)
        if mesh.slots is None
        else np.minimum(mesh.slots, len(materials) - 1).astype(int)
    )
    flips = np.linalg.det(matrix[:3, :3]) < 0
    parts = []
    for slot in np.unique(slots):
        mine = slots == slot
        triangles = mesh.triangles[mine].astype(np.int64)
        normals = None
        positions = mesh.positions
        by_corner = mesh.normals()
        if by_corner is not None:
            normals = by_corner[mine].reshape(-1, 3) @ np.linalg.inv(matrix[:3, :3])
            normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
            positions, triangles = (
                positions[triangles.ravel()],
                np.arange(triangles.size).reshape(-1, 3),
            )
        world = (positions @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
        surface = _surface(scene, scene.materials[materials[slot]])
        parts.append(
            Part(
                f"{mesh.name} {instance} {slot}",
                world,
                triangles[:, ::-1] if flips else triangles,
                normals,
                surface,
            )
        )
    return parts


def _surface(scene: Scene, material: Material) -> Surface:
    if material.program >= 0:
        return _sharp(material.name, scene.programs[material.program])
    front, back = material.front, material.back
    if (
        max(
            front.base_color_texture,
            back.base_color_texture,
            front.emission_texture,
            back.emission_texture,
        )
        >= 0
    ):
        raise NoCounterpartError(f"material '{material.name}' has a texture")
    if front.base_color != back.base_color or any(back.emission):
        raise NoCounterpartError(
            f"material '{material.name}' shines from its back, or has another colour there"
        )
    return Surface("diffuse", front.base_color, emission=front.emission)


def _sharp(name: str, program: Program) -> Surface:
    """A program that is one smooth Glass or Glossy BSDF with constants."""
    from photon_splat.core.native.library import load

    operations = load().shader_operations()
    operation = next(
        (key for key in ("Glass", "Glossy") if operations[key][0] == program.code[0]), None
    )
    if operation is None or len(program.code) != len(operations[operation][1]) + 2:
        raise NoCounterpartError(f"material '{name}' has no counterpart")
    given: dict[str, Any] = {}
    for word, (kind, key, _) in zip(program.code[1:], operations[operation][1], strict=False):
        if kind in ("f", "v") and not word >> 31:
            raise NoCounterpartError(f"material '{name}' is no constant")
        at = int(word) & 0x7FFFFFFF
        given[key] = (
            program.constants[at : at + 3]
            if kind == "v"
            else program.constants[at]
            if kind == "f"
            else None
        )
    if (
        given["weight"] != 1
        or given["roughness"] != 0
        or given["normal"].any()
        or given.get("thin_film_thickness", 0) != 0
    ):
        raise NoCounterpartError(f"material '{name}' is rough, mixed, bent or filmed")
    color = _rgb(given["color"])
    return (
        Surface("glass", color, float(given["ior"]))
        if operation == "Glass"
        else Surface("mirror", color)
    )


def _lamp(light: Light, corners: Array, view: View) -> Part:
    """The lamp as a rectangle that shines and blocks: exact where the camera does not see it and
    nothing lies behind it.
    """
    if light.kind != "area" or light.ellipse or light.spread < np.pi - 1e-6 or not light.normalize:
        raise NoCounterpartError(f"lamp '{light.name}' is no rectangle that shines evenly")
    if (
        light.program >= 0
        or light.light_group >= 0
        or ~light.lit_groups & ((1 << 64) - 1)
        or ~light.blockers & ((1 << 64) - 1)
    ):
        raise NoCounterpartError(f"lamp '{light.name}' has nodes, a group or links")
    x, y = light.size[0] / 2, light.size[1] / 2
    local = np.array([(-x, -y, 0, 1), (-x, y, 0, 1), (x, y, 0, 1), (x, -y, 0, 1)])
    points = (local @ light.matrix.T)[:, :3]
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    area = float(np.linalg.norm(np.cross(points[1] - points[0], points[3] - points[0])))
    if normal @ light.matrix[:3, 2] > 0:  # mirrored: it shines along its own -Z
        points, normal = points[::-1], -normal
    if ((corners - points[0]) @ normal).min() < -1e-6:
        raise NoCounterpartError(f"lamp '{light.name}' has something behind it")
    if not light.camera_visible and _seen(points, view):
        raise NoCounterpartError(f"lamp '{light.name}' would be in the picture")
    radiance = _rgb(np.asarray(light.strength) / (np.pi * area))
    return Part(
        light.name,
        points.astype(np.float32),
        np.array([(0, 1, 2), (0, 2, 3)]),
        None,
        Surface("diffuse", (0, 0, 0), emission=radiance),
    )


def _seen(points: Array, view: View) -> bool:
    """Whether a convex thing may be in the picture: no edge of the frame has all of it outside."""
    local = np.c_[points, np.ones(len(points))] @ np.linalg.inv(view.matrix).T
    depth = -local[:, 2]
    left, right, bottom, top = np.multiply(
        view.screen, 1 + 4 * view.filter_radius / min(view.width, view.height)
    )
    outside = (
        depth <= 0,
        local[:, 0] < left * depth,
        local[:, 0] > right * depth,
        local[:, 1] < bottom * depth,
        local[:, 1] > top * depth,
    )
    return not any(side.all() for side in outside)


def _sun(light: Light) -> Sun:
    if light.program >= 0 or not light.angle > 0:
        raise NoCounterpartError(f"sun '{light.name}' has nodes, or is a point")
    towards = light.matrix[:3, 2] / np.linalg.norm(light.matrix[:3, 2])
    half = light.angle / 2
    return Sun(_rgb(towards), half, _rgb(np.asarray(light.strength) / (np.pi * np.sin(half) ** 2)))


def _rgb(values: Array) -> Rgb:
    r, g, b = (float(v) for v in values)
    return r, g, b


def with_sun_discs(scene: Exact) -> Exact:
    """Suns as discs far away that shine towards the origin, for renderers whose own are points or
    not met by rays.
    """
    turn = np.linspace(0, 2 * np.pi, 65)[:-1]
    discs = []
    for sun in scene.suns:
        towards = np.array(sun.towards)
        side = np.cross(towards, np.eye(3)[np.abs(towards).argmin()])
        side /= np.linalg.norm(side)
        # The polygon has the circle's area.
        radius = (
            SUN_DISTANCE * np.tan(sun.half_angle) * np.sqrt(2 * np.pi / 64 / np.sin(2 * np.pi / 64))
        )
        rim = towards * SUN_DISTANCE + radius * (
            np.cos(turn)[:, None] * side - np.sin(turn)[:, None] * np.cross(towards, side)
        )
        fan = np.array([(0, i, i + 1) for i in range(1, 63)])
        discs.append(
            Part(
                "sun",
                rim.astype(np.float32),
                fan,
                None,
                Surface("diffuse", (0, 0, 0), emission=sun.radiance),
            )
        )
    return replace(scene, parts=scene.parts + discs, suns=[])
