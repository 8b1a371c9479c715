"""Cameras and the raster of pixels."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from .motion import CameraMotion


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
class Stereo:
    """One eye of a picture all around, where every ray has an eye of its own: beside the camera,
    `offset` m to the right of the ray and of what is up. Eyes look at the same point at the
    distance `convergence` (m; infinite: in parallel). merge: angles above and below the horizon,
    radians, between which both eyes become one; None: they never do.

    Up is the camera's own for a panorama, and the scene's +Z for a perspective.
    """

    offset: float
    convergence: float = np.inf
    merge: tuple[float, float] | None = None


@dataclass(slots=True)
class Camera:
    """A camera that looks along its local -Z axis, +Y up (scale and shear of `matrix` already
    removed).

    `screen` is (left, right, bottom, top) of the whole frame: on the plane z = -1 for a perspective
    camera, in metres for an orthographic one; shift, sensor fit, lens and pixel aspect are already
    in it. Points nearer than `clip_start` or beyond `clip_end` (m, along the viewing axis; of a
    panorama: distance) are not seen. With a `panorama`, `screen` is in its coordinates: (0, 1, 0,
    1) unless the camera is shifted. Without `aperture` everything is sharp. All is that of the
    middle of the shutter's opening.
    """

    matrix: NDArray[np.float64]
    screen: tuple[float, float, float, float]
    orthographic: bool = False
    clip_start: float = 0.1
    clip_end: float = 1000.0
    panorama: Panorama | None = None
    aperture: Aperture | None = None
    motion: CameraMotion | None = None
    stereo: Stereo | None = None


@dataclass(slots=True)
class Frame:
    """The raster: the whole frame in pixels and the part of it that is rendered (`border`: x, y,
    width, height, origin bottom left). With `transparent` the camera does not see the world, nor
    sees it through glass of at most the roughness `transparent_glass` (negative: through none).
    Normals are those of the first surface that is as opaque as `alpha_threshold`. `exposure` is a
    factor of all light in the picture.
    """

    width: int
    height: int
    border: tuple[int, int, int, int] | None = None
    transparent: bool = False
    transparent_glass: float = -1.0
    alpha_threshold: float = 0.5
    pixel_filter: PixelFilter = PixelFilter.BLACKMAN_HARRIS
    filter_width: float = 1.5
    exposure: float = 1.0

    @property
    def region(self) -> tuple[int, int, int, int]:
        return self.border or (0, 0, self.width, self.height)
