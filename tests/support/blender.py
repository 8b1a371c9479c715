"""Tests that run inside Blender: a process of its own does them one after the other, so that a
crash costs one test only.

A test function that is marked with `in_blender` is called in that process, on an empty scene with
the engine registered. Its arguments are what JSON carries: parameters, and paths as strings.
"""

from __future__ import annotations

import functools
import importlib
import inspect
import json
import os
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.support.hang import killed_if_hung
from tests.support.paths import ROOT, environment


class Blender:
    """The parent's side: starts the process when it is needed, and again after a crash."""

    def __init__(self, scratch: Path) -> None:
        self.scratch = scratch
        self.process: subprocess.Popen[str] | None = None

    def call(self, check: Callable[..., None], arguments: dict[str, Any]) -> None:
        """Calls `check` over there. The test fails if it raises, ends the process, or hangs."""
        if self.process is None or self.process.poll() is not None:
            self._start()
        process = self.process
        assert process is not None
        assert process.stdin is not None
        assert process.stdout is not None
        request = {
            "module": check.__module__,
            "file": inspect.getfile(check),
            "name": check.__name__,
            "arguments": arguments,
        }
        process.stdin.write(json.dumps(request) + "\n")
        process.stdin.flush()
        with killed_if_hung(process):
            answer = process.stdout.readline()
        if not answer:
            pytest.fail(f"Blender ended with status {process.wait()}", pytrace=False)
        error = json.loads(answer)
        if error:
            pytest.fail(f"in Blender:\n{error}", pytrace=False)

    def _start(self) -> None:
        command = [sys.executable, "-m", "tests.support.blender"]
        self.process = subprocess.Popen(
            command,
            cwd=ROOT,
            env=environment(tempfile.mkdtemp(dir=self.scratch)),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def stop(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.wait()


def in_blender(check: Callable[..., None]) -> Callable[..., None]:
    """The test runs in the process of the fixture `blender`."""

    @functools.wraps(check)
    def run(blender: Blender, **arguments: Any) -> None:
        blender.call(
            check,
            {
                name: str(value) if isinstance(value, Path) else value
                for name, value in arguments.items()
            },
        )

    own = [inspect.Parameter("blender", inspect.Parameter.POSITIONAL_OR_KEYWORD)]
    run.__signature__ = inspect.Signature([*own, *inspect.signature(check).parameters.values()])  # type: ignore[attr-defined]
    return run


def _serve() -> None:
    """Answers every request with one line: null, or what went wrong. What Blender prints goes to
    stderr.
    """
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    import bpy
    import photon_splat
    from photon_splat.blender import job

    photon_splat.register()
    for line in sys.stdin:
        request = json.loads(line)
        error = None
        job.observer.__init__()  # type: ignore[misc]
        try:
            bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
            bpy.context.scene.render.engine = "PHOTON_SPLAT"
            name = ".".join(Path(request["file"]).relative_to(ROOT).with_suffix("").parts)
            called = getattr(importlib.import_module(name), request["name"])
            getattr(called, "__wrapped__", called)(**request["arguments"])
        except BaseException:
            error = traceback.format_exc()
        answers.write(json.dumps(error) + "\n")


if __name__ == "__main__":
    _serve()
