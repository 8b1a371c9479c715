"""Pictures with each instruction set forced, and what is said of one that there is not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest

from tests.support.paths import ROOT

RunPython = Callable[..., CompletedProcess[str]]

RENDER = """
import sys
import numpy as np
sys.path.insert(0, {root!r})
from tests.robustness.test_degenerate import room
from tests.support import corescene as c
picture = c.shoot(room(), passes=2, photons_per_pass=5000, threads=2)
np.save({output!r}, picture.passes["Combined"])
"""
ROUNDING = 1e-5
"""Photons are added in another order by vectors of another width, and with fused products."""


def render(run_python: RunPython, output: Path, level: str) -> np.ndarray:
    code = RENDER.format(root=str(ROOT), output=str(output))
    process = run_python(code, PHOTON_SPLAT_SIMD=level)
    assert process.returncode == 0, process.stderr
    return np.load(output)


@pytest.fixture(scope="session")
def plain() -> dict[str, np.ndarray]:
    return {}


@pytest.mark.parametrize("level", ["", "avx512", "avx2", "sse42"])
def test_every_level_gives_the_picture_within_rounding(
    run_python: RunPython, tmp_path: Path, plain: dict[str, np.ndarray], level: str
) -> None:
    if not plain:
        plain["generic"] = render(run_python, tmp_path / "generic.npy", "generic")
    expected, found = plain["generic"], render(run_python, tmp_path / "level.npy", level)
    assert expected[..., :3].mean() > 0.01
    assert np.abs(found - expected).max() <= ROUNDING * expected.max()


def test_an_unknown_level_is_named(run_python: RunPython, tmp_path: Path) -> None:
    code = RENDER.format(root=str(ROOT), output=str(tmp_path / "none.npy"))
    process = run_python(code, PHOTON_SPLAT_SIMD="sse9")
    assert process.returncode != 0
    assert process.stderr.strip().endswith(
        "The environment variable PHOTON_SPLAT_SIMD must be avx512, avx2, sse42 or generic, and is "
        "'sse9'."
    )
