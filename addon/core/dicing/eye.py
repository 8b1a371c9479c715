"""How large a pixel is at places of the world, as Cycles counts it when it dices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..native.library import load
from ..scene import Camera

if TYPE_CHECKING:
    import photon_splat_native


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
        return self.native().pixel_sizes(np.ascontiguousarray(places, np.float64))

    def native(self) -> photon_splat_native.Eye:
        camera = self.camera
        lens = "orthographic" if camera.orthographic else "perspective"
        return load().Eye(
            lens if camera.panorama is None else "panorama",
            np.ascontiguousarray(camera.matrix, np.float64),
            [float(c) for c in camera.screen],
            self.width,
            self.height,
            self._panorama_angle(),
            self.offscreen,
        )

    def _panorama_angle(self) -> float:
        """rad, of a pixel at the middle of a panorama, else 0."""
        panorama = self.camera.panorama
        if panorama is None:
            return 0.0
        if panorama.kind.startswith("fisheye"):
            return panorama.fov / max(self.width, self.height)
        if panorama.kind == "equirectangular":
            (west, east), (south, north) = panorama.longitude, panorama.latitude
            return min(abs(east - west) / self.width, abs(north - south) / self.height)
        return np.pi / max(self.width, self.height)
