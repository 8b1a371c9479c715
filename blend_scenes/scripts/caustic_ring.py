"""caustic_ring.blend: a polished metal ring on a table in slanting sunlight; the curve that is seen
in cups lies inside it.
"""

from __future__ import annotations

from . import modelling as m
from .caustic_shapes import Ring


def make() -> None:
    m.new_scene(640, 400)
    a = Ring.TABLE_HALF
    m.add_mesh(
        "Table",
        [(-a, -a, 0), (a, -a, 0), (a, a, 0), (-a, a, 0)],
        [(0, 1, 2, 3)],
        m.diffuse("Table", Ring.TABLE_ALBEDO),
    )
    inner, outer, top = Ring.INNER, Ring.OUTER, Ring.HEIGHT
    metal = m.polished_metal("Metal", Ring.COLOR)
    m.add_turned(
        "Ring",
        [(outer, 0.0), (outer, top), (inner, top), (inner, 0.0)],
        metal,
        (0.0, 0.0, 0.0),
        256,
    )
    m.add_light("Sun", "SUN", Ring.STRENGTH, Ring.SUN, (0.0, 0.0, 0.0), angle=Ring.SUN_ANGLE)
    m.set_world((0.0, 0.0, 0.0))
    m.add_camera((0.1, -1.3, 1.25), (-0.02, 0.0, 0.0), lens=42.0)
    m.save("caustic_ring")


if __name__ == "__main__":
    make()
