"""Whether an instance's matrix leaves anything of its mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..report import Report

FLAT = 1e-12
"""Volumes and areas of a scaled unit cube that count as none."""


def is_flat(matrix: NDArray[np.float64], name: str, report: Report) -> bool | None:
    """False: an ordinary matrix. True: it flattens the mesh into a plane. None: it leaves nothing
    of the object `name`, which `report` is told.
    """
    if not np.isfinite(matrix).all():
        report.warn("Objects left out, as their transformation is not a finite number: {}", name)
        return None
    x, y, z = matrix[:3, 0], matrix[:3, 1], matrix[:3, 2]
    largest = np.abs(matrix[:3, :3]).max()
    if largest > 0.0:
        x, y, z = x / largest, y / largest, z / largest
        yz = np.array(
            (y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0])
        )
        if abs(x @ yz) > FLAT:
            return False
        if max(np.abs(yz).max(), np.abs(np.cross(x, y)).max(), np.abs(np.cross(x, z)).max()) > FLAT:
            return True
    report.warn("Objects left out, as their scale is zero: {}", name)
    return None
