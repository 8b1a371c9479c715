"""Tests the extension for Windows under Wine: wine_test.py ARCHIVE.

The module and the add-on of the archive are run by Python 3.13 with Blender 5.2 for Windows (see
wine.py): closed forms, robustness, some cases against Cycles, an install into a clean Blender, and
pictures beside this system's. Where Wine cannot be had the test is skipped and says so. What the
programs wrote, pictures and figures are left in out/wine.
"""

from __future__ import annotations

import functools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from windows_python import Unavailable as NoPython
from wine import BARE, CACHE, ROOT, SITE, Unavailable, Wine, inside

sys.path.insert(0, str(ROOT))
from tests.integration.windows.pictures import DENOISED, SCENES
from tools.run_tests import CHILD

OUT = ROOT / "out" / "wine"
PRODUCT = CACHE / "product"
"""What the archive holds, as importable modules."""
SECONDS = 3000.0
FOLDERS = {
    "closed forms": ["tests/reference/closed_form", "-m", "not slow"],
    "robustness": ["tests/robustness", "-m", "not slow"],
    "Cycles": ["tests/reference/cycles/test_cycles.py", "-m", "not slow"],
}
ROUNDING, DENOISED_ROUNDING = 1e-3, 1e-2
"""Most that a value of a picture may differ between the systems, relative to the larger of it and
the picture's mean: paths may part where rounding decides on which side of an edge a ray goes, in
one pixel of many.
"""
APART = 0.02
"""Share of pixels that may differ by more, for such paths."""
SPEED = 1.2
"""Most that our time over Cycles' may differ between the systems, as a factor."""


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        wine = Wine()
    except (Unavailable, NoPython) as reason:
        print(f"SKIPPED: the extension for Windows is not tested under Wine: {reason}")
        return 0
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    unpack(Path(sys.argv[1]))
    archive = Path(shutil.copy(sys.argv[1], OUT))
    result: dict[str, Any] = {}
    failures: list[str] = []
    steps: dict[str, Callable[[], dict[str, Any]]] = {
        "install": lambda: install(wine, archive, failures),
        "files": lambda: files(wine, failures),
        "pictures": lambda: pictures(wine, failures),
        "speed": lambda: speed(wine, failures),
    }
    for name, options in FOLDERS.items():
        steps[name] = functools.partial(tests, wine, name, options, failures)
    for name, step in steps.items():
        result[name] = step()
        print(json.dumps({name: result[name]}, indent=1), flush=True)
    (OUT / "result.json").write_text(json.dumps(result, indent=1))
    for failure in failures:
        print(f"FAILED {failure}", file=sys.stderr)
    return 1 if failures else 0


def unpack(archive: Path) -> None:
    shutil.rmtree(PRODUCT, ignore_errors=True)
    with zipfile.ZipFile(archive) as file:
        file.extractall(PRODUCT / "photon_splat")
    (wheel,) = (PRODUCT / "photon_splat/wheels").glob("photon_splat_native-*-abi3-win_amd64.whl")
    with zipfile.ZipFile(wheel) as file:
        file.extractall(PRODUCT)


def run(
    wine: Wine, name: str, *arguments: str, path: list[Path], failures: list[str]
) -> float | None:
    """Seconds that Python under Wine took; None if it failed, which is said."""
    began = time.monotonic()
    log = OUT / f"{name.replace(' ', '_')}.log"
    status = wine.python(*arguments, path=path, seconds=SECONDS, log=log)
    seconds = time.monotonic() - began
    print(f"== {name}: {seconds:.0f} s", flush=True)
    if status == 0:
        return seconds
    what = "was still running" if status is None else f"ended with status {status}"
    failures.append(f"{name}: Python under Wine {what} after {seconds:.0f} s; see {log}")
    return None


def tests(wine: Wine, name: str, options: list[str], failures: list[str]) -> dict[str, Any]:
    status, current = inside(OUT / "status"), inside(OUT / "current")
    arguments = ["-c", CHILD, status, current, *options, "-p", "no:cacheprovider", "-q"]
    seconds = run(wine, name, *arguments, path=[PRODUCT, SITE, ROOT], failures=failures)
    last = (OUT / f"{name.replace(' ', '_')}.log").read_text(errors="replace").splitlines()
    counts = {
        what: int(number)
        for number, what in re.findall(r"(\d+) (passed|failed|skipped|error)", last[-1])
    }
    if not counts.get("passed"):
        failures.append(f"{name}: no test passed")
    return counts | {"seconds": seconds}


def install(wine: Wine, archive: Path, failures: list[str]) -> dict[str, Any]:
    """What tests/integration/extension/install.py found."""
    folder = OUT / "installed"
    folder.mkdir()
    script = ["-S", "tests/integration/extension/install.py", inside(archive), inside(folder)]
    code = (
        "import os, sys, runpy; sys.argv = sys.argv[1:]; os.environ['BLENDER_USER_RESOURCES'] = "
        "sys.argv[2] + '/blender'; runpy.run_path(sys.argv[0], run_name='__main__')"
    )
    arguments = ["-S", "-c", code, *script[1:]]
    seconds = run(wine, "install", *arguments, path=[BARE], failures=failures)
    if seconds is None:
        return {}
    lines = (OUT / "install.log").read_text(errors="replace").splitlines()
    found = json.loads(next(line for line in reversed(lines) if line.startswith("{")))
    first, second = (np.load(folder / f"{name}.npy") for name in ("first", "second"))
    for what, right in {
        "it was not installed": found["installed"] == ["FINISHED"],
        "it registers no engine": "RenderEngine PhotonSplatEngine" in found["enabled"],
        "it leaves traces": found["before"] == found["disabled"] == found["disabled again"] == [],
        "its module came from elsewhere": "\\.local\\" in found["native"].replace("/", "\\"),
        "its moderngl came from elsewhere": "\\.local\\" in found["moderngl"].replace("/", "\\"),
        "its picture is black": first.mean() > 0.05,
        "its second picture differs": np.array_equal(first, second),
    }.items():
        if not right:
            failures.append(f"install: {what}")
    return {"seconds": seconds}


def files(wine: Wine, failures: list[str]) -> dict[str, Any]:
    """What tests/integration/windows/files.py found."""
    folder = OUT / "files"
    folder.mkdir()
    script = "tests/integration/windows/files.py"
    arguments = [script, inside(folder)]
    seconds = run(wine, "files", *arguments, path=[PRODUCT, SITE], failures=failures)
    if seconds is None:
        return {}
    found = json.loads((folder / "files.json").read_text(encoding="utf-8"))
    for what, right in {
        "a name that is not ASCII": found["not ASCII"]["status"] == 0
        and "Bild ß 絵.exr" in found["not ASCII"]["files"],
        "a long path": found["long"]["files"] == ["out.exr"],
        "a file that is open": found["open"]["status"] == 1
        and found["open"]["kept"]
        and found["open"]["files"] == ["out.1.exr", "out.exr"]
        and "; the new file is " in found["open"]["said"][0],
    }.items():
        if not right:
            failures.append(f"files: {what} was not handled: {json.dumps(found)}")
    return {"seconds": seconds}


def pictures(wine: Wine, failures: list[str]) -> dict[str, Any]:
    """By scene: share of pixels that are the same bits in both systems, the largest relative
    difference, and the share of pixels that differ by more than rounding.
    """
    script = "tests/integration/windows/pictures.py"
    for system in ("windows", "linux"):
        (OUT / system).mkdir()
    seconds = run(
        wine, "pictures", script, inside(OUT / "windows"), path=[PRODUCT, SITE], failures=failures
    )
    linux(script, str(OUT / "linux"))
    if seconds is None:
        return {}
    found: dict[str, Any] = {"seconds": seconds}
    for name in (*SCENES, DENOISED):
        ours, theirs = (combined(OUT / system / f"{name}.exr") for system in ("linux", "windows"))
        difference = np.abs(ours - theirs).max(-1)
        scale = np.maximum(np.maximum(ours, theirs).max(-1), ours.mean())
        relative = difference / scale
        most = DENOISED_ROUNDING if name == DENOISED else ROUNDING
        found[name] = {
            "identical": float((ours == theirs).all(-1).mean()),
            "largest difference": float(difference.max()),
            "largest relative difference": float(relative.max()),
            "apart": float((relative > most).mean()),
        }
        if found[name]["apart"] > APART:
            failures.append(f"{name}: {found[name]['apart']:.1%} of its pixels differ from Linux'")
    return found


def combined(path: Path) -> np.ndarray:
    """(height, width, 3) of the Combined pass."""
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(str(path))
    pixels = np.asarray(file.read_image(0, 0, 0, 3, oiio.FLOAT), np.float64)
    file.close()
    return pixels.reshape(file.spec().height, file.spec().width, 3)


def speed(wine: Wine, failures: list[str]) -> dict[str, Any]:
    """Our processor time over Cycles' for the Cornell box, in both systems."""
    script = "tests/integration/windows/speed.py"
    output = OUT / "speed_windows.json"
    seconds = run(wine, "speed", script, inside(output), path=[PRODUCT, SITE], failures=failures)
    linux(script, str(OUT / "speed_linux.json"))
    if seconds is None:
        return {}
    found: dict[str, Any] = {"seconds": seconds}
    for system in ("windows", "linux"):
        taken = json.loads((OUT / f"speed_{system}.json").read_text())
        found[system] = taken | {"ours over Cycles'": taken["PHOTON_SPLAT"] / taken["CYCLES"]}
    ratio = found["windows"]["ours over Cycles'"] / found["linux"]["ours over Cycles'"]
    found["windows over linux"] = ratio
    if not 1 / SPEED <= ratio <= SPEED:
        failures.append(f"speed: our time over Cycles' is {ratio:.2f} times what it is on Linux")
    return found


def linux(script: str, argument: str) -> None:
    """The same script in this system's Python."""
    with tempfile.TemporaryDirectory() as user:
        environment = os.environ | {"BLENDER_USER_RESOURCES": user}
        subprocess.run(
            [sys.executable, script, argument],
            cwd=ROOT,
            env=environment,
            check=True,
            capture_output=True,
            timeout=SECONDS,
        )


if __name__ == "__main__":
    sys.exit(main())
