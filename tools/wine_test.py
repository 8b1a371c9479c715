"""Tests the extension for Windows under Wine: wine_test.py ARCHIVE [OLD_PYTHON].

The module and the add-on of the archive are run by Python 3.13 with Blender 5.2 for Windows (see
wine.py): an install into a clean Blender, an update, names of files, a console, places of Blender's
libraries, pictures and speed beside this system's, closed forms, robustness, some cases against
Cycles, each instruction set. Python 3.11 with Blender 4.5 for Windows then installs and updates it,
and renders pictures beside those of OLD_PYTHON, this system's Python 3.11. Where Wine cannot be had
the test is skipped and says so. What the programs wrote, pictures and figures are left in out/wine.
"""

from __future__ import annotations

import functools
import json
import os
import re
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from windows_python import ROOT
from windows_python import Unavailable as NoPython
from wine import Unavailable, Wine, inside
from wine_console import console
from wine_libraries import libraries
from wine_steps import files, install, pictures, speed, update
from wine_trial import Trial

sys.path.insert(0, str(ROOT))
from tools.run_tests import CHILD

OUT = ROOT / "out" / "wine"
NEW, OLD = "3.13", "3.11"
FOLDERS = {
    "closed forms": ["tests/reference/closed_form", "-m", "not slow"],
    "robustness": ["tests/robustness", "-m", "not slow"],
    "Cycles": ["tests/reference/cycles/test_cycles.py", "-m", "not slow"],
    "instruction sets": ["tests/integration/packaging/test_simd_levels.py"],
}
Step = Callable[[Trial], dict[str, Any]]


def main() -> int:
    if not 2 <= len(sys.argv) <= 3:
        print(__doc__, file=sys.stderr)
        return 2
    archive, olds = Path(sys.argv[1]), [os.path.abspath(old) for old in sys.argv[2:]]
    began = time.monotonic()
    shutil.rmtree(OUT, ignore_errors=True)
    short: dict[str, Step] = {"install": install, "update": update, "pictures": pictures}
    steps = short | {"files": files, "console": console, "libraries": libraries}
    steps |= {"speed": speed} | {name: functools.partial(tests, name) for name in FOLDERS}
    result: dict[str, Any] = {}
    failures: list[str] = []
    try:
        result[NEW] = run(Trial(Wine(NEW), archive, OUT / NEW, sys.executable, failures), steps)
        if olds:
            result[OLD] = run(Trial(Wine(OLD), archive, OUT / OLD, olds[0], failures), short)
        else:
            print(f"No Python {OLD} here: the module for it is not tested under Wine.")
    except (Unavailable, NoPython) as reason:
        print(f"SKIPPED: the extension for Windows is not tested under Wine: {reason}")
        return 0
    (OUT / "result.json").write_text(json.dumps(result, indent=1))
    print(f"== all: {time.monotonic() - began:.0f} s")
    for failure in failures:
        print(f"FAILED {failure}", file=sys.stderr)
    return 1 if failures else 0


def run(trial: Trial, steps: dict[str, Step]) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for name, step in steps.items():
        result[name] = step(trial)
        print(
            json.dumps({f"{name}, Python {trial.wine.version}": result[name]}, indent=1), flush=True
        )
    return result


def tests(name: str, trial: Trial) -> dict[str, Any]:
    status, current = inside(trial.out / "status"), inside(trial.out / "current")
    arguments = ["-c", CHILD, status, current, *FOLDERS[name], "-p", "no:cacheprovider", "-q"]
    seconds = trial.run(name, *arguments, path=[trial.product, trial.wine.site, ROOT])
    last = trial.log(name).read_text(errors="replace").splitlines()[-1:]
    counts = {
        what: int(number)
        for number, what in re.findall(r"(\d+) (passed|failed|skipped|error)", "".join(last))
    }
    if not counts.get("passed"):
        trial.fail(f"{name}: no test passed")
    return counts | {"seconds": seconds}


if __name__ == "__main__":
    sys.exit(main())
