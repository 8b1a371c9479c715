"""The splat against our own path tracer: same scene, same shading, so that only the estimator can
differ.

Where the splat is biased, and why:
- blocks where things stand on or lean against a surface: the disc reaches under them, where no
photon can land, and the
  kernel mass does not know it (darker there, by 10 % of the indirect light at worst);
- corners and contact shadows of indirect light narrower than the disc: blurred (both signs, no
loss);
- folds and narrow bevels: few photons within the disc, so rare bright pixels (noise with a heavy
tail, no bias).
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from tests.reference.cycles.cases import CASE, SCENES, Case
from tests.reference.cycles.test_cycles import FAILURES
from tests.reference.cycles.verdict import DARK
from tests.reference.cycles.worker import Worker
from tests.support.compare import Blocks, block_test, mean_ratio, save_pictures, within_known_bias
from tests.support.paths import ROOT

SHARED = Path(os.environ.get("PHOTON_SPLAT_SCENES", ROOT.parent / "shared" / "scenes"))
CORNELL_ORIGINAL = (0.1972, 0.1277, 0.0364)
"""Mean R, G, B of the whole picture, linear, on which three other renderers agree."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cornell_box_100k", "interior", "instances"])
def test_splat_agrees_with_the_path_tracer(worker: Worker, name: str) -> None:
    case = CASE[name]
    splat, _ = worker.render(
        case,
        "splat",
        list(range(6)),
        passes=case.passes,
        photons_per_pass=case.photons_per_pass,
        max_bounces=64,
    )
    reference, _ = worker.render(case, "reference", [21, 22], passes=200, max_bounces=64)
    splat, reference = splat[..., :3], reference[..., :3]
    ratio, error = mean_ratio(splat, reference)
    result = block_test(
        Blocks.of(splat, independent_pixels=False),
        Blocks.of(reference, independent_pixels=True),
        relative=case.block_bias,
        absolute=DARK * float(reference.mean()),
        family_level=0.01 / len(SCENES),
    )
    known = within_known_bias(result, Blocks.of(reference, independent_pixels=True))
    if abs(ratio - 1) > 0.01 or not (result.passed or known):
        save_pictures(FAILURES, f"{name}.integrators", splat.mean(0), reference.mean(0))
        pytest.fail(
            f"{name}: mean {ratio:.4f} +- {error:.4f} of the path tracer's; {result}. Pictures: "
            f"out/failures/{name}.integrators.*.png"
        )


@pytest.mark.parametrize("integrator", ["splat", "reference"])
def test_cornell_original_has_its_known_mean(worker: Worker, integrator: str) -> None:
    path = SHARED / "cornell-original.blend"
    if not path.is_file():
        pytest.skip(f"{path} is not there (set PHOTON_SPLAT_SCENES to the folder that holds it)")
    case = Case("cornell_original", "open_file", {"path": str(path)}, 128, 128)
    passes = 32 if integrator == "reference" else 8
    pictures, _ = worker.render(
        case, integrator, [1, 2], passes=passes, photons_per_pass=50_000, max_bounces=64
    )
    assert pictures[..., :3].mean((0, 1, 2)) == pytest.approx(np.array(CORNELL_ORIGINAL), rel=0.01)
