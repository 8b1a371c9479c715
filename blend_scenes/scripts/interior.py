"""interior.blend: a furnished room whose only light is what sun and sky send through an open
window.

The room spans x -2.6..2.6, y -2.1..2.1, z 0..2.7; the window is in the wall at negative x.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, radians, sin

import bpy
import numpy as np

from . import modelling as m

X, Y, Z, WALL = 2.6, 2.1, 2.7, 0.22
WINDOW_Y, WINDOW_Z = (-1.15, 0.75), (0.8, 2.3)


# Pictures -----------------------------------------------------------------------------------------


def _parquet() -> np.ndarray:
    """Boards of different browns with a grain along them, (256, 256, 3)."""
    rng = np.random.default_rng(3)
    size, boards = 256, 8
    row, column = np.mgrid[:size, :size]
    board = row * boards // size
    shift = rng.integers(0, size, boards)[board]
    half = ((column + shift) % size) * 2 // size
    tone = rng.uniform(0.75, 1.1, (boards, 2))[board, half]
    grain = 0.04 * np.sin(
        row * 1.1 + 3.0 * np.sin((column + shift) * 2 * pi / size * 2)
    ) + rng.normal(0.0, 0.015, (size, size))
    joint = ((row * boards) % size < boards) | ((column + shift) % (size // 2) < 1)
    shade = (tone + grain) * np.where(joint, 0.55, 1.0)
    return np.clip(shade[..., None] * (0.76, 0.58, 0.4), 0.0, 1.0)


def _painting() -> np.ndarray:
    """Hills, a lake and a low sun, (160, 240, 3)."""
    v, u = np.mgrid[0:1:160j, 0:1.5:240j]
    sky = np.stack([0.95 - 0.35 * v, 0.72 - 0.15 * v, 0.45 + 0.35 * v], -1)
    glow = np.exp(-((u - 1.05) ** 2 + (v - 0.62) ** 2) / 0.02)[..., None]
    picture = sky * (1 - glow) + np.array((1.0, 0.93, 0.7)) * glow
    hills = (
        (0.55, 0.09, (0.42, 0.44, 0.62)),
        (0.45, 0.07, (0.27, 0.36, 0.43)),
        (0.36, 0.05, (0.16, 0.27, 0.22)),
    )
    for k, (base, rough, color) in enumerate(hills):
        ridge = base + rough * (
            np.sin(5.1 * u + 1.7 * k)
            + 0.4 * np.sin(13.0 * u + k)
            + 0.15 * np.sin(37.0 * u + 2.0 * k)
        )
        picture = np.where((v < ridge)[..., None], color, picture)
    water = v < 0.2 + 0.01 * np.sin(9.0 * u)
    waves = 0.06 * np.sin(160.0 * v + 4.0 * np.sin(11.0 * u))
    picture = np.where(
        water[..., None], np.stack([0.36 + waves, 0.47 + waves, 0.56 + waves], -1), picture
    )
    return np.clip(picture, 0.0, 1.0)


def _rug() -> np.ndarray:
    """Diamonds within a border, (128, 192, 3)."""
    row, column = np.mgrid[:128, :192]
    diamonds = (np.abs((column % 32) - 15.5) + np.abs((row % 32) - 15.5)) < 10
    edge = np.minimum(np.minimum(row, 127 - row), np.minimum(column, 191 - column))
    rug = np.where(diamonds[..., None], (0.85, 0.76, 0.6), (0.55, 0.2, 0.19))
    return np.where(((edge > 6) & (edge < 12))[..., None], (0.2, 0.26, 0.4), rug)


# Room ---------------------------------------------------------------------------------------------


def _room() -> None:
    """The shell is one sheet, its front inwards, closed but for the window; nothing of it lies
    hidden under something else.
    """
    (y0, y1), (z0, z1) = WINDOW_Y, WINDOW_Z
    out = -X - WALL
    shell = [(x, y, z) for x in (-X, X) for y in (-Y, Y) for z in (0.0, Z)]
    inner = [(-X, y, z) for y in (y0, y1) for z in (z0, z1)]
    outer = [(out, y, z) for y in (y0, y1) for z in (z0, z1)]
    # Three whole walls, the window wall around its opening (8..11), and the reveal from there
    # outwards (12..15).
    walls = [(2, 6, 7, 3), (0, 1, 5, 4), (4, 5, 7, 6)]
    walls += [(0, 2, 10, 8), (2, 3, 11, 10), (3, 1, 9, 11), (1, 0, 8, 9)]
    walls += [(8, 10, 14, 12), (10, 11, 15, 14), (11, 9, 13, 15), (9, 8, 12, 13)]
    m.add_mesh("Walls", shell + inner + outer, walls, m.principled("Wall", (0.72, 0.68, 0.6)))
    m.add_mesh(
        "Ceiling",
        [(-X, -Y, Z), (-X, Y, Z), (X, Y, Z), (X, -Y, Z)],
        [(0, 1, 2, 3)],
        m.diffuse("Ceiling", (0.78, 0.78, 0.76)),
    )
    m.add_picture(
        "Floor",
        [(-X, -Y, 0.0), (X, -Y, 0.0), (X, Y, 0.0), (-X, Y, 0.0)],
        m.principled("Parquet", image=m.packed_image("parquet", _parquet())),
        (5.0, 4.0),
    )
    white = m.diffuse("White paint", (0.75, 0.74, 0.7))
    t, fx0, fx1 = 0.06, -X - 0.12, -X - 0.05
    middle = (y0 + y1) / 2
    frame = [
        ((fx0, y0, z0), (fx1, y0 + t, z1)),
        ((fx0, y1 - t, z0), (fx1, y1, z1)),
        ((fx0, middle - t / 2, z0 + t), (fx1, middle + t / 2, z1 - t)),
        ((fx0, y0 + t, z0), (fx1, y1 - t, z0 + t)),
        ((fx0, y0 + t, z1 - t), (fx1, y1 - t, z1)),
        ((fx0 + 0.01, y0 + t, 1.75), (fx1 - 0.01, middle - t / 2, 1.79)),
        ((fx0 + 0.01, middle + t / 2, 1.75), (fx1 - 0.01, y1 - t, 1.79)),
        ((-X, y0 - 0.06, z0 - 0.04), (-X + 0.16, y1 + 0.06, z0)),
    ]
    m.add_boxes("Window frame", frame, white)
    boards = [
        ((-X, Y - 0.015, 0.0), (X, Y, 0.09)),
        ((X - 0.015, -Y, 0.0), (X, Y - 0.015, 0.09)),
        ((-X, -Y, 0.0), (-X + 0.015, Y - 0.015, 0.09)),
    ]
    m.add_boxes("Baseboard", boards, white)


def _curtain(name: str, y0: float, y1: float, material: bpy.types.Material) -> None:
    """A pleated sheet before the window wall, with a rail above it."""
    columns, rows = 49, 9
    vertices = []
    for row in range(rows):
        height = 0.06 + (2.42 - 0.06) * row / (rows - 1)
        for column in range(columns):
            s = column / (columns - 1)
            depth = 0.045 * sin(s * 2 * pi * 6) * (1.0 - 0.3 * row / (rows - 1))
            vertices.append((-X + 0.2 + depth, y0 + (y1 - y0) * s, height))
    corners = [r * columns + c for r in range(rows - 1) for c in range(columns - 1)]
    faces = [(k, k + 1, k + columns + 1, k + columns) for k in corners]
    m.add_mesh(name, vertices, faces, material, smooth=True)


# Furniture ----------------------------------------------------------------------------------------


def _rounded(thing: bpy.types.Object, width: float, segments: int = 3) -> None:
    bevel = thing.modifiers.new("Round", "BEVEL")
    bevel.width, bevel.segments, bevel.limit_method = width, segments, "ANGLE"
    thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))


def _table(x: float, y: float) -> None:
    oak = m.principled("Oak", (0.47, 0.31, 0.18))
    top = m.add_boxes("Table top", [((-0.75, -0.42, 0.70), (0.75, 0.42, 0.74))], oak, (x, y, 0.0))
    _rounded(top, 0.012, 2)
    legs = [
        ((sx * 0.68 - 0.03, sy * 0.36 - 0.03, 0.0), (sx * 0.68 + 0.03, sy * 0.36 + 0.03, 0.70))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    apron = [((-0.65, sy * 0.36 - 0.01, 0.61), (0.65, sy * 0.36 + 0.01, 0.70)) for sy in (-1, 1)]
    m.add_boxes("Table legs", legs + apron, oak, (x, y, 0.0))
    glaze = m.diffuse("Glaze", (0.25, 0.42, 0.5))
    bowl = [
        (0.0, 0.0),
        (0.06, 0.0),
        (0.07, 0.01),
        (0.12, 0.045),
        (0.15, 0.09),
        (0.145, 0.09),
        (0.115, 0.05),
        (0.06, 0.02),
        (0.0, 0.018),
    ]
    m.add_lathe("Bowl", bowl, glaze, (x - 0.12, y, 0.74), 40)
    peel = m.principled("Orange", (0.78, 0.32, 0.05))
    for dx, dy, dz in (
        (0.05, 0.0, 0.063),
        (-0.04, 0.045, 0.063),
        (-0.03, -0.05, 0.063),
        (0.0, 0.0, 0.128),
    ):
        m.add_sphere("Orange", 0.042, peel, (x - 0.12 + dx, y + dy, 0.74 + dz), 20)
    vase = [(0.0, 0.0), (0.05, 0.0), (0.075, 0.06), (0.08, 0.11), (0.05, 0.19), (0.03, 0.24)]
    vase += [(0.038, 0.28), (0.033, 0.28), (0.025, 0.24), (0.0, 0.2)]
    m.add_lathe(
        "Vase", vase, m.diffuse("Stoneware", (0.7, 0.66, 0.58)), (x + 0.38, y + 0.12, 0.74), 40
    )
    cover = m.diffuse("Book cover", (0.15, 0.28, 0.2))
    m.add_boxes(
        "Book on table",
        [((-0.1, -0.07, 0.0), (0.1, 0.07, 0.03))],
        cover,
        (x - 0.5, y - 0.15, 0.74),
        0.5,
    )


def _chairs(places: Sequence[tuple[float, float, float]]) -> None:
    """Chairs that share one mesh. places: x, y and the turn in degrees."""
    parts = [((-0.21, -0.21, 0.43), (0.21, 0.21, 0.46))]
    feet = [(x, y) for x in (-0.18, 0.18) for y in (-0.18, 0.18)]
    parts += [((x - 0.018, y - 0.018, 0.0), (x + 0.018, y + 0.018, 0.43)) for x, y in feet]
    parts += [((sx * 0.18 - 0.018, 0.165, 0.46), (sx * 0.18 + 0.018, 0.2, 0.92)) for sx in (-1, 1)]
    parts += [((-0.162, 0.172, z), (0.162, 0.193, z + 0.07)) for z in (0.6, 0.72, 0.84)]
    first = m.add_boxes("Chair", parts, m.principled("Beech", (0.62, 0.46, 0.3)))
    for index, (x, y, degrees) in enumerate(places):
        chair = first if index == 0 else m.add_object("Chair", first.data)
        chair.location = (x, y, 0.0)
        chair.rotation_euler[2] = radians(degrees)


def _sofa(x: float, y: float, turn: float) -> None:
    cloth = m.principled("Sofa cloth", (0.22, 0.33, 0.36))
    body = [
        ((-0.95, -0.40, 0.10), (0.95, 0.32, 0.30)),
        ((-0.95, 0.20, 0.305), (0.95, 0.42, 0.82)),
        ((-1.12, -0.42, 0.10), (-0.955, 0.42, 0.60)),
        ((0.955, -0.42, 0.10), (1.12, 0.42, 0.60)),
        ((-0.94, -0.42, 0.305), (-0.005, 0.195, 0.45)),
        ((0.005, -0.42, 0.305), (0.94, 0.195, 0.45)),
    ]
    _rounded(m.add_boxes("Sofa", body, cloth, (x, y, 0.0), turn), 0.045)
    feet = [
        ((sx * 1.0 - 0.03, sy * 0.33 - 0.03, 0.0), (sx * 1.0 + 0.03, sy * 0.33 + 0.03, 0.10))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    m.add_boxes("Sofa feet", feet, m.diffuse("Dark wood", (0.12, 0.08, 0.05)), (x, y, 0.0), turn)
    for k, (dx, color) in enumerate(((-0.6, (0.68, 0.5, 0.14)), (0.62, (0.6, 0.58, 0.52)))):
        cushion = m.add_boxes(
            "Cushion",
            [((-0.21, -0.07, -0.21), (0.21, 0.07, 0.21))],
            m.diffuse(f"Cushion {k}", color),
        )
        c, s = cos(turn), sin(turn)
        cushion.location = (x + dx * c - 0.06 * s, y + dx * s + 0.06 * c, 0.665)
        cushion.rotation_euler = (radians(-16.0), 0.0, turn)
        _rounded(cushion, 0.06, 4)


def _shelf(x: float, y: float) -> None:
    """Book-shelf against the wall at positive y."""
    width, depth, height, board = 1.1, 0.3, 1.9, 0.025
    levels = [0.08 + k * 0.36 for k in range(6)]
    boards = [
        ((-width / 2, -depth, 0.0), (-width / 2 + board, 0.0, height)),
        ((width / 2 - board, -depth, 0.0), (width / 2, 0.0, height)),
    ]
    boards += [
        ((-width / 2 + board, -depth, z), (width / 2 - board, 0.0, z + board)) for z in levels
    ]
    m.add_boxes("Shelf", boards, m.principled("Pine", (0.7, 0.55, 0.36)), (x, y, 0.0))
    colors = [
        (0.5, 0.12, 0.1),
        (0.12, 0.24, 0.42),
        (0.16, 0.34, 0.2),
        (0.62, 0.5, 0.2),
        (0.7, 0.66, 0.58),
        (0.25, 0.15, 0.3),
    ]
    materials = [m.diffuse(f"Book {k}", color) for k, color in enumerate(colors)]
    rng = np.random.default_rng(11)
    books, slots = [], []
    for z in levels[:5]:
        at, end = -width / 2 + board + 0.01, width / 2 - board - rng.uniform(0.05, 0.35)
        while at < end:
            thick, deep, tall = (
                rng.uniform(0.018, 0.05),
                rng.uniform(0.16, 0.24),
                rng.uniform(0.2, 0.3),
            )
            books.append(((at, -0.03 - deep, z + board), (at + thick, -0.03, z + board + tall)))
            slots += [int(rng.integers(len(colors)))] * 6
            at += thick + 0.002
    m.add_mesh("Books", *m.boxes_data(books), materials, slots, location=(x, y, 0.0))


def _floor_lamp(x: float, y: float) -> None:
    """It is daytime: the lamp is off."""
    foot = [(0.0, 0.0), (0.15, 0.0), (0.15, 0.02), (0.012, 0.03), (0.012, 1.5), (0.0, 1.5)]
    m.add_lathe("Lamp foot", foot, m.diffuse("Iron", (0.08, 0.08, 0.09)), (x, y, 0.0))
    m.add_lathe(
        "Lamp shade",
        [(0.21, 0.0), (0.15, 0.3)],
        m.diffuse("Linen", (0.72, 0.65, 0.5)),
        (x, y, 1.38),
        40,
    )


def _plant(x: float, y: float) -> None:
    pot = [
        (0.0, 0.0),
        (0.12, 0.0),
        (0.17, 0.28),
        (0.18, 0.28),
        (0.18, 0.32),
        (0.15, 0.32),
        (0.14, 0.27),
        (0.0, 0.27),
    ]
    m.add_lathe("Pot", pot, m.diffuse("Terracotta", (0.55, 0.27, 0.16)), (x, y, 0.0))
    rng = np.random.default_rng(5)
    vertices: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []
    steps, leaves = 8, 17
    for leaf in range(leaves):
        turn, reach, rise = leaf * 2.4, rng.uniform(0.3, 0.5), rng.uniform(0.45, 0.8)
        for step in range(steps + 1):
            s = step / steps
            out, up = reach * s**1.4, rise * s * (1.5 - 0.75 * s)
            half = 0.055 * sin(pi * min(s * 0.93 + 0.05, 1.0))
            for side in (-1, 0, 1):
                lift = 0.3 * abs(side) * half
                vertices.append(
                    (
                        out * cos(turn) - side * half * sin(turn),
                        out * sin(turn) + side * half * cos(turn),
                        0.27 + up + lift,
                    )
                )
            if step:
                base = len(vertices) - 6
                faces += [
                    (base, base + 3, base + 4, base + 1),
                    (base + 1, base + 4, base + 5, base + 2),
                ]
    m.add_mesh(
        "Leaves",
        vertices,
        faces,
        m.principled("Leaf", (0.12, 0.3, 0.09)),
        smooth=True,
        location=(x, y, 0.0),
    )


def _wall_picture(x: float, z: float) -> None:
    """On the wall at positive y."""
    w, h, t, y = 0.54, 0.36, 0.04, Y
    sides = [((-w - t, -0.03, -h - t), (w + t, 0.0, -h)), ((-w - t, -0.03, h), (w + t, 0.0, h + t))]
    sides += [
        ((s * (w + t / 2) - t / 2, -0.03, -h), (s * (w + t / 2) + t / 2, 0.0, h)) for s in (-1, 1)
    ]
    m.add_boxes("Picture frame", sides, m.diffuse("Frame", (0.1, 0.07, 0.05)), (x, y, z))
    corners = [
        (x - w, y - 0.012, z - h),
        (x + w, y - 0.012, z - h),
        (x + w, y - 0.012, z + h),
        (x - w, y - 0.012, z + h),
    ]
    m.add_picture(
        "Picture", corners, m.principled("Painting", image=m.packed_image("painting", _painting()))
    )


def _carpet(x: float, y: float) -> None:
    half_x, half_y, z = 1.2, 0.8, 0.012
    m.add_boxes(
        "Rug edge",
        [((x - half_x, y - half_y, 0.0), (x + half_x, y + half_y, z - 0.002))],
        m.diffuse("Rug edge", (0.3, 0.1, 0.1)),
    )
    corners = [
        (x - half_x, y - half_y, z),
        (x + half_x, y - half_y, z),
        (x + half_x, y + half_y, z),
        (x - half_x, y + half_y, z),
    ]
    m.add_picture("Rug", corners, m.principled("Rug", image=m.packed_image("rug", _rug())))


def make() -> None:
    m.new_scene(640, 400, "AgX").view_settings.exposure = 0.7
    _room()
    linen = m.diffuse("Curtain", (0.66, 0.6, 0.5))
    _curtain("Curtain left", -1.75, -1.05, linen)
    _curtain("Curtain right", 0.65, 1.35, linen)
    m.add_boxes(
        "Curtain rail",
        [((-X + 0.185, -1.8, 2.43), (-X + 0.215, 1.4, 2.46))],
        m.diffuse("Rail", (0.15, 0.1, 0.07)),
    )
    _carpet(-0.75, 0.1)
    _table(0.75, -0.75)
    _chairs(((0.4, -1.35, 180.0), (1.1, -1.33, 172.0), (0.35, -0.12, 8.0), (1.25, -0.2, -24.0)))
    _sofa(-0.75, 1.45, 0.0)
    _shelf(1.55, Y)
    _floor_lamp(0.62, 1.75)
    _plant(-2.1, 1.6)
    _wall_picture(-0.75, 1.55)
    m.add_light(
        "Sun",
        "SUN",
        80.0,
        (-6.0, -1.5, 5.0),
        (-0.9, 0.35, 0.0),
        angle=radians(0.526),
        color=(1.0, 0.88, 0.7),
    )
    m.set_world((0.62, 0.78, 1.0), 5.0)
    m.add_camera((2.35, -1.95, 1.5), (-0.9, 1.2, 0.85), lens=21.0)
    m.save("interior")


if __name__ == "__main__":
    make()
