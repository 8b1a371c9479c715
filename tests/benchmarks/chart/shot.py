"""One render in a process of its own: `python -m tests.benchmarks.chart.shot METHOD SCENE.blend
WIDTH HEIGHT SECONDS SEED OUT.npz [PARTS]`.

METHOD is a Method or "reference-paths" / "reference-photons" / "reference-cycles-card". Writes
pictures (height, width, 3) float32 with the seconds of each: the render call alone, as Blender's
user waits for it, export, start-up and denoising included; not Blender's own start. PARTS: folder
for the parts of a long render (plan.LONG).
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np

from tests.benchmarks.chart.card import use_graphics_card
from tests.benchmarks.chart.plan import LONG, Method
from tests.reference.cycles.references import cycles_settings

ENDLESS = 1 << 20
TRIALS = (32, 288)
"""Samples of the renders that tell Cycles' rate."""
PARTS = 30


def main(arguments: list[str]) -> None:
    method, blend, width, height, seconds, seed, output = arguments[:7]
    bpy.ops.wm.open_mainfile(filepath=blend)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = (
        int(width),
        int(height),
        100,
    )
    scene.render.use_border = scene.render.use_compositing = False
    if method == "reference-cycles-card":
        found = _cycles(Method.CYCLES_CARD, float(seconds), int(seed), Path())
    elif method.startswith(("Photon Splat", "reference")):
        found = _photon_splat(method, float(seconds), int(seed))
    else:
        found = _cycles(Method(method), float(seconds), int(seed), Path(*arguments[7:]))
    np.savez(output, **found)  # type: ignore[arg-type]


def _photon_splat(method: str, seconds: float, seed: int) -> dict[str, object]:
    import photon_splat
    from photon_splat.blender.job import observer
    from photon_splat.core.render.result import RenderResult
    from photon_splat.core.render.settings import FinalGather, Integrator, RenderSettings

    photon_splat.register()
    scene = bpy.context.scene
    scene.render.engine = "PHOTON_SPLAT"

    def settings(own: RenderSettings) -> RenderSettings:
        if method == Method.SPLAT_DEFAULT:
            return replace(own, seed=seed)
        given = replace(
            own,
            passes=ENDLESS,
            time_limit=seconds,
            error_threshold=0.0,
            seed=seed,
            denoise=method == Method.SPLAT_DENOISED,
        )
        if method == "reference-paths":
            return replace(given, integrator=Integrator.REFERENCE, max_bounces=64)
        return (
            replace(given, final_gather=FinalGather.ON) if method == "reference-photons" else given
        )

    results: list[RenderResult] = []
    observer.settings = settings
    observer.on_result = lambda result, frame: results.append(result)
    started = time.monotonic()
    bpy.ops.render.render()
    took = time.monotonic() - started
    return {"picture": results[0].passes["Combined"][..., :3], "seconds": took}


def _cycles(method: Method, seconds: float, seed: int, parts: Path) -> dict[str, object]:
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    if method == Method.CYCLES_DEFAULT:
        cycles.seed = seed
        cycles.device = "CPU"
    else:
        cycles_settings(ENDLESS, seed)
        cycles.sampling_pattern = "AUTOMATIC"
        cycles.use_denoising = method in (Method.CYCLES_DENOISED, Method.CYCLES_CARD_DENOISED)
        cycles.denoiser = "OPENIMAGEDENOISE"
    if method in (Method.CYCLES_CARD, Method.CYCLES_CARD_DENOISED):
        use_graphics_card()
        _warm_up()
    image = scene.render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "IMAGE"
    image.file_format, image.color_depth, image.color_mode = "OPEN_EXR", "32", "RGBA"
    if seconds >= LONG:
        return _long(seconds, parts)
    cycles.time_limit = 0.0 if method == Method.CYCLES_DEFAULT else seconds
    started = time.monotonic()
    bpy.ops.render.render()
    took = time.monotonic() - started
    return {"picture": _shown(), "seconds": took}


def _warm_up() -> None:
    """Lets the card load its kernels, which whoever renders a second time does not wait for."""
    render, cycles = bpy.context.scene.render, bpy.context.scene.cycles
    kept = render.resolution_percentage, cycles.samples
    render.resolution_percentage, cycles.samples = 10, 2
    bpy.ops.render.render()
    render.resolution_percentage, cycles.samples = kept


def _long(seconds: float, folder: Path) -> dict[str, object]:
    """One long render in ranges of its samples, each kept in `folder`: it goes on where it was
    stopped. Seconds: processor time over threads.
    """
    cycles = bpy.context.scene.cycles
    folder.mkdir(parents=True, exist_ok=True)
    count = folder / "samples"
    if not count.exists():
        count.write_text(str(_samples_in(seconds)))
    cycles.samples = int(count.read_text())
    cycles.use_sample_subset = True
    edges = [cycles.samples * i // PARTS for i in range(PARTS + 1)]
    total, spent = 0.0, 0.0
    for first, end in pairwise(edges):
        path = folder / f"{first}.npz"
        if not path.exists():
            cycles.sample_offset, cycles.sample_subset_length = first, end - first
            started = time.process_time()
            bpy.ops.render.render()
            took = (time.process_time() - started) / _threads()
            np.savez(path.with_suffix(".new.npz"), picture=_shown(), seconds=took)
            path.with_suffix(".new.npz").replace(path)
        with np.load(path) as part:
            total = total + (end - first) * part["picture"].astype(np.float64)
            spent += float(part["seconds"])
    return {"picture": (total / cycles.samples).astype(np.float32), "seconds": spent}


def _shown() -> np.ndarray:
    """What was rendered last, (height, width, 3) float32."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "picture.exr"))
        bpy.data.images["Render Result"].save_render(path)
        shown = bpy.data.images.load(path)
        shown.colorspace_settings.name = "Non-Color"
        pixels = np.empty(shown.size[0] * shown.size[1] * 4, np.float32)
        shown.pixels.foreach_get(pixels)
        picture = pixels.reshape(shown.size[1], shown.size[0], 4)[..., :3]
        bpy.data.images.remove(shown)
    return picture


def _samples_in(seconds: float) -> int:
    """As many as Cycles makes in that time with the machine to itself, from the processor time of
    two trials of some seconds.
    """
    cycles = bpy.context.scene.cycles
    spent = []
    for samples in TRIALS:
        cycles.samples = samples
        started = time.process_time()
        bpy.ops.render.render()
        spent.append((time.process_time() - started) / _threads())
    each = (spent[1] - spent[0]) / (TRIALS[1] - TRIALS[0])
    return round((seconds - spent[0]) / each) + TRIALS[0]


def _threads() -> int:
    render = bpy.context.scene.render
    return render.threads if render.threads_mode == "FIXED" else len(os.sched_getaffinity(0))


if __name__ == "__main__":
    main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # Blender may hang or die at exit
