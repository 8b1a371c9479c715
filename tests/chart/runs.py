"""Renders for the charts, each in a process of its own, kept in build/chart by what they depend on: a run goes on where one stopped."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.chart.plan import Case, Method

ROOT = Path(__file__).resolve().parents[2]
CACHE = ROOT / "build" / "chart"
Array = np.ndarray


@dataclass(frozen=True)
class Shot:
    """picture: (height, width, 3) float32."""

    picture: Array
    seconds: float


def version(method: str) -> str:
    """Of the engine that makes the picture: Blender's, or the native module's and the add-on's contents."""
    import bpy

    if not method.startswith(("Photon", "truth-photons")):
        return bpy.app.version_string
    import photon_splat_native

    digest = hashlib.sha256(Path(photon_splat_native.__file__).read_bytes())
    for path in sorted((ROOT / "addon" / "core").glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def shot(case: Case, method: Method | str, seconds: float, seed: int) -> Shot:
    """The render, from the cache if it has been made. RuntimeError if the process failed."""
    blend = ROOT / "blend_scenes" / f"{case.scene}.blend"
    what = f"{method}|{version(str(method))}|{hashlib.sha256(blend.read_bytes()).hexdigest()}|{case.width}x{case.height}|{seconds:g}|{seed}"
    path = CACHE / f"{case.scene}_{hashlib.sha256(what.encode()).hexdigest()[:20]}.npz"
    if not path.exists():
        _render(method, case, blend, seconds, seed, path)
    with np.load(path) as data:
        return Shot(data["picture"], float(data["seconds"]))


def _render(method: str, case: Case, blend: Path, seconds: float, seed: int, path: Path) -> None:
    CACHE.mkdir(parents=True, exist_ok=True)
    print(f"   {case.scene}: {method}, {seconds:g} s, seed {seed}", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(prefix="photon_splat_chart_") as scratch:
        output = Path(scratch, "shot.npz")
        command = [sys.executable, "-m", "tests.chart.shot", method, str(blend), str(case.width), str(case.height), str(seconds), str(seed)]
        environment = os.environ | {"BLENDER_USER_RESOURCES": str(Path(scratch, "blender"))}
        done = subprocess.run(
            [*command, str(output)],
            cwd=ROOT,
            env=environment,
            timeout=10 * seconds + 300,
            check=False,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        if not output.exists():
            raise RuntimeError(f"{case.scene} by {method}: status {done.returncode}\n{done.stdout[-2000:]}")
        path.write_bytes(output.read_bytes())


def truth(case: Case) -> tuple[Array, Array]:
    """Two independent halves, (height, width, 3) float64."""
    halves = [shot(case, f"truth-{case.truth}", case.truth_seconds, seed).picture.astype(np.float64) for seed in (901, 902)]
    return halves[0], halves[1]
