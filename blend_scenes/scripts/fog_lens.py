"""fog_lens.blend: a spot through a glass ball into fog. The ball gathers the light to a bright
focus in the air behind it, which throws a ring on the floor.
"""

from __future__ import annotations

from . import modelling as m


def make() -> None:
    m.new_scene(640, 400)
    a = 3.0
    m.add_mesh(
        "Floor",
        [(-a, -a, 0), (a, -a, 0), (a, a, 0), (-a, a, 0)],
        [(0, 1, 2, 3)],
        m.diffuse("Floor", (0.35, 0.33, 0.3)),
    )
    m.add_sphere("Ball", 0.22, m.glass("Glass", 1.5), (0.0, 0.0, 0.8), 128)
    m.add_boxes(
        "Fog",
        [((-1.6, -1.2, -0.1), (1.6, 1.2, 2.0))],
        m.medium("Fog", 0.35, (0.9, 0.93, 1.0), 0.4),
    )
    m.add_light(
        "Spot",
        "SPOT",
        90.0,
        (-1.3, 0.0, 1.75),
        (0.0, 0.0, 0.8),
        color=(1.0, 0.86, 0.65),
        shadow_soft_size=0.02,
        spot_size=0.33,
        spot_blend=0.1,
    )
    m.set_world((0.0, 0.0, 0.0))
    m.add_camera((0.15, -3.3, 0.95), (0.1, 0.0, 0.85), lens=46.0)
    m.save("fog_lens")


if __name__ == "__main__":
    make()
