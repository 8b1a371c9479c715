"""Sky Texture nodes -> images of the sky."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Extension, Interpolation, Rgb, SunDisc, Texture
from ..core.scene.sky import Sky, SkyModel, SkySettings, sky
from .images import Textures
from .nodes.links import label
from .report import Report

SKY_MODELS = {
    "SINGLE_SCATTERING": SkyModel.SINGLE_SCATTERING,
    "NISHITA": SkyModel.SINGLE_SCATTERING,
    "MULTIPLE_SCATTERING": SkyModel.MULTIPLE_SCATTERING,
    "PREETHAM": SkyModel.PREETHAM,
    "HOSEK_WILKIE": SkyModel.HOSEK_WILKIE,
}
ANALYTIC = (SkyModel.PREETHAM, SkyModel.HOSEK_WILKIE)
"""Their sun is a direction, and they have no disc."""


@dataclass(slots=True)
class ExportedSky:
    """An equirectangular image, `texture`, in which the sun stands above +X; `turn` (4, 4) brings
    directions there.
    """

    texture: int
    turn: NDArray[np.float64]
    settings: SkySettings
    made: Sky
    has_disc: bool
    sun_intensity: float


def export_sky(node: Any, textures: Textures, owner: str, report: Report) -> ExportedSky:
    """The sky of a Sky Texture node without the sun's disc; `owner` is what warnings name."""
    model = SKY_MODELS.get(node.sky_type)
    if model is None:
        report.warn(
            f"{owner}, node '{label(node)}': the sky model {node.sky_type} is not supported; "
            "taken as Preetham's"
        )
        model = SkyModel.PREETHAM
    if model in ANALYTIC:
        sun = np.asarray(node.sun_direction, np.float64)
        sun = sun / max(float(np.linalg.norm(sun)), 1e-9)
        settings = SkySettings(
            model,
            math.asin(min(max(sun[2], -1.0), 1.0)),
            turbidity=float(node.turbidity),
            ground_albedo=float(node.ground_albedo),
        )
        longitude = math.atan2(sun[1], sun[0])
    else:
        elevation, rotation = _wrapped(float(node.sun_elevation), float(node.sun_rotation))
        settings = SkySettings(
            model,
            elevation,
            float(node.altitude),
            float(node.air_density),
            float(getattr(node, "aerosol_density", getattr(node, "dust_density", 1.0))),
            float(node.ozone_density),
            sun_size=float(node.sun_size),
        )
        longitude = math.pi / 2.0 - rotation
    made = sky(settings)
    texture = textures.add(
        Texture("sky", made.pixels, False, Interpolation.LINEAR, Extension.EXTEND)
    )
    c, s = math.cos(longitude), math.sin(longitude)
    turn = np.eye(4)
    turn[:2, :2] = [[c, s], [-s, c]]
    has_disc = model not in ANALYTIC and bool(node.sun_disc)
    intensity = float(node.sun_intensity)
    return ExportedSky(texture, turn, settings, made, has_disc, intensity)


def sun_disc(found: ExportedSky, to_lookup: NDArray[np.float64], strength: Rgb) -> SunDisc | None:
    """The disc, if there is one, of a sky that is looked up at `to_lookup` (4, 4) of a direction;
    `strength` is a factor of its light.
    """
    if not found.has_disc:
        return None
    elevation = found.settings.sun_elevation
    matrix = (found.turn @ to_lookup)[:3, :3]
    direction = np.linalg.pinv(matrix) @ [math.cos(elevation), 0.0, math.sin(elevation)]
    if not np.isfinite(direction).all() or not np.linalg.norm(direction) > 0.0:
        return None
    x, y, z = direction / np.linalg.norm(direction)
    bottom, top = (
        _scaled(color, strength, found.sun_intensity)
        for color in (found.made.sun_bottom, found.made.sun_top)
    )
    half = found.settings.sun_size / 2.0
    return SunDisc((float(x), float(y), float(z)), half, bottom, top, found.made.horizon)


def _scaled(color: Rgb, strength: Rgb, intensity: float) -> Rgb:
    r, g, b = (c * s * intensity for c, s in zip(color, strength, strict=True))
    return (r, g, b)


def _wrapped(elevation: float, rotation: float) -> tuple[float, float]:
    """A sun that has passed the zenith comes down on the other side."""
    elevation = math.remainder(elevation, 2.0 * math.pi)
    if abs(elevation) > math.pi / 2.0:
        return math.copysign(math.pi, elevation) - elevation, rotation + math.pi
    return elevation, rotation
