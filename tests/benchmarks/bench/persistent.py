"""What Persistent Data saves: python -m tests.benchmarks.bench.persistent [SCENE.blend ...]
[--frames N] [--passes N] [--resolution WxH]

Renders a camera move by Blender's operator, with persistent data and without, frame by frame in
turns, so that both meet the same machine. Prints seconds of a render call and of all processors in
it, medians over the frames after the first, their ratio, and how the two pictures compare.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np
from photon_splat.core.render.result import RenderResult

from tests.support.paths import ROOT

STEP = 0.02
"""Metres that the camera moves to its right from frame to frame."""


def main() -> None:
    import photon_splat

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "scenes",
        nargs="*",
        type=Path,
        default=[ROOT / f"blend_scenes/{name}.blend" for name in ("interior", "instances")],
    )
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--passes", type=int, default=8)
    parser.add_argument("--resolution", default="480x270")
    options = parser.parse_args()
    photon_splat.register()
    for path in options.scenes:
        measure(
            path.resolve(),
            options.frames,
            options.passes,
            tuple(int(n) for n in options.resolution.split("x")),
        )
    photon_splat.unregister()


def measure(path: Path, frames: int, passes: int, size: tuple[int, ...]) -> None:
    shots: dict[bool, list[RenderResult]] = {}
    seconds: dict[bool, list[float]] = {}
    processor: dict[bool, list[float]] = {}
    for persistent in (False, True):
        scene = open_scene(path, passes, size)
        scene.render.use_persistent_data = persistent
        shots[persistent], seconds[persistent], processor[persistent] = [], [], []
        for _ in range(frames):
            before = time.process_time()
            result, took = shoot()
            processor[persistent].append(time.process_time() - before)
            shots[persistent].append(result)
            seconds[persistent].append(took)
            scene.camera.location += scene.camera.matrix_world.to_3x3().col[0].normalized() * STEP
    name = path.stem
    for k in range(frames):
        fresh, kept = (
            shots[which][k].passes["Combined"][..., :3].mean() for which in (False, True)
        )
        reused, stages = shots[True][k].statistics["reused"], shots[True][k].statistics["seconds"]
        print(
            f"{name}, frame {k + 1}: {seconds[False][k]:.2f} s fresh, {seconds[True][k]:.2f} s "
            f"persistent; mean {kept / fresh - 1:+.3%}; "
            f"{reused['photons']:,} photons used again; "
            + ", ".join(f"{stage} {taken:.2f}" for stage, taken in stages.items())
        )
    fresh, kept = (float(np.median(seconds[which][1:])) for which in (False, True))
    cpu_fresh, cpu_kept = (float(np.median(processor[which][1:])) for which in (False, True))
    print(
        f"{name}: frames 2 to {frames}: {fresh:.2f} s fresh, {kept:.2f} s persistent: ratio "
        f"{kept / fresh:.2f}; "
        f"of processors {cpu_fresh:.2f} s and {cpu_kept:.2f} s: ratio {cpu_kept / cpu_fresh:.2f}"
    )


def open_scene(path: Path, passes: int, size: tuple[int, ...]) -> Any:
    import bpy

    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    scene.render.engine = "PHOTON_SPLAT"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = (
        *size,
        100,
    )
    scene.photon_splat.passes, scene.photon_splat.time_limit = passes, 0.0
    scene.photon_splat.error_threshold, scene.photon_splat.denoise = 0.0, False
    return scene


def shoot() -> tuple[RenderResult, float]:
    """A render by the operator, and how long it took, s."""
    import bpy
    from photon_splat.blender import job

    results: list[RenderResult] = []
    job.observer.on_result = lambda result, frame: results.append(result)
    began = time.monotonic()
    bpy.ops.render.render()
    return results[0], time.monotonic() - began


if __name__ == "__main__":
    main()
