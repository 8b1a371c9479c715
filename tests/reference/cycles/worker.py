"""A Blender process that renders cases with Photon Splat on request, so that a crash takes only its
own test along.

Reads one JSON object per line from stdin: case (fields of Case), integrator, seeds, output, and
overrides of RenderSettings. Writes the pictures (seeds, height, width, 4) to `output` (.npy) and
answers with one JSON line: {"ok": true, "statistics": [...]} or {"ok": false, "error": "..."}. What
Blender prints goes to stderr.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from tests.reference.cycles.cases import Case
from tests.support.hang import killed_if_hung
from tests.support.paths import ROOT, environment


class Worker:
    """The parent's side: starts the process when it is needed and again after a crash."""

    def __init__(self, scratch: Path) -> None:
        self.scratch = scratch
        self.process: subprocess.Popen[str] | None = None
        self.done: dict[str, tuple[np.ndarray, list[dict[str, Any]]]] = {}

    def render(
        self, case: Case, integrator: str, seeds: list[int], **settings: Any
    ) -> tuple[np.ndarray, list[dict[str, Any]]]:
        """(K, height, width, 4) pictures, one per seed, and their statistics. RuntimeError if the
        process fails or hangs.

        The same request a second time gets the same answer without rendering again.
        """
        key = json.dumps([case.name, integrator, seeds, settings])
        if key not in self.done:
            self.done[key] = self._render(case, integrator, seeds, settings)
        return self.done[key]

    def _render(
        self, case: Case, integrator: str, seeds: list[int], settings: dict[str, Any]
    ) -> tuple[np.ndarray, list[dict[str, Any]]]:
        if self.process is None or self.process.poll() is not None:
            self._start()
        process = self.process
        assert process is not None
        assert process.stdin is not None
        assert process.stdout is not None
        output = self.scratch / f"{case.name}.{integrator}.npy"
        request = {
            "case": asdict(case),
            "integrator": integrator,
            "seeds": seeds,
            "output": str(output),
            "settings": settings,
        }
        process.stdin.write(json.dumps(request) + "\n")
        process.stdin.flush()
        with killed_if_hung(process):
            answer = process.stdout.readline()
        if not answer:
            raise RuntimeError(
                f"Blender ended with status {process.wait()} while it rendered {case.name}"
            )
        said = json.loads(answer)
        if not said["ok"]:
            raise RuntimeError(said["error"])
        return np.load(output).astype(np.float64), said["statistics"]

    def _start(self) -> None:
        command = [sys.executable, "-m", "tests.reference.cycles.worker"]
        self.process = subprocess.Popen(
            command,
            cwd=ROOT,
            env=environment(self.scratch / "blender"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def stop(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.wait()


def _serve() -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # Blender prints to stdout
    import photon_splat

    photon_splat.register()
    for line in sys.stdin:
        try:
            answer = {"ok": True, "statistics": _render(**json.loads(line))}
        except Exception as error:
            answer = {"ok": False, "error": f"{type(error).__name__}: {error}"}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def _render(
    case: dict[str, Any], integrator: str, seeds: list[int], output: str, settings: dict[str, Any]
) -> list[dict[str, Any]]:
    """Through Blender's render operator, as a user would: export, engine and settings are the real
    ones.
    """
    import bpy
    from photon_splat.blender.job import observer
    from photon_splat.core.render.settings import Integrator

    from tests.reference.cycles.stages import stage

    scene = stage.build(Case(**case))
    scene.render.engine = "PHOTON_SPLAT"
    pictures, statistics, errors = [], [], []

    def keep(result: Any, _: Any) -> None:
        pictures.append(result.passes[case["render_pass"] or "Combined"])
        statistics.append(result.statistics)

    observer.on_result, observer.on_error = keep, errors.append
    for seed in seeds:
        observer.settings = lambda plain, seed=seed: replace(
            plain,
            integrator=Integrator(integrator),
            seed=seed,
            **{"error_threshold": 0.0, "denoise": False} | settings,
        )
        bpy.ops.render.render()
    if errors:
        raise errors[0]
    np.save(output, np.stack(pictures))
    return statistics


if __name__ == "__main__":
    _serve()
