"""Denoises the picture of a finished render."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..scene import Scene
from .blend import blend
from .denoise import Quality, denoise, denoising_runs
from .oidn import DenoiserMissing
from .result import Passes
from .shadow_catcher import has_catchers, with_shadow
from .specks import share_taken, without_specks

MOST_TAKEN = 0.05
"""Of a picture's light, that may be taken out as specks without a word."""
SAMPLES_OF_NOISY_FEATURES = 32.0
"""Camera samples per pixel up to which the denoiser's features are noisier than it expects. Where
they were denoised first, after 1, 14, 64 samples relMSE of street is .49, .90, .99 times as large.
"""
SAMPLES_OF_BLURRED_FEATURES = 256.0
"""The same where depth of field makes noise in them: after 50 samples relMSE of a file with two
cars is .90 times as large.
"""


def has_noisy_features(samples: float, scene: Scene) -> bool:
    """Whether the denoiser's features are noisy after so many camera samples per pixel."""
    sharp = scene.camera.aperture is None
    return samples <= (SAMPLES_OF_NOISY_FEATURES if sharp else SAMPLES_OF_BLURRED_FEATURES)


def runs_of_result(quality: Quality, samples: float, scene: Scene) -> float:
    """Work of denoise_result(), in the unit of denoising_runs()."""
    noisy = has_noisy_features(samples, scene)
    of_picture = denoising_runs(quality, apart=True, noisy_features=noisy)
    of_shadow = denoising_runs(quality, apart=False, noisy_features=False)
    return of_picture + of_shadow * has_catchers(scene)


def denoise_result(
    passes: Passes,
    film: dict[str, Any],
    scene: Scene,
    *,
    passes_done: int,
    samples: float,
    threads: int,
    on_card: bool,
    quality: Quality = Quality.BEST,
    should_cancel: Callable[[], bool] | None = None,
) -> list[str]:
    """Denoises Combined with the features in `film`, which holds the arrays that final_arrays()
    names; samples: camera samples per pixel of all passes. If that cannot be done the picture stays
    as it is. Returns warnings for the user.
    """
    warnings: list[str] = []
    catchers = has_catchers(scene)
    noisy = (film["matte"] if catchers else passes["Combined"])[..., :3]
    direct, variance = film["diffuse_direct"], film["variance"][..., 0]
    try:
        calm = direct + without_specks(noisy - direct, variance, samples)
        taken = share_taken(noisy, calm)
        if taken > MOST_TAKEN:
            warnings.append(
                f"Single paths bring much of the light; {taken:.0%} of it has been taken for "
                "specks by denoising. Give it more time, or do not denoise it."
            )
        clean = denoise(
            calm,
            film["albedo"],
            film["feature_normal"],
            apart=direct,
            noisy_features=has_noisy_features(samples, scene),
            quality=quality,
            threads=threads,
            on_card=on_card,
            should_cancel=should_cancel,
            warn=warnings.append,
        )
        noisy[...] = blend(calm, clean, variance, passes_done)
        if catchers:
            _denoise_shadow(passes, film, scene, quality, threads, on_card, should_cancel)
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
    quality: Quality,
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
        quality=quality,
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
