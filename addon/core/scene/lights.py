"""Lamps, and the image and the suns of the world."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from .material import NO_PROGRAM, Rgb
from .visibility import ALL_GROUPS, ALL_RAYS, NO_LIGHT_GROUP


class LightKind(StrEnum):
    POINT = "point"
    SPOT = "spot"
    SUN = "sun"
    AREA = "area"


@dataclass(slots=True)
class Light:
    """A lamp. It shines along the local -Z axis of `matrix`, whose scale is honoured where Blender
    honours it.

    strength      RGB with colour, temperature, exposure, light-node strength and energy already
                  multiplied in: radiant power in W as Blender's light setting means it (point,
                  spot, area), irradiance in W/m^2 (sun)
    radius        m; point and spot
    soft_falloff  point and spot: the emitter is a disc that faces the receiver instead of a sphere
    spot_size     full cone angle; spot_blend in 0..1
    angle         full angular diameter of a sun
    size          (x, y) of an area light, m, in local coordinates; `ellipse`: inscribed ellipse
                  instead of rectangle
    spread        full angle of an area light's emission; pi = Lambertian
    normalize     area, point, spot: `strength` is total power (True), or does not depend on the
                  emitter's area (False)
    camera_visible  seen directly by camera rays
    program       index into Scene.programs: what it emits, per place and direction, is a factor of
                  `strength`
    lit_groups    bits of the Instances.group that it lights
    blockers      bits of the Instances.group that cast shadows in its light
    light_group   index into Scene.light_groups; -1: none
    seen_by       the rays (`Ray`) that bring its light; what shadow rays bring is scattered as if
                  by one of these
    max_bounces   of a path before it finds the lamp (photons count from the surface that they
                  light); None: any
    met_by_rays   False: light samples find it, other rays do not
    casts_shadows False: nothing blocks its light samples
    """

    name: str
    kind: LightKind
    matrix: NDArray[np.float64]
    strength: Rgb
    radius: float = 0.0
    soft_falloff: bool = True
    spot_size: float = np.pi / 4
    spot_blend: float = 0.15
    angle: float = 0.0
    size: tuple[float, float] = (1.0, 1.0)
    ellipse: bool = False
    spread: float = np.pi
    normalize: bool = True
    camera_visible: bool = False
    program: int = NO_PROGRAM
    lit_groups: int = ALL_GROUPS
    blockers: int = ALL_GROUPS
    light_group: int = NO_LIGHT_GROUP
    seen_by: int = ALL_RAYS
    max_bounces: int | None = None
    met_by_rays: bool = True
    casts_shadows: bool = True


@dataclass(slots=True)
class WorldMap:
    """An image of the world. `to_lookup` (3, 4) maps a direction to that which is looked up;
    `mirror_ball`: the image shows the world mirrored in a ball, else it is equirectangular (u
    against the longitude, v from -Z up, its middle at +X).
    """

    texture: int
    to_lookup: NDArray[np.float64]
    mirror_ball: bool = False


@dataclass(slots=True)
class SunDisc:
    """The sun of a sky: radiance (W/m^2/sr) at its lower and upper edge before limb darkening. What
    lies below the elevation `horizon` is hidden.
    """

    direction: tuple[float, float, float]
    half_angle: float
    bottom: Rgb
    top: Rgb
    horizon: float = -np.pi
