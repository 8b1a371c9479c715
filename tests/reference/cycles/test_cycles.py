"""Photon Splat against Cycles on some cases of cases.py, by verdict.py's rules. `make oracle`
renders them all. Splats have half of their passes here, whose noise the verdict knows; `make
reference` renders them whole.
"""

from __future__ import annotations

from typing import Any
from zlib import crc32

import numpy as np
import pytest

from tests.reference.cycles.cases import CASE, CASES, SCENES, SPLAT_CASES, Case
from tests.reference.cycles.lamp_trees import LAMP_TREES
from tests.reference.cycles.passes import PASSES
from tests.reference.cycles.verdict import judge, render
from tests.reference.cycles.worker import Worker
from tests.support.compare import save_pictures
from tests.support.paths import ROOT

SHARE = 24
"""Of the cases that are no scenes of their own, about one of so many."""


def picked(integrator: str, cases: list[Case], share: int = SHARE) -> list[Case]:
    """By the name, so that a new case changes nothing for the others."""
    return [
        case
        for case in cases
        if case.name not in SCENES and crc32(f"{integrator} {case.name}".encode()) % share == 0
    ]


def named(cases: list[Case], *names: str) -> list[Case]:
    return [case for case in cases if case.name in names]


QUICK_SPLAT = [
    *named(SPLAT_CASES, "cornell_box", "interior", "light_types"),
    *picked("splat", SPLAT_CASES),
    *named(LAMP_TREES, "lamp_area_checker", "lamp_point_linear", "lamp_spot_ies"),
]
QUICK_GATHER = [
    *named(SPLAT_CASES, "cornell_box", "interior"),
    *picked("gather", SPLAT_CASES, 2 * SHARE),
]
QUICK_REFERENCE = [
    *named(CASES, "cornell_box", "interior", "instances"),
    *picked("ref", CASES),
    *named(PASSES, "pass_ambient_pane", "pass_aov_behind_pane", "pass_vector_displaced_shape"),
]

SLOW = {
    "interior",
    "light_types",
    "instances",
    "cornell_box_100k",
    "linked_lamps",
    "equirectangular",
    "grid_cloud_cubic",
    "grid_info",
}
"""Those that only `make reference` renders."""

FAILURES = ROOT / "out" / "failures"


def marked(cases: list[Case]) -> list[Any]:
    """Cases as parameters of a test."""
    return [
        pytest.param(case, id=case.name, marks=[pytest.mark.slow] if case.name in SLOW else [])
        for case in cases
    ]


def in_part(parameters: tuple[Any, ...], name: str, slow: bool) -> list[Any]:
    """A picture by photons with half of the passes, and with all of them for `make reference`."""
    whole = pytest.param(*parameters, 1, id=f"{name}-whole", marks=[pytest.mark.slow])
    return [whole] if slow else [pytest.param(*parameters, 2, id=name), whole]


def splats(cases: list[Case], slow: set[str] = SLOW) -> list[Any]:
    return [part for case in cases for part in in_part((case,), case.name, case.name in slow)]


def compare(case: Case, integrator: str, ours: np.ndarray) -> None:
    verdict = judge(case, integrator, ours)
    if verdict.failures:
        save_pictures(FAILURES, f"{case.name}.{integrator}", verdict.ours, verdict.reference)
        said = "; ".join(verdict.failures)
        pytest.fail(
            f"{case.name}, {integrator}: {said}. Pictures: "
            f"out/failures/{case.name}.{integrator}.*.png"
        )


@pytest.mark.parametrize(("case", "part"), splats(QUICK_SPLAT))
def test_splat(worker: Worker, case: Case, part: int) -> None:
    compare(case, "splat", render(worker, case, "splat", part=part))


@pytest.mark.parametrize(("case", "part"), splats(QUICK_GATHER, SLOW | {"cornell_box"}))
def test_final_gathering(worker: Worker, case: Case, part: int) -> None:
    compare(case, "gather", render(worker, case, "gather", part=part))


@pytest.mark.parametrize("case", marked(QUICK_REFERENCE))
def test_reference_integrator(worker: Worker, case: Case) -> None:
    compare(case, "reference", render(worker, case, "reference"))


def test_the_comparison_can_fail(worker: Worker) -> None:
    """A lamp 3 % too strong, a picture shifted by a pixel, and a block a tenth too dark must not
    pass, with half of the passes neither.
    """
    case = CASE["area_square"]
    reference, _ = worker.render(case, "reference", [11, 12], passes=128, max_bounces=64)
    splat = render(worker, case, "splat", part=2)
    for integrator, pictures in (("reference", reference), ("splat", splat)):
        compare(case, integrator, pictures)
        stained = pictures.copy()
        stained[:, 24:32, 24:32] *= 0.9
        for broken in (pictures * 1.03, np.roll(pictures, 1, axis=2), stained):
            with pytest.raises(pytest.fail.Exception):
                compare(case, integrator, broken)


def test_statistics_say_what_was_done(worker: Worker) -> None:
    _, statistics = worker.render(
        CASE["cornell_box"], "splat", [0], passes=2, photons_per_pass=5000
    )
    said: dict[str, Any] = statistics[0]
    assert {"export", "acceleration", "camera", "photons", "splat", "boundary", "total"} <= said[
        "seconds"
    ].keys()
    assert said["photons"]["traced"] >= 10_000
    assert said["passes"] == 2
    assert said["peak_memory_bytes"] > 1e6
    assert said["warnings"] == []
