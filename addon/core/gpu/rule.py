"""Which of several methods splats a batch: the one that has been faster for batches like it, on the
card in use.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import median

Kind = tuple[int, int]

TRIALS = 3
"""Batches that each method is timed by."""


def kind_of(pairs: int, lists: int) -> Kind:
    """Batches are alike that have about as many photons a block (within a factor of 4: it goes with
    the square of the radius) and keep about as many blocks busy (within 16).
    """
    return (pairs // max(lists, 1)).bit_length() // 2, lists.bit_length() // 4


class Rule:
    """Times all methods in turn on the first batches of each kind, then keeps to the faster by the
    median.

    It outlives a render, as the card does. The choice differs from run to run with the timings; the
    sums do not, for all methods add in the same order.
    """

    def __init__(self) -> None:
        self._seconds: dict[Kind, dict[str, list[float]]] = {}

    def choose(self, kind: Kind, methods: Sequence[str]) -> str:
        timed = self._seconds.get(kind, {})
        fewest = min(methods, key=lambda name: len(timed.get(name, ())))
        if len(methods) == 1 or len(timed.get(fewest, ())) < TRIALS:
            return fewest
        return min(methods, key=lambda name: median(timed[name]))

    def record(self, kind: Kind, method: str, pairs: int, seconds: float) -> None:
        """Notes that a batch of `pairs` took `seconds`. After TRIALS batches nothing more is noted,
        so the choice stays.
        """
        times = self._seconds.setdefault(kind, {}).setdefault(method, [])
        if len(times) < TRIALS:
            times.append(seconds / max(pairs, 1))

    def choices(self) -> Counter[str]:
        """How many kinds each method is the faster for, where that is known."""
        known = [
            times
            for times in self._seconds.values()
            if len(times) > 1 and min(map(len, times.values())) == TRIALS
        ]
        return Counter(min(times, key=lambda name: median(times[name])) for times in known)
