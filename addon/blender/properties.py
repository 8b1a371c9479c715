"""scene.photon_splat: what the user sets, and how it becomes
core.render.settings.RenderSettings.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..core.render.settings import Backend, FinalGather, RenderSettings
from .registration import register_classes, unregister_classes

DEFAULTS = RenderSettings()
CLICK = RenderSettings(passes=4096, error_threshold=0.045, denoise=True)
"""What a click on Render gives, where nothing has been set."""


def _tell(settings: Any, _: Any) -> None:
    """Marks the scene as changed: Blender does not do so by itself for dependency graphs that it
    keeps (Persistent Data).
    """
    settings.id_data.update_tag()


class PhotonSplatSettings(bpy.types.PropertyGroup):
    """Render settings of the engine; the render stops at whichever of passes and time limit comes
    first.
    """

    time_limit: FloatProperty(  # type: ignore[valid-type]
        name="Time Limit",
        description="Stop each view layer after this many seconds, export included; 0 = no limit",
        default=DEFAULTS.time_limit,
        min=0.0,
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
        update=_tell,
    )
    error_threshold: FloatProperty(  # type: ignore[valid-type]
        name="Error Threshold",
        description="Stop when the estimated relative error of the picture is this small: of the "
        "denoised one each pixel's over its own brightness; without Denoise the RMS error over the "
        "mean brightness. 0 = off. Left at its default it does not end a render for which passes "
        "or a time limit have been set",
        default=CLICK.error_threshold,
        min=0.0,
        soft_max=0.5,
        precision=4,
        update=_tell,
    )
    passes: IntProperty(  # type: ignore[valid-type]
        name="Passes",
        description="Number of passes: each takes one camera sample per pixel and traces a new "
        "set of photons",
        default=CLICK.passes,
        min=1,
        soft_max=4096,
        update=_tell,
    )
    photons_per_pass: IntProperty(  # type: ignore[valid-type]
        name="Photons per Pass",
        description="Number of photon paths that start at the lights in the first pass; those "
        "that follow have as many as pay",
        default=DEFAULTS.photons_per_pass,
        min=0,
        soft_max=10_000_000,
        update=_tell,
    )
    max_bounces: IntProperty(  # type: ignore[valid-type]
        name="Max Bounces",
        description="Greatest number of surface bounces between light and camera; 0 = direct "
        "light only",
        default=DEFAULTS.max_bounces,
        min=0,
        soft_max=128,
        max=1024,
        update=_tell,
    )
    radius_scale: FloatProperty(  # type: ignore[valid-type]
        name="Radius Scale",
        description="Multiplies the automatic radius of the photon discs (1 = automatic): smaller "
        "is sharper and noisier",
        default=DEFAULTS.radius_scale,
        min=0.001,
        soft_min=0.1,
        soft_max=10.0,
        max=1000.0,
        update=_tell,
    )
    boundary_correction: BoolProperty(  # type: ignore[valid-type]
        name="Boundary Correction",
        description="Divide by the part of the disc that lies on the surface, so that edges and "
        "corners do not darken",
        default=DEFAULTS.boundary_correction,
        update=_tell,
    )
    adaptive_indirect: BoolProperty(  # type: ignore[valid-type]
        name="Adaptive Indirect Light",
        description="Let paths from the camera find the indirect light where surfaces are too "
        "small, too bent or too dark for photons",
        default=DEFAULTS.adaptive_indirect,
        update=_tell,
    )
    final_gather: EnumProperty(  # type: ignore[valid-type]
        name="Final Gather",
        description="Camera paths take one more bounce before photons light them: noisier, but "
        "without blur (final renders only)",
        items=[
            (
                FinalGather.AUTO.value,
                "Automatic",
                "Where the picture is denoised; without photons where that is less work",
            ),
            (FinalGather.ON.value, "On", "Always"),
            (FinalGather.OFF.value, "Off", "Photons light what the camera sees"),
        ],
        default=DEFAULTS.final_gather.value,
        update=_tell,
    )
    denoise: BoolProperty(  # type: ignore[valid-type]
        name="Denoise",
        description="Run Open Image Denoise on the finished picture",
        default=CLICK.denoise,
        update=_tell,
    )
    backend: EnumProperty(  # type: ignore[valid-type]
        name="Backend",
        description="What splats the photons and denoises the picture",
        items=[
            (
                Backend.AUTO.value,
                "Automatic",
                "The fastest: the processor splats photons, a graphics card denoises the picture",
            ),
            (Backend.CPU.value, "CPU", "The processor does all"),
            (Backend.GPU.value, "GPU", "The graphics card splats photons, too"),
        ],
        default=DEFAULTS.backend.value,
        update=_tell,
    )
    seed: IntProperty(  # type: ignore[valid-type]
        name="Seed",
        description="Another seed gives other noise; the same seed and number of passes give the "
        "same picture bit for bit",
        default=DEFAULTS.seed,
        min=0,
        update=_tell,
    )
    viewport_passes: IntProperty(  # type: ignore[valid-type]
        name="Viewport Passes",
        description="Number of passes that refine the picture in the viewport while nothing "
        "changes",
        default=64,
        min=1,
        soft_max=4096,
        update=_tell,
    )
    viewport_photons_per_pass: IntProperty(  # type: ignore[valid-type]
        name="Viewport Photons per Pass",
        description="Number of photon paths that start at the lights in the first pass that "
        "refines the viewport",
        default=100_000,
        min=0,
        soft_max=10_000_000,
        update=_tell,
    )
    viewport_time_limit: FloatProperty(  # type: ignore[valid-type]
        name="Viewport Time Limit",
        description="Stop refining the picture in the viewport after this many seconds; 0 = no "
        "limit",
        default=0.0,
        min=0.0,
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
        update=_tell,
    )
    viewport_denoise: BoolProperty(  # type: ignore[valid-type]
        name="Viewport Denoise",
        description="Remove noise from the picture in the viewport while nothing changes, with "
        "Open Image Denoise",
        default=True,
        update=_tell,
    )
    point_spacing: FloatProperty(  # type: ignore[valid-type]
        name="Point Spacing",
        description="Distance of gather points in kernel radii; 0 = one point per camera sample",
        default=DEFAULTS.point_spacing,
        min=0.0,
        max=1.0,
        update=_tell,
    )


class PhotonSplatFarmSettings(bpy.types.PropertyGroup):
    """Renders that last long, or on many machines."""

    use_checkpoint: BoolProperty(  # type: ignore[valid-type]
        name="Checkpoint",
        description="Keep what a final render has done in a file now and then and when it is "
        "cancelled, until the render is finished",
        default=False,
    )
    checkpoint: StringProperty(  # type: ignore[valid-type]
        name="File",
        description="OpenEXR file of the checkpoint, with # for the number of the frame",
        default="//checkpoint_####.exr",
        subtype="FILE_PATH",
    )
    checkpoint_minutes: FloatProperty(  # type: ignore[valid-type]
        name="Minutes Between",
        description="Time between two checkpoints, minutes",
        default=10.0,
        min=0.0,
        soft_max=60.0,
    )
    resume: BoolProperty(  # type: ignore[valid-type]
        name="Resume",
        description="Go on from the checkpoint if it is there, and refuse one of another scene; "
        "off: begin anew and replace it",
        default=True,
    )
    system: EnumProperty(  # type: ignore[valid-type]
        name="Scheduler",
        description="What the job is written for",
        items=[
            ("openjd", "Open Job Description", "For openjd and AWS Deadline Cloud"),
            ("flamenco", "Flamenco", "For Flamenco 3, Blender Studio's"),
            ("slurm", "Slurm", "For clusters with Slurm"),
        ],
    )
    kind: EnumProperty(  # type: ignore[valid-type]
        name="Job",
        description="What the machines share",
        items=[
            ("STILL", "Still", "The current frame in parts, which are merged"),
            ("ANIMATION", "Animation", "Whole frames of the scene's range"),
        ],
    )
    parts: IntProperty(  # type: ignore[valid-type]
        name="Parts",
        description="Parts of the picture, which machines render at the same time",
        default=8,
        min=1,
        max=1024,
    )
    chunk: IntProperty(  # type: ignore[valid-type]
        name="Frames per Task",
        description="Frames that one machine renders after the other",
        default=5,
        min=1,
        soft_max=100,
    )
    folder: StringProperty(  # type: ignore[valid-type]
        name="Folder",
        description="Where the job is written; results go into output in there",
        default="//farm",
        subtype="DIR_PATH",
    )


class PhotonSplatViewLayerSettings(bpy.types.PropertyGroup):
    """The engine's own passes, switched on per view layer."""

    use_pass_photon_density: BoolProperty(  # type: ignore[valid-type]
        name="Photon Density",
        description="Deliver the number of photons found around each point, per pass",
        default=False,
    )
    use_pass_surface_id: BoolProperty(  # type: ignore[valid-type]
        name="Surface ID",
        description="Deliver a number per surface patch: photons count only for points on their "
        "own patch",
        default=False,
    )
    use_pass_error: BoolProperty(  # type: ignore[valid-type]
        name="Error",
        description="Deliver the estimated error of each pixel's luminance, noise and blur "
        "together",
        default=False,
    )


CLASSES = (PhotonSplatSettings, PhotonSplatFarmSettings, PhotonSplatViewLayerSettings)


def render_settings(scene: Any, view_layer: Any = None) -> RenderSettings:
    """The settings of a bpy.types.Scene, with what one of its view layers overrides; raises
    ValueError if they do not make sense.
    """
    group, render = scene.photon_splat, scene.render
    spacing = group.point_spacing
    return RenderSettings(
        passes=_passes(scene, view_layer),
        time_limit=group.time_limit,
        error_threshold=_threshold(group, bool(_layer_samples(scene, view_layer))),
        photons_per_pass=group.photons_per_pass,
        max_bounces=group.max_bounces,
        radius_scale=group.radius_scale,
        boundary_correction=group.boundary_correction,
        adaptive_indirect=group.adaptive_indirect,
        final_gather=FinalGather(group.final_gather),
        denoise=group.denoise,
        backend=Backend(group.backend),
        seed=group.seed,
        threads=render.threads if render.threads_mode == "FIXED" else 0,
        point_spacing=DEFAULTS.point_spacing
        if abs(spacing - DEFAULTS.point_spacing) < 1e-6
        else spacing,
    )


def _layer_samples(scene: Any, view_layer: Any) -> int:
    """Samples that a view layer overrides the scene's with, 0 for none. Cycles' setting, where it
    is there, may tell that they do not count.
    """
    use = getattr(getattr(scene, "cycles", None), "use_layer_samples", "USE")
    return 0 if view_layer is None or use == "IGNORE" else int(view_layer.samples)


def _passes(scene: Any, view_layer: Any) -> int:
    passes, samples = int(scene.photon_splat.passes), _layer_samples(scene, view_layer)
    bounded = getattr(getattr(scene, "cycles", None), "use_layer_samples", "USE") == "BOUNDED"
    return min(samples, passes) if samples and bounded else samples or passes


def _threshold(group: PhotonSplatSettings, has_samples: bool) -> float:
    """Who sets another limit, and not this one, wants the best picture within that."""
    others = group.time_limit or has_samples or group.is_property_set("passes")
    given = group.is_property_set("error_threshold")
    return round(float(group.error_threshold), 7) if given or not others else 0.0


def viewport_settings(scene: Any) -> RenderSettings:
    """RenderSettings of the viewport: passes, photons and time limit of its own, everything else as
    in `render_settings`.
    """
    group = scene.photon_splat
    return replace(
        render_settings(scene),
        passes=group.viewport_passes,
        photons_per_pass=group.viewport_photons_per_pass,
        time_limit=group.viewport_time_limit,
        error_threshold=0.0,
        denoise=group.viewport_denoise,
    )


def register() -> None:
    register_classes(CLASSES)
    bpy.types.Scene.photon_splat = bpy.props.PointerProperty(
        type=PhotonSplatSettings, name="Photon Splat"
    )
    bpy.types.Scene.photon_splat_farm = bpy.props.PointerProperty(
        type=PhotonSplatFarmSettings, name="Photon Splat, Farm"
    )
    bpy.types.ViewLayer.photon_splat = bpy.props.PointerProperty(
        type=PhotonSplatViewLayerSettings, name="Photon Splat"
    )


def unregister() -> None:
    for owner in (bpy.types.ViewLayer, bpy.types.Scene):
        for name in ("photon_splat", "photon_splat_farm"):
            if hasattr(owner, name):
                delattr(owner, name)
    unregister_classes(CLASSES)
