"""Images made with numpy for the textured scenes: all tile without a seam unless said otherwise,
row 0 at the bottom.
"""

from __future__ import annotations

from math import pi

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def cloud(
    size: int, fall: float, seed: int, stretch: tuple[float, float] = (1.0, 1.0), low: float = 0.0
) -> Array:
    """(size, size) noise in 0..1 whose spectrum falls as frequency^-fall; stretch: along u, v. No
    frequency below `low` cycles.
    """
    rng = np.random.default_rng(seed)
    fv = np.fft.fftfreq(size)[:, None] * size * stretch[1]
    fu = np.fft.fftfreq(size)[None, :] * size * stretch[0]
    frequency = np.hypot(fu, fv)
    frequency[0, 0] = 1.0
    amplitude = np.where(frequency >= low, frequency**-fall, 0.0)
    amplitude[0, 0] = 0.0
    field = np.fft.ifft2(np.fft.fft2(rng.normal(size=(size, size))) * amplitude).real
    low_end, high_end = np.quantile(field, (0.005, 0.995))
    return np.clip((field - low_end) / (high_end - low_end), 0.0, 1.0)


def blend(factor: Array, a: ArrayLike, b: ArrayLike) -> Array:
    """Between the colours (or colour images) a and b; factor (height, width)."""
    return (1.0 - factor[..., None]) * np.asarray(a, np.float64) + factor[..., None] * np.asarray(
        b, np.float64
    )


def normals(height: Array, strength: float) -> Array:
    """Tangent-space normal map of a height in units of the image's width over `strength`."""
    rows, columns = height.shape
    du = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * 0.5 * columns * strength
    dv = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) * 0.5 * rows * strength
    vectors = np.stack([-du, -dv, np.ones_like(height)], -1)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True) * 0.5 + 0.5


def cells(size: int, points: Array) -> tuple[Array, NDArray[np.int64]]:
    """(nearest, second nearest) distances (2, size, size) on the torus, and which point is nearest.
    points: (n, 2) in 0..1.
    """
    v, u = (np.mgrid[:size, :size] + 0.5) / size
    best = np.full((2, size, size), 9.0)
    owner = np.zeros((size, size), np.int64)
    for index, (pu, pv) in enumerate(points):
        distance = np.hypot((u - pu + 0.5) % 1.0 - 0.5, (v - pv + 0.5) % 1.0 - 0.5)
        nearer = distance < best[0]
        best[1] = np.where(nearer, best[0], np.minimum(best[1], distance))
        owner[nearer] = index
        best[0] = np.minimum(best[0], distance)
    return best, owner


def planks(
    size: int, boards: int, seed: int, light: ArrayLike, dark: ArrayLike
) -> tuple[Array, Array]:
    """Boards along u: colour (size, size, 3) and height (size, size)."""
    rng = np.random.default_rng(seed)
    row, column = np.mgrid[:size, :size]
    board = row * boards // size
    shift = rng.integers(0, size, boards)[board]
    cut = rng.integers(size // 4, 3 * size // 4, boards)[board]
    half = ((column + shift) % size > cut).astype(int)
    tone = rng.uniform(0.0, 0.55, (boards, 2))[board, half]
    grain = cloud(size, 1.2, seed + 1, (0.9, 0.12), 2.0)
    fine = cloud(size, 0.7, seed + 2, (1.0, 0.04), 8.0)
    rolled = grain[row, (column + 97 * board + 190 * half) % size]
    wood = np.clip(0.2 + tone + 0.55 * (rolled - 0.5) + 0.25 * (fine - 0.5), 0.0, 1.0)
    edge = np.minimum((row * boards) % size, size - 1 - (row * boards) % size) / boards
    ends = np.minimum((column + shift) % size, np.abs((column + shift) % size - cut))
    joint = np.clip(np.minimum(edge, ends) / 1.6, 0.0, 1.0)
    color = blend(wood, light, dark) * (0.35 + 0.65 * joint[..., None])
    return np.clip(color, 0.0, 1.0), joint * (0.75 + 0.25 * (1.0 - fine))


def weave(size: int, threads: int) -> Array:
    """Height of a plain weave, `threads` (even) each way."""
    v, u = (np.mgrid[:size, :size] + 0.5) / size * threads
    warp = np.abs(np.sin(pi * u)) * (0.6 + 0.4 * np.cos(pi * v + pi * np.floor(u)))
    weft = np.abs(np.sin(pi * v)) * (0.6 - 0.4 * np.cos(pi * u + pi * np.floor(v)))
    return np.maximum(warp, weft)


def pavers(size: int, rows: int, seed: int) -> tuple[Array, Array]:
    """Rounded setts in rows: colour (size, size, 3) and height."""
    rng = np.random.default_rng(seed)
    per_row = rows
    points = [
        (
            (k + 0.5 * (r % 2) + rng.uniform(-0.14, 0.14)) / per_row,
            (r + 0.5 + rng.uniform(-0.1, 0.1)) / rows,
        )
        for r in range(rows)
        for k in range(per_row)
    ]
    (near, second), owner = cells(size, np.array(points) % 1.0)
    gap = np.clip((second - near) * rows / 0.5, 0.0, 1.0)
    rough = cloud(size, 1.1, seed + 1, low=4.0)
    dome = gap**0.45 * (1.0 - 0.3 * (near * rows) ** 2)
    stone = rng.uniform(0.0, 1.0, len(points))[owner]
    warm = rng.uniform(0.0, 1.0, len(points))[owner]
    color = blend(stone, (0.44, 0.42, 0.4), (0.66, 0.63, 0.6)) * blend(
        warm, (1.0, 0.97, 0.92), (0.97, 0.94, 0.95)
    )
    color *= (0.8 + 0.35 * rough)[..., None]
    joint = np.clip(gap * 3.5, 0.0, 1.0)
    color = blend(joint, (0.29, 0.26, 0.22), color)
    height = dome * (0.9 + 0.18 * rough * joint)
    return np.clip(color, 0.0, 1.0), height


def plaster(size: int, seed: int) -> tuple[Array, Array]:
    """Grey weathering of a wall, to be multiplied with its colour: colour and height."""
    large, small = cloud(size, 1.5, seed), cloud(size, 0.8, seed + 1, low=6.0)
    runs = cloud(size, 1.2, seed + 2, (0.22, 1.6), 1.0)
    patches = np.clip((large - 0.72) * 9.0, 0.0, 1.0)
    tone = 0.84 + 0.16 * large - 0.1 * np.clip((runs - 0.6) * 2.5, 0.0, 1.0) + 0.06 * (small - 0.5)
    color = blend(
        patches, np.repeat(tone[..., None], 3, -1), tone[..., None] * np.array((0.93, 0.9, 0.86))
    )
    return np.clip(color, 0.0, 1.0), 0.55 * cloud(size, 1.0, seed + 3, low=8.0) + 0.45 * large * (
        1.0 - 0.3 * patches
    )


def marble(size: int, seed: int, ground: ArrayLike, vein: ArrayLike) -> Array:
    """Colour of a veined stone."""
    warp = cloud(size, 1.7, seed)
    thin = 1.0 - np.abs(2.0 * cloud(size, 1.55, seed + 1) - 1.0) ** 0.45
    second = 1.0 - np.abs(2.0 * cloud(size, 1.4, seed + 2) - 1.0) ** 0.3
    depth = np.clip(0.95 * thin * (0.35 + 0.9 * warp) + 0.35 * second * warp, 0.0, 1.0)
    shade = 0.92 + 0.08 * cloud(size, 1.6, seed + 3)
    return np.clip(blend(depth, ground, vein) * shade[..., None], 0.0, 1.0)


def tea_towel(size: int) -> Array:
    """Linen with three blue stripes near v = 0.15 and 0.85 (does not tile along v)."""
    v, _ = (np.mgrid[:size, :size] + 0.5) / size
    color = np.broadcast_to(np.array((0.86, 0.83, 0.76)), (size, size, 3)).copy()
    for at, width in (
        (0.1, 0.012),
        (0.15, 0.03),
        (0.2, 0.012),
        (0.9, 0.012),
        (0.85, 0.03),
        (0.8, 0.012),
    ):
        color[np.abs(v - at) < width] = (0.2, 0.3, 0.48)
    return color * (0.92 + 0.08 * weave(size, size // 8))[..., None]


def leaf(size: int, light: ArrayLike, dark: ArrayLike) -> Array:
    """Colour of a leaf: v along its midrib, u across (does not tile)."""
    v, u = (np.mgrid[:size, :size] + 0.5) / size
    across = np.abs(u - 0.5) * 2.0
    ribs = np.abs(((v - 0.55 * across) * 9.0) % 1.0 - 0.5) * 2.0
    rib = np.maximum(
        np.clip(1.0 - across / 0.07, 0.0, 1.0), 0.55 * np.clip((ribs - 0.86) * 8.0, 0.0, 1.0)
    )
    shade = cloud(size, 1.4, 9)
    return np.clip(
        blend(np.clip(0.25 + 0.6 * shade, 0, 1), light, dark) + 0.14 * rib[..., None], 0.0, 1.0
    )


# Pictures of the surroundings ---------------------------------------------------------------------


def _directions(height: int) -> tuple[Array, Array, Array]:
    """Unit vectors of an equirectangular picture's pixels, as Blender looks them up; (height, 2 *
    height) each.
    """
    v, u = np.mgrid[:height, : 2 * height] + 0.5
    elevation = (v / height - 0.5) * pi
    turn = -(u / (2 * height) - 0.5) * 2.0 * pi
    return np.cos(elevation) * np.cos(turn), np.cos(elevation) * np.sin(turn), np.sin(elevation)


def summer_sky(height: int, sun: tuple[float, float, float], power: float, seed: int) -> Array:
    """(height, 2 height, 3) radiance: blue sky with fair-weather clouds, a sun of irradiance
    `power`, ground below.
    """
    x, y, z = _directions(height)
    towards = np.array(sun) / np.linalg.norm(sun)
    cosine = x * towards[0] + y * towards[1] + z * towards[2]
    up = np.clip(z, 0.0, 1.0)
    sky = blend(up**0.55, (0.78, 0.88, 1.0), (0.13, 0.29, 0.68))
    sky += np.clip(cosine, 0.0, 1.0)[..., None] ** 24 * np.array((0.5, 0.42, 0.3))
    sheet = 1.0 / (up + 0.16)
    field = cloud(512, 1.55, seed)
    at = [np.floor((c * sheet * 75.0) % 512).astype(int) for c in (x, y)]
    soft = np.clip((field[at[1], at[0]] - 0.56) * 4.0, 0.0, 1.0) * np.clip(up * 5.0, 0.0, 1.0)
    shade = blend(
        np.clip(field[(at[1] + 9) % 512, (at[0] + 9) % 512] * 1.5 - 0.5, 0, 1),
        (1.5, 1.48, 1.45),
        (0.95, 0.98, 1.06),
    )
    sky = blend(soft, sky, shade)
    sky = blend(np.clip(-z * 25.0, 0.0, 1.0), sky, (0.32, 0.29, 0.25))
    half = 1.1 * pi / height  # the disc must be more than a pixel wide
    disc = np.clip(1.5 - np.arccos(np.clip(cosine, -1, 1)) / half, 0.0, 1.0)
    solid = (
        disc * np.cos((np.mgrid[:height, : 2 * height][0] + 0.5) / height * pi - pi / 2)
    ).sum() * (pi / height) ** 2
    return sky + disc[..., None] * np.array((1.0, 0.87, 0.68)) * power / solid


def studio(
    height: int, boxes: list[tuple[tuple[float, float, float], float, float, ArrayLike]]
) -> Array:
    """(height, 2 height, 3) radiance: soft boxes in a dim room. boxes: direction, half width, half
    height (rad), radiance.
    """
    x, y, z = _directions(height)
    room = blend(np.clip(0.5 + 0.5 * z, 0, 1), (0.1, 0.095, 0.09), (0.28, 0.28, 0.3))
    for towards, half_width, half_height, radiance in boxes:
        turn, rise = (
            np.arctan2(towards[1], towards[0]),
            np.arcsin(towards[2] / np.linalg.norm(towards)),
        )
        across = np.abs((np.arctan2(y, x) - turn + pi) % (2 * pi) - pi) * np.cos(rise) / half_width
        along = np.abs(np.arcsin(np.clip(z, -1, 1)) - rise) / half_height
        inside = np.clip((1.0 - np.maximum(across, along)) * 6.0, 0.0, 1.0)
        room += (inside * (0.7 + 0.3 * (1.0 - np.minimum(np.hypot(across, along), 1.0))))[
            ..., None
        ] * np.asarray(radiance, np.float64)
    return room


# Into the file ------------------------------------------------------------------------------------


def packed(name: str, pixels: Array, *, data: bool = False) -> bpy.types.Image:
    """A packed 8-bit image. pixels: (height, width, 3) or (height, width) in 0..1; data: not a
    colour.
    """
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, -1)
    image = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], is_data=data)
    return _filled(image, pixels)


def packed_radiance(name: str, pixels: Array) -> bpy.types.Image:
    """A packed floating-point image, rounded to halves so that it packs well."""
    image = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], float_buffer=True)
    return _filled(image, pixels.astype(np.float16))


def _filled(image: bpy.types.Image, pixels: NDArray) -> bpy.types.Image:
    rgba = np.ones((*pixels.shape[:2], 4), np.float32)
    rgba[..., :3] = pixels
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    image.pack()
    return image
