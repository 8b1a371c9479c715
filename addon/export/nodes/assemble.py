"""Statements and the values that they read -> code: what is not read falls away, branches of weight
0 are jumped over.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from ...core.scene.shading import GENERATED, Feature, Program
from .values import (
    CONSTANT_BIT,
    NONE,
    TABLES,
    UNMOVED,
    UNUSED,
    BumpOffset,
    Graph,
    Instruction,
    Operation,
    Value,
    operations,
)

ROOT = -1
MOST_TOGETHER = 1024  # the most noise textures that one Together instruction takes
MOST_REGISTERS = 1024
"""Most registers of a program whose instructions are sorted into steps. A program that would need
more uses each result as soon as possible instead.
"""

Order = list[tuple[str, Any]]


@dataclass(slots=True)
class Statement:
    """A closure: an instruction without results. `weight` not constant: everything that only it
    reads is jumped over where it is 0.
    """

    operation: Operation
    operands: tuple[Any, ...]
    weight: Value

    def reads(self) -> list[Value]:
        return [v for v in self.operands if isinstance(v, Value)]

    def get(self, name: str) -> Any:
        return self.operands[
            next(i for i, operand in enumerate(self.operation.operands) if operand.name == name)
        ]


def statement(name: str, **given: Any) -> Statement:
    operation = operations()[name]
    operands = tuple(Graph._operand(operation, operand, given) for operand in operation.operands)
    if given:
        raise TypeError(f"{name} has no operand {', '.join(given)}")
    return Statement(operation, operands, operands[0])


def live_instructions(graph: Graph, statements: list[Statement]) -> set[int]:
    """Indices of the instructions that some statement needs."""
    found: set[int] = set()
    open_ends = [value for made in statements for value in made.reads()]
    while open_ends:
        value = open_ends.pop()
        if not value.is_constant and value.instruction not in found:
            found.add(value.instruction)
            instruction = graph.instructions[value.instruction]
            open_ends.extend(instruction.reads())
            if instruction.offset is not None:
                open_ends.append(instruction.offset.width)
    return found


def assemble(name: str, graph: Graph, statements: list[Statement], features: Feature) -> Program:
    homes = _homes(graph, statements)
    code = _written(graph, statements, homes, _in_steps)
    if code.registers > MOST_REGISTERS:
        code = _written(graph, statements, homes, _as_they_are)
    words, constants = code.finish()
    wants: set[int] = set()
    wants_instances: set[int] = set()
    for index in homes:
        instruction = graph.instructions[index]
        if _uses_generated(instruction):
            wants.add(GENERATED)
        into = wants_instances if instruction.operation.name == "InstanceAttribute" else wants
        for operand, value in zip(
            instruction.operation.operands, instruction.operands, strict=True
        ):
            if operand.kind == "a" and value != NONE:
                into.add(value)
    return Program(
        name,
        words,
        constants,
        code.registers,
        features,
        frozenset(wants),
        frozenset(wants_instances),
    )


def _written(
    graph: Graph,
    statements: list[Statement],
    homes: dict[int, int],
    in_order: Callable[[Graph, list[int]], Order],
) -> _Code:
    code = _Code(graph)
    blocks: dict[int, list[int]] = {}
    for index in sorted(homes):
        blocks.setdefault(homes[index], []).append(index)
    order = in_order(graph, blocks.get(ROOT, []))
    for k, made in enumerate(statements):
        guarded = not made.weight.is_constant
        if guarded:
            order.append(("guard", made.weight))
        order += in_order(graph, blocks.get(k, []))
        order.append(("statement", made))
        if guarded:
            order.append(("label", None))
    code.emit(order)
    return code


def _uses_generated(instruction: Instruction) -> bool:
    name = instruction.operation.name
    if name in {"TextureCoordinate", "Geometry"}:
        return instruction.operation.operands[1].modes[instruction.operands[1]] in {
            "GENERATED",
            "TANGENT",
        }
    return name == "TangentRadial"


def _homes(graph: Graph, statements: list[Statement]) -> dict[int, int]:
    """Where each needed instruction stands: with the only guarded statement that needs it, or at
    the beginning (ROOT).
    """
    homes: dict[int, int] = {}

    def need(value: Value, home: int) -> None:
        if not value.is_constant:
            known = homes.get(value.instruction)
            homes[value.instruction] = home if known is None or known == home else ROOT

    for k, made in enumerate(statements):
        guarded = not made.weight.is_constant
        for value in made.reads():
            need(value, k if guarded and value != made.weight else ROOT)
    for index in range(len(graph.instructions) - 1, -1, -1):
        if index in homes:
            instruction = graph.instructions[index]
            for value in instruction.reads():
                need(value, homes[index])
            if instruction.offset is not None:
                need(instruction.offset.width, homes[index])
    return homes


def _as_they_are(_: Graph, block: list[int]) -> Order:
    return [("instruction", index) for index in block]


def _in_steps(graph: Graph, block: list[int]) -> Order:
    """Sorts a block's instructions into steps of mutually independent ones, so that a processor can
    work at several at a time. Noise textures that do not need one another are computed together,
    after everything else that can be done before them.
    """
    depth: dict[int, int] = {}  # noise textures that come one after another before it
    step: dict[int, int] = {}
    key: dict[int, tuple[int, ...]] = {}
    offsets: dict[BumpOffset | None, int] = {None: 0, UNMOVED: 1}
    for index in block:
        instruction = graph.instructions[index]
        read = instruction.reads() + (
            [instruction.offset.width] if instruction.offset is not None else []
        )
        before = [value.instruction for value in read if value.instruction in depth]
        depth[index] = max(
            (depth[one] + (dimensions_of_noise(graph.instructions[one]) > 0) for one in before),
            default=0,
        )
        step[index] = max((step[one] + 1 for one in before), default=0)
        offset = offsets.setdefault(instruction.offset, len(offsets))
        key[index] = (
            depth[index],
            dimensions_of_noise(instruction),
            step[index],
            offset,
            instruction.operation.opcode,
            index,
        )
    order: Order = []
    for (_, noisy), group in groupby(
        sorted(block, key=lambda index: key[index]), key=lambda index: key[index][:2]
    ):
        some = list(group)
        if noisy and 1 < len(some) <= MOST_TOGETHER:
            order.append(("together", len(some)))
        order += [("instruction", index) for index in some]
    return order


def dimensions_of_noise(instruction: Instruction) -> int:
    """Of the noise of textures whose noise can be computed together with others'; else 0."""
    if instruction.operation.name == "NoiseTexture":
        return 1 + int(instruction.get("noise_dimensions"))
    return 3 if instruction.operation.name == "WaveTexture" else 0


class _Code:
    """Words, constants and registers of a program while it is written."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.words: list[int] = []
        self.constants: list[float] = []
        self.registers = 0
        self._constant_at: dict[tuple[float, ...], int] = {}
        self._register_at: dict[tuple[int, int], int] = {}
        self._free: dict[int, list[int]] = {1: [], 3: []}

    def emit(self, order: Order) -> None:
        last, wanted = self._uses(order)
        dying: dict[int, list[tuple[int, int]]] = {}
        for result, position in last.items():
            dying.setdefault(position, []).append(result)
        offset: BumpOffset = UNMOVED
        target = 0
        for position, (kind, what) in enumerate(order):
            if kind == "guard":
                if offset != UNMOVED:
                    offset = self._move_to(UNMOVED)
                self.words += [operations()["JumpIfZero"].opcode, self._read(what), 0]
                target = len(self.words) - 1
            elif kind == "label":
                if offset != UNMOVED:
                    offset = self._move_to(UNMOVED)
                self.words[target] = len(self.words)
            elif kind == "together":
                self.words += [operations()["Together"].opcode, what]
            elif kind == "instruction":
                instruction = self.graph.instructions[what]
                if instruction.offset is not None and instruction.offset != offset:
                    offset = self._move_to(instruction.offset)
                self._write(instruction, what, wanted)
            else:
                if offset != UNMOVED:
                    offset = self._move_to(UNMOVED)
                self._write(what, None, wanted)
            for result in dying.get(position, ()):
                width = 3 if self._is_vector(result) else 1
                self._free[width].append(self._register_at[result])
        self.words.append(operations()["End"].opcode)

    def finish(self) -> tuple[Any, Any]:
        return np.array(self.words, np.uint32), np.array(self.constants or [0.0], np.float32)

    def _uses(self, order: Order) -> tuple[dict[tuple[int, int], int], set[tuple[int, int]]]:
        """Position of the last use of every result (instruction, operand), and which are used at
        all.
        """
        last: dict[tuple[int, int], int] = {}
        for position, (kind, what) in enumerate(order):
            reads: list[Value] = []
            if kind == "guard":
                reads = [what]
            elif kind == "statement":
                reads = what.reads()
            elif kind == "instruction":
                instruction = self.graph.instructions[what]
                reads = instruction.reads()
                if instruction.offset is not None:
                    reads.append(instruction.offset.width)
            for value in reads:
                if not value.is_constant:
                    last[value.instruction, int(value.data[0])] = position
        return last, set(last)

    def _is_vector(self, result: tuple[int, int]) -> bool:
        return self.graph.instructions[result[0]].operation.operands[result[1]].kind == "V"

    def _move_to(self, offset: BumpOffset) -> BumpOffset:
        operation = operations()["Offset"]
        self.words += [
            operation.opcode,
            operation.operands[0].modes.index(offset.axis),
            self._read(offset.width),
        ]
        return offset

    def _write(
        self, instruction: Instruction | Statement, index: int | None, wanted: set[tuple[int, int]]
    ) -> None:
        words = [instruction.operation.opcode]
        for i, (operand, value) in enumerate(
            zip(instruction.operation.operands, instruction.operands, strict=True)
        ):
            if operand.kind in {"F", "V"}:
                result = (-1 if index is None else index, i)
                words.append(
                    self._allocate(result, 3 if operand.kind == "V" else 1)
                    if result in wanted
                    else UNUSED
                )
            elif isinstance(value, Value):
                words.append(self._read(value))
            elif operand.kind in TABLES:
                words.append(self._constant(value))
            else:
                words.append(int(value))
        self.words += words

    def _allocate(self, result: tuple[int, int], width: int) -> int:
        if self._free[width]:
            at = self._free[width].pop()
        else:
            at = self.registers
            self.registers += width
        self._register_at[result] = at
        return at

    def _read(self, value: Value) -> int:
        if value.is_constant:
            return self._constant(value.data) | CONSTANT_BIT
        return self._register_at[value.instruction, int(value.data[0])] + int(value.data[1])

    def _constant(self, data: tuple[float, ...]) -> int:
        at = self._constant_at.get(data)
        if at is None:
            at = self._constant_at[data] = len(self.constants)
            self.constants.extend(data)
        return at
