"""Where what the graph shows stands."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .geometry.flatness import ordinary


class Matrices:
    """Of the instances of a graph, (4, 4) to the world, by their places in it.

    In Blender 5.2 an instance that comes first, and is the only one of its maker, says of itself
    where the next object stands, if that has instances too. Its own object knows better then, and
    only then.
    """

    def __init__(self, depsgraph: Any) -> None:
        found = np.empty((1024, 4, 4))
        own: NDArray[np.float64] | None = None
        count = 0
        for count, instance in enumerate(depsgraph.object_instances, 1):
            if count > len(found):
                found = np.concatenate([found, np.empty_like(found)])
            found[count - 1] = instance.matrix_world
            if count == 1 and instance.is_instance:
                own = np.array(instance.object.matrix_world, np.float64)
            if count == 2 and own is not None:
                if not instance.is_instance and np.array_equal(found[0], found[1]):
                    found[0] = own
                own = None
        self._all = found[:count]
        self.ordinary: list[bool] = ordinary(self._all).tolist()
        """Where is_flat() would find nothing."""

    def of(self, place: int) -> NDArray[np.float64]:
        return self._all[place]
