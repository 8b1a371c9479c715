"""Blender's camera and output settings -> core.scene.Camera and Frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Aperture, Camera, Frame, Panorama, PanoramaKind, PixelFilter
from .report import Report
from .views import View


class NoCameraError(ValueError):
    """The scene has no camera to render from."""


def resolution(render: Any) -> tuple[int, int]:
    """Size of the whole frame in pixels, as Blender rounds it."""
    percentage = render.resolution_percentage
    return max(render.resolution_x * percentage // 100, 1), max(
        render.resolution_y * percentage // 100, 1
    )


def export_frame(scene: Any, view_layer: Any, given: Any = None) -> Frame:
    """Raster, border, film and filter of a bpy.types.Scene. `given`: the bpy.types.RenderSettings
    that have the raster and the border, if those are another scene's.
    """
    render = given or scene.render
    width, height = resolution(render)
    return Frame(
        width=width,
        height=height,
        border=_border(render, width, height) if render.use_border else None,
        alpha_threshold=float(view_layer.pass_alpha_threshold),
        **film_of(scene),
    )


def film_of(scene: Any) -> dict[str, Any]:
    """Film and pixel filter, for Frame: those of Cycles, which files set, where Blender has it."""
    render, cycles = scene.render, getattr(scene, "cycles", None)
    film: dict[str, Any] = {"transparent": bool(render.film_transparent)}
    if cycles is None:
        return film | {"filter_width": float(render.filter_size)}
    clear = bool(cycles.film_transparent_glass)
    return film | {
        "transparent_glass": float(cycles.film_transparent_roughness) if clear else -1.0,
        "pixel_filter": PixelFilter(cycles.pixel_filter_type.lower()),
        "filter_width": float(cycles.filter_width),
        "exposure": float(cycles.film_exposure),
    }


def export_camera(
    ob: Any,
    scene: Any,
    report: Report,
    view: View | None = None,
    size: tuple[int, int] | None = None,
) -> Camera:
    """Camera object `ob` (evaluated) framed by `scene.render`, or for pictures of `size` (width,
    height in pixels), in one view of several if there is a `view`; raises NoCameraError if there is
    no camera.
    """
    if ob is None:
        raise NoCameraError(
            f"Scene '{scene.name}' has no camera: add one, or set an object as the scene's active "
            "camera"
        )
    if ob.type != "CAMERA":
        raise NoCameraError(
            f"Object '{ob.name}' is the active camera of scene '{scene.name}' but is not a camera"
        )
    camera, render = ob.data, scene.render
    if camera.type not in {"PERSP", "ORTHO", "PANO"}:
        raise ValueError(
            f"Camera '{ob.name}' is of type {camera.type}; there are perspective, orthographic "
            "and panoramic cameras"
        )
    width, height = size or resolution(render)
    x, y = view.shift_x(ob) if view else float(camera.shift_x), float(camera.shift_y)
    whole = (
        (x, 1.0 + x, y, 1.0 + y)
        if camera.type == "PANO"
        else screen(camera, width, height, render.pixel_aspect_y / render.pixel_aspect_x, x)
    )
    return Camera(
        matrix=camera_matrix(ob, report, view),
        screen=whole,
        orthographic=camera.type == "ORTHO",
        clip_start=float(camera.clip_start),
        clip_end=float(camera.clip_end),
        panorama=_panorama(
            ob.name, camera, width * render.pixel_aspect_x, height * render.pixel_aspect_y
        )
        if camera.type == "PANO"
        else None,
        aperture=_aperture(ob, camera) if camera.dof.use_dof else None,
        stereo=view.stereo(ob) if view else None,
    )


def camera_matrix(ob: Any, report: Report, view: View | None = None) -> NDArray[np.float64]:
    """Where an evaluated camera is, without scale."""
    matrix = view.matrix(ob) if view else np.array(ob.matrix_world, np.float64)
    return _rigid(matrix, ob.name, report)


def screen(
    camera: Any, width: int, height: int, aspect: float, shift_x: float | None = None
) -> tuple[float, float, float, float]:
    """(left, right, bottom, top) of the frame at z = -1 (perspective) or in metres (orthographic).

    `aspect` is a pixel's height over its width; `shift_x`: of the view, where there are several.
    Lens, sensor and shift refer to the side that the sensor is fitted to.
    """
    tall = height * aspect
    fit = camera.sensor_fit
    horizontal = fit == "HORIZONTAL" or (fit == "AUTO" and width >= tall)
    fitted = float(width if horizontal else tall)
    if camera.type == "ORTHO":
        extent = float(camera.ortho_scale)
    else:
        extent = float(camera.sensor_height if fit == "VERTICAL" else camera.sensor_width) / float(
            camera.lens
        )
    pixel = extent / fitted
    x, y = (camera.shift_x if shift_x is None else shift_x) * extent, camera.shift_y * extent
    half_x, half_y = 0.5 * width * pixel, 0.5 * tall * pixel
    return (x - half_x, x + half_x, y - half_y, y + half_y)


def _panorama(name: str, camera: Any, x: float, y: float) -> Panorama:
    """x, y: width and height of the picture, in any unit."""

    def setting(key: str) -> Any:
        """Before Blender 5 panoramas were Cycles' own."""
        return getattr(camera, key) if hasattr(camera, key) else getattr(camera.cycles, key)

    kind = setting("panorama_type")
    if kind.lower() not in set(PanoramaKind):
        raise ValueError(f"Camera '{name}' is a panorama of type {kind}, which is not supported")
    fit = camera.sensor_fit
    if fit == "HORIZONTAL" or (fit == "AUTO" and x > y):
        sensor = (camera.sensor_width, camera.sensor_width * y / x)
    else:
        side = camera.sensor_height if fit == "VERTICAL" else camera.sensor_width
        sensor = (side * x / y, side)
    k0, k1, k2, k3, k4 = (float(setting(f"fisheye_polynomial_k{i}")) for i in range(5))
    panorama = Panorama(
        PanoramaKind(kind.lower()),
        longitude=(float(setting("longitude_min")), float(setting("longitude_max"))),
        latitude=(float(setting("latitude_min")), float(setting("latitude_max"))),
        fov=float(setting("fisheye_fov")),
        focal_length=float(setting("fisheye_lens")),
        sensor=(float(sensor[0]), float(sensor[1])),
        polynomial=(k0, k1, k2, k3, k4),
    )
    if panorama.kind is PanoramaKind.CENTRAL_CYLINDRICAL:
        u_min, u_max, v_min, v_max = (
            float(setting(f"central_cylindrical_range_{end}"))
            for end in ("u_min", "u_max", "v_min", "v_max")
        )
        radius = max(float(setting("central_cylindrical_radius")), 1e-6)
        panorama.cylinder = (u_min, u_max, v_min / radius, v_max / radius)
    return panorama


SHARPEST_FSTOP = 1e-5
NEAREST_FOCUS = 1e-5


def _aperture(ob: Any, camera: Any) -> Aperture:
    """Blender's f-stop means the lens' focal length over its diameter; an orthographic camera
    counts as a lens of 1 m.
    """
    dof = camera.dof
    length = 1.0 if camera.type == "ORTHO" else float(camera.lens) * 1e-3
    return Aperture(
        radius=length / (2.0 * max(float(dof.aperture_fstop), SHARPEST_FSTOP)),
        focus=max(_focus_distance(ob, dof), NEAREST_FOCUS),
        blades=int(dof.aperture_blades),
        rotation=float(dof.aperture_rotation),
        ratio=max(float(dof.aperture_ratio), 1e-3),
    )


def _focus_distance(ob: Any, dof: Any) -> float:
    """m along the viewing axis: of the object in focus, or of its bone, if there is one."""
    target = dof.focus_object
    if target is None:
        return float(dof.focus_distance)
    place = np.array(target.matrix_world, np.float64)
    if target.type == "ARMATURE" and dof.focus_subtarget:
        bone = target.pose.bones.get(dof.focus_subtarget)
        if bone is not None:
            place = place @ np.array(bone.matrix, np.float64)
    matrix = np.array(ob.matrix_world, np.float64)
    axis = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    return float(abs(axis @ (matrix[:3, 3] - place[:3, 3])))


def _border(render: Any, width: int, height: int) -> tuple[int, int, int, int] | None:
    """Pixels of the render border, truncated in single precision as Blender does."""

    def pixel(fraction: float, size: int) -> int:
        return int(np.float32(fraction) * np.float32(size))

    x0, x1 = pixel(render.border_min_x, width), pixel(render.border_max_x, width)
    y0, y1 = pixel(render.border_min_y, height), pixel(render.border_max_y, height)
    if (x0, y0, x1, y1) == (0, 0, width, height):
        return None
    return (x0, y0, max(x1 - x0, 1), max(y1 - y0, 1))


def _rigid(matrix: NDArray[np.float64], name: str, report: Report) -> NDArray[np.float64]:
    """`matrix` without scale and shear; the viewing axis keeps its direction, mirroring stays."""
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    if not np.isfinite(matrix).all() or not (lengths > 0.0).all():
        raise ValueError(
            f"Camera '{name}' has a transformation that is zero or not a finite number"
        )
    rigid = matrix.copy()
    rigid[:3, :3] /= lengths
    z, y, x = rigid[:3, 2].copy(), rigid[:3, 1].copy(), rigid[:3, 0].copy()
    if max(abs(y @ z), abs(x @ z), abs(x @ y)) > 1e-4:
        report.warn(f"Camera '{name}' is sheared by a parent; the shear is left out")
    upright = y - z * (y @ z)
    if np.linalg.norm(upright) < 1e-6:
        raise ValueError(f"Camera '{name}' has a transformation that squeezes it flat")
    upright /= np.linalg.norm(upright)
    side = np.cross(upright, z)
    rigid[:3, 0] = side if side @ x >= 0.0 else -side
    rigid[:3, 1] = upright
    return rigid
