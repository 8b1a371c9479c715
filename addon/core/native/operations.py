"""What a shader program does, read from its code."""

from __future__ import annotations

from collections.abc import Iterator

from ..scene.shading import Program
from .library import load


def operations_of(program: Program) -> Iterator[tuple[str, list[tuple[str, int]]]]:
    """The name of each operation, and its operands: kind (see ops.def) and word."""
    named = {
        opcode: (name, [kind for kind, _, _ in operands])
        for name, (opcode, operands) in load().shader_operations().items()
    }
    words, at = program.code.tolist(), 0
    while at < len(words):
        name, kinds = named[words[at]]
        at += 1
        yield name, list(zip(kinds, words[at : at + len(kinds)], strict=True))
        at += len(kinds)


def textures_of(program: Program) -> Iterator[int]:
    """Indices of the textures that a program names."""
    for _, operands in operations_of(program):
        yield from (word for kind, word in operands if kind == "t")
