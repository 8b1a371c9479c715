"""What numpy arrays and tuples become on their way to native code."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray


@contextmanager
def naming(what: str) -> Iterator[None]:
    """Puts `what` before the message of a ValueError."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from error


def rgb(color: tuple[float, float, float]) -> list[float]:
    return [float(c) for c in color]


def contiguous(values: NDArray | None, dtype: type) -> NDArray | None:
    return None if values is None else np.ascontiguousarray(values, dtype)


def first_of(names: list[str], most: int = 3) -> str:
    """The first of many names, for a sentence, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
