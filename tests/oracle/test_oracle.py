"""Photon Splat against Cycles on the cases of cases.py: the whole picture's mean, and every 8x8 block by z-test.

Both integrators are held to it. The path tracer must agree within `reference_bias` (shading normals and float texture
lookups differ a little between any two renderers); the splat may show its kernel's bias, `block_bias`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.compare import Blocks, block_test, mean_ratio, save_pictures, within_known_bias
from tests.oracle.cases import CASE, CASES, NAMES, SCENES, SPLAT_CASES, Case
from tests.oracle.references import load
from tests.oracle.worker import Worker

FAILURES = Path(__file__).resolve().parents[2] / "out" / "failures"
FAMILY_LEVEL = 0.01 / len(CASES)
"""Chance that a picture of equal expectation fails; over the whole table one per cent."""
DARK = 0.002
"""Deviation allowed to a block beside the relative one, in units of the picture's mean."""


def compare(case: Case, integrator: str, ours: np.ndarray) -> None:
    reference = load(case)
    assert ours.shape[1:] == reference.shape[1:], f"{case.name} came out {ours.shape[1:]} instead of {reference.shape[1:]}"
    assert np.isfinite(ours).all()
    channels = slice(0, 4) if case.alpha else slice(0, 3)
    ours, reference = ours[..., channels], reference[..., channels]
    splat = integrator == "splat"
    bias = case.block_bias if splat else case.reference_bias
    mean = float(reference.mean())
    result = block_test(
        Blocks.of(ours, independent_pixels=not splat),
        Blocks.of(reference, independent_pixels=True),
        relative=bias,
        absolute=DARK * mean,
        family_level=FAMILY_LEVEL,
    )
    ratio, error = mean_ratio(ours, reference)
    tolerance = case.mean_tolerance if splat else case.mean_tolerance / 2
    failed = []
    if abs(ratio - 1) > tolerance:
        failed.append(f"mean is {ratio:.4f} +- {error:.4f} of Cycles'")
    if not result.passed and not (
        splat and case.name in SCENES and within_known_bias(result, Blocks.of(reference, independent_pixels=True))
    ):
        failed.append(str(result))
    if failed:
        save_pictures(FAILURES, f"{case.name}.{integrator}", ours.mean(0), reference.mean(0))
        pytest.fail(f"{case.name}, {integrator}: {'; '.join(failed)}. Pictures: out/failures/{case.name}.{integrator}.*.png")


@pytest.mark.parametrize("case", SPLAT_CASES, ids=lambda case: case.name)
def test_splat(worker: Worker, case: Case) -> None:
    pictures, _ = worker.render(case, "splat", list(range(6)), passes=case.passes, photons_per_pass=case.photons_per_pass, max_bounces=64)
    compare(case, "splat", pictures)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_reference_integrator(worker: Worker, case: Case) -> None:
    passes = 96 if case.name in SCENES else 256
    pictures, _ = worker.render(case, "reference", [11, 12], passes=passes, max_bounces=64)
    compare(case, "reference", pictures)


def test_the_comparison_can_fail(worker: Worker) -> None:
    """A lamp 3 % too strong, and a picture shifted by a pixel, must not pass."""
    case = CASE["area_square"]
    pictures, _ = worker.render(case, "reference", [11, 12], passes=128, max_bounces=64)
    compare(case, "reference", pictures)
    for broken in (pictures * 1.03, np.roll(pictures, 1, axis=2)):
        with pytest.raises(pytest.fail.Exception):
            compare(case, "reference", broken)


def test_statistics_say_what_was_done(worker: Worker) -> None:
    _, statistics = worker.render(CASE["cornell_box"], "splat", [0], passes=2, photons_per_pass=5000)
    said: dict[str, Any] = statistics[0]
    assert {"export", "acceleration", "camera", "photons", "splat", "boundary", "total"} <= said["seconds"].keys()
    assert said["photons"]["traced"] >= 10_000
    assert said["passes"] == 2
    assert said["peak_memory_bytes"] > 1e6
    assert said["warnings"] == []
