"""The light on the watched surface of each caustic scene, by tests/reference/caustics/tracer.py:
`python -m tests.reference.caustics.reference [NAME ...]`.

Keeps radiance of the surface as seen by View's camera, in two independent halves (height, width, 3)
float16, row 0 at low y.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from blend_scenes.scripts.caustic_shapes import Glass, Pool, Ring, SmallGlass
from tests.reference.caustics.tracer import (
    Array,
    Rectangle,
    Sphere,
    Strip,
    Surface,
    Waves,
    fresnel,
    trace,
)

FOLDER = Path(__file__).resolve().parent / "references"
PIXELS, FINE = 48, 4
"""Pixels along each side of the view, and cells of the histogram along each side of a pixel."""
FILTER = 1.5
"""Width in pixels of the camera's Blackman-Harris filter."""
Photons = tuple[Array, Array, Array]


@dataclass(frozen=True)
class View:
    """A camera straight above (middle x, y), orthographic, `size` metres wide, that sees only what
    is below `below`.
    """

    scene: str
    middle: tuple[float, float]
    size: float
    below: float
    albedo: tuple[float, float, float]
    surfaces: Callable[[], list[Surface]]
    emit: Callable[[int, np.random.Generator], Photons]
    millions: int
    caustic_only: bool = False


def _floor(half: float, albedo: tuple[float, float, float], z: float = 0.0) -> Surface:
    return Surface(Rectangle(2, z, (-half, -half), (half, half)), "diffuse", albedo)


def _glass_surfaces() -> list[Surface]:
    return [
        _floor(Glass.TABLE_HALF, Glass.TABLE_ALBEDO),
        Surface(Sphere(Glass.CENTRE, Glass.RADIUS), "glass", ior=Glass.IOR),
    ]


def _ring_surfaces() -> list[Surface]:
    way = [
        (Ring.OUTER, 0.0),
        (Ring.OUTER, Ring.HEIGHT),
        (Ring.INNER, Ring.HEIGHT),
        (Ring.INNER, 0.0),
    ]
    ring = [Surface(Strip(a, b), "mirror", Ring.COLOR) for a, b in pairwise(way)]
    return [_floor(Ring.TABLE_HALF, Ring.TABLE_ALBEDO), *ring]


def _pool_surfaces() -> list[Surface]:
    a, top = Pool.HALF, Pool.RIM
    walls = [
        Surface(Rectangle(axis, side, (-a, 0.0), (a, top)), "diffuse", Pool.WALL_ALBEDO)
        for axis in (0, 1)
        for side in (-a, a)
    ]
    swing = sum(amplitude for _, amplitude, _ in Pool.WAVES)
    water = Waves(Pool.height, Pool.slope, Pool.LEVEL - swing, Pool.LEVEL + swing, a)
    return [_floor(a, Pool.FLOOR_ALBEDO), *walls, Surface(water, "glass", ior=Pool.IOR)]


def _small_surfaces() -> list[Surface]:
    """The tumbler on its table. Only photons that went through the glass are kept, so the room does
    not matter.
    """
    profile = SmallGlass.PROFILE
    strips = [Strip(a, b, SmallGlass.PLACE) for a, b in pairwise(profile)]
    table = _floor(SmallGlass.TABLE_HALF, SmallGlass.TABLE_ALBEDO, SmallGlass.TABLE_HEIGHT)
    return [table, *(Surface(strip, "glass", ior=SmallGlass.IOR) for strip in strips)]


def _lamp_photons(
    place: tuple[float, ...],
    size: float,
    power: float,
    aim: tuple[Array, Array],
    count: int,
    rng: np.random.Generator,
) -> Photons:
    """From a square lamp that faces down to points spread evenly over the rectangle `aim` (low,
    high corner).
    """
    low, high = aim
    start = np.asarray(place) + np.concatenate(
        [(rng.random((count, 2)) - 0.5) * size, np.zeros((count, 1))], -1
    )
    end = low + (high - low) * np.concatenate([rng.random((count, 2)), np.zeros((count, 1))], -1)
    way = end - start
    square = (way**2).sum(-1)
    direction = way / np.sqrt(square)[:, None]
    area = float(np.prod((high - low)[:2]))
    # radiance P/(pi A) * A * area * cos cos / distance^2
    flux = power / np.pi * area * direction[:, 2] ** 2 / square / count
    return start, direction, np.repeat(flux[:, None], 3, -1)


def _near_and_far(
    photons: Callable[[tuple[Array, Array], int], Photons],
    inner: Sequence[Sequence[float]],
    half: float,
    count: int,
) -> Photons:
    """Most photons aimed at the `inner` corners' rectangle of a table, the others at the rest of
    the table.
    """
    low, high = (np.array([*corner, 0.0]) for corner in inner)
    near = photons((low, high), count * 4 // 5)
    far = photons((np.array([-half, -half, 0.0]), np.array([half, half, 0.0])), count // 5)
    end = far[0] - far[1] * (far[0][:, 2] / far[1][:, 2])[:, None]
    keep = ~((end >= low) & (end <= high))[:, :2].all(-1)
    origin, direction, flux = (np.concatenate([x, y[keep]]) for x, y in zip(near, far, strict=True))
    return origin, direction, flux


def _glass_photons(count: int, rng: np.random.Generator) -> Photons:
    def photons(aim: tuple[Array, Array], count: int) -> Photons:
        return _lamp_photons(Glass.LAMP, Glass.LAMP_SIZE, Glass.POWER, aim, count, rng)

    return _near_and_far(photons, ((-0.45, -0.6), (0.75, 0.45)), Glass.TABLE_HALF, count)


def _sun_photons(
    towards: tuple[float, ...],
    angle: float,
    strength: float,
    aim: tuple[Array, Array],
    count: int,
    rng: np.random.Generator,
) -> Photons:
    """Through points spread evenly over a horizontal rectangle, from far away."""
    middle = np.asarray(towards) / np.linalg.norm(towards)
    x = np.cross(middle, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    y = np.cross(middle, x)
    radius, turn = (
        np.tan(angle / 2) * np.sqrt(rng.random((count, 1))),
        2 * np.pi * rng.random((count, 1)),
    )
    direction = -(middle + radius * (np.cos(turn) * x + np.sin(turn) * y))
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    low, high = aim
    through = low + (high - low) * np.concatenate(
        [rng.random((count, 2)), np.zeros((count, 1))], -1
    )
    flux = strength * -direction[:, 2] * float(np.prod((high - low)[:2])) / count
    return through - 3.0 * direction, direction, np.repeat(flux[:, None], 3, -1)


def _ring_photons(count: int, rng: np.random.Generator) -> Photons:
    def photons(aim: tuple[Array, Array], count: int) -> Photons:
        return _sun_photons(Ring.SUN, Ring.SUN_ANGLE, Ring.STRENGTH, aim, count, rng)

    return _near_and_far(photons, ((-0.7, -0.6), (0.55, 0.55)), Ring.TABLE_HALF, count)


def _pool_photons(count: int, rng: np.random.Generator) -> Photons:
    """Through the opening; what hits the walls from outside does not matter."""
    a, top = Pool.HALF, Pool.RIM
    corner = np.array([a, a, 0.0])
    lift = np.array([0.0, 0.0, top])
    start, direction, flux = _sun_photons(
        Pool.SUN, Pool.SUN_ANGLE, Pool.STRENGTH, (lift - corner, lift + corner), count, rng
    )
    return start + 3.0 * direction, direction, flux


def _small_photons(count: int, rng: np.random.Generator) -> Photons:
    """To the shadow of the tumbler's bounding ball on the table, generously."""
    place, lamp = np.asarray(SmallGlass.PLACE), np.asarray(SmallGlass.LAMP)
    middle = place + np.array([0.0, 0.0, 0.025])
    stretch = (lamp[2] - place[2]) / (lamp[2] - middle[2])
    shadow = lamp + (middle - lamp) * stretch
    shadow[2] = SmallGlass.TABLE_HEIGHT
    half = np.array([0.055, 0.055, 0.0])
    return _lamp_photons(
        SmallGlass.LAMP,
        SmallGlass.LAMP_SIZE,
        SmallGlass.POWER,
        (shadow - half, shadow + half),
        count,
        rng,
    )


VIEWS = {
    "glass": View(
        "caustic_glass",
        (0.12, -0.08),
        0.75,
        0.001,
        Glass.TABLE_ALBEDO,
        _glass_surfaces,
        _glass_photons,
        24,
    ),
    "ring": View(
        "caustic_ring", (0.0, 0.0), 1.0, 0.001, Ring.TABLE_ALBEDO, _ring_surfaces, _ring_photons, 24
    ),
    "pool": View(
        "caustic_pool", (0.0, 0.0), 1.6, 0.3, Pool.FLOOR_ALBEDO, _pool_surfaces, _pool_photons, 8
    ),
    "small_glass": View(
        "small_glass",
        (0.12, -0.07),
        0.16,
        SmallGlass.TABLE_HEIGHT + 0.0003,
        SmallGlass.TABLE_ALBEDO,
        _small_surfaces,
        _small_photons,
        20,
        True,
    ),
}


def irradiance(view: View, photons: int, seed: int, cells: int = PIXELS * FINE) -> Array:
    """(cells, cells, 3) irradiance in W/m^2 of the view's cells, row 0 at low y."""
    low = np.asarray(view.middle) - view.size / 2
    total = np.zeros((cells * cells, 3))
    rng = np.random.default_rng(seed)

    def land(points: Array, flux: Array, bent: np.ndarray) -> None:
        if view.caustic_only:
            points, flux = points[bent], flux[bent]
        index = np.floor((points[:, :2] - low) / view.size * cells).astype(int)
        seen = ((index >= 0) & (index < cells)).all(-1)
        where = index[seen, 1] * cells + index[seen, 0]
        for channel in range(3):
            total[:, channel] += np.bincount(where, flux[seen, channel], cells * cells)

    batch = 1_000_000
    batches = max(photons // batch, 1)
    for _ in range(batches):
        trace(view.surfaces(), *view.emit(batch, rng), rng, land)
    return total.reshape(cells, cells, 3) / batches / (view.size / cells) ** 2


def seen_by_pixels(fine: Array) -> Array:
    """Cells to pixels, through the camera's pixel filter; cells beyond the view count as the
    outermost ones.
    """
    offset = (np.arange(-2 * FINE, 2 * FINE) + 0.5) / FINE
    turn = 2 * np.pi * (offset / FILTER + 0.5)
    weight = (
        0.35875 - 0.48829 * np.cos(turn) + 0.14128 * np.cos(2 * turn) - 0.01168 * np.cos(3 * turn)
    )
    weight = np.where(np.abs(offset) < FILTER / 2, weight, 0.0)
    weight /= weight.sum()
    for axis in (0, 1):
        margin = [(0, 0)] * 3
        margin[axis] = (2 * FINE, 2 * FINE)
        padded = np.moveaxis(np.pad(fine, margin, mode="edge"), axis, 0)
        starts = np.arange(PIXELS) * FINE + FINE // 2
        rows = [np.tensordot(weight, padded[start : start + 4 * FINE], 1) for start in starts]
        fine = np.moveaxis(np.stack(rows), 0, axis)
    return fine


def seen_through_water(floor: Array, view: View) -> Array:
    """What a camera straight above the pool sees of the floor's radiance `floor` (cells):
    refracted, less what is reflected.
    """
    cells = PIXELS * FINE
    y, x = (np.mgrid[:cells, :cells] + 0.5) / cells * view.size - view.size / 2
    slope_x, slope_y = Pool.slope(x, y)
    normal = np.stack([-slope_x, -slope_y, np.ones_like(x)], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    cosine = normal[..., 2]
    reflectance, inner = fresnel(cosine, np.full_like(cosine, Pool.IOR))
    down = np.array([0.0, 0.0, -1.0]) / Pool.IOR + (cosine / Pool.IOR - inner)[..., None] * normal
    reach = Pool.height(x, y) / -down[..., 2]
    to_x, to_y = x + reach * down[..., 0], y + reach * down[..., 1]
    column, row = (
        np.clip(((to + view.size / 2) / view.size * cells).astype(int), 0, cells - 1)
        for to in (to_x, to_y)
    )
    return floor[row, column] * (1 - reflectance)[..., None]


def make(name: str) -> None:
    view = VIEWS[name]
    fine = [
        irradiance(view, view.millions * 500_000, seed) * np.asarray(view.albedo) / np.pi
        for seed in (1, 2)
    ]
    FOLDER.mkdir(exist_ok=True)
    halves = [seen_by_pixels(cells) for cells in fine]
    np.savez_compressed(
        FOLDER / f"{name}.npz",
        half_1=halves[0].astype(np.float16),
        half_2=halves[1].astype(np.float16),
    )
    if name == "pool":
        halves = [seen_by_pixels(seen_through_water(cells, view)) for cells in fine]
        np.savez_compressed(
            FOLDER / "pool_from_above.npz",
            half_1=halves[0].astype(np.float16),
            half_2=halves[1].astype(np.float16),
        )


def load(name: str) -> Array:
    """(2, height, width, 3): radiance, two halves."""
    with np.load(FOLDER / f"{name}.npz") as file:
        return np.stack([file["half_1"], file["half_2"]]).astype(np.float64)


def main(names: list[str]) -> int:
    for name in names or list(VIEWS):
        started = time.monotonic()
        make(name)
        halves = load(name)
        noise = np.abs(halves[0] - halves[1]).mean() / halves.mean()
        print(
            f"{name:12} {time.monotonic() - started:6.1f} s  mean {halves.mean():.4f}  noise "
            f"{noise:.3f}",
            file=sys.stderr,
            flush=True,
        )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
