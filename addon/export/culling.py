"""Culling of Simplify: objects that are left out as they stand beside the view or far from the
camera, by the rules of Cycles.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Camera


def kept_by_culling(scene: Any, camera: Camera) -> Callable[[Any], bool] | None:
    """Tells of instances of the graph whether they stay; None: all do."""
    cycles, render = getattr(scene, "cycles", None), scene.render
    if cycles is None or not render.use_simplify or render.use_multiview or camera.panorama:
        return None
    culling = _Culling(cycles, camera)
    return culling.keeps if culling.by_view or culling.by_distance else None


class _Culling:
    """Only objects that allow it are left out, never lamps."""

    def __init__(self, cycles: Any, camera: Camera) -> None:
        self._camera = camera
        self._margin = float(cycles.camera_cull_margin)
        self._distance = float(cycles.distance_cull_margin)
        self.by_view = bool(cycles.use_camera_cull)
        self.by_distance = bool(cycles.use_distance_cull) and self._distance > 0.0
        self._to_camera = np.linalg.inv(camera.matrix)

    def keeps(self, instance: Any) -> bool:
        """Not what stands outside of all that culls it."""
        ob = instance.object
        own = ob.original.cycles
        by_view = self.by_view and own.use_camera_cull
        by_distance = self.by_distance and own.use_distance_cull
        if ob.type == "LIGHT" or not (by_view or by_distance):
            return True
        corners = np.array(ob.bound_box, np.float64)
        matrix = np.array(instance.matrix_world, np.float64)
        corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
        return (by_view and not self._is_beside(corners)) or (
            by_distance and not self._is_far(corners)
        )

    def _is_beside(self, corners: NDArray[np.float64]) -> bool:
        """Whether the frame, wider by the margin (a share of its sides), holds nothing of a box.
        Sees boxes that reach behind the camera as Cycles does.
        """
        camera, margin = self._camera, self._margin
        seen = corners @ self._to_camera[:3, :3].T + self._to_camera[:3, 3]
        z, near, far = -seen[:, 2], camera.clip_start, camera.clip_end
        depth, weight = (z - near) / (far - near), np.ones_like(z)
        if not camera.orthographic:
            depth, weight = depth * far, np.where(z == 0.0, np.finfo(np.float32).tiny, z)
        if (depth < -margin).all():
            return True
        left, right, bottom, top = camera.screen
        places = (seen[:, :2] / weight[:, None] - (left, bottom)) / (right - left, top - bottom)
        places = np.where(depth[:, None] < 0.0, 1.0 - places, places)
        return bool(
            (places.min(axis=0) >= 1.0 + margin).any() or (places.max(axis=0) <= -margin).any()
        )

    def _is_far(self, corners: NDArray[np.float64]) -> bool:
        eye = self._camera.matrix[:3, 3]
        nearest = np.clip(eye, corners.min(axis=0), corners.max(axis=0))
        return bool(np.linalg.norm(eye - nearest) > self._distance)
