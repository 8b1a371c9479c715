"""Small scenes straight from the dataclasses of the core, without Blender."""

from __future__ import annotations

import time
from collections.abc import Sequence
from math import tan

import numpy as np
from photon_splat.core.render.session import RenderResult, render
from photon_splat.core.render.settings import Integrator, RenderSettings
from photon_splat.core.scene import (
    Camera,
    Frame,
    Instances,
    Light,
    LightKind,
    Material,
    Mesh,
    PixelFilter,
    Scene,
    Side,
)

Point = Sequence[float]
CUBE_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
BOTH = (Integrator.SPLAT, Integrator.REFERENCE)


def look_at(eye: Point, aim: Point, up: Point = (0.0, 0.0, 1.0)) -> np.ndarray:
    """A matrix at `eye` whose -Z axis points at `aim`."""
    back = np.asarray(eye, float) - np.asarray(aim, float)
    back /= np.linalg.norm(back)
    side = np.cross(up, back)
    if np.linalg.norm(side) < 1e-6:
        side = np.cross((0.0, 1.0, 0.0), back)
    side /= np.linalg.norm(side)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = (
        side,
        np.cross(back, side),
        back,
        eye,
    )
    return matrix


def ortho_down(
    height: float, size: float, pixels: int, centre: Point = (0.0, 0.0)
) -> tuple[Camera, Frame]:
    """A camera at z = height that sees the square of `size` metres about `centre` below it; x to
    the right, y upwards; box filter.
    """
    matrix = np.eye(4)
    matrix[:3, 3] = (*centre, height)
    half = size / 2
    camera = Camera(
        matrix, (-half, half, -half, half), orthographic=True, clip_start=1e-6, clip_end=1e6
    )
    return camera, Frame(pixels, pixels, pixel_filter=PixelFilter.BOX, filter_width=1.0)


def perspective(
    eye: Point, aim: Point, width: int, height: int, field: float = 0.9
) -> tuple[Camera, Frame]:
    """field: full horizontal angle of view, radians."""
    x = tan(field / 2)
    y = x * height / width
    return Camera(look_at(eye, aim), (-x, x, -y, y), clip_start=1e-6, clip_end=1e6), Frame(
        width, height
    )


def pixel_grid(size: float, pixels: int, fine: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """x and y of `fine` x `fine` points in every pixel of `ortho_down`, (pixels * fine, pixels *
    fine).
    """
    at = ((np.arange(pixels * fine) + 0.5) / (pixels * fine) - 0.5) * size
    return np.meshgrid(at, at)


def coarsen(values: np.ndarray, fine: int = 4) -> np.ndarray:
    """Means over the points of a pixel: (N * fine, N * fine) to (N, N)."""
    n = len(values) // fine
    return values.reshape(n, fine, n, fine).mean((1, 3))


def mesh(
    vertices: Sequence[Point] | np.ndarray, faces: Sequence[Sequence[int]], name: str = "mesh"
) -> Mesh:
    """A flat-shaded mesh; faces with more than three corners are cut into fans."""
    triangles = [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]
    return Mesh(name, np.asarray(vertices, np.float32), np.asarray(triangles, np.uint32))


def quad(half: float = 2.0, z: float = 0.0) -> Mesh:
    return mesh(
        [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)],
        [(0, 1, 2, 3)],
        "quad",
    )


def box(low: Point, high: Point, *, inwards: bool = False) -> Mesh:
    corners = [
        (x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])
    ]
    return mesh(corners, [face[::-1] for face in CUBE_FACES] if inwards else CUBE_FACES, "box")


def globe(radius: float, levels: int, *, inwards: bool = False, smooth: bool = False) -> Mesh:
    """An octahedron refined `levels` times, projected to the sphere: 8 * 4**levels triangles."""
    points = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    faces = np.array(
        [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    )
    for _ in range(levels):
        a, b, c = points[faces[:, 0]], points[faces[:, 1]], points[faces[:, 2]]
        ab, bc, ca = a + b, b + c, c + a
        every = np.concatenate(
            [np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
        flat = every.reshape(-1, 3)
        flat = flat / np.linalg.norm(flat, axis=1, keepdims=True)
        points, inverse = np.unique(np.round(flat, 9), axis=0, return_inverse=True)
        faces = inverse.reshape(-1, 3)
    if inwards:
        faces = faces[:, ::-1]
    sign = -1.0 if inwards else 1.0
    normals = (sign * points[faces]).astype(np.float32) if smooth else None
    return Mesh("globe", (points * radius).astype(np.float32), faces.astype(np.uint32), normals)


def lambert(
    albedo: float | Point, emission: float | Point = 0.0, *, back_emission: bool = True
) -> Material:
    """Both sides reflect `albedo`; the back shines only with `back_emission`."""
    color, shine = (
        tuple(np.broadcast_to(np.asarray(v, float), 3).tolist()) for v in (albedo, emission)
    )
    return Material(
        "lambert",
        Side(color, emission=shine),
        Side(color, emission=shine if back_emission else (0.0, 0.0, 0.0)),
    )


def scene(
    view: tuple[Camera, Frame],
    things: Sequence[tuple[Mesh, Material]],
    lights: Sequence[Light] = (),
    world: float = 0.0,
) -> Scene:
    """Every mesh once, where it is, each with one material."""
    count = len(things)
    index = np.arange(count, dtype=np.uint32)
    return Scene(
        *view,
        meshes=[thing[0] for thing in things],
        instances=Instances(index, np.tile(np.eye(4), (count, 1, 1)), index.copy()),
        material_sets=[np.array([k], np.int32) for k in range(count)],
        materials=[thing[1] for thing in things],
        lights=list(lights),
        world=(world,) * 3,
    )


def lamp(
    kind: LightKind,
    strength: float,
    location: Point = (0.0, 0.0, 1.0),
    aim: Point | None = None,
    **settings: object,
) -> Light:
    """A lamp at `location` that shines at `aim`, straight down without one."""
    x, y, z = location
    matrix = look_at(location, aim if aim is not None else (x, y, z - 1.0))
    return Light("lamp", kind, matrix, (strength,) * 3, **settings)  # type: ignore[arg-type]


def lit_box(width: int, height: int) -> Scene:
    """A box of 2 m, seen from within, with a lamp under its ceiling."""
    what = scene(
        perspective((0.0, -0.95, 0.0), (0.0, 1.0, 0.0), width, height, 2.2),
        [(box((-1, -1, -1), (1, 1, 1), inwards=True), lambert(0.7))],
    )
    what.lights = [lamp(LightKind.AREA, 10.0, (0.0, 0.0, 0.9), size=(0.8, 0.8))]
    return what


def shoot(
    what: Scene, integrator: Integrator = Integrator.SPLAT, **settings: object
) -> RenderResult:
    return render(what, RenderSettings(integrator=integrator, **settings), started=time.monotonic())  # type: ignore[arg-type]


def picture(
    what: Scene, integrator: Integrator = Integrator.SPLAT, **settings: object
) -> np.ndarray:
    """RGB of a render, (height, width, 3) float64, row 0 at the bottom."""
    return shoot(what, integrator, **settings).passes["Combined"][..., :3].astype(np.float64)
