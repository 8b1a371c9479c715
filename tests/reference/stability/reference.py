"""What is right for each case, and how far a picture is from it."""

from __future__ import annotations

import time
from functools import cache
from pathlib import Path

import numpy as np
from photon_splat.core.render.result import Passes
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import Integrator, RenderSettings

from tests.reference.stability.cases import CASES, PIXELS, Case
from tests.support.compare import block_means

FILE = Path(__file__).with_name("reference.npz")
BLOCK = 4


def bounced(passes: Passes) -> np.ndarray:
    """(H, W) mean of the channels: light that has bounced; with what the surface emits where that
    is part of the case.
    """
    light = passes["Diffuse Indirect"] * passes["Diffuse Color"]
    return light.mean(-1).astype(np.float64)


def picture(case: Case, passes: Passes) -> np.ndarray:
    return (
        passes["Combined"][..., :3].mean(-1).astype(np.float64) if case.whole else bounced(passes)
    )


def shoot(case: Case, **settings: object) -> np.ndarray:
    plain = {"passes": case.passes, "photons_per_pass": case.photons, "max_bounces": 64}
    result = render(case.make(), RenderSettings(**(plain | settings)), started=time.monotonic())  # type: ignore[arg-type]
    return picture(case, result.passes)


def make(names: list[str]) -> None:
    """Path-traces the cases without an exact answer, or those named. Minutes."""
    kept = _file() if names and FILE.exists() else {}
    wanted = [case for case in CASES if case.exact is None]
    kept = {case.name: kept[case.name] for case in wanted if case.name in kept}
    for case in wanted:
        if not names or case.name in names:
            kept[case.name] = shoot(
                case, integrator=Integrator.REFERENCE, passes=case.samples
            ).astype(np.float32)
            print(case.name, flush=True)
    np.savez_compressed(FILE, **kept)


@cache
def _file() -> dict[str, np.ndarray]:
    with np.load(FILE) as file:
        return {name: file[name] for name in file.files}


def reference_of(case: Case) -> np.ndarray:
    return (
        _file()[case.name].astype(np.float64)
        if case.exact is None
        else np.full((PIXELS, PIXELS), case.exact)
    )


def worst_block(case: Case, values: np.ndarray) -> float:
    """Largest deviation of a 4x4 block's mean, relative to the reference's mean (or to the case's
    unit).
    """
    reference = reference_of(case)
    difference = block_means((values - reference)[..., None], BLOCK)
    return float(
        np.abs(difference).max() / (reference.mean() if reference.mean() > 0 else case.unit)
    )
