"""Kinds of ray, and groups of things that light and shadow tell apart."""

from __future__ import annotations

from enum import IntFlag

import numpy as np


class Ray(IntFlag):
    """Kinds of ray, as bits in the order of the native RayInfo::Kind. Light that a light sample
    brings counts as brought by a shadow ray.
    """

    CAMERA = 1
    SHADOW = 2
    DIFFUSE = 4
    GLOSSY = 8
    TRANSMISSION = 16
    VOLUME = 64


ALL_RAYS = 0xFFFFFFFF
GROUPS = 64
ALL_GROUPS = (1 << GROUPS) - 1
NO_LIGHT_GROUP = -1
TERMINATOR_OFFSET = float(np.float32(0.1))
"""Shading > Geometry Offset, as Blender has it."""
