"""Scenes that nobody would make, by Cycles and by our path tracer: the exporter says what Cycles
shows, or a warning says where not.

What this has found: an instance that comes first in the graph in the place of what comes next;
materials of slots that the evaluated mesh lacks, or that the object has emptied; objects in place
of hair all in one place.
"""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.support import random_scenes, stage
from tests.support.blender import in_blender

PIXELS = 48
SAMPLES = (64, 512)
"""More where few differ: the tails of few samples are heavy."""
TOLD = ("exactly in each other", "exactly in a surface")
"""Warnings of what is not as in Cycles, where rounding decides there."""
SHARE = 0.02
"""Of 8x8 blocks and channels that may differ by chance."""


def _by_cycles(folder: str, seed: int, samples: int) -> np.ndarray:
    import bpy
    import OpenImageIO as oiio

    made = stage.scene()
    render, cycles = made.render, made.cycles
    render.engine = "CYCLES"
    cycles.samples, cycles.seed = samples, seed
    for name in ("use_adaptive_sampling", "use_denoising", "use_fast_gi", "blur_glossy"):
        setattr(cycles, name, 0)
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    kinds = ("", "diffuse_", "glossy_", "transmission_", "volume_")
    for name in (*(f"{kind}bounces" for kind in kinds[1:]), "max_bounces"):
        setattr(cycles, name, 12)
    cycles.transparent_max_bounces = 12
    image = render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "IMAGE"
    image.file_format, image.color_depth, image.color_mode = "OPEN_EXR", "32", "RGBA"
    render.filepath = f"{folder}/cycles.exr"
    bpy.ops.render.render(write_still=True)
    pixels = oiio.ImageBuf(render.filepath).get_pixels(oiio.FLOAT)[::-1, :, :4]
    return np.nan_to_num(pixels.astype(np.float64), posinf=1e6)


def _by_us(seed: int, samples: int) -> tuple[np.ndarray, list[str]]:
    import bpy
    from photon_splat.blender import job
    from photon_splat.core.render.settings import Integrator

    stage.scene().render.engine = "PHOTON_SPLAT"
    job.observer.settings = lambda given: replace(
        given,
        passes=samples,
        integrator=Integrator.REFERENCE,
        seed=seed,
        max_bounces=12,
        denoise=False,
        error_threshold=0.0,
    )
    with stage.watched() as results:
        bpy.ops.render.render()
    job.observer.settings = job.Observer().settings
    [result] = results
    pixels = result.passes["Combined"].astype(np.float64)
    return pixels, list(result.statistics["warnings"])


def _share_that_differs(theirs: list[np.ndarray], ours: list[np.ndarray]) -> float:
    """Of the means of 8x8 blocks, beyond noise and 2 %; two pictures of either show the noise."""
    brightest = max(2.0 * float(np.percentile(np.mean(theirs, 0), 99)), 1e-3)

    def blocks(pixels: np.ndarray) -> np.ndarray:
        shape = (PIXELS // 8, 8, PIXELS // 8, 8, 4)
        return np.minimum(pixels, brightest).reshape(shape).mean((1, 3))

    a, b = [blocks(p) for p in theirs], [blocks(p) for p in ours]
    noise = np.sqrt(((a[0] - a[1]) ** 2 + (b[0] - b[1]) ** 2) / 4.0)
    noise = np.hypot(noise, noise.mean())
    mean = np.mean(a, 0)
    allowed = 4.0 * noise + 0.02 * mean + 0.01 * mean.mean() + 1e-5
    return float((np.abs(np.mean(b, 0) - mean) > allowed).mean())


def _compare(folder: str, seed: int) -> str | None:
    """What is wrong, or None."""
    made = random_scenes.build(random.Random(seed))
    made.render.resolution_x = made.render.resolution_y = PIXELS
    for samples in SAMPLES:
        theirs = [_by_cycles(folder, k, samples) for k in (1, 2)]
        ours: list[Any] = [_by_us(k, samples) for k in (1, 2)]
        share = _share_that_differs(theirs, [pixels for pixels, _ in ours])
        told = any(text in warning for text in TOLD for warning in ours[0][1])
        if share <= SHARE or told:
            return None
    return f"seed {seed}: {100.0 * share:.0f} % of the picture differs, {ours[0][1]}"


@pytest.mark.parametrize("first", [0, pytest.param(8, marks=pytest.mark.slow)])
@in_blender
def test_any_scene_is_as_cycles_shows_it(first: int, tmp_path: str) -> None:
    seeds = range(first, first + (200 if first else 8))
    wrong = [said for seed in seeds if (said := _compare(tmp_path, seed))]
    assert not wrong, "\n".join(wrong)
