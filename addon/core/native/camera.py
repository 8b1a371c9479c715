"""Hands camera and frame to the native renderer."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from ..scene import Camera, Frame

if TYPE_CHECKING:
    from photon_splat_native import Renderer


def place_camera(renderer: Renderer, camera: Camera, frame: Frame) -> None:
    """Sets the camera. A renderer that has been built takes it over with set_view()."""
    screen = [float(c) for c in camera.screen]
    renderer.set_shading_view(
        np.ascontiguousarray(camera.matrix, np.float64), screen, camera.orthographic
    )
    renderer.set_camera(
        matrix=np.ascontiguousarray(camera.matrix, np.float64),
        screen=screen,
        orthographic=camera.orthographic,
        clip_start=camera.clip_start,
        clip_end=camera.clip_end,
        frame=[frame.width, frame.height],
        region=list(frame.region),
        transparent=frame.transparent,
        transparent_glass=frame.transparent_glass,
        alpha_threshold=frame.alpha_threshold,
        pixel_filter=str(frame.pixel_filter),
        filter_width=frame.filter_width,
        exposure=frame.exposure,
    )
    if camera.panorama is not None:
        panorama: dict[str, Any] = {
            k: list(v) if isinstance(v, tuple) else v for k, v in asdict(camera.panorama).items()
        }
        renderer.set_panorama(**panorama | {"kind": str(camera.panorama.kind)})
    if camera.aperture is not None:
        renderer.set_aperture(**asdict(camera.aperture))
    if camera.stereo is not None:
        begins, ends = camera.stereo.merge or (0.0, 0.0)
        renderer.set_stereo(camera.stereo.offset, camera.stereo.convergence, begins, ends)
    if camera.motion is not None:
        renderer.set_camera_motion(
            np.ascontiguousarray(camera.motion.matrices, np.float64), list(camera.motion.zoom)
        )
