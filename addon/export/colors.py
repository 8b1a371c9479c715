"""Colours as a renderer needs them: a constant plus textures, each times a factor."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.scene import NO_TEXTURE, Rgb, Texture
from .images import Textures, linear_rgb


def rgb(value: ArrayLike) -> NDArray[np.float64]:
    """(3,) from a number, an RGB or an RGBA."""
    array = np.asarray(value, np.float64)
    return np.repeat(array, 3) if array.ndim == 0 else array[:3].copy()


@dataclass(slots=True)
class Color:
    """constant + sum over textures of factor * texture: linear RGB (3,) each; keys of `textured` are texture indices."""

    constant: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    textured: dict[int, NDArray[np.float64]] = field(default_factory=dict)

    @property
    def is_constant(self) -> bool:
        return not any(factor.any() for factor in self.textured.values())

    def __mul__(self, factor: ArrayLike) -> Color:
        scale = rgb(factor)
        return Color(self.constant * scale, {index: value * scale for index, value in self.textured.items()})

    def __add__(self, other: Color) -> Color:
        textured = dict(self.textured)
        for index, value in other.textured.items():
            textured[index] = textured.get(index, np.zeros(3)) + value
        return Color(self.constant + other.constant, textured)

    def mean(self, textures: Textures) -> NDArray[np.float64]:
        total = self.constant.copy()
        for index, factor in self.textured.items():
            total += factor * textures.mean(index)
        return total

    def as_texture(self, textures: Textures) -> tuple[Rgb, int, bool]:
        """(factor, texture index, exact): sums are baked into a new texture if all images have one size, else averaged."""
        used = {index: factor for index, factor in self.textured.items() if factor.any()}
        if not used:
            return _triple(self.constant), NO_TEXTURE, True
        first, *others = used
        if not others and not self.constant.any():
            return _triple(used[first]), first, True
        reading = [(t.pixels.shape[:2], t.interpolation, t.extension) for t in (textures.list[index] for index in used)]
        if any(r != reading[0] for r in reading):
            return _triple(self.mean(textures)), NO_TEXTURE, False
        model = textures.list[first]
        baked = np.ones((*reading[0][0], 4), np.float32)
        baked[..., :3] = self.constant
        for index, factor in used.items():
            baked[..., :3] += linear_rgb(textures.list[index]) * factor.astype(np.float32)
        name = " + ".join(textures.list[index].name for index in used)
        return (1.0, 1.0, 1.0), textures.add(Texture(name, baked, False, model.interpolation, model.extension)), True


def _triple(value: NDArray[np.float64]) -> Rgb:
    return (float(value[0]), float(value[1]), float(value[2]))
