"""Takes the manual's pictures of panels anew: manual_pictures.py ARCHIVE [--suite SUITE].

Runs manual_panels.py in the Blender with a window that viewport_test.py uses, and leaves the
pictures in docs/pictures.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import blender_window
import debian_chroot

ROOT = Path(__file__).resolve().parent.parent
SCREEN = "390x1100x24"
SECONDS = 600


def main() -> int:
    options = blender_window.options_of(__doc__).parse_args()
    try:
        chroot = blender_window.make(options.suite)
    except debian_chroot.Unavailable as reason:
        print(f"No pictures: {reason}", file=sys.stderr)
        return 1
    folder = ROOT / "out" / "manual"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    user = blender_window.there(folder / "user")
    script = ["--factory-startup", "--addons", blender_window.MODULE]
    script += ["--python", "tools/manual_panels.py", "--", blender_window.there(folder)]
    with (folder / "blender.log").open("w") as log:
        for command in (
            blender_window.install(chroot, user, blender_window.there(options.archive)),
            blender_window.blender(chroot, user, *script, screen=SCREEN),
        ):
            subprocess.run(command, stdout=log, stderr=log, timeout=SECONDS, check=True)
    for picture in folder.glob("*.png"):
        shutil.copy(picture, ROOT / "docs/pictures")
        print(f"docs/pictures/{picture.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
