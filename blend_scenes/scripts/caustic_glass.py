"""caustic_glass.blend: a glass ball on a table under a small bright lamp. Nothing but the table
scatters diffusely.
"""

from __future__ import annotations

from . import modelling as m
from .caustic_shapes import Glass


def make() -> None:
    m.new_scene(640, 400)
    a = Glass.TABLE_HALF
    m.add_mesh(
        "Table",
        [(-a, -a, 0), (a, -a, 0), (a, a, 0), (-a, a, 0)],
        [(0, 1, 2, 3)],
        m.diffuse("Table", Glass.TABLE_ALBEDO),
    )
    m.add_sphere("Ball", Glass.RADIUS, m.glass("Glass", Glass.IOR), Glass.CENTRE, 128)
    m.add_light("Lamp", "AREA", Glass.POWER, Glass.LAMP, shape="SQUARE", size=Glass.LAMP_SIZE)
    m.set_world((0.0, 0.0, 0.0))
    m.add_camera((0.55, -1.25, 0.75), (0.06, -0.02, 0.12), lens=42.0)
    m.save("caustic_glass")


if __name__ == "__main__":
    make()
