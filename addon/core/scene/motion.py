"""What moves while the shutter is open.

Steps are evenly spread over the time that it is open: the first where it opens, the last where it
closes, the middle one (there is one) where everything else of a scene is described.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(slots=True)
class Shutter:
    """`curve` (K,) float32: how far open it is at equal steps of its time. `rolling`: share of its
    time that each line of the picture is exposed for, the topmost first; negative: all at once.
    """

    curve: NDArray[np.float32]
    rolling: float = -1.0


@dataclass(slots=True)
class MeshMotion:
    """A mesh at S steps: positions (S, V, 3); corner_normals (S, T, 3, 3) or vertex_normals
    (S, V, 3), or neither: the mesh is flat, or its normals turn with its triangles.
    """

    positions: NDArray[np.float32]
    corner_normals: NDArray[np.float32] | None = None
    vertex_normals: NDArray[np.float32] | None = None


@dataclass(slots=True)
class CameraMotion:
    """A camera at S steps: matrices (S, 4, 4) as Camera.matrix; `zoom`: size of its screen where
    the shutter opens and where it closes, over that in the middle.
    """

    matrices: NDArray[np.float64]
    zoom: tuple[float, float] = (1.0, 1.0)
