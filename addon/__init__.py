"""Photon Splat: a Blender render engine that splats photons. Importable without Blender; `register` needs it."""

from __future__ import annotations


def version() -> str:
    """The engine's version, as the extension's manifest states it."""
    import tomllib
    from pathlib import Path

    return tomllib.loads(Path(__file__).with_name("blender_manifest.toml").read_text())["version"]


def register() -> None:
    import atexit

    import bpy

    from . import engine, panels, persistent, settings, viewport

    settings.register()
    viewport.register()
    persistent.register()
    engine.register()
    panels.register()
    if getattr(bpy.app, "module", False):  # Blender 4.5 as a Python module hangs at exit while a render engine or a panel is registered
        atexit.register(unregister)


def unregister() -> None:
    import atexit

    from . import engine, panels, persistent, settings, viewport

    atexit.unregister(unregister)
    panels.unregister()
    engine.unregister()
    persistent.unregister()
    viewport.unregister()
    settings.unregister()
