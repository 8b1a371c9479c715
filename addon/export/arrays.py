"""Blender's arrays as numpy arrays: without a copy where memory allows it, by foreach_get
elsewhere.

A view reads Blender's own memory: it is valid until the next change of the dependency graph, so
whatever outlives the export must be copied out of it.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..core.native.library import load

FEW = 512
"""So few elements are copied without a check: copying them is faster than the check."""

MANY = 1 << 16
"""So many rows are gathered by all threads."""


def read(collection: Any, attribute: str, dtype: DTypeLike, width: int = 1) -> NDArray:
    """(n, width) array, or (n,) for width 1, of `attribute` of all n elements of a Blender
    collection. Read only.
    """
    shape = (len(collection), width) if width > 1 else (len(collection),)
    if shape[0] == 0:
        return np.empty(shape, dtype)
    view = _view(collection, attribute, np.dtype(dtype), width) if shape[0] > FEW else None
    return read_copy(collection, attribute, dtype, width) if view is None else view.reshape(shape)


def gathered(values: NDArray, indices: NDArray) -> NDArray:
    """values[indices], of four bytes a number. ValueError for an index that does not exist."""
    if indices.size < MANY:
        return values[indices]
    result = np.empty((*indices.shape, *values.shape[1:]), values.dtype)
    width = int(np.prod(values.shape[1:]))
    load().gather(
        np.ascontiguousarray(values).view(np.uint32).reshape(len(values), width),
        np.ascontiguousarray(indices, np.int32).view(np.uint32).reshape(-1),
        result.view(np.uint32).reshape(-1, width),
    )
    return result


def read_copy(collection: Any, attribute: str, dtype: DTypeLike, width: int = 1) -> NDArray:
    """As `read`, by foreach_get: the way that Blender's interface promises."""
    count = len(collection)
    flat = np.empty(count * width, dtype)
    if count:
        collection.foreach_get(attribute, flat)
    return flat.reshape((count, width) if width > 1 else (count,))


def _view(collection: Any, attribute: str, dtype: np.dtype, width: int) -> NDArray | None:
    """A view of the elements' memory, or None where they are not one plain array of `dtype`, as
    Blender reads it.
    """
    count = len(collection)
    size = dtype.itemsize * width
    try:
        first, last = collection[0].as_pointer(), collection[count - 1].as_pointer()
    except (AttributeError, TypeError):
        return None
    if not first or last - first != (count - 1) * size:
        return None
    view = np.frombuffer((ctypes.c_char * (count * size)).from_address(first), dtype).reshape(
        count, width
    )
    view.flags.writeable = False
    for index in {0, count // 2, count - 1}:
        value = np.atleast_1d(np.array(getattr(collection[index], attribute), dtype))
        if not np.array_equal(view[index], value, equal_nan=dtype.kind == "f"):
            return None
    return view
