"""Where what the graph shows stands."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def matrix_of(instance: Any) -> NDArray[np.float64]:
    """(4, 4) to the world, of an instance of the graph.

    Its object is asked: in Blender 5.2 an instance that comes first in the graph says of itself
    what the next one is, if that is of another object.
    """
    return np.array(instance.object.matrix_world, np.float64)
