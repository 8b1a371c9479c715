"""Installs the extension as a link does that is dragged from a repository's page into Blender's
window, and renders: dropped.py -- REPOSITORY FOLDER, run by a Blender with a window under xvfb-run.

What Blender calls for a dropped link is called here; the dialog that it opens is answered by a key.
FOLDER/dropped.json is what was found.
"""

from __future__ import annotations

import html
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urljoin

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
from tests.integration.extension.install import render

MODULE = "bl_ext.photon_splat_test.photon_splat"
TRIES = 60


def link(repository: Path) -> str:
    """What a browser makes of the page's link to the archive."""
    page = repository / "index.html"
    (reference,) = re.findall(r'href="([^"]+\.zip\?[^"]+)"', page.read_text(encoding="utf-8"))
    return urljoin(page.as_uri(), html.unescape(reference))


def drop(repository: Path, folder: Path) -> Iterator[float]:
    """Seconds to leave Blender to itself, after each step."""
    bpy.context.preferences.system.use_online_access = True  # for a file too
    repositories = bpy.context.preferences.extensions.repos
    entry = repositories.new(
        name="Test", module="photon_splat_test", remote_url=(repository / "index.json").as_uri()
    )
    entry.enabled = True
    bpy.ops.extensions.repo_sync(repo_index=list(repositories).index(entry))
    press("mousemove", "700", "400")
    yield 1.0
    bpy.ops.extensions.package_install("INVOKE_DEFAULT", url=link(repository))
    yield 1.0
    press("mousemove", "705", "405")
    for _ in range(TRIES):  # the dialog takes no answer before Blender has read the repository
        yield 1.0
        if MODULE in bpy.context.preferences.addons:
            break
        press("key", "Return")
    found = {"enabled": MODULE in bpy.context.preferences.addons}
    if found["enabled"]:
        render(f"{folder}/dropped.npy")
        found["native"] = sys.modules["photon_splat_native"].__file__
    (folder / "dropped.json").write_text(json.dumps(found))
    os._exit(0)


def press(*arguments: str) -> None:
    subprocess.run(["xdotool", *arguments], check=True)


def main(repository: Path, folder: Path) -> None:
    steps = drop(repository, folder)

    def step() -> float:
        try:
            with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
                return next(steps)
        except BaseException as error:
            (folder / "dropped.json").write_text(json.dumps({"error": repr(error)}))
            os._exit(0)

    bpy.app.timers.register(step, first_interval=2.0)


if __name__ == "__main__":
    main(*map(Path, sys.argv[sys.argv.index("--") + 1 :]))
