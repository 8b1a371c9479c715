"""Hands the settings of a render to the native renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..render.settings import FinalGather, RenderSettings
from ..scene import NO_PROGRAM, Scene
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
    "fallback",
)
"""Settings that the renderer has by the same name."""


def _has_media(scene: Scene) -> bool:
    return scene.world_volume != NO_PROGRAM or any(
        material.volume != NO_PROGRAM for material in scene.materials
    )


def set_options(renderer: Renderer, scene: Scene, settings: RenderSettings) -> None:
    """What the renderer is to know of `settings`, before it is built."""
    native = load()
    options = renderer.options
    for name in SAME_OPTIONS:
        setattr(options, name, getattr(settings, name))
    options.force_caustics = "caustics" in settings.force
    options.seed = settings.seed & 0xFFFFFFFF
    if settings.final_gather == FinalGather.ON:
        options.final_gather = native.FinalGather.ON
    elif settings.final_gather == FinalGather.AUTO and settings.denoise:
        options.final_gather = native.FinalGather.BY_TRIAL
    else:
        options.final_gather = native.FinalGather.OFF
    options.tries_paths = (
        settings.final_gather == FinalGather.AUTO
        and not settings.denoise
        and "photons" not in settings.force
        # Of light that media scatter photons may bring little.
        and bool(settings.time_limit or settings.error_threshold or _has_media(scene))
    )
