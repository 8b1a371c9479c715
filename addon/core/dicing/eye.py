"""How large a pixel is at places of the world, as Cycles counts it when it dices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene import Camera


@dataclass(slots=True)
class Eye:
    """A camera and the size of its whole frame in pixels. Out of its view pixels grow with the
    distance from it, `offscreen` - 1 times as fast as they do with the distance from the camera.
    """

    camera: Camera
    width: int
    height: int
    offscreen: float = 1.0

    def known_as(self) -> tuple[object, ...]:
        camera = self.camera
        lens = (camera.screen, camera.orthographic, repr(camera.panorama))
        return (camera.matrix.tobytes(), *lens, self.width, self.height, self.offscreen)

    def pixel_sizes(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) m, the width of a pixel at each of `places` (N, 3)."""
        matrix = self.camera.matrix
        seen = (places - matrix[:3, 3]) @ matrix[:3, :3]
        if self.camera.panorama is not None:
            return self._panorama_angle() * np.linalg.norm(seen, axis=1)
        if self.camera.orthographic:
            return self._orthographic(seen)
        return self._perspective(seen)

    def _pixels(self) -> tuple[float, float]:
        left, right, bottom, top = self.camera.screen
        return (right - left) / self.width, (top - bottom) / self.height

    def _orthographic(self, seen: NDArray[np.float64]) -> NDArray[np.float64]:
        size = np.full(len(seen), min(self._pixels()))
        if self.offscreen > 1.0:
            left, right, bottom, top = self.camera.screen
            nearest = seen.copy()
            np.clip(seen[:, 0], left, right, out=nearest[:, 0])
            np.clip(seen[:, 1], bottom, top, out=nearest[:, 1])
            np.minimum(seen[:, 2], 0.0, out=nearest[:, 2])
            away = np.linalg.norm(seen - nearest, axis=1)
            half = 0.5 * np.sqrt((right - left) * (top - bottom))
            size *= 1.0 + (self.offscreen - 1.0) * away / half
        return size

    def _perspective(self, seen: NDArray[np.float64]) -> NDArray[np.float64]:
        """As if each place were straight ahead."""
        left, right, bottom, top = self.camera.screen
        ahead = np.array([0.5 * (left + right), 0.5 * (bottom + top), -1.0])
        across, up = self._pixels()
        step = np.array([across, 0.0, 0.0]) if across < up else np.array([0.0, up, 0.0])
        axis, beside = ahead / np.linalg.norm(ahead), ahead + step
        turned = beside / np.linalg.norm(beside) - axis
        angle = float(np.linalg.norm(turned - (turned @ axis) * axis))
        size = angle * np.linalg.norm(seen, axis=1)
        if self.offscreen > 1.0:
            size += angle * (self.offscreen - 1.0) * self._out_of_view(seen)
        return size

    def _out_of_view(self, seen: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) m, how far places are from the pyramid that is seen."""
        left, right, bottom, top = self.camera.screen
        # Of each side: its normal outwards, and the direction in it away from the camera.
        sides = [
            ((1.0, 0.0, right), (right, 0.0, -1.0)),
            ((-1.0, 0.0, -left), (left, 0.0, -1.0)),
            ((0.0, 1.0, top), (0.0, top, -1.0)),
            ((0.0, -1.0, -bottom), (0.0, bottom, -1.0)),
        ]
        distance = np.linalg.norm(seen, axis=1)
        away = np.zeros(len(seen))
        for normal, along in sides:
            beyond = seen @ (np.array(normal) / np.linalg.norm(normal))
            before = seen @ np.array(along) >= 0.0
            out = beyond > 0.0
            np.maximum(away, np.where(before, beyond, distance), out=away, where=out)
        return away

    def _panorama_angle(self) -> float:
        """rad, of a pixel at the middle of the picture."""
        panorama = self.camera.panorama
        assert panorama is not None
        if panorama.kind.startswith("fisheye"):
            return panorama.fov / max(self.width, self.height)
        if panorama.kind == "equirectangular":
            (west, east), (south, north) = panorama.longitude, panorama.latitude
            return min(abs(east - west) / self.width, abs(north - south) / self.height)
        return np.pi / max(self.width, self.height)
