"""What a world's textures look up: maps of directions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .nodes.links import Source, default_value

Matrix = NDArray[np.float64]
DIRECTION_OUTPUTS = {"TEX_COORD": {"Generated", "Object"}, "NEW_GEOMETRY": {"Position"}}
"""Outputs that are the direction itself in a world."""


def direction_map(texture: Source) -> Matrix | None:
    """(4, 4) from a direction to what the texture looks up; None if that is no affine map of
    it.
    """
    vector = texture.input("Vector")
    own = texture.node.texture_mapping
    matrix = _mapping(own.vector_type, own.translation, own.rotation, own.scale)
    while vector is not None and vector.node is not None:
        node = vector.node
        if node.type == "MAPPING":
            values = [vector.input(name) for name in ("Location", "Rotation", "Scale")]
            if any(value is not None and value.node is not None for value in values):
                return None
            location, rotation, scale = (
                default_value(v.socket) if v is not None else d
                for v, d in zip(values, (0, 0, 1), strict=True)
            )
            matrix = matrix @ _mapping(node.vector_type, location, rotation, scale)
            vector = vector.input("Vector")
            if vector is not None and vector.node is None:
                return None
        elif (
            vector.socket.name in DIRECTION_OUTPUTS.get(node.type, ())
            and getattr(node, "object", None) is None
        ):
            return matrix
        else:
            return None
    return matrix


def _mapping(kind: str, location: Any, rotation: Any, scale: Any) -> Matrix:
    """(4, 4) of Blender's Mapping node (and of a texture's own mapping)."""
    from mathutils import Euler

    place, turn, size = np.eye(4), np.eye(4), np.eye(4)
    place[:3, 3] = location
    turn[:3, :3] = np.array(Euler(np.broadcast_to(rotation, 3).tolist()).to_matrix())
    factors = np.broadcast_to(np.asarray(scale, np.float64), 3)
    if kind in {"TEXTURE", "NORMAL"}:
        factors = np.divide(1.0, factors, out=np.zeros(3), where=factors != 0.0)
    size[:3, :3] = np.diag(factors)
    if kind == "TEXTURE":
        place[:3, 3] *= -1.0
        return size @ turn.T @ place
    return turn @ size if kind in {"VECTOR", "NORMAL"} else place @ turn @ size
