"""Blender's sky models as images, computed by the native module."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..native.library import load
from . import Rgb

WIDTH, HEIGHT = 512, 1024


class SkyModel(StrEnum):
    SINGLE_SCATTERING = "single_scattering"
    MULTIPLE_SCATTERING = "multiple_scattering"
    PREETHAM = "preetham"
    HOSEK_WILKIE = "hosek_wilkie"


@dataclass(frozen=True, slots=True)
class SkySettings:
    """Angles in radians, altitude in m, densities relative to the Earth's; `turbidity` is the only
    parameter of Preetham, and with `ground_albedo` of Hosek and Wilkie.
    """

    model: SkyModel
    sun_elevation: float
    altitude: float = 0.0
    air: float = 1.0
    aerosol: float = 1.0
    ozone: float = 1.0
    turbidity: float = 2.2
    ground_albedo: float = 0.3
    sun_size: float = 0.0095


@dataclass(frozen=True, slots=True)
class Sky:
    """pixels: (HEIGHT, WIDTH, 4) float32 radiance, equirectangular, the sun above +X. sun_bottom,
    sun_top: radiance at the edges of its disc, which shows itself above the elevation `horizon`; 0
    for models without one.
    """

    pixels: NDArray[np.float32]
    sun_bottom: Rgb
    sun_top: Rgb
    horizon: float


@lru_cache(maxsize=4)
def sky(settings: SkySettings) -> Sky:
    """Some tenths of a second; ValueError for settings that are not finite."""
    pixels, bottom, top, horizon = load().sky(
        model=str(settings.model),
        sun_elevation=settings.sun_elevation,
        altitude=settings.altitude,
        air=settings.air,
        aerosol=settings.aerosol,
        ozone=settings.ozone,
        turbidity=settings.turbidity,
        ground_albedo=settings.ground_albedo,
        angular_diameter=settings.sun_size,
        width=WIDTH,
        height=HEIGHT,
    )
    return Sky(pixels, bottom, top, horizon)
