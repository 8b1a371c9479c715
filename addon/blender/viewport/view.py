"""A 3D viewport of Blender -> the view that the renderer is asked for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.scene import Camera, Frame
from ...core.viewport.view import View
from ...export.camera import NoCameraError, export_camera, film_of, resolution, screen
from ...export.report import Report

Rectangle = tuple[float, float, float, float]
"""left, right, bottom, top"""


def view_of(
    region: Any,
    space: Any,
    rv3d: Any,
    scene: Any,
    pixel: int,
    bounds: NDArray[np.float64] | None = None,
    local: Any = None,
) -> View:
    """What the region of a 3D viewport shows, in pixels `pixel` times as wide as the screen's.

    scene   evaluated, for its render settings and its camera
    bounds  (2, 3) corners of what stands in the scene, m: an orthographic view, which begins behind
            the eye, begins there
    local   the evaluated camera object of this viewport alone, if it has one
    """
    width, height = max(int(region.width), 1), max(int(region.height), 1)
    frame = Frame(
        width,
        height,
        **film_of(scene),
    )
    window, camera = projection(rv3d)
    seen = None
    ob = local or scene.camera
    if rv3d.view_perspective == "CAMERA" and ob is not None and ob.type == "CAMERA":
        try:
            seen = export_camera(ob, scene, Report())
        except (NoCameraError, ValueError):
            seen = None
    if seen is not None:
        whole = camera_frame(ob.data, scene.render, window)
        # A whole panorama fills the frame; nothing is seen around it.
        camera = replace(
            seen, screen=window if seen.panorama is None else mapped(window, whole, seen.screen)
        )
        frame.border = border_in_camera(
            scene.render,
            ob.data,
            window,
            whole,
            width,
            height,
            only_frame=seen.panorama is not None,
        )
    else:
        camera.clip_start, camera.clip_end = float(space.clip_start), float(space.clip_end)
        if camera.orthographic:
            begin_before(camera, bounds)
        if space.use_render_border:
            fractions = (
                space.render_border_min_x,
                space.render_border_max_x,
                space.render_border_min_y,
                space.render_border_max_y,
            )
            frame.border = pixels(fractions, width, height)
    return View(camera, frame, pixel)


def projection(rv3d: Any) -> tuple[Rectangle, Camera]:
    """What of the plane z = -1 (perspective) or in metres (orthographic) the region shows, and a
    camera that sees it.
    """
    p = np.array(rv3d.window_matrix, np.float64)
    matrix = np.linalg.inv(np.array(rv3d.view_matrix, np.float64))
    if rv3d.is_perspective:
        window = (
            (p[0, 2] - 1) / p[0, 0],
            (p[0, 2] + 1) / p[0, 0],
            (p[1, 2] - 1) / p[1, 1],
            (p[1, 2] + 1) / p[1, 1],
        )
    else:
        window = (
            (-1 - p[0, 3]) / p[0, 0],
            (1 - p[0, 3]) / p[0, 0],
            (-1 - p[1, 3]) / p[1, 1],
            (1 - p[1, 3]) / p[1, 1],
        )
    left, right, bottom, top = (float(side) for side in window)
    return (left, right, bottom, top), Camera(
        matrix, (left, right, bottom, top), orthographic=not rv3d.is_perspective
    )


def begin_before(camera: Camera, bounds: NDArray[np.float64] | None) -> None:
    """Moves the eye of an orthographic camera back, out of the scene, as far as the view is not
    clipped before it.
    """
    axis, eye = camera.matrix[:3, 2], camera.matrix[:3, 3]
    back = camera.clip_end
    if bounds is not None:
        radius = 0.5 * float(np.linalg.norm(bounds[1] - bounds[0])) + 1e-3
        back = min(max(float(axis @ (bounds.mean(axis=0) - eye)) + radius, 0.0), back)
    camera.matrix = camera.matrix.copy()
    camera.matrix[:3, 3] = eye + axis * back
    camera.clip_start, camera.clip_end = 0.0, camera.clip_end + back


def camera_frame(camera: Any, render: Any, window: Rectangle) -> Rectangle:
    """Where the camera's frame lies in the region: fractions of its width and height."""
    width, height = resolution(render)
    left, right, bottom, top = screen(
        camera, width, height, render.pixel_aspect_y / render.pixel_aspect_x
    )
    across, up = window[1] - window[0], window[3] - window[2]
    return (
        (left - window[0]) / across,
        (right - window[0]) / across,
        (bottom - window[2]) / up,
        (top - window[2]) / up,
    )


def mapped(window: Rectangle, whole: Rectangle, inside: Rectangle) -> Rectangle:
    """The coordinates of the whole region when those of the frame `whole` (fractions of it) are
    `inside`.
    """
    across, up = (
        (inside[1] - inside[0]) / (whole[1] - whole[0]),
        (inside[3] - inside[2]) / (whole[3] - whole[2]),
    )
    left, bottom = inside[0] - whole[0] * across, inside[2] - whole[2] * up
    return (left, left + across, bottom, bottom + up)


def border_in_camera(
    render: Any,
    camera: Any,
    window: Rectangle,
    whole: Rectangle,
    width: int,
    height: int,
    only_frame: bool,
) -> tuple[int, int, int, int] | None:
    """What is to be rendered of a camera view: its border, its frame if all around is hidden, or
    everything.
    """
    hidden = camera.show_passepartout and camera.passepartout_alpha >= 1.0
    if render.use_border:
        x, y = whole[1] - whole[0], whole[3] - whole[2]
        sides = (whole[0] + render.border_min_x * x, whole[0] + render.border_max_x * x)
        return pixels(
            (*sides, whole[2] + render.border_min_y * y, whole[2] + render.border_max_y * y),
            width,
            height,
        )
    return pixels(whole, width, height) if hidden or only_frame else None


def pixels(fractions: Rectangle, width: int, height: int) -> tuple[int, int, int, int]:
    """(x, y, width, height) of a part of the region, at least one pixel of it."""
    x0, x1 = (int(np.clip(np.floor(f * width + 0.5), 0, width)) for f in fractions[:2])
    y0, y1 = (int(np.clip(np.floor(f * height + 0.5), 0, height)) for f in fractions[2:])
    x0, y0 = min(x0, width - 1), min(y0, height - 1)
    return (x0, y0, max(x1 - x0, 1), max(y1 - y0, 1))
