"""Irradiance of a horizontal floor by formula. Positions in metres, radiance W/m^2/sr, power W; z
of the floor is 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan, cos, pi, sin, tan

import numpy as np

Array = np.ndarray


def polygon(corners: Sequence[Sequence[float]], radiance: float, x: Array, y: Array) -> Array:
    """Lambert's formula: E = L/2 * sum over edges of (angle the edge subtends) * (normal of the
    plane through it and the point) . n.

    The polygon lies wholly above the floor; its orientation does not matter.
    """
    total = np.zeros_like(x)
    rays = [np.stack([cx - x, cy - y, np.full_like(x, cz)], -1) for cx, cy, cz in corners]
    rays = [ray / np.linalg.norm(ray, axis=-1, keepdims=True) for ray in rays]
    for a, b in zip(rays, rays[1:] + rays[:1], strict=True):
        normal = np.cross(a, b)
        length = np.linalg.norm(normal, axis=-1)
        angle = np.arctan2(length, (a * b).sum(-1))
        total += angle * normal[..., 2] / length
    return np.abs(total) * radiance / 2


def point(power: float, height: float, x: Array, y: Array) -> Array:
    """Intensity P/(4 pi) in every direction; the lamp hangs above the origin."""
    square = x**2 + y**2 + height**2
    return power / (4 * pi) * height / square**1.5


def sphere(power: float, radius: float, height: float, x: Array, y: Array) -> Array:
    """A uniform sphere wholly above the floor lights it as a point of the same power does."""
    assert radius < height
    return point(power, height, x, y)


def spot(power: float, size: float, blend: float, height: float, x: Array, y: Array) -> Array:
    """A point lamp times smoothstep((cos t - c)/((1 - c) blend)), t from straight down, c =
    cos(size/2).
    """
    cosine = height / np.sqrt(x**2 + y**2 + height**2)
    edge = cos(size / 2)
    if blend == 0.0:
        fade = (cosine > edge).astype(float)
    else:
        s = np.clip((cosine - edge) / ((1 - edge) * blend), 0.0, 1.0)
        fade = s * s * (3 - 2 * s)
    return point(power, height, x, y) * fade


def tilted_sun(irradiance: float, angle: float, tilt: float) -> float:
    """A sun whose disc is wholly above the horizon: E cos(tilt) for every angular size, by
    definition of its strength.
    """
    assert tilt + angle / 2 < pi / 2
    return irradiance * cos(tilt)


def disk_on_axis(power: float, radius: float, height: float) -> float:
    """Under the middle of a Lambertian disk of radiance P/(pi A)."""
    return power / (pi * radius**2) * radius**2 / (radius**2 + height**2)


def facing_disk_on_axis(power: float, radius: float, height: float) -> float:
    """A point lamp with soft falloff: a disk that faces the receiver, radiance P/(4 pi^2 r^2)."""
    return power / (4 * pi**2 * radius**2) * pi * radius**2 / (radius**2 + height**2)


def spread_beam(power: float, area: float) -> float:
    """Where the floor sees the whole cone of an area lamp's spread inside the lamp's outline, E =
    P/A.
    """
    return power / area


def spread_disk_on_axis(power: float, radius: float, height: float, spread: float) -> float:
    """Disk of radiance P/(pi A) (tan h - tan t)/(tan h - h), h = spread/2: E = integral of L cos t
    over the disk's cone, by quadrature.
    """
    half, steps = spread / 2, 200_000
    end = min(half, atan(radius / height))
    t = (np.arange(steps) + 0.5) / steps * end
    radiance = power / (pi * pi * radius**2) * (tan(half) - np.tan(t)) / (tan(half) - half)
    return float((radiance * np.cos(t) * np.sin(t)).mean() * end * 2 * pi)


def rectangle_corners(
    size_x: float, size_y: float, height: float, turn: float = 0.0
) -> list[tuple[float, float, float]]:
    c, s = cos(turn), sin(turn)
    half = (
        (-size_x / 2, -size_y / 2),
        (size_x / 2, -size_y / 2),
        (size_x / 2, size_y / 2),
        (-size_x / 2, size_y / 2),
    )
    return [(c * x - s * y, s * x + c * y, height) for x, y in half]
