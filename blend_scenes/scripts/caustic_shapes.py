"""Measures of the four caustic scenes, without bpy: tests/reference/caustics traces the same shapes
by formula.

Metres, Z up, tables at z = 0 unless said otherwise. Lamps are squares of Lambertian radiance POWER
/ (pi SIZE^2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Glass:
    """caustic_glass: a glass ball on a table under a small bright lamp."""

    TABLE_HALF, TABLE_ALBEDO = 1.0, (0.5, 0.42, 0.34)
    CENTRE, RADIUS, IOR = (0.0, 0.0, 0.202), 0.2, 1.5
    LAMP, LAMP_SIZE, POWER = (-0.55, 0.35, 0.95), 0.06, 12.0


class Ring:
    """caustic_ring: a polished metal ring on a table, the sun aslant: a nephroid's half, for a cup
    the 'cardioid'.
    """

    TABLE_HALF, TABLE_ALBEDO = 1.2, (0.5, 0.42, 0.34)
    INNER, OUTER, HEIGHT = 0.4, 0.43, 0.16
    COLOR = (0.95, 0.78, 0.5)
    SUN, SUN_ANGLE, STRENGTH = (1.0, 0.35, 0.75), np.radians(0.526), 3.0
    """SUN: towards it."""


class Pool:
    """caustic_pool: a basin of water with waves under the sun; everything on its floor is seen
    through the water.
    """

    HALF, RIM = 1.0, 0.75
    LEVEL, IOR = 0.6, 1.33
    FLOOR_ALBEDO, WALL_ALBEDO = (0.45, 0.6, 0.65), (0.35, 0.5, 0.55)
    SUN, SUN_ANGLE, STRENGTH = (0.35, -0.25, 1.0), np.radians(0.526), 3.0
    # Waves: (wave number x, wave number y) in radians a metre, amplitude in metres, phase.
    WAVES = (
        ((11.0, 4.0), 0.011, 0.3),
        ((-5.0, 13.0), 0.009, 1.1),
        ((9.0, -17.0), 0.005, 2.0),
        ((21.0, 10.0), 0.003, 4.0),
    )

    @classmethod
    def height(cls, x: Array, y: Array) -> Array:
        return cls.LEVEL + sum(
            a * np.sin(kx * x + ky * y + phase) for (kx, ky), a, phase in cls.WAVES
        )

    @classmethod
    def slope(cls, x: Array, y: Array) -> tuple[Array, Array]:
        waves = [(kx, ky, a * np.cos(kx * x + ky * y + phase)) for (kx, ky), a, phase in cls.WAVES]
        return np.asarray(sum(kx * c for kx, _, c in waves)), np.asarray(
            sum(ky * c for _, ky, c in waves)
        )


class SmallGlass:
    """small_glass: a room 4 m wide; on its table a tumbler 4 cm wide, lit by a small lamp."""

    ROOM_HALF, ROOM_HEIGHT, ROOM_ALBEDO = 2.0, 2.6, (0.5, 0.5, 0.5)
    TABLE_HALF, TABLE_HEIGHT, TABLE_ALBEDO = 0.6, 0.75, (0.55, 0.4, 0.28)
    PLACE, IOR = (0.1, -0.05, 0.7505), 1.5
    """PLACE: the middle of the tumbler's underside."""
    PROFILE = (
        (0.0, 0.0),
        (0.0165, 0.0),
        (0.02, 0.05),
        (0.018, 0.05),
        (0.0152, 0.008),
        (0.0, 0.008),
    )
    """(radius, height) around the glass, from the middle of its underside over its rim to the
    middle of its inside.
    """
    LAMP, LAMP_SIZE, POWER = (-0.5, 0.45, 1.65), 0.05, 8.0
