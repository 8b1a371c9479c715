"""How far a surface bends at its vertices: the Geometry node's Pointiness."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import read_copy


def pointiness(mesh: Any) -> NDArray[np.float32]:
    """(V,) of a bpy.types.Mesh: the angle between a vertex's normal and the mean direction of its
    edges, by pi, averaged with that of its neighbours. 0.5 where it is flat, more on ridges, less
    in grooves; 0 for a vertex without edges. Vertices in one place count as one.
    """
    places, whose = np.unique(
        read_copy(mesh.vertices, "co", np.float32, 3), axis=0, return_inverse=True
    )
    whose = whose.ravel()
    count = len(places)
    positions = places.astype(np.float64)
    normals = _sums(
        whose, read_copy(mesh.vertex_normals, "vector", np.float32, 3).astype(np.float64), count
    )
    edges = np.sort(whose[read_copy(mesh.edges, "vertices", np.int32, 2)].reshape(-1, 2), axis=1)
    edges = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0)
    first, second = edges.T
    along = _unit(positions[second] - positions[first])
    neighbours = np.bincount(edges.ravel(), minlength=count)
    mean = (_sums(first, along, count) - _sums(second, along, count)) / np.maximum(neighbours, 1)[
        :, None
    ]
    cosine = np.clip((_unit(normals) * mean).sum(axis=1), -1.0, 1.0)
    bend = np.where(neighbours > 0, np.arccos(cosine) / np.pi, 0.0)
    around = np.bincount(first, bend[second], count) + np.bincount(second, bend[first], count)
    smooth = (bend + around) / (neighbours + 1)
    return smooth[whose].astype(np.float32)


def _sums(
    index: NDArray[np.int64], vectors: NDArray[np.float64], count: int
) -> NDArray[np.float64]:
    """(count, 3): sums of `vectors` that share an index."""
    return np.stack([np.bincount(index, vectors[:, k], count) for k in range(3)], axis=1)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normalizes vectors; those of length 0 stay 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.nan_to_num(
        np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0)
    )
