"""Puts the statistics of a finished render together."""

from __future__ import annotations

import time
from typing import Any

from ..native.lights import lights_in_surfaces
from ..scene import Scene
from .memory import peak_memory_bytes
from .persistent import Start
from .plan import make_plan, pilot_sentences
from .statistics import Statistics
from .worker import Worker


def final_statistics(
    start: Start, worker: Worker, scene: Scene, started: float, export_seconds: float
) -> Statistics:
    statistics: Any = start.renderer.statistics()
    statistics["seconds"] |= {"export": export_seconds, "total": time.monotonic() - started}
    statistics |= {
        "passes": worker.record.part.passes_before + worker.passes_done,
        "backend": str(worker.splatter.backend),
        "integrator": str(worker.settings.integrator),
        "cancelled": worker.cancelled,
        "film_bytes": worker.film_bytes,
        "texture_bytes": start.renderer.texture_memory,
        "reused": {"geometry": start.reused, "photons": statistics["photons"]["reused"]},
        "peak_memory_bytes": peak_memory_bytes(),
        "warnings": [
            *scene.warnings,
            *worker.warnings,
            *worker.record.warnings(),
            *lights_in_surfaces(start.renderer, scene),
        ],
    } | worker.splatter.statistics()
    if statistics["threads"] < statistics["threads_wanted"]:
        statistics["warnings"].append(
            f"Of {statistics['threads_wanted']} threads the system has started "
            f"{statistics['threads']}: the render has taken longer."
        )
    plan = make_plan(scene, worker.settings)
    statistics["plan"] = {
        "sentences": plan.sentences + pilot_sentences(statistics),
        "flags": plan.flags,
    }
    if statistics["bad_samples"]:
        statistics["warnings"].append(
            f"{statistics['bad_samples']} camera samples were not finite, or far too bright for "
            "any film, and have been left out."
        )
    return statistics
