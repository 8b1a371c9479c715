"""The extension for Windows with one Python under Wine, and the same Blender in this system."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import time
import zipfile
from pathlib import Path
from typing import Any

from wine import ROOT, Wine

SECONDS = 3000.0


class Trial:
    """One Python under Wine with the archive.

    out: folder of what is left. product: what the archive holds, as importable modules. linux: the
    Python of this system that has the same Blender.
    """

    def __init__(
        self, wine: Wine, archive: Path, out: Path, linux: str, failures: list[str]
    ) -> None:
        self.wine, self.out, self.linux, self.failures = wine, out, linux, failures
        self.product = out / "product"
        out.mkdir(parents=True)
        self.archive = Path(shutil.copy(archive, out))
        unpack(self.archive, self.product, wine.version)

    def run(
        self, name: str, *arguments: str, path: list[Path], program: Path | None = None
    ) -> float | None:
        """Seconds that Python under Wine took; None if it failed, which is said."""
        began = time.monotonic()
        status = self.wine.python(
            *arguments, path=path, seconds=SECONDS, log=self.log(name), program=program
        )
        seconds = time.monotonic() - began
        print(f"== {name}, Python {self.wine.version}: {seconds:.0f} s", flush=True)
        if status == 0:
            return seconds
        what = "was still running" if status is None else f"ended with status {status}"
        self.fail(f"{name}: Python under Wine {what} after {seconds:.0f} s; see {self.log(name)}")
        return None

    def run_linux(self, script: str, argument: str) -> None:
        """The same script in this system's Python."""
        with tempfile.TemporaryDirectory() as user:
            environment = os.environ | {"BLENDER_USER_RESOURCES": user}
            subprocess.run(
                [self.linux, script, argument],
                cwd=ROOT,
                env=environment,
                check=True,
                capture_output=True,
                timeout=SECONDS,
            )

    def log(self, name: str) -> Path:
        return self.out / f"{name.replace(' ', '_')}.log"

    def answer(self, name: str) -> dict[str, Any]:
        """The JSON object that the program of that step printed."""
        lines = self.log(name).read_text(errors="replace").splitlines()
        found = next(line for line in reversed(lines) if line.startswith("{"))
        return dict(json.loads(found))

    def fail(self, what: str) -> None:
        self.failures.append(f"Python {self.wine.version}: {what}")


def unpack(archive: Path, product: Path, version: str) -> None:
    with zipfile.ZipFile(archive) as file:
        file.extractall(product / "photon_splat")
    tag = f"cp{version.replace('.', '')}"
    wheels = sorted((product / "photon_splat/wheels").glob("photon_splat_native-*.whl"))
    wheel = next(wheel for wheel in wheels if f"-{tag}-" in wheel.name or "-abi3-" in wheel.name)
    with zipfile.ZipFile(wheel) as file:
        file.extractall(product)
