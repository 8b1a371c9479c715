"""Cases like those of cases.py: surfaces that their materials' displacement moves."""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.cases import Case


def _moved(name: str, *, splat: bool = False, **options: Any) -> Case:
    return Case(
        f"displaced_{name}",
        "displaced",
        options,
        samples=1024,
        block_bias=0.04,
        splat=splat,
        photons_per_pass=20_000,
    )


DISPLACEMENT = (
    _moved("grid", splat=True),
    _moved("grid_little", amount=0.08),
    _moved("grid_much_midlevel", amount=0.7, midlevel=0.2),
    _moved("grid_world", space="WORLD", scale=(1.0, 1.3, 0.6)),
    _moved("grid_stretched", scale=(1.2, 0.7, 0.9)),
    _moved("grid_object", height="object", color="places"),
    _moved("plate", shape="plate"),
    _moved("ball_image", shape="ball", height="image", splat=True),
    _moved("ball_flat", shape="ball", shading="flat"),
    _moved("ball_mirrored", shape="ball", scale=(-1.0, 1.0, 1.2), height="image"),
    _moved("box_sharp", shape="box", shading="sharp"),
    _moved("box_custom", shape="box", shading="custom"),
    _moved("vector_object", shape="ball", height="vector", amount=0.2),
    _moved("vector_world", shape="ball", height="vector", space="WORLD", scale=(1.2, 1.0, 0.7)),
    _moved("vector_tangent", height="vector", space="TANGENT", amount=0.25),
    _moved("vector_tangent_ball", shape="ball", height="vector", space="TANGENT", amount=0.25),
    _moved("vector_bump", method="BUMP", height="vector", space="TANGENT", amount=0.1),
    _moved("both", method="BOTH", shape="coarse", splat=True),
    _moved("both_object", method="BOTH", shape="coarse", height="object", amount=0.4),
    _moved("both_scaled", method="BOTH", shape="coarse", scale=(0.8, 1.2, 0.6)),
    _moved("both_world", method="BOTH", shape="coarse", space="WORLD", scale=(0.8, 1.2, 0.6)),
    _moved("both_flat", method="BOTH", shape="coarse", shading="flat"),
    _moved("both_sharp", method="BOTH", shape="box", shading="sharp"),
    _moved(
        "both_vector", method="BOTH", shape="coarse", height="vector", space="TANGENT", amount=0.1
    ),
    _moved("second_plain", shape="ball", second="plain"),
    _moved("second_moved", shape="ball", second="moved"),
    _moved("second_both", shape="ball", second="both"),
    _moved("shining", shape="ball", color="shining", amount=0.5, splat=True),
    _moved("normal_map", shape="ball", height="image", normal_map="ORIGINAL"),
    Case("displaced_copies", "displaced_copies", {}, block_bias=0.04),
    Case("displaced_copies_world", "displaced_copies", {"space": "WORLD"}, splat=False),
    Case("displaced_copies_own", "displaced_copies", {"linked": "OBJECT"}, splat=False),
)
