"""Installs the built extension in a clean Blender, renders, disables and enables it: install.py
ARCHIVE FOLDER.

Runs in a process of its own whose Blender user folder is FOLDER/blender and that can import bpy and
numpy only. Prints one JSON object: what was found.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from pathlib import Path
from typing import Any

MODULE = "bl_ext.user_default.photon_splat"
TRACES = ("photon_splat", "PHOTON_SPLAT", "PhotonSplat")


def main(archive: str, folder: str) -> dict[str, Any]:
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    found: dict[str, Any] = {"before": traces()}
    result = bpy.ops.extensions.package_install_files(
        filepath=archive, repo="user_default", enable_on_install=True
    )
    found["installed"] = sorted(result)
    found["package"] = sys.modules[MODULE].__file__
    found["enabled"] = traces()
    render(f"{folder}/first.npy")
    found["native"] = sys.modules["photon_splat_native"].__file__
    found["moderngl"] = find("moderngl")
    bpy.ops.preferences.addon_disable(module=MODULE)
    found["disabled"] = traces()
    bpy.ops.preferences.addon_enable(module=MODULE)
    render(f"{folder}/second.npy")
    bpy.ops.preferences.addon_disable(module=MODULE)
    found["disabled again"] = traces()
    return found


def render(path: str) -> None:
    import bpy
    import numpy as np

    bpy.ops.wm.open_mainfile(filepath=str(Path("blend_scenes/cornell_box.blend").resolve()))
    scene = bpy.context.scene
    scene.render.engine = "PHOTON_SPLAT"
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.render.resolution_percentage = 100
    scene.photon_splat.passes, scene.photon_splat.time_limit, scene.photon_splat.backend = (
        2,
        0.0,
        "CPU",
    )
    scene.render.filepath = path + ".exr"
    if hasattr(scene.render.image_settings, "media_type"):
        scene.render.image_settings.media_type = "IMAGE"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    np.save(path, pixels)
    bpy.data.images.remove(image)


def traces() -> list[str]:
    """What of the extension Blender and this process know: classes, properties, engines of panels,
    handlers, timers, threads.
    """
    import bpy

    found = [f"class {name}" for name in dir(bpy.types) if name.startswith(TRACES)]
    for cls in bpy.types.bpy_struct.__subclasses__():
        properties = cls.bl_rna.properties.keys()
        found += [
            f"property {cls.__name__}.{name}" for name in properties if name.startswith(TRACES)
        ]
    for kind in (
        bpy.types.Panel,
        bpy.types.Operator,
        bpy.types.Menu,
        bpy.types.UIList,
        bpy.types.PropertyGroup,
        bpy.types.RenderEngine,
    ):
        found += [
            f"{kind.__name__} {cls.__name__}"
            for cls in kind.__subclasses__()
            if MODULE in cls.__module__ and cls.is_registered
        ]
    for panel in bpy.types.Panel.__subclasses__():
        if MODULE not in panel.__module__ and "PHOTON_SPLAT" in getattr(
            panel, "COMPAT_ENGINES", ()
        ):
            found.append(f"engine of {panel.__name__}")
    for name in dir(bpy.app.handlers):
        handlers = getattr(bpy.app.handlers, name)
        if isinstance(handlers, list):
            found += [
                f"handler {name}"
                for handler in handlers
                if MODULE in getattr(handler, "__module__", "")
            ]
    return found + [
        f"thread {thread.name}" for thread in threading.enumerate() if "Photon Splat" in thread.name
    ]


def find(name: str) -> str | None:
    import importlib.util

    spec = importlib.util.find_spec(name)
    return spec.origin if spec else None


if __name__ == "__main__":
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    print(json.dumps(main(*sys.argv[1:])), file=answers, flush=True)
    os._exit(0)
