"""Tests installs and an update from a repository in a Blender with a window: update_test.py ARCHIVE
[--suite SUITE].

An older version is installed and renders; then the repository offers the archive's version, which
Blender finds, installs over the loaded module, and renders with. In another Blender the archive's
link on the repository's page is dropped into the window. As viewport_test.py it runs Debian's
Blender under a virtual X server, in the same system. Figures are left in out/update-SUITE.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import blender_window
import debian_chroot
import numpy as np
from viewport_test import SCREEN

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from tests.integration.extension import repositories  # noqa: E402

SCRIPTS = "tests/integration/extension"
SECONDS = 600


def main() -> int:
    options = blender_window.options_of(__doc__).parse_args()
    try:
        chroot = blender_window.make(options.suite)
    except debian_chroot.Unavailable as reason:
        print(f"SKIPPED: an update is not tested in a window: {reason}")
        return 0
    folder = ROOT / "out" / f"update-{options.suite}"
    shutil.rmtree(folder, ignore_errors=True)
    repositories.make_old(folder / "old", options.archive)
    repositories.make_new(folder / "new", options.archive)
    there = blender_window.there(folder)
    run(chroot, folder, "update", f"{there}/old", f"{there}/new", there)
    run(chroot, folder, "dropped", f"{there}/new", there)
    found, dropped = (
        json.loads((folder / f"{name}.json").read_text()) for name in ("update", "dropped")
    )
    print(json.dumps({"update": found, "dropped": dropped}, indent=1))
    failures = judge(found, folder) + judge_dropped(dropped, folder)
    for failure in failures:
        print(f"FAILED {failure}", file=sys.stderr)
    return 1 if failures else 0


def run(chroot: Path, folder: Path, script: str, *arguments: str) -> None:
    """Each script has a Blender user of its own."""
    user = blender_window.there(folder / script)
    options = ["--factory-startup", "--online-mode", "--python", f"{SCRIPTS}/{script}.py", "--"]
    command = blender_window.blender(chroot, user, *options, *arguments, screen=SCREEN)
    with (folder / f"{script}.log").open("w") as log:
        subprocess.run(command, stdout=log, stderr=log, timeout=SECONDS, check=False)


def judge(found: dict[str, object], folder: Path) -> list[str]:
    """What is not as it should be."""
    if "error" in found:
        return [f"Blender said {found['error']}; see {folder / 'update.log'}"]
    current = repositories.current_version()
    first, second = (np.load(folder / f"{name}.npy") for name in ("first", "second"))
    checks = {
        "the older version was not installed": found["installed"] == repositories.OLD,
        "the new version was not offered": found["offered"] == [current],
        "the update did not finish": found["upgraded"] == ["FINISHED"],
        "the new version is not there after the update": found["after"] == current,
        "the extension is not enabled after the update": found["enabled"],
        "the older native module was not loaded": found["native before"] == repositories.OLD,
        "the new native module is not loaded": found["native after"] == current,
        "the first picture is black": first.mean() > 0.05,
        "the second picture differs": np.array_equal(first, second),
    }
    return [what for what, right in checks.items() if not right]


def judge_dropped(found: dict[str, object], folder: Path) -> list[str]:
    if not found.get("enabled"):
        return [f"the dropped link installed nothing: {found}; see {folder / 'dropped.log'}"]
    if np.array_equal(np.load(folder / "dropped.npy"), np.load(folder / "second.npy")):
        return []
    return ["the picture after the dropped link differs"]


if __name__ == "__main__":
    sys.exit(main())
