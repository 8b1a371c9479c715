"""Recognizes programs that amount to Lambertian reflection and emission with constants or one
image, for which the renderer has a faster way.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.scene import NO_TEXTURE
from .compiler import Compiled
from .values import NONE, ORIGIN, ZERO, Instruction, Value

Rgb = tuple[float, float, float]


@dataclass(slots=True)
class Linear:
    """constant + sum over textures of factor * texture, linear RGB (3,) each."""

    constant: NDArray[np.float64]
    textured: dict[int, NDArray[np.float64]] = field(default_factory=dict)

    def __mul__(self, factor: NDArray[np.float64] | float) -> Linear:
        return Linear(self.constant * factor, {k: v * factor for k, v in self.textured.items()})

    def __add__(self, other: Linear) -> Linear:
        textured = dict(self.textured)
        for k, v in other.textured.items():
            textured[k] = textured.get(k, np.zeros(3)) + v
        return Linear(self.constant + other.constant, textured)

    def single(self) -> tuple[Rgb, int] | None:
        """(factor, texture) if the function is no more than that, else None."""
        used = {k: v for k, v in self.textured.items() if v.any()}
        if not used:
            return _triple(self.constant), NO_TEXTURE
        if len(used) > 1 or self.constant.any():
            return None
        ((texture, factor),) = used.items()
        return _triple(factor), texture


def _triple(value: NDArray[np.float64]) -> Rgb:
    return float(value[0]), float(value[1]), float(value[2])


def lambertian(compiled: Compiled) -> tuple[tuple[Rgb, int], tuple[Rgb, int]] | None:
    """((albedo, texture), (emission, texture)) that a program comes to exactly, or None."""
    albedo, emission = Linear(np.zeros(3)), Linear(np.zeros(3))
    for made in compiled.statements:
        name = made.operation.name
        if name not in {"Diffuse", "Emission"} or not made.weight.is_constant:
            return None
        if name == "Diffuse" and (made.get("normal") != ORIGIN or made.get("roughness") != ZERO):
            return None
        color = linear(compiled, made.get("color"))
        if color is None:
            return None
        share = color * made.weight.data[0]
        if name == "Diffuse":
            albedo = albedo + share
        else:
            emission = emission + share
    single = albedo.single(), emission.single()
    return None if single[0] is None or single[1] is None else (single[0], single[1])


def linear(compiled: Compiled, value: Value) -> Linear | None:
    """A colour as a linear function of textures on the render-active UV map, or None."""
    known: dict[Value, Linear | None] = {}
    waiting = [value]
    while waiting:  # each value once, those that it is made of first
        open_ends = [part for part in _parts(compiled, waiting[-1]) if part not in known]
        if open_ends:
            waiting += open_ends
        else:
            one = waiting.pop()
            known[one] = _linear(compiled, one, known)
    return known[value]


def _parts(compiled: Compiled, value: Value) -> list[Value]:
    """The colours that a sum or a product is made of."""
    if value.is_constant:
        return []
    instruction = compiled.graph.instructions[value.instruction]
    names = {"ScaleVector": ("a",), "MixColor": ("a", "b")}.get(instruction.operation.name, ())
    return [_get(instruction, name) for name in names]


def _linear(compiled: Compiled, value: Value, known: dict[Value, Linear | None]) -> Linear | None:
    """The linear function of a value whose inputs are already known."""
    if value.is_constant:
        return Linear(np.array(value.data, np.float64))
    instruction = compiled.graph.instructions[value.instruction]
    name = instruction.operation.name
    if value.data[1]:
        return None
    if name == "ImageTexture":
        return _image(compiled, instruction) if value.data[0] == 0 else None
    if name == "ScaleVector":
        a, factor = _get(instruction, "a"), _get(instruction, "b")
        found = known[a]
        return found * factor.data[0] if found is not None and factor.is_constant else None
    if name == "MixColor":
        return _mix(instruction, known)
    return None


def _get(instruction: Instruction, name: str) -> Any:
    return instruction.operands[
        next(i for i, operand in enumerate(instruction.operation.operands) if operand.name == name)
    ]


def _mode(instruction: Instruction, name: str) -> str:
    operand = next(operand for operand in instruction.operation.operands if operand.name == name)
    return operand.modes[_get(instruction, name)]


def _image(compiled: Compiled, instruction: Instruction) -> Linear | None:
    where = _get(instruction, "vector")
    if (
        where.is_constant
        or _mode(instruction, "projection") != "FLAT"
        or _mode(instruction, "unassociate") == "ON"
    ):
        return None
    source = compiled.graph.instructions[where.instruction]
    if source.operation.name != "UvMap" or _get(source, "attribute") != NONE:
        return None
    return Linear(np.zeros(3), {_get(instruction, "image"): np.ones(3)})


def _mix(instruction: Instruction, known: dict[Value, Linear | None]) -> Linear | None:
    """Mix and Multiply of colours by a constant factor; the latter where one of the colours is
    constant.
    """
    factor = _get(instruction, "factor")
    kind = _mode(instruction, "blend_type")
    if (
        not factor.is_constant
        or _mode(instruction, "clamp_result") == "ON"
        or kind not in {"MIX", "MULTIPLY"}
    ):
        return None
    share = factor.data[0]
    if _mode(instruction, "clamp_factor") == "ON":
        share = min(max(share, 0.0), 1.0)
    a, b = known[_get(instruction, "a")], known[_get(instruction, "b")]
    if a is None or b is None:
        return None
    if kind == "MIX":
        return a * (1.0 - share) + b * share
    if not a.textured:
        return a * (1.0 - share) + b * a.constant * share
    return a * (1.0 - share) + a * b.constant * share if not b.textured else None
