"""Blender's camera and output settings -> core.scene.Camera and Frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Camera, Frame, PixelFilter
from ..report import Report


class NoCameraError(ValueError):
    """The scene has no camera to render from."""


def resolution(render: Any) -> tuple[int, int]:
    """Size of the whole frame in pixels, as Blender rounds it."""
    percentage = render.resolution_percentage
    return max(render.resolution_x * percentage // 100, 1), max(render.resolution_y * percentage // 100, 1)


def export_frame(render: Any) -> Frame:
    """Raster, border, film and filter of a bpy.types.RenderSettings."""
    width, height = resolution(render)
    return Frame(
        width=width,
        height=height,
        border=_border(render, width, height) if render.use_border else None,
        transparent=bool(render.film_transparent),
        pixel_filter=PixelFilter.BLACKMAN_HARRIS,
        filter_width=float(render.filter_size),
    )


def export_camera(ob: Any, scene: Any, report: Report) -> Camera:
    """Camera object `ob` (evaluated) framed by `scene.render`; raises NoCameraError if there is none."""
    if ob is None:
        raise NoCameraError(f"Scene '{scene.name}' has no camera: add one, or set an object as the scene's active camera")
    if ob.type != "CAMERA":
        raise NoCameraError(f"Object '{ob.name}' is the active camera of scene '{scene.name}' but is not a camera")
    camera, render = ob.data, scene.render
    if camera.type not in {"PERSP", "ORTHO"}:
        raise ValueError(f"Camera '{ob.name}' is of type {camera.type}; only perspective and orthographic cameras are supported yet")
    _report_unsupported(ob, camera, render, report)
    width, height = resolution(render)
    return Camera(
        matrix=_rigid(np.array(ob.matrix_world, np.float64), ob.name, report),
        screen=screen(camera, width, height, render.pixel_aspect_y / render.pixel_aspect_x),
        orthographic=camera.type == "ORTHO",
        clip_start=float(camera.clip_start),
        clip_end=float(camera.clip_end),
    )


def screen(camera: Any, width: int, height: int, aspect: float) -> tuple[float, float, float, float]:
    """(left, right, bottom, top) of the frame at z = -1 (perspective) or in metres (orthographic).

    `aspect` is a pixel's height over its width. Lens, sensor and shift refer to the side that the sensor is fitted to.
    """
    tall = height * aspect
    fit = camera.sensor_fit
    horizontal = fit == "HORIZONTAL" or (fit == "AUTO" and width >= tall)
    fitted = float(width if horizontal else tall)
    if camera.type == "ORTHO":
        extent = float(camera.ortho_scale)
    else:
        extent = float(camera.sensor_height if fit == "VERTICAL" else camera.sensor_width) / float(camera.lens)
    pixel = extent / fitted
    x, y = camera.shift_x * extent, camera.shift_y * extent
    half_x, half_y = 0.5 * width * pixel, 0.5 * tall * pixel
    return (x - half_x, x + half_x, y - half_y, y + half_y)


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
        raise ValueError(f"Camera '{name}' has a transformation that is zero or not a finite number")
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


def _report_unsupported(ob: Any, camera: Any, render: Any, report: Report) -> None:
    if camera.dof.use_dof:
        report.warn(f"Camera '{ob.name}': depth of field is not supported yet; everything is sharp")
    if render.use_motion_blur:
        report.warn("Motion blur is not supported yet; everything stands still")
    if render.use_multiview:
        report.warn("Stereoscopy is not supported yet; all views are the same")
