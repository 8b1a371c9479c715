"""Renders for the charts, each in a process of its own, kept in build/chart by what they depend on:
a run goes on where one stopped.
"""

from __future__ import annotations

import hashlib
import pickle
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.benchmarks.chart.plan import LONG, RIVALS, Case, Method
from tests.benchmarks.chart.rivals import driver
from tests.support.paths import ROOT

MOST_BY_DEFAULT = 300.0
"""Seconds that a render without a limit is expected to take; it gets ten times as long."""
CACHE = ROOT / "build" / "chart"
Array = np.ndarray


@dataclass(frozen=True)
class Shot:
    """picture: (height, width, 3) float32."""

    picture: Array
    seconds: float


def version(method: str) -> str:
    """Of the engine that makes the picture: Blender's, or the native module's and the add-on's
    contents.
    """
    import bpy

    if not method.startswith(("Photon", "reference-photons")):
        return bpy.app.version_string
    from photon_splat.core.native.library import load

    digest = hashlib.sha256(Path(load().__file__ or "").read_bytes())
    for path in sorted((ROOT / "addon").rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def path_of(case: Case, method: Method | str, seconds: float, seed: int) -> Path:
    """Where the cache has the render, or will have it."""
    if method in RIVALS:
        made_by, asked = (
            driver.version(str(method)),
            pickle.dumps(driver.description(case, str(method))),
        )
    else:
        made_by, asked = version(str(method)), case.blend.read_bytes()
    scene = hashlib.sha256(asked).hexdigest()
    what = f"{method}|{made_by}|{scene}|{case.width}x{case.height}|{seconds:g}|{seed}"
    return CACHE / f"{case.scene}_{hashlib.sha256(what.encode()).hexdigest()[:20]}.npz"


def shot(case: Case, method: Method | str, seconds: float, seed: int) -> Shot:
    """The render, from the cache if it has been made. RuntimeError if the process failed."""
    path = path_of(case, method, seconds, seed)
    if not path.exists():
        _render(str(method), case, seconds, seed, path)
    with np.load(path) as data:
        return Shot(data["picture"], float(data["seconds"]))


def _render(method: str, case: Case, seconds: float, seed: int, path: Path) -> None:
    CACHE.mkdir(parents=True, exist_ok=True)
    print(f"   {case.scene}: {method}, {seconds:g} s, seed {seed}", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(prefix="photon_splat_chart_") as scratch:
        output = Path(scratch, "shot.npz")
        if method in RIVALS:
            said = driver.render(case, method, seconds, seed, output)
        else:
            size = (str(case.width), str(case.height))
            shot_of = [
                sys.executable,
                "-m",
                "tests.benchmarks.chart.shot",
                method,
                str(case.blend),
                *size,
                str(seconds),
                str(seed),
                str(output),
            ]
            if seconds >= LONG:
                shot_of.append(str(path.with_suffix("")))
            said = driver.run(shot_of, seconds or MOST_BY_DEFAULT)
        if not output.exists():
            raise RuntimeError(f"{case.scene} by {method}: {said[-2000:]}")
        path.write_bytes(output.read_bytes())


def reference(case: Case) -> tuple[Array, Array]:
    """Two independent halves, (height, width, 3) float64."""
    halves = [
        shot(case, f"reference-{case.reference}", case.reference_seconds, seed).picture.astype(
            np.float64
        )
        for seed in (901, 902)
    ]
    return halves[0], halves[1]
