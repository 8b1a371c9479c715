"""What a render gives back: named passes made of the film's sums, and how far it has come."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..scene.labels import Labels
from .statistics import Statistics

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
    PassInfo("Glossy Color", "RGB"),
    PassInfo("Transmission Direct", "RGB"),
    PassInfo("Transmission Indirect", "RGB"),
    PassInfo("Transmission Color", "RGB"),
    PassInfo("Volume Direct", "RGB"),
    PassInfo("Volume Indirect", "RGB"),
    PassInfo("Emission", "RGB"),
    PassInfo("Environment", "RGB"),
    PassInfo("Photon Density", "X"),
    PassInfo("Surface ID", "X"),
    PassInfo("Error", "X"),
)

SHADOW_PASS = PassInfo("Shadow Catcher", "RGB")
"""What catchers keep of the light that they would have without other things. Combined is then
without them.
"""

NOISY_PASS = PassInfo("Noisy Image", "RGBA")
"""Combined before it was denoised."""

DATA_PASSES = (
    PassInfo("Position", "XYZ"),
    PassInfo("UV", "UVA"),
    PassInfo("Mist", "Z"),
    PassInfo("Object Index", "X"),
    PassInfo("Material Index", "X"),
    PassInfo("Vector", "XYZW"),
    PassInfo("Ambient Occlusion", "RGB"),
    PassInfo("Denoising Albedo", "RGB"),
    PassInfo("Denoising Normal", "XYZ"),
)
"""What is seen, instead of its light. They are there where they are wanted; data_passes.py makes
all but those of WANTED_ARRAYS, which are the film's.
"""
WANTED_ARRAYS = {
    "Ambient Occlusion": "ambient_occlusion",
    "Denoising Albedo": "albedo",
    "Denoising Normal": "feature_normal",
}
DATA_ARRAYS = {
    "Position": "position",
    "UV": "uv",
    "Mist": "mist",
    "Object Index": "object_index",
    "Material Index": "material_index",
    "Vector": "vector",
}
CRYPTOMATTES = {
    "CryptoObject": "object_matte",
    "CryptoAsset": "asset_matte",
    "CryptoMaterial": "material_matte",
}

MATTE_CHANNELS = "rgba"
LIGHT_GROUP_CHANNELS = "RGB"

FILM_ARRAYS = {
    "Combined": "combined",
    "Depth": "depth",
    "Normal": "normal",
    "Diffuse Direct": "diffuse_direct_per_albedo",
    "Diffuse Indirect": "diffuse_indirect_per_albedo",
    "Diffuse Color": "diffuse_color",
    "Glossy Direct": "glossy_direct_per_color",
    "Glossy Indirect": "glossy_indirect_per_color",
    "Glossy Color": "glossy_color",
    "Transmission Direct": "transmission_direct_per_color",
    "Transmission Indirect": "transmission_indirect_per_color",
    "Transmission Color": "transmission_color",
    "Volume Direct": "volume_direct",
    "Volume Indirect": "volume_indirect",
    "Emission": "emission",
    "Environment": "environment",
    "Photon Density": "photon_density",
    "Surface ID": "surface_id",
    "Error": "error",
}
"""Which array of the native film each pass is. Light that lobes send is divided by their colour, as
Cycles divides it (0 where that is black).
"""


@dataclass(slots=True)
class Progress:
    """fraction 0..1 of what `passes` or `time_limit` ask for; `interim` holds passes where they
    were wanted and are new.
    """

    fraction: float
    message: str
    passes_done: int
    interim: Passes | None = None


@dataclass(slots=True)
class RenderResult:
    """passes: name → (height, width, channels) float32, row 0 at the bottom, of those that were
    wanted. noisy: the RGB of Combined before it was denoised, if it was. labels: of the scene,
    where passes ask for them.
    """

    passes: Passes
    cancelled: bool
    statistics: Statistics
    noisy: NDArray[np.float32] | None = None
    labels: Labels | None = None


def light_group_pass(name: str) -> PassInfo:
    """The pass of a light group, named as by Cycles."""
    return PassInfo(f"Combined_{name}", LIGHT_GROUP_CHANNELS)


def matte_pass(name: str, number: int) -> PassInfo:
    """The pass that holds the ranks 2 * number and 2 * number + 1 of a Cryptomatte."""
    return PassInfo(f"{name}{number:02}", MATTE_CHANNELS)


def aov_pass(name: str, is_color: bool) -> PassInfo:
    """A pass that materials fill."""
    return PassInfo(name, "RGBA" if is_color else "X")


def infos_of(passes: Passes) -> list[PassInfo]:
    """All passes; those of light groups and of data come last."""
    film = {info.name for info in PASSES}
    more = (_info_of(name, pixels.shape[2]) for name, pixels in passes.items() if name not in film)
    return [*PASSES, *more]


def _info_of(name: str, channels: int) -> PassInfo:
    """Of a pass that is none of PASSES."""
    for info in DATA_PASSES:
        if info.name == name:
            return info
    if name.startswith(tuple(CRYPTOMATTES)):
        return PassInfo(name, MATTE_CHANNELS)
    if channels == len(LIGHT_GROUP_CHANNELS):
        return PassInfo(name, LIGHT_GROUP_CHANNELS)
    return aov_pass(name, is_color=channels > 1)


def film_arrays(wanted: Collection[str] | None = None, labels: Labels | None = None) -> list[str]:
    """Names of the film arrays for the passes `wanted` (None: all), of those of WANTED_ARRAYS for
    such as `labels` names, and for light groups.
    """
    named = labels.passes if labels is not None else ()
    arrays = [array for name, array in FILM_ARRAYS.items() if wanted is None or name in wanted]
    return [*arrays, *(a for name, a in WANTED_ARRAYS.items() if name in named), "light_groups"]


def channels_of_arrays(arrays: Collection[str]) -> int:
    """Floats per pixel of these film arrays together, without light groups."""
    channels = {FILM_ARRAYS[info.name]: len(info.channels) for info in PASSES}
    return sum(channels.get(name, 3) for name in arrays if name != "light_groups")


def passes_from_film(film: dict[str, Any], light_groups: Sequence[str] = ()) -> Passes:
    """The passes whose arrays are in `film`. light_groups: names of the film's light groups."""
    arrays = FILM_ARRAYS | WANTED_ARRAYS
    return {name: film[array] for name, array in arrays.items() if array in film} | {
        light_group_pass(name).name: film["light_groups"][i] for i, name in enumerate(light_groups)
    }


def black_passes(width: int, height: int, light_groups: Sequence[str] = ()) -> Passes:
    """The result of a render that was cancelled before its first pass."""
    infos = [*PASSES, *map(light_group_pass, light_groups)]
    return {p.name: np.zeros((height, width, len(p.channels)), np.float32) for p in infos}
