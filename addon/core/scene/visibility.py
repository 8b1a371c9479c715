"""Kinds of ray, and groups of things that light and shadow tell apart."""

from __future__ import annotations

from enum import IntFlag


class Ray(IntFlag):
    """Kinds of ray, as bits; native code has the same order (RayInfo::Kind). Light samples come by
    shadow rays.
    """

    CAMERA = 1
    SHADOW = 2
    DIFFUSE = 4
    GLOSSY = 8
    TRANSMISSION = 16


ALL_RAYS = 0xFFFFFFFF
GROUPS = 64
ALL_GROUPS = (1 << GROUPS) - 1
NO_LIGHT_GROUP = -1
