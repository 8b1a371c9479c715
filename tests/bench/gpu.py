"""The GPU splatter: time against photons, kernel radius and resolution, against the CPU splatter, and what overlaps.

    make bench-gpu [GPU_OPTIONS="--quick --software"]

Prints a table and writes it as JSON. GPU times are OpenGL timer queries around the drawing of each batch (copies to the
card included). Refuses renderers that run on the CPU unless told --software.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
import threading
import time
from pathlib import Path
from typing import Any

from photon_splat.core.gpu import context, painter, splatter
from photon_splat.core.native import load
from photon_splat.core.native_scene import fill_renderer
from photon_splat.core.scene import Scene
from photon_splat.core.settings import RenderSettings

from tests import corescene as c
from tests.gpu import scenes

SEED_MS = 740.0
"""Lavignotte & Paulin (2003): one million photons on a GeForce FX 5800."""
PATHS_PER_BATCH = 1 << 17
RESOLUTIONS = ((640, 360), (1280, 720), (1920, 1080), (3840, 2160))
PHOTONS = (10**5, 10**6, 10**7, 10**8)
RADII = (1.0, 2.0, 4.0, 8.0, 16.0)
RUNS = (1, 8, 32, 128, 512, 1 << 20)


class TimedPainter(painter.Painter):
    """Adds up the nanoseconds that the card says it drew."""

    nanoseconds = 0

    def splat(self, batch: painter.Batch) -> None:
        query = self._graphics.gl.query(time=True)
        with query:
            super().splat(batch)
        self.nanoseconds += query.elapsed


def room(width: int, height: int) -> Scene:
    scene = scenes.room(16)
    scene.camera, scene.frame = c.perspective((-0.9, -0.9, 0.2), (0.3, 0.3, -0.4), width, height, 1.3)
    return scene


def measure(width: int, height: int, photons: int, radius_scale: float = 1.0, longest_run: int = painter.LONGEST_RUN) -> dict[str, Any]:
    """One pass of at least `photons` photons: ms of both splatters for the same photons.

    cpu_ms holds the search for pairs; the GPU splatter needs pairs_ms of the CPU for it, beside gpu_ms of the card.
    """
    splatter.LONGEST_RUN = longest_run
    settings = RenderSettings(photons_per_pass=photons, radius_scale=radius_scale)
    renderer = load().Renderer(0)
    fill_renderer(renderer, room(width, height), settings)
    renderer.build()
    renderer.trace_camera(0)
    renderer.make_points(0)
    card = splatter.GpuSplatter(renderer, threading.Event())
    seconds = {"trace": 0.0, "pairs": 0.0, "cpu": 0.0}

    def timed(name: str, task: Any, *arguments: Any) -> None:
        began = time.monotonic()
        task(*arguments)
        seconds[name] += time.monotonic() - began

    try:
        card.begin_pass()
        done = first = 0
        while done < photons:
            timed("trace", renderer.trace_photons, 0, first, min(PATHS_PER_BATCH, photons))
            pairs_before = renderer.statistics()["seconds"]["splat"]
            card.add_photons()
            seconds["pairs"] += renderer.statistics()["seconds"]["splat"] - pairs_before
            context.submit(lambda: None).result()  # the CPU is to itself
            timed("cpu", renderer.splat)
            done, first = done + renderer.photon_count, first + PATHS_PER_BATCH
            if not renderer.photon_count:
                raise RuntimeError("the scene stores no photons")
        card.finish_pass()
        statistics = card.statistics()["gpu"]
    finally:
        card.close()
    return {
        "width": width,
        "height": height,
        "photons": done,
        "radius_scale": radius_scale,
        "longest_run": longest_run,
        "points": renderer.statistics()["visible_points"],
        "pairs": statistics["pairs"],
        "gpu_ms": card._painter.nanoseconds / 1e6,  # type: ignore[attr-defined]
        "cpu_ms": 1e3 * seconds["cpu"],
        "pairs_ms": 1e3 * seconds["pairs"],
        "trace_ms": 1e3 * seconds["trace"],
    }


def overlap(width: int, height: int, photons: int) -> dict[str, Any]:
    """A render of four passes: wall time against the busier of the two sides."""
    gpu = c.shoot(room(width, height), backend="GPU", passes=4, photons_per_pass=photons).statistics["gpu"]
    return gpu | {"wall_over_busiest": gpu["wall_seconds"] / max(gpu["busy_seconds"], gpu["cpu_busy_seconds"])}


def cases(quick: bool) -> list[dict[str, Any]]:
    """The first is the seed's million photons."""
    size = (160, 90) if quick else (1920, 1080)
    photons = 20_000 if quick else 1_000_000
    made = [{"size": size, "photons": photons}]
    made += [{"size": size, "photons": p // (1000 if quick else 1)} for p in PHOTONS]
    made += [{"size": size, "photons": photons, "radius_scale": r} for r in (RADII[:3] if quick else RADII)]
    made += [{"size": (w // 8, h // 8) if quick else (w, h), "photons": photons} for w, h in RESOLUTIONS]
    made += [{"size": size, "photons": photons, "radius_scale": r, "longest_run": n} for r in (1.0, 4.0) for n in RUNS]
    return made


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--software", action="store_true", help="measure a renderer that runs on the CPU, too")
    parser.add_argument("--quick", action="store_true", help="small sizes, to see that everything runs")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/bench_gpu.json"))
    options = parser.parse_args()
    try:
        graphics = context.submit(context.graphics).result()
    except context.NoGraphics as reason:
        print(f"bench-gpu: {reason}", file=sys.stderr)
        return 1
    if not graphics.hardware and not options.software:
        print(
            f"bench-gpu: {graphics.renderer} runs on the CPU; these figures are for graphics cards (--software measures it)",
            file=sys.stderr,
        )
        return 1
    splatter.Painter = TimedPainter  # type: ignore[misc]
    version = context.submit(lambda: graphics.gl.info["GL_VERSION"]).result()
    report: dict[str, Any] = {"renderer": graphics.renderer, "opengl": version, "machine": platform.platform(), "cases": []}
    print(f"{graphics.renderer}, OpenGL {version}")
    columns = ("width", "height", "photons", "radius_scale", "longest_run", "points", "pairs", "gpu_ms", "cpu_ms", "pairs_ms", "trace_ms")
    print(" ".join(f"{name:>12}" for name in columns))
    measure(160, 90, 1000)  # compiles shaders
    for case in cases(options.quick):
        found = measure(*case.pop("size"), **case)
        report["cases"].append(found)
        print(" ".join(f"{found[name]:12.4g}" if isinstance(found[name], float) else f"{found[name]:12}" for name in columns), flush=True)
    if not options.quick:
        report["gpu_ms_per_million"] = report["cases"][0]["gpu_ms"] * 1e6 / report["cases"][0]["photons"]
        print(f"a million photons: {report['gpu_ms_per_million']:.1f} ms; the seed: {SEED_MS:.0f} ms")
    report["overlap"] = overlap(*((160, 90, 40_000) if options.quick else (1920, 1080, 1_000_000)))
    print(f"overlap: wall time is {report['overlap']['wall_over_busiest']:.2f} of the busier side's")
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text(json.dumps(report, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
