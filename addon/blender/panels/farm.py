"""The panel Farm: checkpoints of long renders, and jobs for many machines."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from ...farm import Animation, FarmError, Job, Still, System, write_bundle
from ..records import limits_of_parts
from ..registration import register_classes, unregister_classes
from .base import RenderPanel, split_layout


class PHOTON_SPLAT_OT_farm(bpy.types.Operator):
    bl_idname = "photon_splat.farm"
    bl_label = "Write Job"
    bl_description = (
        "Write what the scheduler needs to render the saved file with photon-splat on its machines"
    )

    def execute(self, context: Any) -> set[str]:
        scene, settings = context.scene, context.scene.photon_splat_farm
        if not bpy.data.filepath:
            self.report({"ERROR"}, "Save the file first: the machines read it from disk")
            return {"CANCELLED"}
        folder = Path(bpy.path.abspath(settings.folder))
        scene_file = Path(bpy.data.filepath)
        try:
            what, options = _what(scene, settings)
            job = Job(
                name=scene_file.stem,
                scene=str(scene_file),
                output=str(folder / "output"),
                what=what,
                options=tuple(options),
            )
            then = write_bundle(job, System(settings.system), folder)
        except FarmError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if bpy.data.is_dirty:
            self.report({"WARNING"}, "The file has changes that are not saved, and not in the job")
        if job.doubt():
            self.report({"WARNING"}, job.doubt().capitalize())
        self.report({"INFO"}, f"{folder} is written. Next: {then}")
        return {"FINISHED"}


def _what(scene: Any, settings: Any) -> tuple[Still | Animation, list[str]]:
    """And more options of photon-splat render."""
    if settings.kind == "STILL":
        return Still(scene.frame_current, settings.parts), limits_of_parts(scene, settings.parts)
    frames = range(scene.frame_start, scene.frame_end + 1, scene.frame_step)
    return Animation(tuple(frames), settings.chunk), []


class PHOTON_SPLAT_PT_farm(RenderPanel, bpy.types.Panel):
    bl_label = "Farm"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        layout, settings = split_layout(self), context.scene.photon_splat_farm
        layout.prop(settings, "use_checkpoint")
        column = layout.column()
        column.active = settings.use_checkpoint
        column.prop(settings, "checkpoint")
        column.prop(settings, "checkpoint_minutes")
        column.prop(settings, "resume")
        layout.separator()
        layout.prop(settings, "system")
        layout.prop(settings, "kind")
        layout.prop(settings, "parts" if settings.kind == "STILL" else "chunk")
        layout.prop(settings, "folder")
        layout.operator("photon_splat.farm", icon="EXPORT")


CLASSES = (PHOTON_SPLAT_OT_farm, PHOTON_SPLAT_PT_farm)


def register() -> None:
    register_classes(CLASSES)


def unregister() -> None:
    unregister_classes(CLASSES)
