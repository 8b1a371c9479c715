"""Puts the statistics of a finished render together."""

from __future__ import annotations

import time
from typing import Any

from ..native.coincident import coincident_surfaces
from ..native.lights import lights_in_surfaces
from ..scene import Scene
from .memory import peak_memory_bytes
from .persistent import Start
from .plan import make_plan, pilot_sentences
from .settings import RenderSettings
from .statistics import Statistics
from .worker import Worker

NOISY = 0.2
"""Relative RMSE from which a picture is named noisy. Of 26 files that artists have published, after
8 s at 200 pixels, 17 lie below .18 and 9 above .21, among them all that differ from Cycles.
"""


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
            *coincident_surfaces(start.renderer, scene),
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


def still_noisy(statistics: Statistics, settings: RenderSettings, *, cancelled: bool) -> list[str]:
    """A warning where the time limit has ended a raw picture while it was noisy: who sets a number
    of passes has asked for just that.
    """
    error = statistics["error"]["relative_rmse"]
    in_time = settings.time_limit > 0.0 and statistics["passes"] < settings.passes
    if settings.denoise or cancelled or not in_time or error < NOISY:
        return []
    return [
        f"The picture is noisy: the time limit of {settings.time_limit:g} s has ended it at an "
        f"estimated error of {100.0 * error:.0f} %. Give it more time, or denoise it."
    ]
