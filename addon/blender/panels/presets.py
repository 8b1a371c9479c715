"""Presets of the sampling settings, by Blender's own system: Draft, Good and Final come with the
engine.
"""

from __future__ import annotations

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from ..engine import ENGINE
from ..registration import register_classes, unregister_classes

FOLDER = "photon_splat/render"
HOME = str(Path(__file__).resolve().parent.parent)
"""Blender looks for presets/FOLDER in it."""


class PHOTON_SPLAT_PT_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Sampling Presets"
    preset_subdir = FOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = "photon_splat.preset_add"
    COMPAT_ENGINES = {ENGINE}


class PHOTON_SPLAT_OT_preset_add(AddPresetBase, bpy.types.Operator):
    bl_idname = "photon_splat.preset_add"
    bl_label = "Add Sampling Preset"
    bl_description = (
        "Keep the settings of Sampling and Light Paths under a name, or remove those of a name"
    )
    preset_menu = "PHOTON_SPLAT_PT_presets"
    preset_defines = ["settings = bpy.context.scene.photon_splat"]
    preset_values = [
        f"settings.{name}"
        for name in (
            "error_threshold",
            "passes",
            "time_limit",
            "photons_per_pass",
            "max_bounces",
            "viewport_passes",
            "viewport_photons_per_pass",
        )
    ]
    preset_subdir = FOLDER


CLASSES = (PHOTON_SPLAT_OT_preset_add, PHOTON_SPLAT_PT_presets)


def _homes() -> list[str]:
    """Where Blender looks for presets, FOLDER and all."""
    return [path.removesuffix(f"/presets/{FOLDER}") for path in bpy.utils.preset_paths(FOLDER)]


def register() -> None:
    register_classes(CLASSES)
    # Blender 4.2 finds the user's own presets only
    if hasattr(bpy.utils, "register_preset_path") and HOME not in _homes():
        bpy.utils.register_preset_path(HOME)


def unregister() -> None:
    if hasattr(bpy.utils, "unregister_preset_path") and HOME in _homes():
        bpy.utils.unregister_preset_path(HOME)
    unregister_classes(CLASSES)
