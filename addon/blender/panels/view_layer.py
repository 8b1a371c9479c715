"""Panels of the view layer's tab."""

from __future__ import annotations

from typing import Any

import bpy

from ...core.render.result import PASSES
from ...export.labels import FOR_DENOISING, MATTES
from ...export.labels import SWITCHES as DATA_SWITCHES
from ..passes import switch_of
from ..registration import register_classes, unregister_classes
from .base import RenderPanel, split_layout

DATA = ("Depth", "Normal", "Surface ID", "Photon Density", "Error")
"""Passes that are no light."""

LIGHT = ("Ambient Occlusion",)
"""Of those that are made where they are wanted, what stands with light."""


class PHOTON_SPLAT_PT_passes(RenderPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: Any) -> None:
        layout, view_layer = split_layout(self), context.view_layer
        data, light = layout.column(heading="Data"), layout.column(heading="Light")
        for info in PASSES:
            column = data if info.name in DATA else light
            found = switch_of(view_layer, info.name)
            if found is not None and found[0] is not None:
                column.prop(*found, text=info.name)
        if hasattr(view_layer, "cycles"):
            light.prop(view_layer.cycles, "use_pass_shadow_catcher")
        for name, switch in DATA_SWITCHES.items():
            (light if name in LIGHT else data).prop(view_layer, switch, text=name)
        if hasattr(view_layer, "cycles"):
            data.prop(view_layer.cycles, FOR_DENOISING, text="Denoising Data")
        mattes = layout.column(heading="Cryptomatte")
        for name, switch in MATTES.items():
            mattes.prop(view_layer, switch, text=name.removeprefix("Crypto"))
        levels = mattes.column()
        levels.active = any(getattr(view_layer, switch) for switch in MATTES.values())
        levels.prop(view_layer, "pass_cryptomatte_depth", text="Levels")


class PHOTON_SPLAT_PT_aovs(RenderPanel, bpy.types.Panel):
    bl_label = "Shader AOVs"
    bl_context = "view_layer"
    bl_parent_id = "PHOTON_SPLAT_PT_passes"

    def draw(self, context: Any) -> None:
        _draw_list(split_layout(self), context.view_layer, "aov", "VIEWLAYER_UL_aov")


class PHOTON_SPLAT_PT_light_groups(RenderPanel, bpy.types.Panel):
    bl_label = "Light Groups"
    bl_context = "view_layer"
    bl_parent_id = "PHOTON_SPLAT_PT_passes"

    def draw(self, context: Any) -> None:
        buttons = _draw_list(split_layout(self), context.view_layer, "lightgroup", "UI_UL_list")
        buttons.separator()
        buttons.operator("scene.view_layer_add_used_lightgroups", icon="FILE_REFRESH", text="")


def _draw_list(layout: Any, view_layer: Any, what: str, list_type: str) -> Any:
    """The view layer's list of `what`, and a column of buttons, which is returned."""
    row, name = layout.row(), f"{what}s"
    active = f"active_{what}_index"
    row.template_list(list_type, name, view_layer, name, view_layer, active, rows=3)
    buttons = row.column(align=True)
    buttons.operator(f"scene.view_layer_add_{what}", icon="ADD", text="")
    buttons.operator(f"scene.view_layer_remove_{what}", icon="REMOVE", text="")
    return buttons


def _draw_light_group(panel: Any, owner: Any, view_layer: Any) -> None:
    """What light group `owner`, an object or a world, is of."""
    row = split_layout(panel).row(align=True)
    row.prop_search(
        owner,
        "lightgroup",
        view_layer,
        "lightgroups",
        text="Light Group",
        results_are_suggestions=True,
    )
    known = any(group.name == owner.lightgroup for group in view_layer.lightgroups)
    button = row.column(align=True)
    button.enabled = bool(owner.lightgroup) and not known
    button.operator("scene.view_layer_add_lightgroup", icon="ADD", text="").name = owner.lightgroup


class PHOTON_SPLAT_OBJECT_PT_light_group(RenderPanel, bpy.types.Panel):
    bl_label = "Light Group"
    bl_parent_id = "OBJECT_PT_shading"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(super().poll(context) and getattr(context, "object", None))

    def draw(self, context: Any) -> None:
        _draw_light_group(self, context.object, context.view_layer)


class PHOTON_SPLAT_WORLD_PT_light_group(RenderPanel, bpy.types.Panel):
    bl_label = "Light Group"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(super().poll(context) and getattr(context, "world", None))

    def draw(self, context: Any) -> None:
        _draw_light_group(self, context.world, context.view_layer)


class PHOTON_SPLAT_WORLD_PT_preview(RenderPanel, bpy.types.Panel):
    bl_label = "Preview"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(super().poll(context) and getattr(context, "world", None))

    def draw(self, context: Any) -> None:
        self.layout.template_preview(context.world)


CLASSES = (
    PHOTON_SPLAT_PT_passes,
    PHOTON_SPLAT_PT_aovs,
    PHOTON_SPLAT_PT_light_groups,
    PHOTON_SPLAT_OBJECT_PT_light_group,
    PHOTON_SPLAT_WORLD_PT_light_group,
    PHOTON_SPLAT_WORLD_PT_preview,
)


def register() -> None:
    register_classes(CLASSES)


def unregister() -> None:
    unregister_classes(CLASSES)
