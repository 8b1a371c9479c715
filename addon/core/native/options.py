"""Hands the settings of a render to the native renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..render.plan import Plan
from ..render.settings import RenderSettings
from .library import load

if TYPE_CHECKING:
    from photon_splat_native import Renderer

SAME_OPTIONS = (
    "photons_per_pass",
    "max_bounces",
    "radius_scale",
    "point_spacing",
    "boundary_correction",
    "caustics",
    "adaptive_radius",
    "adaptive_samples",
    "occlusion",
    "adaptive_indirect",
)
"""Settings that the renderer has by the same name."""


def set_options(renderer: Renderer, settings: RenderSettings, plan: Plan) -> None:
    """What the renderer is to know of both, before it is built or begins again."""
    options = renderer.options
    for name in SAME_OPTIONS:
        setattr(options, name, getattr(settings, name))
    options.seed = settings.seed & 0xFFFFFFFF
    options.indirect_light = load().IndirectLight[plan.indirect_light]
