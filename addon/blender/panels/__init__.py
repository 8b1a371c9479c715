"""The engine's panels, where Cycles' are, and those of Blender's own that fit it."""

from __future__ import annotations

from . import blender, farm, motion, presets, render, report, view_layer

PARTS = (presets, render, farm, motion, view_layer, report)


def register() -> None:
    for part in PARTS:
        part.register()
    blender.register()


def unregister() -> None:
    blender.unregister()
    for part in reversed(PARTS):
        part.unregister()
