"""Names and places of files that trouble Windows, by the command line: files.py FOLDER.

Writes FOLDER/files.json: by what was tried, the exit status, what is there afterwards, and what was
said.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import shutil
import sys
from pathlib import Path
from typing import Any

SCENE = Path(__file__).resolve().parents[3] / "blend_scenes" / "cornell_box.blend"
OPTIONS = ("--resolution", "16x16", "--passes", "1", "--photons-per-pass", "1000", "--verbose")


def main(folder: Path) -> None:
    found = {
        "not ASCII": not_ascii(folder / "Bücher 光 ø"),
        "long": long(folder / "long"),
        "open": still_open(folder / "open"),
    }
    (folder / "files.json").write_text(json.dumps(found), encoding="utf-8")


def not_ascii(folder: Path) -> dict[str, Any]:
    folder.mkdir()
    scene = folder / "Küche 部屋.blend"
    shutil.copy(SCENE, scene)
    return render(scene, folder / "Bild ß 絵.exr")


def long(folder: Path) -> dict[str, Any]:
    """A path of more than the 260 characters that old programs for Windows can open."""
    for _ in range(3):
        folder = folder / ("x" * 100)
    folder.mkdir(parents=True)
    return render(SCENE, folder / "out.exr")


def still_open(folder: Path) -> dict[str, Any]:
    """A picture that a viewer shows is not lost, nor is the new one."""
    folder.mkdir()
    picture = folder / "out.exr"
    picture.write_bytes(b"old")
    with picture.open("rb"):
        found = render(SCENE, picture)
    return found | {"kept": picture.read_bytes() == b"old"}


def render(scene: Path, output: Path) -> dict[str, Any]:
    from photon_splat.cli import main as photon_splat

    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        status = photon_splat(["render", str(scene), "-o", str(output), *OPTIONS])
    return {
        "status": status,
        "files": sorted(path.name for path in output.parent.iterdir()),
        "said": said.getvalue().strip().splitlines()[-1:],
    }


if __name__ == "__main__":
    main(Path(sys.argv[1]))
    sys.stdout.flush()
    os._exit(0)
