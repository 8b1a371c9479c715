"""Blender's dependency graph -> core.scene.Scene: the only way from Blender's data into the
engine.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..core.scene import Scene
from .report import Report

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..core.scene import Camera, Frame
    from .cancelled import Watch
    from .kept import Kept
    from .motion import Moving
    from .shutter import Blur, FrameSet
    from .views import View


def export_scene(
    depsgraph: Any,
    camera: Any = None,
    frame: Frame | None = None,
    kept: Kept | None = None,
    watch: Watch | None = None,
    frame_set: FrameSet | None = None,
    view: View | None = None,
) -> Scene:
    """Export what `depsgraph` (evaluated) holds, seen through `camera` (default: the scene's);
    `kept` and `watch` as in export_contents; in one view of several if there is a `view`.
    `frame_set` takes the graph to other frames, for motion blur and motion vectors; None:
    everything stands still.

    Raises ValueError with one sentence if there is nothing to look through; whatever else cannot be
    rendered is named in the result's `warnings`.
    """
    from .shutter import blur_of

    blur = blur_of(depsgraph) if frame_set is not None else None
    if blur is None or frame_set is None:
        return _export_still(depsgraph, camera, frame, Report(), kept, watch, view=view)
    return _export_moving(depsgraph, camera, frame, kept, watch, frame_set, blur, view)


def _export_still(
    depsgraph: Any,
    camera: Any,
    frame: Frame | None,
    report: Report,
    kept: Kept | None,
    watch: Watch | None,
    moving: Moving | None = None,
    view: View | None = None,
) -> Scene:
    from .camera import export_camera, export_frame
    from .culling import kept_by_culling
    from .visibility import wants_shadow_pass

    scene = depsgraph.scene_eval
    frame = frame or export_frame(scene, depsgraph.view_layer)
    seen = export_camera(camera or scene.camera, scene, report, view, (frame.width, frame.height))
    # Here and below, of originals: a graph that Blender keeps is not told when they change.
    light_groups = [group.name for group in depsgraph.view_layer.lightgroups]
    exported = export_contents(
        depsgraph,
        seen,
        frame,
        report,
        kept,
        kept_by_culling(scene, seen),
        light_groups=light_groups,
        watch=watch,
        moving=moving,
        with_labels=True,
    )
    exported.shadow_pass = wants_shadow_pass(depsgraph.view_layer)
    return exported


def _export_moving(
    depsgraph: Any,
    camera: Any,
    frame: Frame | None,
    kept: Kept | None,
    watch: Watch | None,
    frame_set: FrameSet,
    blur: Blur,
    view: View | None,
) -> Scene:
    """All is described as it is at the middle of the shutter's opening; then the graph is looked at
    at other times.
    """
    from .cancelled import Watch
    from .motion import Moving
    from .shutter import other_times

    watch, report = watch or Watch(), Report()
    # the same all of the time
    eye: Any = getattr(camera or depsgraph.scene_eval.camera, "original", None)
    with other_times(depsgraph, frame_set) as go:
        if blur.centre:
            go(blur.centre)
            kept = None  # what is kept is that of whole frames
        moving = Moving(depsgraph, blur, report, view)
        now = None if eye is None else eye.evaluated_get(depsgraph)
        scene = _export_still(depsgraph, now, frame, report, kept, watch, moving, view)
        moving.add_camera(eye.evaluated_get(depsgraph), Report())
        for time in moving.times():
            watch.go_on()
            go(blur.centre + 0.5 * blur.shutter * time)
            moving.see(depsgraph, eye, time, watch.go_on)
    if blur.vectors and scene.labels is not None:
        scene.labels.neighbours = moving.neighbours(scene)
    elif not blur.vectors:
        moving.move(scene, depsgraph.scene.render)
    scene.warnings, scene.missing = report.messages(), report.messages(of_missing=True)
    return scene


def export_contents(
    depsgraph: Any,
    camera: Camera,
    frame: Frame,
    report: Report,
    kept: Kept | None = None,
    visible: Callable[[Any], bool] | None = None,
    light_groups: Sequence[str] = (),
    watch: Watch | None = None,
    moving: Moving | None = None,
    with_labels: bool = False,
) -> Scene:
    """What `depsgraph` holds, for a camera that need not be Blender's.

    kept     what exports before made and this one may use; None: nothing
    visible  says of an instance of the graph whether it is to be seen; None: all are
    light_groups  names of those whose light is to be kept apart
    watch    raises Cancelled, through this, where the export is to stop; None: it goes on
    moving   is told of all instances
    with_labels  if the view layer asks for passes of data
    """
    from .cancelled import Watch
    from .hair_shaders import report_hair_shaders
    from .images import Textures
    from .kept import Kept
    from .labels import Labelled, aovs, wanted
    from .materials import Materials, Shading
    from .nodes.aovs import report_aovs_of_world
    from .nodes.links import uses_nodes
    from .objects import Objects
    from .world import export_world

    kept, watch = kept or Kept(), watch or Watch()
    scene = depsgraph.scene_eval
    view_layer = depsgraph.view_layer_eval
    exported = Scene(camera, frame, light_groups=list(light_groups))
    textures = Textures(report, kept, watch)
    shading = Shading(textures, report, depsgraph, watch)
    labelled = Labelled() if with_labels and wanted(view_layer) else None
    materials = Materials(shading, aovs(view_layer) if labelled else ())
    objects = Objects(materials, shading, kept, exported.light_groups, moving, labelled)
    objects.collect(depsgraph, visible)
    objects.collect_shading(depsgraph, shading.around.wants, shading.wanted_of_instances)
    objects.displace(depsgraph, camera, frame)
    world = getattr(view_layer, "world_override", None) or scene.world
    if not view_layer.use_sky:
        world = None
    export_world(world, shading, exported)
    if world is not None and world.original.lightgroup in exported.light_groups:
        exported.world_light_group = exported.light_groups.index(world.original.lightgroup)
    exported.meshes, exported.instances = objects.meshes, objects.instances()
    exported.material_sets, exported.lights = objects.material_sets, objects.lights
    exported.materials, exported.textures, exported.programs = (
        materials.list,
        textures.list,
        shading.programs,
    )
    report_hair_shaders(exported, report)
    if getattr(getattr(scene, "cycles", None), "use_fast_gi", False):
        report.warn("Fast GI Approximation is not used: all indirect light is traced")
    if labelled is not None:
        if world is not None and uses_nodes(world):
            names = (name for name, _ in aovs(view_layer))
            report_aovs_of_world(world, world.node_tree, names, report)
        exported.labels = labelled.labels(
            view_layer, scene, materials.list, materials.aov_programs()
        )
    exported.warnings, exported.missing = report.messages(), report.messages(of_missing=True)
    return exported
