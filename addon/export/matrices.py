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
        instances = depsgraph.object_instances
        flat = np.empty(16 * len(instances), np.float32)
        instances.foreach_get("matrix_world", flat)
        # Blender keeps them by columns.
        self.all = flat.reshape(-1, 4, 4).transpose(0, 2, 1).astype(np.float64, order="C")
        if len(self.all) > 1 and np.array_equal(self.all[0], self.all[1]):
            self._mend_first(instances)
        self.ordinary: list[bool] = ordinary(self.all).tolist()
        """Where is_flat() would find nothing."""

    def _mend_first(self, instances: Any) -> None:
        for place, instance in enumerate(instances):
            if instance.is_instance != (place == 0):
                return
            if place == 1:
                break
            own = np.array(instance.object.matrix_world, np.float64)
        self.all[0] = own

    def of(self, place: int) -> NDArray[np.float64]:
        return self.all[place]
