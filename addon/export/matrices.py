"""Where what the graph shows stands."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Matrices:
    """Of the instances of a graph, (4, 4) to the world, by their places in it.

    In Blender 5.2 an instance that comes first, and is the only one of its maker, says of itself
    where the next object stands, if that has instances too. Its own object knows better then, and
    only then.
    """

    def __init__(self, depsgraph: Any) -> None:
        self._first: NDArray[np.float64] | None = None
        instances = iter(depsgraph.object_instances)
        first = next(instances, None)
        if first is None or not first.is_instance:
            return
        said, own = _matrix(first), _matrix(first.object)
        after = next(instances, None)
        if after is not None and not after.is_instance and np.array_equal(said, _matrix(after)):
            self._first = own

    def of(self, place: int, instance: Any) -> NDArray[np.float64]:
        return self._first if place == 0 and self._first is not None else _matrix(instance)


def _matrix(what: Any) -> NDArray[np.float64]:
    return np.array(what.matrix_world, np.float64)
