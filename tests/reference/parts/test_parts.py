"""Eight parts of eight passes, merged, are as good as one render of 64; and their blur is that of
the whole, not that of one part.
"""

from __future__ import annotations

import time

import numpy as np
import pytest
from photon_splat.core.render.parts import Part
from photon_splat.core.render.record import Record
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import FinalGather, RenderSettings
from photon_splat.core.render.sums import Sums, added
from photon_splat.core.scene import LightKind, Scene

from tests.support import corescene

PIXELS, PHOTONS = 32, 8000
PARTS, PASSES = 8, 8
SEEDS = 10
WEIGHTS = np.array([0.2126, 0.7152, 0.0722])


def room() -> Scene:
    """Indirect light with contact shadows, so that blur shows."""
    return corescene.scene(
        corescene.perspective((0, -1.9, 1.0), (0, 0, 0.8), PIXELS, PIXELS, 1.2),
        [
            (
                corescene.box((-2, -2, 0), (2, 2, 2), inwards=True),
                corescene.lambert((0.7, 0.6, 0.5)),
            ),
            (corescene.box((-0.9, 0.2, 0), (-0.2, 0.9, 1.1)), corescene.lambert((0.6, 0.7, 0.8))),
            (corescene.box((0.2, -0.3, 0), (0.8, 0.3, 0.5)), corescene.lambert((0.8, 0.5, 0.4))),
        ],
        [corescene.lamp(LightKind.POINT, 60.0, (1.2, 1.2, 1.6))],
    )


def sums_of(what: Scene, passes: int, seed: int, part: Part, **more: object) -> Sums:
    record = Record(part, keeps=True)
    asked = RenderSettings(passes=passes, photons_per_pass=PHOTONS, seed=seed, **more)  # type: ignore[arg-type]
    render(what, asked, started=time.monotonic(), record=record)
    assert record.total is not None
    return record.total


def light(sums: Sums) -> np.ndarray:
    return sums.film().film(["combined"])["combined"][..., :3].astype(float) @ WEIGHTS


@pytest.mark.slow
def test_parts_are_as_good_as_the_whole() -> None:
    what = room()
    truth = light(sums_of(what, 1200, 999, Part(), final_gather=FinalGather.ON))
    found: dict[str, list[np.ndarray]] = {"whole": [], "parts": [], "naive": []}
    estimates = []
    for seed in range(SEEDS):
        found["whole"].append(light(sums_of(what, PARTS * PASSES, seed, Part())))
        merged = added([sums_of(what, PASSES, seed, Part(i, PARTS)) for i in range(1, PARTS + 1)])
        estimates.append(merged.film().error()["relative_rmse"])
        found["parts"].append(light(merged))
        apart = [sums_of(what, PASSES, 1000 * seed + i, Part()) for i in range(1, PARTS + 1)]
        for number, one in enumerate(apart):
            one.films[0].part = number
        found["naive"].append(light(added(apart)))
    rmse, bias = {}, {}
    for name, pictures in found.items():
        errors = (np.array(pictures) - truth) / truth.mean()
        rmse[name] = np.sqrt(np.mean(errors**2))
        noise = errors.var(axis=0, ddof=1) / SEEDS
        bias[name] = np.sqrt(np.mean(errors.mean(axis=0) ** 2 - noise))
    print(rmse, bias, np.mean(estimates))
    assert rmse["parts"] < 1.05 * rmse["whole"]
    assert bias["parts"] < 0.65 * bias["naive"]
    assert 0.7 < rmse["parts"] / np.mean(estimates) < 1.5  # what the calibration promises
