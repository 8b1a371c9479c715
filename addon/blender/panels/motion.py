"""Motion blur of a scene and of objects: settings that Cycles has as well."""

from __future__ import annotations

from typing import Any

import bpy

from ..registration import register_classes, unregister_classes
from .base import RenderPanel, split_layout

MOVING = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CAMERA"}


class PHOTON_SPLAT_PT_motion_blur(RenderPanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context: Any) -> None:
        layout, scene = split_layout(self), context.scene
        layout.active = scene.render.use_motion_blur
        layout.prop(scene.render, "motion_blur_position", text="Position")
        layout.prop(scene.render, "motion_blur_shutter")
        cycles = getattr(scene, "cycles", None)
        if cycles is not None:
            layout.prop(cycles, "rolling_shutter_type", text="Rolling Shutter")
            row = layout.row()
            row.active = cycles.rolling_shutter_type != "NONE"
            row.prop(cycles, "rolling_shutter_duration")


class PHOTON_SPLAT_PT_motion_blur_curve(RenderPanel, bpy.types.Panel):
    bl_label = "Shutter Curve"
    bl_parent_id = "PHOTON_SPLAT_PT_motion_blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        layout, render = split_layout(self), context.scene.render
        layout.active = render.use_motion_blur
        layout.template_curve_mapping(render, "motion_blur_shutter_curve")


class PHOTON_SPLAT_PT_object_motion_blur(RenderPanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        ob = context.object
        if not super().poll(context) or ob is None or not hasattr(ob, "cycles"):
            return False
        return ob.type in MOVING or ob.instance_type == "COLLECTION"

    def draw_header(self, context: Any) -> None:
        self.layout.active = context.scene.render.use_motion_blur
        self.layout.prop(context.object.cycles, "use_motion_blur", text="")

    def draw(self, context: Any) -> None:
        layout, ob = split_layout(self), context.object
        layout.active = context.scene.render.use_motion_blur and ob.cycles.use_motion_blur
        layout.prop(ob.cycles, "motion_steps", text="Steps")
        if ob.type != "CAMERA":
            layout.prop(ob.cycles, "use_deform_motion", text="Deformation")


CLASSES = (
    PHOTON_SPLAT_PT_motion_blur,
    PHOTON_SPLAT_PT_motion_blur_curve,
    PHOTON_SPLAT_PT_object_motion_blur,
)


def register() -> None:
    register_classes(CLASSES)


def unregister() -> None:
    unregister_classes(CLASSES)
