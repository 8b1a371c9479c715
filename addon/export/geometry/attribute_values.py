"""The numbers of Blender's attributes, and of an attribute of edges at vertices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..arrays import read_copy

# For each type of attribute: the property that holds its value, its number of components, and what
# that property is read as.
_STORED: dict[str, tuple[str, int, DTypeLike]] = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT4": ("vector", 4, np.float32),
    "QUATERNION": ("value", 4, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}


def numbers_of(attribute: Any) -> NDArray[np.float32] | None:
    """(N, C) of the N elements, colours linear; 0 for what is not finite. None for what holds no
    numbers.
    """
    if attribute.data_type not in _STORED:
        return None
    field, width, dtype = _STORED[attribute.data_type]
    values = read_copy(attribute.data, field, dtype, width).astype(np.float32)
    return finite(values.reshape(-1, width))


def finite(values: NDArray) -> NDArray:
    """With 0 for what is not finite."""
    if np.isfinite(values).all():
        return values
    return np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)


def bytes_of(attribute: Any) -> NDArray[np.uint8]:
    """(N, 4) of colours of the type BYTE_COLOR, encoded in sRGB."""
    encoded = read_copy(attribute.data, "color_srgb", np.float32, 4)
    return np.rint(np.clip(encoded, 0.0, 1.0) * 255.0).astype(np.uint8)


def at_vertices(mesh: Any, values: NDArray, data_type: str) -> NDArray:
    """(V, C): an attribute of edges, (E, C), at each vertex by its edges, as Blender has it: their
    mean, in the attribute's own type. A truth is one where any edge's is, whole numbers are
    rounded, bytes cut off, rotations are mixed as their axes times their angles.
    """
    ends = read_copy(mesh.edges, "vertices", np.int32, 2)
    counts = np.bincount(ends.ravel(), minlength=len(mesh.vertices))[:, None]

    def mean(of: NDArray) -> NDArray[np.float32]:
        total = np.zeros((len(mesh.vertices), of.shape[1]), np.float32)
        for side in (0, 1):
            np.add.at(total, ends[:, side], of)
        return total * (np.float32(1.0) / np.maximum(counts, 1).astype(np.float32))

    if data_type == "BOOLEAN":
        return (mean(values) > 0).astype(np.float32)
    if data_type in {"INT", "INT8"}:
        found = mean(values)
        return np.copysign(np.floor(np.abs(found) + 0.5), found)
    if data_type == "BYTE_COLOR":
        return mean(values.astype(np.float32)).astype(np.uint8)
    if data_type == "QUATERNION":
        return _rotations(mean(_turns(values)))
    return mean(values)


def _turns(rotations: NDArray[np.float32]) -> NDArray[np.float32]:
    """Axes times angles of unit quaternions (w, x, y, z)."""
    sine = np.linalg.norm(rotations[:, 1:], axis=1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, rotations[:, :1])
    return (rotations[:, 1:] / np.maximum(sine, 1e-12) * angle).astype(np.float32)


def _rotations(turns: NDArray[np.float32]) -> NDArray[np.float32]:
    """Unit quaternions of no more than half a turn."""
    angle = np.linalg.norm(turns, axis=1, keepdims=True)
    axis = turns / np.maximum(angle, 1e-12)
    angle = np.where(angle > np.pi, angle - 2.0 * np.pi, angle)
    return np.hstack([np.cos(angle / 2), axis * np.sin(angle / 2)]).astype(np.float32)
