"""What wine_test.py tries with the extension for Windows and one Python: each step returns its
figures, and adds to the trial's failures what is not as it should be.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from update_test import judge
from wine import ROOT, inside
from wine_trial import Trial

sys.path.insert(0, str(ROOT))
from tests.integration.extension import repositories
from tests.integration.windows.pictures import DENOISED, LARGE, SCENES

ROUNDING, DENOISED_ROUNDING = 1e-3, 1e-2
"""Most that a value of a picture may differ between the systems, relative to the larger of it and
the picture's mean: paths may part where rounding decides on which side of an edge a ray goes, in
one pixel of many.
"""
APART = 0.02
"""Share of pixels that may differ by more, for such paths."""
SPEED = 1.2
"""Most that our time over Cycles' may differ between the systems, as a factor."""
CLEAN = (
    "-X",
    "utf8",
    "-S",
    "-c",
    "import os, sys, runpy; sys.argv = sys.argv[1:]; os.environ['BLENDER_USER_RESOURCES'] = "
    "sys.argv[-1] + '/blender'; runpy.run_path(sys.argv[0], run_name='__main__')",
)
"""Runs a script whose last argument is the folder of its Blender's user. Blender's own Python takes
no notice of the system's code page; that of the command line does.
"""


def install(trial: Trial) -> dict[str, Any]:
    """What tests/integration/extension/install.py found."""
    folder = trial.out / "installed für 光"
    folder.mkdir()
    script = "tests/integration/extension/install.py"
    arguments = [*CLEAN, script, inside(trial.archive), inside(folder)]
    seconds = trial.run("install", *arguments, path=[trial.wine.bare])
    if seconds is None:
        return {}
    found = trial.answer("install")
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
            trial.fail(f"install: {what}")
    return {"seconds": seconds}


def update(trial: Trial) -> dict[str, Any]:
    """What tests/integration/extension/update.py found: an update while the module is loaded."""
    folder = trial.out / "updated für 光"
    repositories.make_old(folder / "old", trial.archive)
    repositories.make_new(folder / "new", trial.archive)
    script = "tests/integration/extension/update.py"
    arguments = [script, *(inside(folder / name) for name in ("old", "new")), inside(folder)]
    seconds = trial.run("update", *CLEAN, *arguments, path=[trial.wine.bare])
    if seconds is None:
        return {}
    for failure in judge(trial.answer("update"), folder):
        trial.fail(f"update: {failure}")
    return {"seconds": seconds}


def files(trial: Trial) -> dict[str, Any]:
    """What tests/integration/windows/files.py found."""
    folder = trial.out / "files"
    folder.mkdir()
    arguments = ["tests/integration/windows/files.py", inside(folder)]
    seconds = trial.run("files", *arguments, path=[trial.product, trial.wine.site])
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
            trial.fail(f"files: {what} was not handled: {json.dumps(found)}")
    return {"seconds": seconds}


def pictures(trial: Trial) -> dict[str, Any]:
    """By scene: share of pixels that are the same bits in both systems, the largest relative
    difference, and the share of pixels that differ by more than rounding.
    """
    script = "tests/integration/windows/pictures.py"
    windows, linux = (trial.out / name for name in ("windows", "linux"))
    windows.mkdir()
    linux.mkdir()
    path = [trial.product, trial.wine.site]
    seconds = trial.run("pictures", script, inside(windows), path=path)
    trial.run_linux(script, str(linux))
    if seconds is None:
        return {}
    found: dict[str, Any] = {"seconds": seconds}
    for name in (*SCENES, DENOISED, LARGE):
        ours, theirs = (combined(folder / f"{name}.exr") for folder in (linux, windows))
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
            trial.fail(f"{name}: {found[name]['apart']:.1%} of its pixels differ from Linux'")
    return found


def combined(path: Path) -> np.ndarray:
    """(height, width, 3) of the Combined pass."""
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(str(path))
    pixels = np.asarray(file.read_image(0, 0, 0, 3, oiio.FLOAT), np.float64)
    file.close()
    return pixels.reshape(file.spec().height, file.spec().width, 3)


def speed(trial: Trial) -> dict[str, Any]:
    """Our processor time over Cycles' for the Cornell box, in both systems."""
    script = "tests/integration/windows/speed.py"
    outputs = {system: trial.out / f"speed_{system}.json" for system in ("windows", "linux")}
    path = [trial.product, trial.wine.site]
    seconds = trial.run("speed", script, inside(outputs["windows"]), path=path)
    trial.run_linux(script, str(outputs["linux"]))
    if seconds is None:
        return {}
    found: dict[str, Any] = {"seconds": seconds}
    for system, output in outputs.items():
        taken = json.loads(output.read_text())
        found[system] = taken | {"ours over Cycles'": taken["PHOTON_SPLAT"] / taken["CYCLES"]}
    ratio = found["windows"]["ours over Cycles'"] / found["linux"]["ours over Cycles'"]
    found["windows over linux"] = ratio
    if not 1 / SPEED <= ratio <= SPEED:
        trial.fail(f"speed: our time over Cycles' is {ratio:.2f} times what it is on Linux")
    return found
