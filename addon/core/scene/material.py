"""Materials and textures: what surfaces are made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from numpy.typing import NDArray

Rgb = tuple[float, float, float]
NO_TEXTURE = -1
NO_PROGRAM = -1


class Interpolation(StrEnum):
    """How a texture is read between its pixels."""

    LINEAR = "linear"
    CLOSEST = "closest"
    CUBIC = "cubic"


class Extension(StrEnum):
    """How a texture continues outside the unit square; CLIP_OPAQUE: black with an alpha of 1."""

    REPEAT = "repeat"
    EXTEND = "extend"
    CLIP = "clip"
    CLIP_OPAQUE = "clip_opaque"
    MIRROR = "mirror"


@dataclass(slots=True)
class Texture:
    """An image: `pixels` (height, width, 4) uint8 or float32, RGBA, row 0 at v = 0 (bottom).

    `srgb` tells that the RGB of `pixels` is sRGB-encoded and is decoded when read; otherwise it is
    linear.
    """

    name: str
    pixels: NDArray
    srgb: bool = True
    interpolation: Interpolation = Interpolation.LINEAR
    extension: Extension = Extension.REPEAT


@dataclass(slots=True)
class Side:
    """One side of a surface: Lambertian reflectance and Lambertian emission.

    `base_color` is the diffuse albedo, multiplied by the texture's RGB if there is one; `emission`
    is the emitted radiance (W/m^2/sr), multiplied by its texture likewise. Texture indices point
    into `Scene.textures`.
    """

    base_color: Rgb = (0.8, 0.8, 0.8)
    base_color_texture: int = NO_TEXTURE
    emission: Rgb = (0.0, 0.0, 0.0)
    emission_texture: int = NO_TEXTURE


@dataclass(slots=True)
class Material:
    """A surface material; the two sides may differ (a Mix Shader driven by Geometry > Backfacing).

    `program`: index into Scene.programs; then the sides are not read. `volume`: the same of the
    medium behind the surface.
    """

    name: str
    front: Side = field(default_factory=Side)
    back: Side = field(default_factory=Side)
    program: int = NO_PROGRAM
    volume: int = NO_PROGRAM
    pass_index: int = 0
