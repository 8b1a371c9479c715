"""Blender's own panels that fit the engine."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from ..engine import ENGINE

# Panels of other engines that show just what this one reads, too.
BORROWED = {
    "DATA_PT_EEVEE_light",
    "DATA_PT_camera_dof",
    "DATA_PT_camera_dof_aperture",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
    "VIEWLAYER_PT_override",
}
# Made for engines without settings of their own.
NOT_OURS = {
    "VIEWLAYER_PT_filter",
    "VIEWLAYER_PT_layer_passes",
    "RENDER_PT_gpencil",
    "RENDER_PT_simplify_greasepencil",
}


def _panels() -> Iterator[Any]:
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        name = panel.__name__
        if (
            isinstance(engines, set)
            and name not in NOT_OURS
            and (name in BORROWED or "BLENDER_RENDER" in engines)
        ):
            yield panel


def register() -> None:
    for panel in _panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister() -> None:
    own = __package__.rpartition(".")[0]
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if not panel.__module__.startswith(own) and isinstance(engines, set):
            engines.discard(ENGINE)
