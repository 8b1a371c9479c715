"""Cases like those of cases.py: surfaces that are subdivided as finely as the camera sees them."""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.cases import Case


def _fine(name: str, *, splat: bool = False, bias: float = 0.003, **options: Any) -> Case:
    return Case(
        f"adaptive_{name}",
        "adaptive",
        options,
        samples=1024,
        block_bias=0.04,
        reference_bias=bias,
        splat=splat,
        photons_per_pass=20_000,
    )


ADAPTIVE = (
    # The surface
    _fine("cube", splat=True),
    _fine("cube_level_0", level=0),
    _fine("cube_level_4", level=4),
    _fine("cube_recursive", level=1, use_limit_surface=False),
    _fine("cube_simple", kind="SIMPLE", level=0),
    _fine("cube_flat", shading="flat", pixels=0.5),
    _fine("creased", shape="sharp", pixels=0.1, bias=0.01),
    _fine("creased_level_0", shape="creased", level=0, pixels=0.1, bias=0.01),
    _fine("creases_unused", shape="creased", use_creases=False),
    _fine("pinned", shape="pinned", level=0, pixels=0.1, bias=0.01),
    _fine("sheet", shape="sheet"),
    _fine("sheet_level_0", shape="sheet", level=0),
    _fine("sheet_corners", shape="sheet", level=0, boundary_smooth="PRESERVE_CORNERS"),
    _fine("drum", shape="drum", level=0),
    _fine("monkey", shape="monkey", level=1),
    _fine("monkey_level_0", shape="monkey", level=0),
    # Displaced
    _fine("noise", shape="sheet", kind="SIMPLE", height="noise", splat=True),
    _fine("noise_cube", height="noise", splat=True),
    _fine("noise_cube_level_0", height="noise", level=0),
    _fine("object_ball", shape="ball", height="object", level=1),
    _fine("image_sheet", shape="sheet", kind="SIMPLE", height="image"),
    _fine("image_ball", shape="ball", height="image", level=1),
    _fine("vector_ball", shape="ball", height="vector", level=1),
    _fine("flat", shape="sheet", kind="SIMPLE", height="noise", shading="flat"),
    _fine("both", shape="sheet", kind="SIMPLE", height="noise", method="BOTH"),
    _fine("both_coarse", shape="coarse", kind="SIMPLE", height="noise", method="BOTH", pixels=0.5),
    _fine("second_plain", shape="ball", height="noise", second="plain", level=1, bias=0.01),
    _fine("field", shape="field", kind="SIMPLE", height="noise", ground=True, splat=True),
    _fine("field_image", shape="field", kind="SIMPLE", height="image", ground=True),
    _fine("places", shape="ball", height="object", color="places", level=1),
    # How fine
    _fine("pixel", shape="sheet", kind="SIMPLE", height="noise", pixels=1.0, bias=0.01),
    _fine("edge", shape="sheet", kind="SIMPLE", height="noise", edge=0.01),
    _fine("limit_1", shape="sheet", kind="SIMPLE", height="noise", limit=1, level=0, bias=0.01),
    _fine("far_camera", shape="ball", level=0, pixels=1.0, dicing_camera=True, bias=0.01),
)
