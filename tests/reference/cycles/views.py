"""Cases like those of cases.py: views of pictures that have several."""

from __future__ import annotations

from math import radians
from typing import Any

from tests.reference.cycles.cases import Case


def _stereo(name: str, eye: str, **options: Any) -> Case:
    return Case(f"view_{name}", "stereo", {"eye": eye, **options}, splat=False)


def _around(name: str, eye: str, **options: Any) -> Case:
    wide = {"kind": "PANO", "use_spherical_stereo": True}
    return Case(
        f"view_around_{name}", "stereo", {"eye": eye, **wide, **options}, 64, 32, splat=False
    )


MERGED = {
    "use_pole_merge": True,
    "pole_merge_angle_from": radians(20),
    "pole_merge_angle_to": radians(60),
}
VIEWS = (
    _stereo("off_axis_left", "left"),
    _stereo("off_axis_right", "right", convergence_distance=1.2),
    _stereo("parallel", "right", convergence_mode="PARALLEL"),
    _stereo("toe_in", "right", convergence_mode="TOE", convergence_distance=1.5),
    _stereo("pivot", "left", pivot="CENTER", convergence_distance=1.5),
    _stereo("spherical", "left", use_spherical_stereo=True, convergence_distance=1.5),
    _stereo(
        "spherical_focus",
        "right",
        dof=True,
        use_spherical_stereo=True,
        convergence_mode="PARALLEL",
    ),
    _around("left", "left", convergence_distance=1.5),
    _around("parallel", "right", convergence_mode="PARALLEL"),
    _around("merged", "right", convergence_distance=1.5, **MERGED),
    _around("focus", "left", dof=True, convergence_distance=1.5),
    Case("view_of_camera_left", "one_camera_of_two", {"suffix": "_L"}, splat=False),
    Case("view_of_camera_right", "one_camera_of_two", {"suffix": "_R"}, splat=False),
)
