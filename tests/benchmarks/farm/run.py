"""Parts up to 1,000: what they cost beside their passes, their error and their bias.

Usage: python -m tests.benchmarks.farm.run [OUT.png]

A room of 24 x 24 pixels gets 1,000 passes, in 1, 10, 100 and 1,000 parts, which are all rendered
and merged; and in as many renders of other seeds without a common radius schedule, averaged. Errors
are those against 3,000 passes with final gathering, whose blur is that of what paths meet second.
Times are CPU seconds: export, acceleration, pilot and common passes, and passes, of a part;
merging; and how long N machines take if one machine needs so long for each.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from photon_splat.core.render.parts import Part
from photon_splat.core.render.record import Record
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import FinalGather, RenderSettings
from photon_splat.core.render.sums import Sums, added
from photon_splat.core.scene import LightKind, Scene

from tests.support import corescene

mpl.use("Agg")
from matplotlib import pyplot as plt

PASSES = 1000
PARTS = (1, 10, 100, 1000)
PIXELS = 24
PHOTONS = 4000
START_SECONDS = 1.0
"""Of a process with Blender, about: one that rendered a single small pass took 1.2 s of CPU."""
WEIGHTS = np.array([0.2126, 0.7152, 0.0722])


@dataclass
class Result:
    parts: int
    rmse: float
    naive_rmse: float
    estimate: float
    seconds: float
    """CPU, of one part."""
    merge: float


def room() -> Scene:
    return corescene.scene(
        corescene.perspective((0, -1.9, 1.0), (0, 0, 0.8), PIXELS, PIXELS, 1.2),
        [
            (corescene.box((-2, -2, 0), (2, 2, 2), inwards=True), corescene.lambert(0.6)),
            (corescene.box((-0.9, 0.2, 0), (-0.2, 0.9, 1.1)), corescene.lambert(0.7)),
        ],
        [corescene.lamp(LightKind.POINT, 60.0, (1.2, 1.2, 1.6))],
    )


def settings(passes: int, **more: object) -> RenderSettings:
    return RenderSettings(passes=passes, photons_per_pass=PHOTONS, threads=1, **more)  # type: ignore[arg-type]


def sums_of(what: Scene, asked: RenderSettings, part: Part) -> Sums:
    record = Record(part, keeps=True)
    render(what, asked, started=time.monotonic(), record=record)
    assert record.total is not None
    return record.total


def light(sums: Sums) -> np.ndarray:
    return sums.film().film(["combined"])["combined"][..., :3].astype(float) @ WEIGHTS


def together(what: Scene, count: int, naive: bool) -> tuple[Sums, float, float]:
    """The sums of all parts, CPU seconds of one, and of the merge."""
    passes, spent, merging = PASSES // count, 0.0, 0.0
    total: Sums | None = None
    waiting: list[Sums] = []
    for number in range(1, count + 1):
        began = time.process_time()
        if naive:
            one = sums_of(what, settings(passes, seed=number), Part())
            one.films[0].part = number
        else:
            one = sums_of(what, settings(passes), Part(number, count))
        spent += time.process_time() - began
        waiting.append(one)
        if len(waiting) == 50 or number == count:
            began = time.process_time()
            total = added(waiting if total is None else [total, *waiting])
            merging += time.process_time() - began
            waiting = []
    assert total is not None
    return total, spent / count, merging


def measure() -> list[Result]:
    what = room()
    gathered = settings(3000, final_gather=FinalGather.ON, seed=99)
    truth = light(sums_of(what, gathered, Part()))

    def error(picture: np.ndarray) -> float:
        return float(np.sqrt(np.mean((picture - truth) ** 2)) / truth.mean())

    results = []
    for count in PARTS:
        merged, seconds, merge = together(what, count, naive=False)
        apart = merged if count == 1 else together(what, count, naive=True)[0]
        estimate = merged.film().error()["relative_rmse"]
        results.append(
            Result(count, error(light(merged)), error(light(apart)), estimate, seconds, merge)
        )
        print(results[-1], flush=True)
    return results


def draw(results: list[Result], path: Path) -> None:
    parts = [one.parts for one in results]
    figure, (times, errors) = plt.subplots(1, 2, figsize=(10, 4))
    scale = results[0].seconds
    of_part = [(one.seconds + START_SECONDS) / (scale + START_SECONDS) for one in results]
    merging = [one.merge / (scale + START_SECONDS) for one in results]
    times.loglog(parts, [1 / n for n in parts], ":", color="grey", label="ideal")
    times.loglog(parts, of_part, "o-", label="a part, with start and pilot")
    times.loglog(parts[1:], merging[1:], "s--", label="merge")
    times.set(xlabel="parts", ylabel="time over that of one render")
    errors.semilogx(parts, [100 * one.naive_rmse for one in results], "s--", label="other seeds")
    errors.semilogx(parts, [100 * one.rmse for one in results], "o-", label="parts, merged")
    errors.set(xlabel="parts", ylabel="RMSE, % of the mean", ylim=(0, None))
    for axes in (times, errors):
        axes.grid(alpha=0.3)
        axes.legend()
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main() -> None:
    path = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/pictures/farm.png")
    draw(measure(), path)


if __name__ == "__main__":
    main()
