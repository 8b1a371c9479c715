"""What tests.benchmarks.bench.gpu measures: single passes by both splatters, and whole renders."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from statistics import median
from typing import Any

from photon_splat.core.gpu import context, painter, splatter
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Scene

from tests.benchmarks.bench.gpu_discs import measure_discs
from tests.support import corescene as c
from tests.support import gpu_scenes as scenes

PATHS_PER_BATCH = 1 << 17
MILLION = 10**6
REPEATS = 3
"""Passes whose median counts, after one in which the driver compiles and allocates; of more than a
million photons, one in all.
"""

PASSES = 4
"""Of whole renders."""


@dataclass(frozen=True, slots=True)
class Case:
    """One pass of at least `photons` photons.

    discs: see gpu_discs.py. spacing 0: a point per camera sample. cpu: measure the CPU splatter,
    too.
    """

    width: int
    height: int
    photons: int
    radius: float = 1.0
    discs: bool = False
    longest_run: int = painter.LONGEST_RUN
    spacing: float = 1 / 3
    cpu: bool = True


def room(width: int, height: int) -> Scene:
    scene = scenes.room(16)
    scene.camera, scene.frame = c.perspective(
        (-0.9, -0.9, 0.2), (0.3, 0.3, -0.4), width, height, 1.3
    )
    return scene


def cases(quick: bool) -> dict[str, list[Case]]:
    """By group; quick: small sizes, to see that everything runs."""
    shrink, photons = (16, 5_000) if quick else (1, MILLION)
    sizes = [
        (w // shrink, h // shrink) for w, h in ((1920, 1080), (640, 360), (1280, 720), (3840, 2160))
    ]
    full = sizes[0]
    radii, counts = (
        ((1.0, 4.0), (1_000, 10_000))
        if quick
        else ((1.0, 2.0, 4.0, 8.0, 16.0), (10**5, 10**6, 10**7, 10**8))
    )
    runs = (1, 128) if quick else (1, 8, 32, 128, 512, 1 << 20)
    return {
        "seed": [Case(*full, photons)],
        "photons": [Case(*full, n) for n in counts],
        "radius": [Case(*full, photons, radius=r) for r in radii],
        "resolution": [Case(*size, photons) for size in sizes],
        "runs": [
            Case(*full, photons, radius=r, longest_run=n, cpu=False)
            for r in radii[:3:2]
            for n in runs
        ],
        "pixels": [
            Case(*full, photons, longest_run=1, spacing=0.0),
            Case(*full, photons, spacing=0.0),
            Case(*full, photons, discs=True, spacing=0.0),
        ],
    }


def measure(case: Case) -> dict[str, Any]:
    """ms of both splatters for the same photons.

    gpu_ms: the card's own clock, copies to the card included; busy_ms: wall time of its thread,
    with points and sums to and fro. cpu_ms holds the search for pairs; the GPU splatter needs
    pairs_ms of the CPU for it.
    """
    if case.discs:
        return measure_discs(case, room(case.width, case.height))
    splatter.LONGEST_RUN = case.longest_run
    settings = RenderSettings(
        photons_per_pass=case.photons,
        radius_scale=case.radius,
        point_spacing=case.spacing,
        adaptive_indirect=False,
    )
    renderer = load().Renderer(0)
    fill_renderer(renderer, room(case.width, case.height), settings)
    renderer.build()
    renderer.trace_camera(0)
    renderer.place_points(0)
    card = splatter.GpuSplatter(renderer, threading.Event())
    try:
        repeats = REPEATS if case.photons <= MILLION else 0
        found = [
            _one_pass(renderer, card, case, cpu=case.cpu and i == repeats)
            for i in range(repeats + 1)
        ][-REPEATS:]
        hits = float(renderer.points()["count"].sum())
    finally:
        card.close()
        splatter.LONGEST_RUN = painter.LONGEST_RUN
    last = found[-1]
    ms = {
        name: median(one[name] for one in found)
        for name in ("gpu_ms", "busy_ms", "pairs_ms", "trace_ms")
    }
    return {
        "width": case.width,
        "height": case.height,
        "radius": case.radius,
        "drawn": "blocks",
        "longest_run": case.longest_run,
        "points": renderer.statistics()["visible_points"],
        "photons": last["photons"],
        "pairs": last["pairs"],
        "tests_per_photon": 64 * last["pairs"] / last["photons"],
        "hits_per_photon": hits / last["photons"],
        **ms,
        "cpu_ms": last["cpu_ms"],
    }


def _one_pass(renderer: Any, card: splatter.GpuSplatter, case: Case, cpu: bool) -> dict[str, float]:
    before = card.statistics()["gpu"]
    seconds = {"trace": 0.0, "pairs": 0.0, "cpu": 0.0}

    def timed(name: str, task: Callable[..., None], *arguments: int) -> None:
        began = time.monotonic()
        task(*arguments)
        seconds[name] += time.monotonic() - began

    card.begin_pass()
    done = first = 0
    while done < case.photons:
        timed("trace", renderer.trace_photons, first, min(PATHS_PER_BATCH, case.photons))
        pairs_before = renderer.statistics()["seconds"]["splat"]
        card.add_photons()
        seconds["pairs"] += renderer.statistics()["seconds"]["splat"] - pairs_before
        if cpu:
            context.submit(lambda: None).result()  # the CPU is to itself
            timed("cpu", renderer.splat)
        done, first = done + renderer.photon_count, first + PATHS_PER_BATCH
        if not renderer.photon_count:
            raise RuntimeError("the scene stores no photons")
    card.finish_pass()
    after = card.statistics()["gpu"]
    return {
        "photons": done,
        "pairs": after["pairs"] - before["pairs"],
        "gpu_ms": 1e3 * (after["card_seconds"] - before["card_seconds"]),
        "busy_ms": 1e3 * (after["busy_seconds"] - before["busy_seconds"]),
        "cpu_ms": 1e3 * seconds["cpu"] if cpu else float("nan"),
        "pairs_ms": 1e3 * seconds["pairs"],
        "trace_ms": 1e3 * seconds["trace"],
    }


def renders(quick: bool) -> Iterator[dict[str, Any]]:
    """Whole renders of PASSES passes by either splatter: what overlaps, and how long the GPU waits
    for M(x).

    mass_ms: the CPU's for M(x), per pass, when the card has nothing to do. M(x) on the card could
    save at most mass_share of the render, if it took no time there. gpu_idle_ms: all that the card
    waits for, per pass.
    """
    width, height, counts = (120, 68, (5_000,)) if quick else (1920, 1080, (200_000, MILLION))
    for photons in counts:
        for backend in ("GPU", "CPU"):
            statistics = c.shoot(
                room(width, height), backend=backend, passes=PASSES, photons_per_pass=photons
            ).statistics
            seconds = statistics["seconds"]
            found = {
                "backend": backend,
                "photons_per_pass": photons,
                "total_seconds": seconds["total"],
            }
            found |= {
                "mass_ms": 1e3 * seconds["boundary"] / PASSES,
                "mass_share": seconds["boundary"] / seconds["total"],
            }
            if backend == "GPU":
                gpu = statistics["gpu"]
                found |= {
                    name: gpu[name] for name in ("wall_seconds", "busy_seconds", "cpu_busy_seconds")
                }
                found["gpu_idle_ms"] = 1e3 * (seconds["total"] - gpu["busy_seconds"]) / PASSES
                found["wall_over_busiest"] = gpu["wall_seconds"] / max(
                    gpu["busy_seconds"], gpu["cpu_busy_seconds"]
                )
            yield found
