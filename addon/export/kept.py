"""Keeps arrays of meshes and images from one export to the next, as long as they do not change."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from typing import Any, TypeVar

from .report import Report

Value = TypeVar("Value")


class Kept:
    """Values by key, with the warnings that came with them and the identities (`identity`) of what
    they were made of.
    """

    def __init__(self) -> None:
        self._values: dict[Hashable, tuple[Any, Report, frozenset[int]]] = {}
        self._used: set[Hashable] = set()
        self.made = 0

    def get(
        self, key: Hashable, sources: Iterable[int], report: Report, make: Callable[[Report], Value]
    ) -> Value:
        """The value of `key`: what `make`, which writes its warnings to the report it is given,
        returned before or returns now.
        """
        self._used.add(key)
        if key not in self._values:
            own = Report()
            self._values[key] = (make(own), own, frozenset(sources))
            self.made += 1
        value, warnings, _ = self._values[key]
        report.add(warnings)
        return value

    def forget(self, sources: Iterable[int]) -> None:
        """Drops what was made from any of these data-blocks."""
        changed = set(sources)
        self._values = {key: entry for key, entry in self._values.items() if not entry[2] & changed}

    def forget_unused(self) -> None:
        """Drops what nobody has asked for since the last call."""
        self._values = {key: entry for key, entry in self._values.items() if key in self._used}
        self._used.clear()

    def clear(self) -> None:
        self._values.clear()


def identity(block: Any) -> int:
    """A number that a data-block of Blender keeps for the session; the same for its evaluated
    copies. 0: no data-block.
    """
    return 0 if block is None else int(block.original.session_uid)
