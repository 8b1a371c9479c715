"""What the engine promises in figures: `python -m tests.benchmarks.bench.run [NAME ...]`. Prints,
and writes out/bench.json.

Each measurement runs in a process of its own (memory and caches are its own). Exit status 1 if a
promise is missed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np

from tests.benchmarks.bench.scenes import ROOT, bumpy_globe_in_a_box, from_blend
from tests.support.processes import environment

MEMORY_LIMIT = 2e9
Figures = dict[str, Any]


def seed_table() -> Figures:
    """The seed's table: 2 M photons traced, 1 M photons splatted, on 1,500 and on 100,000
    triangles. Seconds, medians of 3.
    """
    from photon_splat.core.native.fill import fill_renderer
    from photon_splat.core.native.library import load
    from photon_splat.core.render.settings import RenderSettings

    figures: Figures = {}
    for name in ("cornell_box_1500", "cornell_box_100k"):
        scene = from_blend(name, 512, 512)
        trace, splat = [], []
        for seed in range(3):
            renderer = load().Renderer(0)
            fill_renderer(renderer, scene, RenderSettings(photons_per_pass=2_000_000, seed=seed))
            renderer.build()
            renderer.trace_camera(0)
            renderer.place_points(0)
            before = renderer.statistics()
            renderer.trace_photons(0, 2_000_000)
            traced = renderer.statistics()
            renderer.splat()
            splatted = renderer.statistics()
            stored = traced["photons"]["stored"] - before["photons"]["stored"]
            trace.append(traced["seconds"]["photons"] - before["seconds"]["photons"])
            splat.append((splatted["seconds"]["splat"] - traced["seconds"]["splat"]) * 1e6 / stored)
        figures[name] = {
            "triangles": int(sum(len(scene.meshes[m].triangles) for m in scene.instances.mesh)),
            "trace_2M_seconds": median(trace),
            "splat_1M_seconds": median(splat),
            "stored_of_2M": int(stored),
        }
    ratio = (
        figures["cornell_box_100k"]["splat_1M_seconds"]
        / figures["cornell_box_1500"]["splat_1M_seconds"]
    )
    return figures | {"splat_ratio": ratio, "kept": ratio <= 1.15}


def reference_halves() -> np.ndarray:
    """Two independent path-traced halves of cornell_box, (2, 512, 512, 3) float64; made once and
    kept in build/.
    """
    from photon_splat.core.render.session import render
    from photon_splat.core.render.settings import Integrator, RenderSettings

    cache = ROOT / "build" / "bench" / "cornell_box_512.npy"
    if not cache.exists():
        scene = from_blend("cornell_box", 512, 512)
        print(
            "   reference: two halves of 600 samples (kept for next time)",
            file=sys.stderr,
            flush=True,
        )
        settings = [
            RenderSettings(passes=600, max_bounces=64, seed=seed, integrator=Integrator.REFERENCE)
            for seed in (71, 72)
        ]
        halves = [render(scene, half, started=time.monotonic()) for half in settings]
        cache.parent.mkdir(parents=True, exist_ok=True)
        np.save(cache, np.stack([half.passes["Combined"][..., :3] for half in halves]))
    return np.load(cache).astype(np.float64)


def error_at_10_seconds() -> Figures:
    """RMSE of cornell_box at 512x512 after 1 and 10 s, export included, free of the path-traced
    reference's noise.
    """
    import bpy
    from photon_splat.core.render.session import render
    from photon_splat.core.render.settings import RenderSettings
    from photon_splat.export import export_scene

    from tests.support.compare import rmse_two_halves

    half_1, half_2 = reference_halves()
    figures: Figures = {"mean": float((half_1 + half_2).mean() / 2)}
    for seconds in (1.0, 10.0):
        bpy.ops.wm.open_mainfile(filepath=str(ROOT / "blend_scenes" / "cornell_box.blend"))
        depsgraph = bpy.context.evaluated_depsgraph_get()
        started = time.monotonic()
        scene = export_scene(depsgraph)
        result = render(scene, RenderSettings(passes=100_000, time_limit=seconds), started=started)
        took = time.monotonic() - started
        picture = result.passes["Combined"][..., :3].astype(np.float64)
        figures[f"{seconds:g} s"] = {
            "rmse": rmse_two_halves(picture, half_1, half_2),
            "mean_ratio": float(picture.mean() / ((half_1 + half_2).mean() / 2)),
            "seconds": took,
            "passes": result.statistics["passes"],
            "photons": result.statistics["photons"]["traced"],
            "stages": result.statistics["seconds"],
        }
    return figures | {
        "kept": figures["10 s"]["rmse"] <= 0.010 and figures["10 s"]["seconds"] < 10.5
    }


def photon_tracer_against_embree() -> Figures:
    """Rays per second of the photon tracer over those of Embree alone on the same ways backwards
    (its fastest call); best of 3 each.
    """
    from photon_splat.core.native.fill import fill_renderer
    from photon_splat.core.native.library import load
    from photon_splat.core.render.settings import RenderSettings

    figures: Figures = {}
    for name, scene in (
        ("globe_131k", bumpy_globe_in_a_box()),
        ("cornell_box_100k", from_blend("cornell_box_100k")),
    ):
        runs = []
        for _ in range(3):
            renderer = load().Renderer(0)
            fill_renderer(renderer, scene, RenderSettings())
            renderer.build()
            bench = renderer.bench_photon_tracer(500_000)
            runs.append(
                (
                    bench["rays"] / bench["tracer_seconds"],
                    {call: bench["embree_rays"] / s for call, s in bench["embree_seconds"].items()},
                )
            )
        tracer = max(run[0] for run in runs)
        embree = {call: max(run[1][call] for run in runs) for call in runs[0][1]}
        call = max(embree, key=lambda key: embree[key])
        figures[name] = {
            "tracer_Mrays_per_s": tracer / 1e6,
            "embree_Mrays_per_s": embree[call] / 1e6,
            "call": call,
            "share": tracer / embree[call],
        }
    return figures | {"kept": figures["globe_131k"]["share"] >= 0.6}


def memory_of_instances() -> Figures:
    """10 million instanced triangles, rendered at the scene's own size: peak memory of the process,
    Blender included.
    """
    from photon_splat.core.render.session import render
    from photon_splat.core.render.settings import RenderSettings

    started = time.monotonic()
    scene = from_blend("instances")
    triangles = int(sum(len(scene.meshes[m].triangles) for m in scene.instances.mesh))
    render(scene, RenderSettings(passes=4), started=started)
    peak = _peak_memory()
    return {
        "triangles": triangles,
        "peak_bytes": peak,
        "seconds": time.monotonic() - started,
        "kept": peak < MEMORY_LIMIT,
    }


def _peak_memory() -> int:
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def memory_of_photons(photons: str = "") -> Figures:
    """Peak memory of one pass of 10 k to 100 M photons on cornell_box, each in a process of its
    own.
    """
    if photons:
        from photon_splat.core.render.session import render
        from photon_splat.core.render.settings import RenderSettings

        scene = from_blend("cornell_box", 128, 128)
        result = render(
            scene, RenderSettings(passes=1, photons_per_pass=int(photons)), started=time.monotonic()
        )
        return {"peak_bytes": _peak_memory(), "seconds": result.statistics["seconds"]["total"]}
    counts = (10_000, 100_000, 1_000_000, 10_000_000, 100_000_000)
    figures: Figures = {
        f"{count:,}": _in_process("memory_of_photons", str(count)) for count in counts
    }
    peaks = [figures[f"{count:,}"]["peak_bytes"] for count in counts]
    return figures | {"growth": max(peaks) / peaks[0], "kept": max(peaks) < 1.1 * peaks[0]}


def export_of_a_million_triangles() -> Figures:
    """See export.py beside this file."""
    from tests.benchmarks.bench import export

    return export.measure()


def splat_of_a_million_photons() -> Figures:
    """See splat.py beside this file."""
    from tests.benchmarks.bench import splat

    return splat.measure()


def first_picture() -> Figures:
    """See first_picture.py beside this file."""
    from tests.benchmarks.bench import first_picture as bench

    return bench.measure()


MEASUREMENTS: dict[str, Callable[..., Figures]] = {
    function.__name__: function
    for function in (
        seed_table,
        error_at_10_seconds,
        photon_tracer_against_embree,
        memory_of_instances,
        memory_of_photons,
        export_of_a_million_triangles,
        splat_of_a_million_photons,
        first_picture,
    )
}


def _in_process(name: str, *arguments: str) -> Figures:
    with tempfile.TemporaryDirectory(prefix="photon_splat_bench_") as scratch:
        answer = os.path.join(scratch, "figures.json")
        command = [
            sys.executable,
            "-m",
            "tests.benchmarks.bench.run",
            "--child",
            answer,
            name,
            *arguments,
        ]
        blender = environment(os.path.join(scratch, "blender"))
        done = subprocess.run(
            command, cwd=ROOT, env=blender, stdout=sys.stderr, timeout=900, check=False
        )
        try:
            with open(answer) as file:
                return json.load(file)
        except FileNotFoundError:
            return {"error": f"the process ended with status {done.returncode}", "kept": False}


def _show(figures: Figures, indent: str = "   ") -> None:
    for key, value in figures.items():
        if isinstance(value, dict):
            print(f"{indent}{key}")
            _show(value, indent + "   ")
        else:
            print(
                f"{indent}{key:24} {value:.4g}"
                if isinstance(value, float)
                else f"{indent}{key:24} {value:,}"
                if type(value) is int
                else f"{indent}{key:24} {value}"
            )


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--child"]:
        figures = MEASUREMENTS[arguments[2]](*arguments[3:])
        with open(arguments[1], "w") as file:
            json.dump(figures, file)
            file.flush()
        os._exit(0)  # Blender may hang or die at exit
    unknown = [name for name in arguments if name not in MEASUREMENTS]
    if unknown:
        print(
            f"no such measurement: {', '.join(unknown)}; there are {', '.join(MEASUREMENTS)}",
            file=sys.stderr,
        )
        return 2
    results: Figures = {}
    for name in arguments or MEASUREMENTS:
        print(f"== {name}: {(MEASUREMENTS[name].__doc__ or '').splitlines()[0]}", flush=True)
        results[name] = _in_process(name)
        _show(results[name])
    output = ROOT / "out" / "bench.json"
    output.parent.mkdir(exist_ok=True)
    output.write_text(json.dumps(results, indent=2))
    missed = [name for name, figures in results.items() if not figures.get("kept", True)]
    print(
        f"{output.relative_to(ROOT)} written. "
        + (f"MISSED: {', '.join(missed)}" if missed else "Every promise is kept.")
    )
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
