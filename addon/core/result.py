"""What a render gives back: named passes made of the film's sums, and how far it has come."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Passes = dict[str, NDArray[np.float32]]


@dataclass(frozen=True, slots=True)
class PassInfo:
    name: str
    channels: str
    """One letter per channel, as an EXR file names them."""


PASSES = (
    PassInfo("Combined", "RGBA"),
    PassInfo("Depth", "Z"),
    PassInfo("Normal", "XYZ"),
    PassInfo("Diffuse Direct", "RGB"),
    PassInfo("Diffuse Indirect", "RGB"),
    PassInfo("Diffuse Color", "RGB"),
    PassInfo("Glossy Direct", "RGB"),
    PassInfo("Glossy Indirect", "RGB"),
    PassInfo("Transmission Direct", "RGB"),
    PassInfo("Transmission Indirect", "RGB"),
    PassInfo("Emission", "RGB"),
    PassInfo("Photon Density", "X"),
    PassInfo("Surface ID", "X"),
    PassInfo("Error", "X"),
)

LIGHT_GROUP_CHANNELS = "RGB"

LIGHT = (
    "diffuse_direct",
    "diffuse_indirect",
    "glossy_direct",
    "glossy_indirect",
    "transmission_direct",
    "transmission_indirect",
    "emission",
    "environment",
)
"""What the film keeps apart and the picture is the sum of."""


@dataclass(slots=True)
class Progress:
    """fraction 0..1 of what `passes` or `time_limit` ask for; `interim` holds passes where they were wanted and are new."""

    fraction: float
    message: str
    passes_done: int
    interim: Passes | None = None


@dataclass(slots=True)
class RenderResult:
    """passes: name → (height, width, channels) float32, row 0 at the bottom. statistics: the --stats object. noisy: the RGB of Combined
    before it was denoised, if it was."""

    passes: Passes
    cancelled: bool
    statistics: dict[str, Any]
    noisy: NDArray[np.float32] | None = None


def light_group_pass(name: str) -> PassInfo:
    """The pass of a light group, named as by Cycles."""
    return PassInfo(f"Combined_{name}", LIGHT_GROUP_CHANNELS)


def infos_of(passes: Passes) -> list[PassInfo]:
    """Of all there are, those of light groups last."""
    known = {info.name for info in PASSES}
    return [*PASSES, *(PassInfo(name, LIGHT_GROUP_CHANNELS) for name in passes if name not in known)]


def passes_from_film(film: dict[str, Any], light_groups: Sequence[str] = ()) -> Passes:
    """Diffuse light is divided by the albedo, as Cycles divides it (0 where that is black); glossy and
    transmitted light has its colour in it. `light_groups`: names of those that the film has."""
    color = film["diffuse_color"]

    def per_albedo(light: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.divide(light, color, out=np.zeros_like(light), where=color > 0)

    combined = np.empty((*color.shape[:2], 4), np.float32)
    combined[..., :3] = sum(film[light] for light in LIGHT)
    combined[..., 3:] = film["alpha"]
    return {
        "Combined": combined,
        "Depth": film["depth"],
        "Normal": film["normal"],
        "Diffuse Direct": per_albedo(film["diffuse_direct"]),
        "Diffuse Indirect": per_albedo(film["diffuse_indirect"]),
        "Diffuse Color": color,
        "Glossy Direct": film["glossy_direct"],
        "Glossy Indirect": film["glossy_indirect"],
        "Transmission Direct": film["transmission_direct"],
        "Transmission Indirect": film["transmission_indirect"],
        "Emission": film["emission"],
        "Photon Density": film["photon_density"],
        "Surface ID": film["surface_id"],
        "Error": film["error"],
    } | {light_group_pass(name).name: film["light_groups"][i] for i, name in enumerate(light_groups)}


def black_passes(width: int, height: int, light_groups: Sequence[str] = ()) -> Passes:
    """What a render that was cancelled before its first pass gives back."""
    infos = [*PASSES, *map(light_group_pass, light_groups)]
    return {p.name: np.zeros((height, width, len(p.channels)), np.float32) for p in infos}
