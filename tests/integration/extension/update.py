"""Installs an older version from a repository, updates it to the one that the repository offers
next, and renders with both: update.py OLD_REPOSITORY NEW_REPOSITORY FOLDER.

A repository is a folder with an index.json. Runs in a process of its own, with a Blender user
folder of its own. Prints one JSON object: what was found.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
import tomllib
from pathlib import Path
from typing import Any

MODULE = "bl_ext.photon_splat_test.photon_splat"


def main(old: str, new: str, folder: str) -> dict[str, Any]:
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    served = Path(folder, "served")
    shutil.copytree(old, served)
    bpy.context.preferences.system.use_online_access = True  # for a file too
    repository = bpy.context.preferences.extensions.repos.new(
        name="Test", module="photon_splat_test", remote_url=(served / "index.json").as_uri()
    )
    repository.enabled = True
    index = list(bpy.context.preferences.extensions.repos).index(repository)
    found: dict[str, Any] = {}
    bpy.ops.extensions.repo_sync(repo_index=index)
    bpy.ops.extensions.package_install(
        repo_index=index, pkg_id="photon_splat", enable_on_install=True
    )
    found["installed"] = version()
    render(f"{folder}/first.npy")
    found["native"] = sys.modules["photon_splat_native"].__file__
    found["native before"] = sys.modules["photon_splat_native"].__version__

    shutil.rmtree(served)
    shutil.copytree(new, served)
    bpy.ops.extensions.repo_sync(repo_index=index)
    found["offered"] = offered(served)
    found["upgraded"] = sorted(bpy.ops.extensions.package_upgrade_all())
    found["after"] = version()
    found["enabled"] = MODULE in bpy.context.preferences.addons
    render(f"{folder}/second.npy")
    found["native after"] = sys.modules["photon_splat_native"].__version__
    return found


def version() -> str:
    """Of what is installed."""
    manifest = Path(sys.modules[MODULE].__file__ or "").with_name("blender_manifest.toml")
    return str(tomllib.loads(manifest.read_text(encoding="utf-8"))["version"])


def offered(repository: Path) -> list[str]:
    index = json.loads((repository / "index.json").read_text(encoding="utf-8"))
    return sorted({entry["version"] for entry in index["data"]})


def render(path: str) -> None:
    from tests.integration.extension.install import render as render_box

    render_box(path)


def in_window(old: str, new: str, folder: str) -> None:
    """main() in the Blender whose window is open, which then ends; FOLDER/update.json is what was
    found.
    """
    import bpy

    try:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            found = main(old, new, folder)
    except BaseException as error:
        found = {"error": repr(error)}
    Path(folder, "update.json").write_text(json.dumps(found))
    os._exit(0)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
    if "--" in sys.argv:
        import bpy

        three = sys.argv[sys.argv.index("--") + 1 :]
        bpy.app.timers.register(lambda: in_window(*three), first_interval=2.0)
    else:
        answers = os.fdopen(os.dup(1), "w")
        os.dup2(2, 1)
        print(json.dumps(main(*sys.argv[1:])), file=answers, flush=True)
        os._exit(0)
