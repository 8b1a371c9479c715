"""True displacement: what moves the vertices of a mesh before it is rendered."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .shading import Program

# Ids of the attributes that hold positions and smooth normals from before displacement.
UNDISPLACED, UNDISPLACED_NORMALS = 1, 2


@dataclass(frozen=True, slots=True)
class Displacement:
    """What a material does to the surface: `program` moves vertices; `bumps`: normals stay what
    they were, and the material's own program bends them.
    """

    program: Program
    bumps: bool


@dataclass(slots=True)
class Normals:
    """Smooth normals of a mesh that is displaced, whatever it is shaded with: of corners (T, 3, 3),
    or of vertices (V, 3) instead.

    smooth       (T,) bool, triangles that are shaded with them; None: all
    own_corners  those of corners are more than their vertices': there are sharp edges or custom
                 normals
    """

    corners: NDArray[np.float32] | None
    vertices: NDArray[np.float32] | None
    smooth: NDArray[np.bool_] | None = None
    own_corners: bool = False
