"""A telling part of the gallery, one case per family, the integrators in turn. `make oracle`
renders it whole, by both.
"""

from __future__ import annotations

import pytest

from tests.reference.cycles.gallery import BY_NAME, GALLERY
from tests.reference.cycles.references import FOLDER
from tests.reference.cycles.report import TELLING
from tests.reference.cycles.test_cycles import compare, in_part
from tests.reference.cycles.verdict import INTEGRATORS, render
from tests.reference.cycles.worker import Worker

QUICK = {
    "diffuse_1",
    "glossy_ggx_0.3",
    "glass_multi_0.4",
    "glass_sharp_ior_1.5",
    "sheet_alpha_image",
    "principled_roughness_0.25",
}
"""The others only `make reference` renders."""


@pytest.mark.parametrize(
    ("name", "integrator", "part"),
    [
        part
        for k, name in enumerate(TELLING)
        for part in in_part(
            (name, INTEGRATORS[k % 2]), f"{name}-{INTEGRATORS[k % 2]}", name not in QUICK
        )
    ],
)
def test_material(worker: Worker, name: str, integrator: str, part: int) -> None:
    case = BY_NAME[name]
    compare(case, integrator, render(worker, case, integrator, part=part))


def test_every_case_has_its_reference() -> None:
    missing = [case.name for case in GALLERY if not (FOLDER / f"{case.name}.npz").is_file()]
    assert not missing, f"no Cycles reference of {', '.join(missing)}: run `make references`"
    assert len(BY_NAME) >= 150
