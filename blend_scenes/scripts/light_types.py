"""light_types.blend: twelve compartments, each lit by one light of its own.

Upper row: sun (through an open top), area lights as square, rectangle, disk, ellipse, and a disk of
50 degrees spread. Lower row: point, point with a radius (soft falloff), point as a sphere, spot
with a hard edge, spot with a soft edge and radius, an emissive mesh. Objects that belong to one
light have its name, so that each can be rendered alone.
"""

from __future__ import annotations

from math import radians

from . import modelling as m

COLUMNS, WIDTH, DEPTH, HEIGHT, WALL = 6, 1.0, 0.8, 1.0, 0.04
PAPER, CLAY = (0.72, 0.70, 0.66), (0.55, 0.32, 0.24)


def cell_centre(column: int, row: int) -> tuple[float, float, float]:
    """The middle of a compartment's floor; row 0 is the lower one."""
    return ((column - (COLUMNS - 1) / 2) * (WIDTH + WALL), 0.0, row * (HEIGHT + WALL))


class _Quads:
    """Gathers axis-aligned rectangles as faces of one mesh."""

    def __init__(self) -> None:
        self.vertices: list[tuple[float, float, float]] = []
        self.faces: list[tuple[int, ...]] = []

    def add(
        self,
        axis: int,
        at: float,
        low: tuple[float, float],
        high: tuple[float, float],
        *,
        positive: bool,
    ) -> None:
        """A rectangle across `axis` (0, 1, 2) at `at`; low and high give the other two axes in
        cyclic order; `positive`: faces +axis.
        """
        base = len(self.vertices)
        for u, v in ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])):
            point = [0.0, 0.0, 0.0]
            point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3] = at, u, v
            self.vertices.append((point[0], point[1], point[2]))
        order = (0, 1, 2, 3) if positive else (3, 2, 1, 0)
        self.faces.append(tuple(base + k for k in order))


def _shelf() -> None:
    """Twelve boxes open to the front, the first of the upper row to the top as well. No face lies
    hidden under another.
    """
    quads = _Quads()
    y0, y1 = -DEPTH / 2, DEPTH / 2
    top = 2 * HEIGHT + WALL
    for row in range(2):
        for column in range(COLUMNS):
            x, _, z = cell_centre(column, row)
            x0, x1, z1 = x - WIDTH / 2, x + WIDTH / 2, z + HEIGHT
            quads.add(2, z, (x0, y0), (x1, y1), positive=True)
            if (column, row) != (0, 1):
                quads.add(2, z1, (x0, y0), (x1, y1), positive=False)
            quads.add(1, y1, (z, x0), (z1, x1), positive=False)
            quads.add(0, x0, (y0, z), (y1, z1), positive=True)
            quads.add(0, x1, (y0, z), (y1, z1), positive=False)
    left, right = cell_centre(0, 0)[0] - WIDTH / 2, cell_centre(COLUMNS - 1, 0)[0] + WIDTH / 2
    open_end = left + WIDTH
    # The front edges of the boards: upright ones row by row, lying ones from end to end, none above
    # the open compartment.
    for row in range(2):
        z = row * (HEIGHT + WALL)
        for column in range(COLUMNS + 1):
            x = left - WALL + column * (WIDTH + WALL)
            quads.add(1, y0, (z, x), (z + HEIGHT, x + WALL), positive=False)
    for z, x in ((-WALL, left - WALL), (HEIGHT, left - WALL), (top, open_end)):
        quads.add(1, y0, (z, x), (z + WALL, right + WALL), positive=False)
    # Outside.
    quads.add(0, left - WALL, (y0, -WALL), (y1 + WALL, top), positive=False)
    quads.add(0, right + WALL, (y0, -WALL), (y1 + WALL, top + WALL), positive=True)
    quads.add(2, -WALL, (left - WALL, y0), (right + WALL, y1 + WALL), positive=False)
    quads.add(1, y1 + WALL, (-WALL, left - WALL), (top, right + WALL), positive=True)
    quads.add(1, y1 + WALL, (top, open_end), (top + WALL, right + WALL), positive=True)
    quads.add(2, top + WALL, (open_end, y0), (right + WALL, y1 + WALL), positive=True)
    quads.add(0, open_end, (y0, top), (y1 + WALL, top + WALL), positive=False)
    # The rim of the open compartment.
    quads.add(2, top, (left - WALL, y0), (left, y1), positive=True)
    quads.add(2, top, (left - WALL, y1), (open_end, y1 + WALL), positive=True)
    m.add_mesh("Shelf", quads.vertices, quads.faces, m.principled("Paper", PAPER))


def _objects() -> None:
    clay = m.diffuse("Clay", CLAY)
    for row in range(2):
        for column in range(COLUMNS):
            x, y, z = cell_centre(column, row)
            m.add_sphere(f"Ball {row}{column}", 0.16, clay, (x + 0.17, y + 0.12, z + 0.16), 24)
            m.add_boxes(
                f"Block {row}{column}",
                [((-0.12, -0.12, 0.0), (0.12, 0.12, 0.3))],
                clay,
                (x - 0.2, y + 0.05, z),
                0.4,
            )


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
    m.add_light(
        "Area ellipse", "AREA", 4.0, at(4, 1), shape="ELLIPSE", size=0.2, size_y=0.7, color=warm
    )
    m.add_light("Area spread", "AREA", 2.0, at(5, 1), shape="DISK", size=0.5, spread=radians(50.0))
    m.add_light("Point", "POINT", 5.0, at(0, 0, 0.75), shadow_soft_size=0.0, color=(0.7, 0.85, 1.0))
    m.add_light("Point soft", "POINT", 5.0, at(1, 0, 0.75), shadow_soft_size=0.12)
    m.add_light(
        "Point sphere", "POINT", 5.0, at(2, 0, 0.75), shadow_soft_size=0.12, use_soft_falloff=False
    )
    hard = m.add_light(
        "Spot hard",
        "SPOT",
        20.0,
        at(3, 0),
        aim(3),
        spot_size=radians(55.0),
        spot_blend=0.0,
        shadow_soft_size=0.0,
    )
    hard.data.exposure = 0.5
    m.add_light(
        "Spot soft",
        "SPOT",
        30.0,
        at(4, 0),
        aim(4),
        spot_size=radians(75.0),
        spot_blend=1.0,
        shadow_soft_size=0.06,
    )
    bulb = m.emission("Bulb", (1.0, 0.6, 0.3), 5.0)
    m.add_sphere("Emissive mesh", 0.13, bulb, at(5, 0, 0.6), 16)


def make() -> None:
    m.new_scene(960, 352)
    _shelf()
    _objects()
    _lights()
    middle = HEIGHT + WALL / 2
    m.add_camera(
        (0.0, -9.0, middle + 3.6),
        (0.0, 0.0, middle + 0.05),
        ortho_scale=COLUMNS * (WIDTH + WALL) + 3 * WALL,
    )
    m.save("light_types")


if __name__ == "__main__":
    make()
