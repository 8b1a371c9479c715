"""What a result takes from the film: arrays by name, made into passes."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from ..scene import Scene
from .result import Passes, film_arrays, passes_from_film
from .settings import RenderSettings
from .shadow_catcher import shadow_arrays, split_off_shadow

OF_DENOISING = ("Combined",)
"""Passes that the denoiser reads."""
FOR_DENOISING = ("albedo", "feature_normal", "variance", "diffuse_direct")
"""Arrays of the film that the denoiser reads and that are no passes."""


def final_arrays(
    wanted: Collection[str] | None, settings: RenderSettings, scene: Scene
) -> list[str]:
    """Names of the film arrays that the result is made of."""
    return [
        *film_arrays(wanted, scene.labels),
        *shadow_arrays(scene, settings.denoise),
        *(FOR_DENOISING if settings.denoise else ()),
    ]


def final_passes(film: dict[str, Any], scene: Scene) -> Passes:
    """The passes that `film` holds, arrays as final_arrays() names them."""
    passes = passes_from_film(film, scene.light_groups)
    split_off_shadow(passes, film, scene)
    return passes


def interim_passes(renderer: Any, wanted: Collection[str] | None, scene: Scene) -> Passes:
    """The passes as they are now, not denoised."""
    names = [*film_arrays(wanted, scene.labels), *shadow_arrays(scene, denoise=False)]
    return final_passes(renderer.film(names), scene)
