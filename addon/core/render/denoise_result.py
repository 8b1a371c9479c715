"""Denoises the picture of a finished render."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..scene import Scene
from .denoise import blend, denoise
from .oidn import DenoiserMissing
from .result import Passes
from .shadow_catcher import has_catchers, with_shadow

SAMPLES_WORTH_TWO = 8.0
"""Camera samples per pixel from which the diffuse direct light is denoised separately. That takes a
tenth of a second per 100,000 pixels; after 14 samples relMSE is .90 (cornell_box), .95 (kitchen,
street), .99 (interior) times as large.
"""
SAMPLES_OF_NOISY_FEATURES = 32.0
"""Camera samples per pixel up to which the denoiser's features are noisier than it expects, so that
they are denoised first. After 1, 14, 64 samples relMSE of street is .49, .90, .99 times as large.
"""
SAMPLES_OF_BLURRED_FEATURES = 256.0
"""The same where depth of field makes noise in them: after 50 samples relMSE of a file with two
cars is .90 times as large.
"""


def denoising_options(samples: float, scene: Scene) -> dict[str, bool]:
    """The options of denoise() for a picture of so many camera samples per pixel."""
    sharp = scene.camera.aperture is None
    most = SAMPLES_OF_NOISY_FEATURES if sharp else SAMPLES_OF_BLURRED_FEATURES
    return {"apart": samples >= SAMPLES_WORTH_TWO, "noisy_features": samples <= most}


def denoise_result(
    passes: Passes,
    film: dict[str, Any],
    scene: Scene,
    *,
    passes_done: int,
    samples: float,
    threads: int,
    on_card: bool,
    should_cancel: Callable[[], bool] | None = None,
) -> list[str]:
    """Denoises Combined with the features in `film`, which holds the arrays that final_arrays()
    names; samples: camera samples per pixel of all passes. If that cannot be done the picture stays
    as it is. Returns warnings for the user.
    """
    warnings: list[str] = []
    catchers = has_catchers(scene)
    noisy = (film["matte"] if catchers else passes["Combined"])[..., :3]
    how = denoising_options(samples, scene)
    try:
        clean = denoise(
            noisy,
            film["albedo"],
            film["feature_normal"],
            apart=film["diffuse_direct"] if how["apart"] else None,
            noisy_features=how["noisy_features"],
            threads=threads,
            on_card=on_card,
            should_cancel=should_cancel,
            warn=warnings.append,
        )
        noisy[...] = blend(noisy, clean, film["variance"][..., 0], passes_done)
        if catchers:
            _denoise_shadow(passes, film, scene, threads, on_card, should_cancel)
    except (DenoiserMissing, RuntimeError) as error:
        warnings.append(f"The picture has not been denoised: {error}.")
    if scene.light_groups:
        warnings.append(
            "Only Combined is denoised; the passes of light groups are not, so that their sum "
            "is noisier."
        )
    return warnings


def _denoise_shadow(
    passes: Passes,
    film: dict[str, Any],
    scene: Scene,
    threads: int,
    on_card: bool,
    should_cancel: Callable[[], bool] | None,
) -> None:
    """The shadow on catchers has noise of its own. Makes the picture of it and of what has been
    denoised.
    """
    film["shadow_catcher"][...] = denoise(
        film["shadow_catcher"],
        film["albedo"],
        film["feature_normal"],
        threads=threads,
        on_card=on_card,
        should_cancel=should_cancel,
    )
    if not scene.shadow_pass:
        passes["Combined"][...] = with_shadow(
            film["matte"],
            film["shadow_catcher"],
            film["backdrop"],
            scene.frame.transparent,
        )
