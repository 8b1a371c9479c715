"""A box of 4 x 4 x 3 m of one material, on the floor's middle."""

from __future__ import annotations

import math
from typing import Any

from tests.support import stage


def walls(material: Any, *, ceiling: bool = True) -> None:
    import bpy

    up, side = math.pi / 2, (0.0, math.pi / 2, 0.0)
    sheets = [((0, 0, 0), (0, 0, 0), (4, 4, 1))]
    sheets += [((0, 0, 3), (math.pi, 0, 0), (4, 4, 1))] if ceiling else []
    sheets += [((0, y, 1.5), (up, 0, 0), (4, 3, 1)) for y in (-2, 2)]
    sheets += [((x, 0, 1.5), side, (3, 4, 1)) for x in (-2, 2)]
    for place, turn, size in sheets:
        bpy.ops.mesh.primitive_plane_add(size=1, location=place, rotation=turn)
        wall = bpy.context.object
        wall.scale = size
        wall.data.materials.append(material)


def lit_room(material: Any) -> Any:
    """Lit from the ceiling. Returns the camera, which looks along +Y from before the wall."""
    walls(material)
    stage.lamp("AREA", 80, (0.3, 0.2, 2.9)).data.size = 1
    seen_from = stage.camera((0, -1.9, 1.5))
    seen_from.rotation_euler = (math.pi / 2, 0, 0)
    seen_from.data.angle = 1.6
    return seen_from
