"""cornell_box.blend, and the same box cut into about 1,500 and 100,000 triangles (cornell_box_1500,
cornell_box_100k).

A 2 m box, open towards the camera: red on the left, green on the right, two blocks, a light in a
hole of the ceiling that shines downwards only. All three files are the same picture.
"""

from __future__ import annotations

from math import radians

from . import modelling as m

WHITE, RED, GREEN = (0.73, 0.73, 0.73), (0.61, 0.06, 0.05), (0.12, 0.44, 0.10)
LIGHT_COLOR, LIGHT_STRENGTH = (1.0, 0.83, 0.56), 10.6
HALF = 1.0
HOLE = (0.30, 0.25)


def _room(levels: int) -> None:
    a, top = HALF, 2.0 * HALF
    white, red, green = m.diffuse("White", WHITE), m.diffuse("Red", RED), m.diffuse("Green", GREEN)
    walls = m.add_mesh(
        "Room",
        [
            (-a, -a, 0),
            (a, -a, 0),
            (a, a, 0),
            (-a, a, 0),
            (-a, -a, top),
            (a, -a, top),
            (a, a, top),
            (-a, a, top),
        ],
        [(0, 1, 2, 3), (3, 2, 6, 7), (0, 3, 7, 4), (1, 5, 6, 2)],
        [white, red, green],
        [0, 0, 1, 2],
    )
    x, y = HOLE
    ceiling = m.add_mesh(
        "Ceiling",
        [
            (-a, -a, top),
            (a, -a, top),
            (a, a, top),
            (-a, a, top),
            (-x, -y, top),
            (x, -y, top),
            (x, y, top),
            (-x, y, top),
        ],
        [(0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
        white,
    )
    lamp = m.add_mesh(
        "Light",
        [(-x, -y, top), (-x, y, top), (x, y, top), (x, -y, top)],
        [(0, 1, 2, 3)],
        m.front_emission("Light", LIGHT_COLOR, LIGHT_STRENGTH),
    )
    for thing in (walls, ceiling, lamp):
        m.subdivide_flat(thing, levels)


def _block(
    name: str,
    size: float,
    height: float,
    location: tuple[float, float, float],
    degrees: float,
    levels: int,
) -> None:
    corners, faces = m.box_data((-size / 2, -size / 2, 0.0), (size / 2, size / 2, height))
    block = m.add_mesh(
        name, corners, faces[1:], m.diffuse(name, WHITE), location=location, turn=radians(degrees)
    )
    m.subdivide_flat(block, levels)


def make(name: str, levels: int) -> None:
    """levels: how often each quad of the room is halved in both directions; the blocks' quads once
    less.
    """
    m.new_scene(512, 512)
    _room(levels)
    _block("Tall block", 0.6, 1.2, (-0.34, 0.35, 0.0), 17.0, levels - 1)
    _block("Short block", 0.6, 0.6, (0.36, -0.30, 0.0), -18.0, levels - 1)
    m.add_camera((0.0, -4.9, 1.0), (0.0, 0.0, 1.0), lens=65.0)
    m.save(name)


if __name__ == "__main__":
    make("cornell_box", 0)
    make("cornell_box_1500", 3)
    make("cornell_box_100k", 6)
