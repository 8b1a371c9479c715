"""Blender's dependency graph -> core.scene.Scene: the only way from Blender's data into the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..core.scene import Scene
from ..report import Report

if TYPE_CHECKING:
    from ..core.scene import Frame


def export_scene(depsgraph: Any, camera: Any = None, frame: Frame | None = None) -> Scene:
    """Export what `depsgraph` (evaluated) holds, seen through `camera` (default: the scene's).

    Raises ValueError with one sentence if there is nothing to look through; whatever else cannot be rendered is named in
    the result's `warnings`.
    """
    from .camera import export_camera, export_frame
    from .images import Textures
    from .materials import Materials
    from .objects import Objects
    from .world import export_world

    report = Report()
    scene = depsgraph.scene_eval
    view_layer = depsgraph.view_layer_eval
    exported = Scene(export_camera(camera or scene.camera, scene, report), frame or export_frame(scene.render))
    textures = Textures(report)
    materials = Materials(textures, report)
    objects = Objects(materials, textures, report)
    objects.collect(depsgraph)
    exported.world = export_world(getattr(view_layer, "world_override", None) or scene.world, textures, report)
    exported.meshes, exported.instances = objects.meshes, objects.instances()
    exported.material_sets, exported.lights = objects.material_sets, objects.lights
    exported.materials, exported.textures = materials.list, textures.list
    exported.warnings = report.messages()
    return exported
