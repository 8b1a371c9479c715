"""Values that a program computes, before they have registers: constants, and results of
instructions that stand once each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...core.native import library as native
from ...core.scene import SunDisc

CONSTANT_BIT = 0x80000000
UNUSED = 0x7FFFFFFF
NONE = 0xFFFFFFFF
TABLES = {"T1", "T3", "T4", "M", "P"}
# Operations that depend on the position of the hit. Offset moves that position, so each step of a
# Bump has results of its own.
MOVED_WITH_HIT = {
    "Geometry",
    "TextureCoordinate",
    "UvMap",
    "Attribute",
    "CurvesInfo",
    "PointInfo",
    "CameraData",
    "Wireframe",
    "TangentUv",
    "TangentRadial",
    "VectorDisplacement",
}
# Operations whose result depends on more than their operands.
OF_THE_HIT = MOVED_WITH_HIT | {
    *(
        "Fresnel",
        "LayerWeight",
        "LightFalloff",
        "VectorTransform",
        "Backfacing",
        "InstanceAttribute",
        "GridValue",
        "ObjectLocation",
    ),
    *("AmbientOcclusion", "Bevel", "Raycast"),
    *("LightPath", "NormalMap", "Bump", "DisplacementBump", "ImageTexture", "EnvironmentTexture"),
    "SunDisc",
}


class Operand(NamedTuple):
    kind: str
    name: str
    modes: tuple[str, ...]


class Operation(NamedTuple):
    name: str
    opcode: int
    operands: tuple[Operand, ...]


@cache
def operations() -> dict[str, Operation]:
    """Every instruction there is, as native code has it."""
    table = native.load().shader_operations()
    return {
        name: Operation(name, code, tuple(Operand(*operand) for operand in operands))
        for name, (code, operands) in table.items()
    }


class Value(NamedTuple):
    """A float (width 1) or a vector or colour (width 3).

    `instruction` < 0: the constant `data`; else output operand `data[0]` of that instruction, from
    component `data[1]` on.
    """

    width: int
    instruction: int
    data: tuple[float, ...]

    @property
    def is_constant(self) -> bool:
        return self.instruction < 0

    def component(self, index: int) -> Value:
        if self.is_constant:
            return number(self.data[index])
        return Value(1, self.instruction, (self.data[0], self.data[1] + index))


def number(value: float) -> Value:
    return Value(1, -1, (float(value),))


def vector(values: Sequence[float]) -> Value:
    x, y, z = (float(v) for v in values[:3])
    return Value(3, -1, (x, y, z))


ZERO, ONE = number(0.0), number(1.0)
ORIGIN = vector((0.0, 0.0, 0.0))


@dataclass(frozen=True, slots=True)
class BumpOffset:
    """Where a value is computed, relative to the hit. A Bump node computes its height a step of
    `width` along `axis` "DX" or "DY" away too; "NONE" is the hit itself. "BEFORE", "BEFORE_DX" and
    "BEFORE_DY" are the same on the surface that a displacement has moved from there.
    """

    axis: str = "NONE"
    width: Value = ZERO


UNMOVED = BumpOffset()


@dataclass(slots=True)
class Instruction:
    """`operands` in the operation's order: Value for what is read, None for what is written, words
    and tables as they are.
    """

    operation: Operation
    operands: tuple[Any, ...]
    # For operations that depend on the position of the hit; None: the same result everywhere.
    offset: BumpOffset | None

    def reads(self) -> list[Value]:
        return [v for v in self.operands if isinstance(v, Value)]

    def get(self, name: str) -> Any:
        return self.operands[
            next(i for i, operand in enumerate(self.operation.operands) if operand.name == name)
        ]


class Graph:
    """Instructions of one program, each different one once. Operands come before what reads
    them.
    """

    def __init__(self, folding: Folding) -> None:
        self.folding = folding
        self.instructions: list[Instruction] = []
        self.offset = UNMOVED
        self.sun_discs: list[SunDisc] = []  # of skies in a world
        self._known: dict[Any, int] = {}

    def add(self, name: str, **given: Any) -> dict[str, Value]:
        """Results of an operation by the names of its outputs. Given are Values, modes by name,
        numbers, texture and attribute ids, tables.

        With nothing but constants to read, and nothing of the hit, the results are constants.
        """
        operation = operations()[name]
        operands = tuple(self._operand(operation, operand, given) for operand in operation.operands)
        if given:
            raise TypeError(f"{name} has no operand {', '.join(given)}")
        offset = self.offset if name in MOVED_WITH_HIT else UNMOVED if name == "NormalMap" else None
        outputs = [
            (i, operand) for i, operand in enumerate(operation.operands) if operand.kind in "FV"
        ]
        if name not in OF_THE_HIT and all(v.is_constant for v in operands if isinstance(v, Value)):
            return folded(self.folding, operation, operands)
        key = (name, operands, offset)
        index = self._known.get(key)
        if index is None:
            index = self._known[key] = len(self.instructions)
            self.instructions.append(Instruction(operation, operands, offset))
        return {
            operand.name: Value(3 if operand.kind == "V" else 1, index, (i, 0))
            for i, operand in outputs
        }

    def one(self, name: str, **given: Any) -> Value:
        """The only result of an operation."""
        (value,) = self.add(name, **given).values()
        return value

    @staticmethod
    def _operand(operation: Operation, operand: Operand, given: dict[str, Any]) -> Any:
        if operand.kind in {"F", "V"}:
            return None
        try:
            value = given.pop(operand.name)
        except KeyError:
            raise TypeError(f"{operation.name} needs {operand.name}") from None
        if operand.kind in {"f", "v"} and value.width != (3 if operand.kind == "v" else 1):
            raise TypeError(f"{operation.name}: {operand.name} has the wrong width")
        if operand.kind == "m":
            if isinstance(value, bool):
                value = "ON" if value else "OFF"
            return operand.modes.index(value)
        return value

    # --- arithmetic, with what is trivial left out ---

    def multiply(self, a: Value, b: Value) -> Value:
        """Product of two floats."""
        for one, other in ((a, b), (b, a)):
            if one.is_constant and one.data[0] in (0.0, 1.0):
                return ZERO if one.data[0] == 0.0 else other
        return self.one("Multiply", a=a, b=b)

    def add_numbers(self, a: Value, b: Value) -> Value:
        for one, other in ((a, b), (b, a)):
            if one == ZERO:
                return other
        return self.one("Add", a=a, b=b)

    def scale(self, color: Value, factor: Value) -> Value:
        return color if factor == ONE else self.one("ScaleVector", a=color, b=factor)

    # --- conversions between kinds of sockets ---

    def convert(self, value: Value, from_type: str, to_type: str) -> Value:
        """As Cycles converts where a link joins sockets of different types (VALUE, VECTOR, RGBA and
        what is handled like them).
        """
        wide = to_type in {"VECTOR", "RGBA", "ROTATION", "SHADER"}
        if value.width == 3 and not wide:
            value = (
                self.one("Luminance", color=value)
                if from_type == "RGBA"
                else self.one("Average", value=value)
            )
        if to_type in {"INT", "BOOLEAN"}:
            return self.one("Math", a=value, b=ZERO, c=ZERO, operation="TRUNC", use_clamp=False)
        return self.one("Spread", value=value) if wide and value.width == 1 else value


class Folding:
    """Computes operations on constants, by native code itself."""

    def __init__(self) -> None:
        self._renderer: Any = None

    def run(self, words: list[int], constants: list[float], registers: int) -> NDArray[np.float32]:
        if self._renderer is None:
            self._renderer = native.load().Renderer(0)
        values = np.array(constants or [0.0], np.float32)
        return self._renderer.run_constant_program(np.array(words, np.uint32), values, registers)


def folded(folding: Folding, operation: Operation, operands: tuple[Any, ...]) -> dict[str, Value]:
    """Constant results of an operation on constants."""
    constants: list[float] = []
    words = [operation.opcode]
    outputs: list[tuple[str, int, int]] = []
    registers = 0
    for operand, value in zip(operation.operands, operands, strict=True):
        if operand.kind in {"F", "V"}:
            width = 3 if operand.kind == "V" else 1
            outputs.append((operand.name, registers, width))
            words.append(registers)
            registers += width
        elif isinstance(value, Value):
            words.append(len(constants) | CONSTANT_BIT)
            constants.extend(value.data)
        elif operand.kind in TABLES:
            words.append(len(constants))
            constants.extend(value)
        else:
            words.append(value)
    words.append(operations()["End"].opcode)
    result = folding.run(words, constants, registers)
    return {
        name: Value(width, -1, tuple(float(v) for v in result[at : at + width]))
        for name, at, width in outputs
    }
