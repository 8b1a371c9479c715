"""A light tracer in numpy, from the formulas alone: exact shapes, Snell, Fresnel, Lambert. Shares
no code with the renderer.

Photons start at the lamps, choose between reflection and refraction at random, scatter diffusely,
and are counted where they land on the watched surface. Rays are (N, 3) origins and unit directions,
flux is (N, 3) in W (RGB).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
NEAR = 1e-8
"""m; hits nearer than this are where the ray started."""


class Shape(Protocol):
    def hit(self, origin: Array, direction: Array) -> Array:
        """(N,) distance to the first hit, infinity without one."""

    def normal(self, point: Array) -> Array:
        """(N, 3) unit normals, out of the solid where the shape bounds one."""


@dataclass(frozen=True)
class Rectangle:
    """Part of the plane where coordinate `axis` is `value`: low <= other two coordinates <= high,
    in order of their axes.
    """

    axis: int
    value: float
    low: Sequence[float]
    high: Sequence[float]

    def hit(self, origin: Array, direction: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (self.value - origin[:, self.axis]) / direction[:, self.axis]
        t = np.where(np.isfinite(t) & (t > NEAR), t, np.inf)
        point = origin + np.where(np.isfinite(t), t, 0.0)[:, None] * direction
        for axis, low, high in zip(
            [a for a in range(3) if a != self.axis], self.low, self.high, strict=True
        ):
            t = np.where((point[:, axis] >= low) & (point[:, axis] <= high), t, np.inf)
        return t

    def normal(self, point: Array) -> Array:
        return np.broadcast_to(np.eye(3)[self.axis], point.shape)


def _nearest_root(
    a: Array, b: Array, c: Array, allowed: Callable[[Array], NDArray[np.bool_]]
) -> Array:
    """Smallest allowed root > NEAR of a t^2 + b t + c = 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(b * b - 4 * a * c), b))
        roots = np.stack([q / a, c / q])
    best = np.full(a.shape, np.inf)
    for t in roots:
        t = np.where(np.isfinite(t) & (t > NEAR), t, np.inf)
        t = np.where(allowed(t), t, np.inf)
        best = np.minimum(best, t)
    return best


@dataclass(frozen=True)
class Sphere:
    centre: Sequence[float]
    radius: float

    def hit(self, origin: Array, direction: Array) -> Array:
        offset = origin - np.asarray(self.centre)
        b, c = 2 * (offset * direction).sum(-1), (offset**2).sum(-1) - self.radius**2
        return _nearest_root(np.ones_like(b), b, c, np.isfinite)

    def normal(self, point: Array) -> Array:
        return (point - np.asarray(self.centre)) / self.radius


@dataclass(frozen=True)
class Strip:
    """What the segment from `first` to `second` (radius, height) sweeps around the Z axis through
    `place`.

    The solid lies on the left of the way from first to second in the (radius, height) plane.
    """

    first: Sequence[float]
    second: Sequence[float]
    place: Sequence[float] = (0.0, 0.0, 0.0)

    def hit(self, origin: Array, direction: Array) -> Array:
        (r0, z0), (r1, z1) = self.first, self.second
        o = origin - np.asarray(self.place)
        if z0 == z1:
            with np.errstate(divide="ignore", invalid="ignore"):
                t = (z0 - o[:, 2]) / direction[:, 2]
            t = np.where(np.isfinite(t) & (t > NEAR), t, np.inf)
            radius = np.hypot(*(o + np.where(np.isfinite(t), t, 0.0)[:, None] * direction).T[:2])
            return np.where((radius >= min(r0, r1)) & (radius <= max(r0, r1)), t, np.inf)
        k = (r1 - r0) / (z1 - z0)
        here = r0 + k * (o[:, 2] - z0)
        a = direction[:, 0] ** 2 + direction[:, 1] ** 2 - k * k * direction[:, 2] ** 2
        b = 2 * (o[:, 0] * direction[:, 0] + o[:, 1] * direction[:, 1] - k * here * direction[:, 2])
        c = o[:, 0] ** 2 + o[:, 1] ** 2 - here**2

        def within(t: Array) -> NDArray[np.bool_]:
            z = o[:, 2] + np.where(np.isfinite(t), t, 0.0) * direction[:, 2]
            return (z >= min(z0, z1)) & (z <= max(z0, z1)) & (r0 + k * (z - z0) > 0)

        return _nearest_root(a, b, c, within)

    def normal(self, point: Array) -> Array:
        dr, dz = self.second[0] - self.first[0], self.second[1] - self.first[1]
        out = (point - np.asarray(self.place))[:, :2]
        out = out / np.maximum(np.linalg.norm(out, axis=-1, keepdims=True), 1e-300)
        normal = np.concatenate([dz * out, np.full((len(point), 1), -dr)], -1)
        return normal / np.hypot(dr, dz)


@dataclass(frozen=True)
class Waves:
    """z = height(x, y) between `low` and `high`, over |x|, |y| <= half; the solid is below. First
    crossing of even steps, then Newton.
    """

    height: Callable[[Array, Array], Array]
    slope: Callable[[Array, Array], tuple[Array, Array]]
    low: float
    high: float
    half: float
    steps: int = 10

    def _above(self, origin: Array, direction: Array, t: Array) -> Array:
        point = origin + t[:, None] * direction
        return point[:, 2] - self.height(point[:, 0], point[:, 1])

    def hit(self, origin: Array, direction: Array) -> Array:
        z, dz = origin[:, 2], direction[:, 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            enter, leave = np.sort(np.stack([(self.low - z) / dz, (self.high - z) / dz]), axis=0)
            side = np.min(
                [
                    np.where(
                        direction[:, a] > 0, self.half - origin[:, a], -self.half - origin[:, a]
                    )
                    / direction[:, a]
                    for a in (0, 1)
                ],
                axis=0,
            )
        start = np.maximum(np.nan_to_num(enter), 1e-6)
        end = np.minimum(np.nan_to_num(leave, posinf=1e3), np.nan_to_num(side, nan=1e3, posinf=1e3))
        found = np.full(len(z), np.inf)
        a, value = start, self._above(origin, direction, start)
        open_ = end > start
        for k in range(1, self.steps + 1):
            b = start + (end - start) * k / self.steps
            new = self._above(origin, direction, b)
            crossed = open_ & (value * new <= 0) & (value != 0)
            if crossed.any():
                found[crossed] = self._refine(
                    origin[crossed], direction[crossed], a[crossed], b[crossed]
                )
                open_ = open_ & ~crossed
            a, value = b, new
        return found

    def _refine(self, origin: Array, direction: Array, a: Array, b: Array) -> Array:
        sign = np.sign(self._above(origin, direction, a))
        for _ in range(4):
            middle = (a + b) / 2
            same = np.sign(self._above(origin, direction, middle)) == sign
            a, b = np.where(same, middle, a), np.where(same, b, middle)
        t = (a + b) / 2
        for _ in range(4):  # Newton
            point = origin + t[:, None] * direction
            slope_x, slope_y = self.slope(point[:, 0], point[:, 1])
            rate = direction[:, 2] - slope_x * direction[:, 0] - slope_y * direction[:, 1]
            rate = np.where(np.abs(rate) < 1e-6, 1e-6, rate)
            t = np.clip(t - (point[:, 2] - self.height(point[:, 0], point[:, 1])) / rate, a, b)
        return t

    def normal(self, point: Array) -> Array:
        x, y = self.slope(point[:, 0], point[:, 1])
        normal = np.stack([-x, -y, np.ones_like(x)], -1)
        return normal / np.linalg.norm(normal, axis=-1, keepdims=True)


@dataclass(frozen=True)
class Surface:
    """kind: diffuse (color: albedo), mirror (color) or glass (ior)."""

    shape: Shape
    kind: str
    color: Sequence[float] = (1.0, 1.0, 1.0)
    ior: float = 1.0


def fresnel(cosine: Array, ratio: Array) -> tuple[Array, Array]:
    """Unpolarised reflectance and the cosine of the refracted ray; ratio = n behind / n before; 1
    and 0 under total reflection.
    """
    square = 1.0 - (1.0 - cosine**2) / ratio**2
    inner = np.sqrt(np.maximum(square, 0.0))
    along = (ratio * cosine - inner) / (ratio * cosine + inner)
    across = (cosine - ratio * inner) / (cosine + ratio * inner)
    return np.where(square > 0, (along**2 + across**2) / 2, 1.0), inner


def _scatter(
    surface: Surface, point: Array, d: Array, flux: Array, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Outgoing directions and flux. What crosses into an index n carries 1/n^2: flux of the
    radiance that is constant along rays.
    """
    normal = surface.shape.normal(point)
    cosine = -(d * normal).sum(-1)
    inside = cosine < 0
    normal, cosine = np.where(inside[:, None], -normal, normal), np.abs(cosine)
    if surface.kind == "diffuse":
        u, turn = rng.random(len(d)), 2 * np.pi * rng.random(len(d))
        helper = np.where(np.abs(normal[:, :1]) > 0.5, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
        x = np.cross(normal, helper)
        x /= np.linalg.norm(x, axis=-1, keepdims=True)
        y = np.cross(normal, x)
        radius = np.sqrt(u)
        out = (
            (radius * np.cos(turn))[:, None] * x
            + (radius * np.sin(turn))[:, None] * y
            + np.sqrt(1 - u)[:, None] * normal
        )
        return out, flux * np.asarray(surface.color)
    mirrored = d + 2 * cosine[:, None] * normal
    if surface.kind == "mirror":
        return mirrored, flux * np.asarray(surface.color)
    ratio = np.where(inside, 1.0 / surface.ior, surface.ior)
    reflectance, inner = fresnel(cosine, ratio)
    refracted = d / ratio[:, None] + (cosine / ratio - inner)[:, None] * normal
    chosen = rng.random(len(d)) < reflectance
    out = np.where(chosen[:, None], mirrored, refracted)
    return out / np.linalg.norm(out, axis=-1, keepdims=True), np.where(
        chosen[:, None], flux, flux / ratio[:, None] ** 2
    )


def trace(
    surfaces: Sequence[Surface],
    origin: Array,
    direction: Array,
    flux: Array,
    rng: np.random.Generator,
    land: Callable[[Array, Array, NDArray[np.bool_]], None],
    *,
    diffuse_bounces: int = 6,
) -> None:
    """Follow photons; land(points, flux, bent) is told what reaches surfaces[0], `bent`: after a
    mirror or glass and nothing diffuse.
    """
    scattered = np.zeros(len(origin), int)
    bent = np.zeros(len(origin), bool)
    for _ in range(64):
        distance = np.stack([surface.shape.hit(origin, direction) for surface in surfaces])
        which, t = distance.argmin(0), distance.min(0)
        hit = np.isfinite(t)
        which, scattered, bent, flux = which[hit], scattered[hit], bent[hit], flux[hit]
        point, direction = origin[hit] + t[hit, None] * direction[hit], direction[hit]
        landed = which == 0
        land(point[landed], flux[landed], bent[landed] & (scattered[landed] == 0))
        for k, surface in enumerate(surfaces):
            at = which == k
            if at.any():
                direction[at], flux[at] = _scatter(surface, point[at], direction[at], flux[at], rng)
                scattered[at] += surface.kind == "diffuse"
                bent[at] |= surface.kind != "diffuse"
        if not len(flux):
            return
        # Russian roulette after the second diffuse bounce keeps the expectation.
        power = flux.max(-1)
        survive = np.where(
            scattered > 1, np.minimum(power / np.maximum(power.mean(), 1e-300), 1.0), 1.0
        )
        alive = (rng.random(len(power)) < survive) & (scattered <= diffuse_bounces)
        flux = flux / np.maximum(survive, 1e-300)[:, None]
        origin, direction, flux, scattered, bent = (
            x[alive] for x in (point, direction, flux, scattered, bent)
        )
