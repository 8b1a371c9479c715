"""How long edges are to be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..native.library import load
from .eye import Eye

if TYPE_CHECKING:
    import photon_splat_native


@dataclass(frozen=True, slots=True)
class Wanted:
    """Edges of `length` pixels, or of so many units of the mesh's own measure without an eye;
    `levels`: how often an edge may be halved.
    """

    length: float
    levels: int
    eye: Eye | None

    def native(self, matrix: NDArray[np.float64]) -> photon_splat_native.WantedEdges:
        """For a mesh that stands by `matrix`."""
        eye = None if self.eye is None else self.eye.native()
        return load().WantedEdges(self.length, eye, np.ascontiguousarray(matrix, np.float64))
