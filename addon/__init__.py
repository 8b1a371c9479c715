"""Photon Splat: a Blender render engine that splats photons. Importable without Blender; `register`
needs it.
"""

from __future__ import annotations


def version() -> str:
    """The engine's version, as the extension's manifest states it."""
    import tomllib
    from pathlib import Path

    manifest = Path(__file__).with_name("blender_manifest.toml")
    return tomllib.loads(manifest.read_text(encoding="utf-8"))["version"]


def register() -> None:
    import atexit

    import bpy

    from .blender import engine, panels, persistent, properties, viewport

    try:
        for part in (properties, viewport, persistent, engine, panels):
            part.register()
    except BaseException:
        unregister()
        raise
    atexit.unregister(unregister)
    # Blender 4.5 as a Python module hangs at exit while a render engine or a panel is registered
    if getattr(bpy.app, "module", False):
        atexit.register(unregister)


def unregister() -> None:
    import atexit
    import contextlib

    from .blender import engine, panels, persistent, properties, viewport

    atexit.unregister(unregister)
    with contextlib.ExitStack() as parts:  # the last one first, and all of them whatever happens
        for part in (properties, viewport, persistent, engine, panels):
            parts.callback(part.unregister)
