"""How a render engine of Blender looks through cameras in one of several views: stereo pictures and
sets of cameras.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Stereo


class View:
    """One view of a picture that has several. Blender moves the camera for it, but for spherical
    stereo, whose every ray has an eye of its own.
    """

    def __init__(self, engine: Any, name: str) -> None:
        self._engine, self.name = engine, name

    def enter(self) -> None:
        """From now on Blender answers for this view."""
        self._engine.active_view_set(self.name)

    def matrix(self, ob: Any) -> NDArray[np.float64]:
        spherical = self._engine.use_spherical_stereo(ob)
        return np.array(
            self._engine.camera_model_matrix(ob, use_spherical_stereo=spherical), np.float64
        )

    def shift_x(self, ob: Any) -> float:
        spherical = self._engine.use_spherical_stereo(ob)
        return float(self._engine.camera_shift_x(ob, use_spherical_stereo=spherical))

    def stereo(self, ob: Any) -> Stereo | None:
        if not self._engine.use_spherical_stereo(ob):
            return None
        asked = ob.data.stereo
        half = 0.5 * float(asked.interocular_distance)
        return Stereo(
            offset=-half if self.name == "left" else half,
            convergence=math.inf
            if asked.convergence_mode == "PARALLEL"
            else float(asked.convergence_distance),
            merge=(float(asked.pole_merge_angle_from), float(asked.pole_merge_angle_to))
            if asked.use_pole_merge
            else None,
        )


def views_of(engine: Any, result: Any, scene: Any) -> list[View | None]:
    """Of a render result that has been begun; [None] where there is but one."""
    if not scene.render.use_multiview:
        return [None]
    return [View(engine, view.name) for view in result.views]
