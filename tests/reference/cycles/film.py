"""Cases like those of cases.py: the film, and what a view layer leaves out."""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.cases import Case


def _film(name: str, **options: Any) -> Case:
    alpha = bool(options.get("transparent"))
    return Case(f"film_{name}", "film", options, samples=512, alpha=alpha)


FILM = (
    _film("exposure", exposure=2.5),
    _film("clear_glass", transparent=True, transparent_glass=True),
    _film(
        "clear_rough_glass",
        transparent=True,
        transparent_glass=True,
        transparent_roughness=0.5,
    ),
    _film("glass_on_transparent", transparent=True),
    _film("filter_box", pixel_filter_type="BOX"),
    _film("filter_gaussian", pixel_filter_type="GAUSSIAN", filter_width=2.5),
    _film("filter_wide", filter_width=4.0),
    Case("layer_without_sky", "layer_without", {"switch": "use_sky"}, samples=512),
    Case("layer_without_solid", "layer_without", {"switch": "use_solid"}, samples=64),
)
