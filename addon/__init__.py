"""Photon Splat: a Blender render engine that splats photons. Importable without Blender; `register` needs it."""

from __future__ import annotations


def version() -> str:
    """The engine's version, as the extension's manifest states it."""
    import tomllib
    from pathlib import Path

    return tomllib.loads(Path(__file__).with_name("blender_manifest.toml").read_text())["version"]


def register() -> None:
    from . import engine, panels, settings

    settings.register()
    engine.register()
    panels.register()


def unregister() -> None:
    from . import engine, panels, settings

    panels.unregister()
    engine.unregister()
    settings.unregister()
