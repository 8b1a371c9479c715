"""Opens a .blend file in Blender's Python module."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .arguments import CommandError
from .progress import say


def open_file(path: Path) -> Any:
    """The file's current scene; its scripts do not run. What Blender found wrong in a file that it
    has opened all the same is told in a warning, as Blender itself goes on. Raises CommandError.
    """
    try:
        import bpy
    except ImportError as error:
        raise CommandError(f"Blender's Python module bpy cannot be loaded: {error}") from error
    from .. import register

    register()
    whole = path.resolve()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(whole), load_ui=False, use_scripts=False)
    except RuntimeError as error:  # any error that Blender reports, be the file open or not
        told = " ".join(str(error).split()).removeprefix("Error: ").replace(" Error: ", "; ")
        if not bpy.data.filepath or Path(bpy.data.filepath) != whole:
            raise CommandError(f"{path} cannot be opened: {told}") from error
        say(f"photon-splat: warning: {path}: Blender reports: {told}\n")
    return bpy.context.scene
