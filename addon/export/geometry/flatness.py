"""Whether an instance's matrix leaves anything of its mesh."""

from __future__ import annotations

from itertools import chain
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from ..report import Report

FLAT = 1e-12
"""Volumes and areas of a scaled unit cube that count as none."""


def ordinary(matrices: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which of these (N, 4, 4) are ordinary for sure: nearly all. is_flat() looks at the others."""
    a, b, c = (matrices[:, :3, k] for k in range(3))
    with np.errstate(all="ignore"):
        most = np.abs(matrices[:, :3, :3]).max(axis=(1, 2), initial=0.0)
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        finite = np.isfinite(volume + matrices[:, :3, 3].sum(axis=1))
        return np.asarray((np.abs(volume) > FLAT * most**3) & finite)


def is_flat(matrix: NDArray[np.float64], name: str, report: Report) -> bool | None:
    """False: an ordinary matrix. True: it flattens the mesh into a plane. None: it leaves nothing
    of the object `name`, which `report` is told.
    """
    entries: list[list[float]] = matrix.tolist()
    if not all(map(isfinite, chain.from_iterable(entries))):
        report.warn("Objects left out, as their transformation is not a finite number: {}", name)
        return None
    rows = [row[:3] for row in entries[:3]]
    largest = max(map(abs, chain.from_iterable(rows)))
    if largest > 0.0:
        x, y, z = ([row[k] / largest for row in rows] for k in range(3))
        yz = _cross(y, z)
        if abs(x[0] * yz[0] + x[1] * yz[1] + x[2] * yz[2]) > FLAT:
            return False
        if max(map(abs, (*yz, *_cross(x, y), *_cross(x, z)))) > FLAT:
            return True
    report.warn("Objects left out, as their scale is zero: {}", name)
    return None


def _cross(a: list[float], b: list[float]) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
