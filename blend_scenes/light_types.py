"""light_types.blend: twelve compartments, each lit by one light of its own.

Upper row: sun (through an open top), area lights as square, rectangle, disk, ellipse, and a disk of 50 degrees spread.
Lower row: point, point with a radius (soft falloff), point as a sphere, spot with a hard edge, spot with a soft edge
and radius, an emissive mesh. Objects that belong to one light have its name, so that each can be rendered alone.
"""

from __future__ import annotations

from math import radians

from . import modelling as m

COLUMNS, WIDTH, DEPTH, HEIGHT, WALL = 6, 1.0, 0.8, 1.0, 0.04
PAPER, CLAY = (0.72, 0.70, 0.66), (0.55, 0.32, 0.24)


def cell_centre(column: int, row: int) -> tuple[float, float, float]:
    """The middle of a compartment's floor; row 0 is the lower one."""
    return ((column - (COLUMNS - 1) / 2) * (WIDTH + WALL), 0.0, row * (HEIGHT + WALL))


def _shelf() -> None:
    x0, x1 = cell_centre(0, 0)[0] - WIDTH / 2, cell_centre(COLUMNS - 1, 0)[0] + WIDTH / 2
    z2 = 2 * HEIGHT + WALL
    y0, y1 = -DEPTH / 2, DEPTH / 2
    open_cell_end = x0 + WIDTH
    boards = [
        ((x0 - WALL, y0, -WALL), (x1 + WALL, y1, 0.0)),
        ((x0 - WALL, y0, HEIGHT), (x1 + WALL, y1, HEIGHT + WALL)),
        ((open_cell_end, y0, z2), (x1 + WALL, y1, z2 + WALL)),
        ((x0 - WALL, y1, -WALL), (x1 + WALL, y1 + WALL, z2 + WALL)),
    ]
    for row in range(2):
        z = row * (HEIGHT + WALL)
        for column in range(COLUMNS + 1):
            x = x0 - WALL + column * (WIDTH + WALL)
            boards.append(((x, y0, z), (x + WALL, y1, z + HEIGHT)))
    m.add_boxes("Shelf", boards, m.principled("Paper", PAPER))


def _objects() -> None:
    clay = m.diffuse("Clay", CLAY)
    for row in range(2):
        for column in range(COLUMNS):
            x, y, z = cell_centre(column, row)
            m.add_sphere(f"Ball {row}{column}", 0.16, clay, (x + 0.17, y + 0.12, z + 0.16), 24)
            m.add_boxes(f"Block {row}{column}", [((-0.12, -0.12, 0.0), (0.12, 0.12, 0.3))], clay, (x - 0.2, y + 0.05, z), 0.4)


def _lights() -> None:
    def at(column: int, row: int, height: float = 0.9) -> tuple[float, float, float]:
        x, y, z = cell_centre(column, row)
        return (x, y, z + height)

    def aim(column: int) -> tuple[float, float, float]:
        x, y, z = cell_centre(column, 0)
        return (x + 0.05, y + 0.1, z)

    x, y, z = at(0, 1)
    m.add_light("Sun", "SUN", 3.0, (x, y, z + 2.0), (x + 0.5, y - 0.1, z), angle=radians(3.0))
    warm = (1.0, 0.9, 0.75)
    m.add_light("Area square", "AREA", 4.0, at(1, 1), shape="SQUARE", size=0.4, color=warm)
    m.add_light("Area rectangle", "AREA", 4.0, at(2, 1), shape="RECTANGLE", size=0.7, size_y=0.15)
    m.add_light("Area disk", "AREA", 4.0, at(3, 1), shape="DISK", size=0.5)
    m.add_light("Area ellipse", "AREA", 4.0, at(4, 1), shape="ELLIPSE", size=0.2, size_y=0.7, color=warm)
    m.add_light("Area spread", "AREA", 2.0, at(5, 1), shape="DISK", size=0.5, spread=radians(50.0))
    m.add_light("Point", "POINT", 5.0, at(0, 0, 0.75), shadow_soft_size=0.0, color=(0.7, 0.85, 1.0))
    m.add_light("Point soft", "POINT", 5.0, at(1, 0, 0.75), shadow_soft_size=0.12)
    m.add_light("Point sphere", "POINT", 5.0, at(2, 0, 0.75), shadow_soft_size=0.12, use_soft_falloff=False)
    hard = m.add_light("Spot hard", "SPOT", 20.0, at(3, 0), aim(3), spot_size=radians(55.0), spot_blend=0.0, shadow_soft_size=0.0)
    hard.data.exposure = 0.5
    m.add_light("Spot soft", "SPOT", 30.0, at(4, 0), aim(4), spot_size=radians(75.0), spot_blend=1.0, shadow_soft_size=0.06)
    bulb = m.emission("Bulb", (1.0, 0.6, 0.3), 5.0)
    m.add_sphere("Emissive mesh", 0.13, bulb, at(5, 0, 0.6), 16)


def make() -> None:
    m.new_scene(960, 352)
    _shelf()
    _objects()
    _lights()
    middle = HEIGHT + WALL / 2
    m.add_camera((0.0, -9.0, middle + 3.6), (0.0, 0.0, middle + 0.05), ortho_scale=COLUMNS * (WIDTH + WALL) + 3 * WALL)
    m.save("light_types")


if __name__ == "__main__":
    make()
