"""small_glass.blend: a room 4 m wide and in it, on a table, a tumbler 4 cm wide; a lamp of 5 cm
makes its caustic.
"""

from __future__ import annotations

from . import modelling as m
from .caustic_shapes import SmallGlass


def make() -> None:
    m.new_scene(640, 360)
    a, top = SmallGlass.ROOM_HALF, SmallGlass.ROOM_HEIGHT
    corners = [
        (-a, -a, 0),
        (a, -a, 0),
        (a, a, 0),
        (-a, a, 0),
        (-a, -a, top),
        (a, -a, top),
        (a, a, top),
        (-a, a, top),
    ]
    sides = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
    m.add_mesh("Room", corners, sides, m.diffuse("Room", SmallGlass.ROOM_ALBEDO))
    half, height = SmallGlass.TABLE_HALF, SmallGlass.TABLE_HEIGHT
    table = ((-half, -half, height - 0.03), (half, half, height))
    m.add_boxes("Table", [table], m.diffuse("Table", SmallGlass.TABLE_ALBEDO))
    m.add_turned(
        "Tumbler", SmallGlass.PROFILE, m.glass("Glass", SmallGlass.IOR), SmallGlass.PLACE, 96
    )
    m.add_light(
        "Lamp", "AREA", SmallGlass.POWER, SmallGlass.LAMP, shape="SQUARE", size=SmallGlass.LAMP_SIZE
    )
    m.set_world((0.0, 0.0, 0.0))
    x, y, z = SmallGlass.PLACE
    m.add_camera(
        (x + 0.05, y - 0.3, z + 0.22), (x + 0.025, y - 0.015, z), lens=50.0
    ).data.clip_start = 0.01
    m.save("small_glass")


if __name__ == "__main__":
    make()
