"""Hands textures, node programs and materials to the native renderer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..scene import NO_PROGRAM, Scene, Side, Texture
from ..scene.shading import Program
from .convert import naming, rgb

if TYPE_CHECKING:
    from photon_splat_native import Renderer


def add_textures(renderer: Renderer, textures: Sequence[Texture]) -> None:
    """Pixels that several textures share are kept once."""
    # index of the first texture with these pixels: the others only read them differently and share
    # its memory
    stored: dict[int, int] = {}
    for index, texture in enumerate(textures):
        first = stored.setdefault(id(texture.pixels), index)
        if first != index and textures[first].srgb == texture.srgb:
            renderer.add_texture_reading(first, str(texture.interpolation), str(texture.extension))
            continue
        renderer.add_texture(
            np.ascontiguousarray(texture.pixels),
            texture.srgb,
            str(texture.interpolation),
            str(texture.extension),
        )


def add_program(renderer: Renderer, program: Program) -> int:
    """Returns its index."""
    return renderer.add_program(
        program.name, program.code, program.constants, program.registers, int(program.features)
    )


def add_materials(renderer: Renderer, scene: Scene) -> None:
    """Textures, programs and the materials that refer to them."""
    add_textures(renderer, scene.textures)
    for program in scene.programs:
        add_program(renderer, program)
    for material in scene.materials:
        with naming(f"material '{material.name}'"):
            if material.program != NO_PROGRAM:
                renderer.add_program_material(material.program)
            else:
                renderer.add_material(_side(material.front), _side(material.back))
            if material.volume != NO_PROGRAM:
                renderer.set_volume(material.volume)


def _side(side: Side) -> tuple:
    return (
        rgb(side.base_color),
        side.base_color_texture,
        rgb(side.emission),
        side.emission_texture,
    )
