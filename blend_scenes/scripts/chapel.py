"""chapel.blend: sun through panes of coloured glass into the haze of a stone hall. A glass ball
gathers one of the shafts to a focus.
"""

from __future__ import annotations

import bpy
import numpy as np

from . import modelling as m
from .things import parts as p

WIDE, LONG, HIGH, WALL = 2.6, 3.6, 4.8, 0.3  # m: halves, height, thickness
SILL, TOP, HALF = 1.5, 4.1, 0.42  # m: of a window
WINDOWS = (-2.3, 0.0, 2.3)  # m: their middles along the hall
ROWS, COLUMNS, LEAD, PANE = 9, 3, 0.018, 0.012
COLORS = (
    (0.85, 0.06, 0.05),
    (0.08, 0.18, 0.9),
    (1.0, 0.55, 0.06),
    (0.1, 0.6, 0.2),
    (0.95, 0.9, 0.75),
)
SUN = (6.0, -1.6, 6.2)
BALL, PEDESTAL = (0.42, 0.62, 1.15), 0.85


def make() -> None:
    scene = m.new_scene(1280, 720, "AgX")
    scene.view_settings.look = "AgX - High Contrast"
    stone, floor = m.diffuse("Stone", (0.42, 0.38, 0.33)), m.diffuse("Floor", (0.3, 0.27, 0.24))
    _hall(stone, floor)
    chance = np.random.default_rng(5)
    panes = [_pane(f"Pane {k}", color) for k, color in enumerate(COLORS)]
    for number, middle in enumerate(WINDOWS):
        _window(number, middle, panes, m.diffuse("Lead", (0.03, 0.03, 0.03)), chance)
    x, y, _ = BALL
    p.box("Pedestal", (x - 0.2, y - 0.2, 0), (x + 0.2, y + 0.2, PEDESTAL), stone, 0.02)
    m.add_sphere("Ball", BALL[2] - PEDESTAL, m.glass("Crystal", 1.5), BALL, 128)
    inside = ((-WIDE - 0.05, -LONG - 0.05, -0.05), (WIDE + 0.05, LONG + 0.05, HIGH + 0.05))
    m.add_boxes("Haze", [inside], m.medium("Haze", 0.05, (0.97, 0.97, 1.0), 0.35))
    m.add_light("Sun", "SUN", 110.0, SUN, (0.0, 0.0, 0.3), color=(1.0, 0.93, 0.82), angle=0.0093)
    m.set_world((0.01, 0.015, 0.03))
    m.add_camera((-2.2, -3.2, 1.25), (0.75, 0.55, 1.75), lens=22.0)
    m.save("chapel")


def _pane(name: str, color: m.Point) -> bpy.types.Material:
    """Coloured once on the way in and once on the way out."""
    material = m.glass(name, 1.5)
    node = next(n for n in material.node_tree.nodes if n.type == "BSDF_GLASS")
    node.inputs["Color"].default_value = (*(c**0.5 for c in color), 1.0)
    return material


def _hall(stone: bpy.types.Material, floor: bpy.types.Material) -> None:
    a, b = WIDE + WALL, LONG + WALL
    m.add_boxes("Floor", [((-a, -b, -WALL), (a, b, 0))], floor)
    walls = [
        ((-a, -b, 0), (-WIDE, b, HIGH)),
        ((-WIDE, -b, 0), (WIDE, -LONG, HIGH)),
        ((-WIDE, LONG, 0), (WIDE, b, HIGH)),
        ((-a, -b, HIGH), (a, b, HIGH + WALL)),
        ((WIDE, -b, 0), (a, b, SILL)),
        ((WIDE, -b, TOP), (a, b, HIGH)),
    ]
    edges = [-b, *(y + s * HALF for y in WINDOWS for s in (-1, 1)), b]
    walls += [
        ((WIDE, first, SILL), (a, end, TOP))
        for first, end in zip(edges[::2], edges[1::2], strict=True)
    ]
    m.add_boxes("Walls", walls, stone)
    beams = [((-WIDE, y - 0.12, HIGH - 0.3), (WIDE, y + 0.12, HIGH)) for y in (-2.4, 0.0, 2.4)]
    m.add_boxes("Beams", beams, m.diffuse("Oak", (0.13, 0.08, 0.05)))


def _window(
    number: int,
    middle: float,
    panes: list[bpy.types.Material],
    lead: bpy.types.Material,
    chance: np.random.Generator,
) -> None:
    """Panes between bars; the colours of both halves mirror each other."""
    x = WIDE + WALL / 2
    ys = np.linspace(middle - HALF, middle + HALF, COLUMNS + 1)
    zs = np.linspace(SILL, TOP, ROWS + 1)
    colors = chance.integers(len(panes), size=(ROWS, COLUMNS))
    colors[:, -1] = colors[:, 0]
    for color, material in enumerate(panes):
        boxes = [
            (
                (x - PANE / 2, float(ys[c]) + LEAD / 2, float(zs[r]) + LEAD / 2),
                (x + PANE / 2, float(ys[c + 1]) - LEAD / 2, float(zs[r + 1]) - LEAD / 2),
            )
            for r, c in np.argwhere(colors == color)
        ]
        if boxes:
            m.add_boxes(f"Window {number}, {color}", boxes, material)
    bars = [
        ((x - LEAD, middle - HALF, z - LEAD / 2), (x + LEAD, middle + HALF, z + LEAD / 2))
        for z in map(float, zs)
    ]
    bars += [
        ((x - LEAD, y - LEAD / 2, SILL), (x + LEAD, y + LEAD / 2, TOP)) for y in map(float, ys)
    ]
    m.add_boxes(f"Lead {number}", bars, lead)


if __name__ == "__main__":
    make()
