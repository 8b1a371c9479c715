"""Blender's dependency graph -> core.scene.Scene: the only way from Blender's data into the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..core.scene import Scene
from ..report import Report

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..core.scene import Camera, Frame
    from .kept import Kept


def export_scene(depsgraph: Any, camera: Any = None, frame: Frame | None = None, kept: Kept | None = None) -> Scene:
    """Export what `depsgraph` (evaluated) holds, seen through `camera` (default: the scene's); `kept` as in export_contents.

    Raises ValueError with one sentence if there is nothing to look through; whatever else cannot be rendered is named in
    the result's `warnings`.
    """
    from .camera import export_camera, export_frame

    report = Report()
    scene = depsgraph.scene_eval
    seen = export_camera(camera or scene.camera, scene, report)
    return export_contents(depsgraph, seen, frame or export_frame(scene.render), report, kept)


def export_contents(
    depsgraph: Any, camera: Camera, frame: Frame, report: Report, kept: Kept | None = None, visible: Callable[[Any], bool] | None = None
) -> Scene:
    """What `depsgraph` holds, for a camera that need not be Blender's.

    kept     what exports before made and this one may use; None: nothing
    visible  says of an instance of the graph whether it is to be seen; None: all are
    """
    from .images import Textures
    from .kept import Kept
    from .materials import Materials, Shading
    from .objects import Objects
    from .world import export_world

    kept = kept or Kept()
    scene = depsgraph.scene_eval
    view_layer = depsgraph.view_layer_eval
    if len(view_layer.lightgroups):
        report.warn("Light groups are not supported; they give no passes of their own")
    exported = Scene(camera, frame)
    textures = Textures(report, kept)
    shading = Shading(textures, report, depsgraph)
    materials = Materials(shading)
    objects = Objects(materials, shading, kept)
    objects.collect(depsgraph, visible)
    objects.collect_shading(depsgraph, shading.around.wants, *shading.wanted)
    export_world(getattr(view_layer, "world_override", None) or scene.world, shading, exported)
    exported.meshes, exported.instances = objects.meshes, objects.instances()
    exported.material_sets, exported.lights = objects.material_sets, objects.lights
    exported.materials, exported.textures, exported.programs = materials.list, textures.list, shading.programs
    exported.warnings = report.messages()
    return exported
