"""Whether a picture agrees with Cycles': the whole picture's mean, and every 8x8 block by z-test
with both variances.

All integrators are held to it. The path tracer must agree within `reference_bias` (shading normals
and float texture lookups differ a little between any two renderers); the splat may show its
kernel's bias, `block_bias`, with final gathering half of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from photon_splat.core.render.settings import FinalGather

from tests.reference.cycles.cases import SCENES, Case
from tests.reference.cycles.gallery import ALL
from tests.reference.cycles.references import load
from tests.reference.cycles.worker import Worker
from tests.support.compare import Blocks, block_test, mean_ratio, within_known_bias

FAMILY_LEVEL = 0.01 / len(ALL)
"""Chance that a picture of equal expectation fails; over the whole table one per cent."""
DARK = 0.002
"""Deviation allowed to a block beside the relative one, in units of the picture's mean."""
INTEGRATORS = ("splat", "gather", "reference")
"""The second: splat, with final gathering."""


@dataclass
class Verdict:
    """`ratio` of the means, its standard error, and how far the case is beyond what is allowed (1:
    at the limit).
    """

    ours: np.ndarray
    reference: np.ndarray
    ratio: float
    error: float
    excess: float
    failures: list[str]


def judge(case: Case, integrator: str, ours: np.ndarray) -> Verdict:
    """ours: (K, height, width, 4)."""
    reference = load(case)
    if ours.shape[1:3] != reference.shape[1:3]:
        raise ValueError(
            f"{case.name} came out {ours.shape[1:3]} instead of {reference.shape[1:3]}"
        )
    channels = slice(0, 4) if case.alpha else slice(0, 3)
    ours, reference = ours[..., channels], reference[..., channels]
    if not np.isfinite(ours).all():
        count = int((~np.isfinite(ours)).sum())
        return Verdict(
            np.nan_to_num(ours).mean(0),
            reference.mean(0),
            np.nan,
            np.nan,
            np.inf,
            [f"{count} values are not finite"],
        )
    splat = integrator != "reference"
    blocks = Blocks.of(reference, independent_pixels=True)
    result = block_test(
        Blocks.of(ours, independent_pixels=not splat),
        blocks,
        relative={
            "splat": case.block_bias,
            "gather": case.block_bias / 2,
            "reference": case.reference_bias,
        }[integrator],
        absolute=DARK * abs(float(reference.mean())),
        family_level=FAMILY_LEVEL,
    )
    ratio, error = mean_ratio(ours, reference)
    tolerance = case.mean_tolerance if splat else case.mean_tolerance / 2
    if integrator == "splat":
        tolerance += case.photons_less
    failures = []
    if abs(ratio - 1) > tolerance:
        failures.append(f"mean is {ratio:.4f} +- {error:.4f} of Cycles'")
    if not result.passed and not (
        integrator == "splat" and case.name in SCENES and within_known_bias(result, blocks)
    ):
        failures.append(str(result))
    beyond = float(np.log(max(result.p_values.min(), 1e-300)) / np.log(result.level))
    excess = max(abs(ratio - 1) / tolerance, min(beyond, 50.0) if failures else min(beyond, 1.0))
    return Verdict(ours.mean(0), reference.mean(0), ratio, error, excess, failures)


def render(
    worker: Worker, case: Case, integrator: str, threads: int = 0, part: int = 1
) -> np.ndarray:
    """(K, height, width, 4): six splats, gathered or not, or two path-traced pictures. 0 threads:
    all of the machine's. part: splats have the passes of the case over this.
    """
    if integrator == "reference":
        settings: dict[str, Any] = {"passes": case.reference_passes}
        return worker.render(
            case, integrator, [11, 12], max_bounces=64, threads=threads, **settings
        )[0]
    gather = FinalGather.ON if integrator == "gather" else FinalGather.OFF
    settings = {
        "passes": case.passes // part,
        "photons_per_pass": case.photons_per_pass,
        "final_gather": gather,
    }
    return worker.render(
        case, "splat", list(range(6)), max_bounces=64, threads=threads, **settings
    )[0]
