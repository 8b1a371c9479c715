"""Panels of the render tab: how much is computed, and with what."""

from __future__ import annotations

from typing import Any

import bpy

from ...core.gpu.context import may_have_hardware
from ...core.render.memory import current_memory_bytes, peak_memory_bytes
from ..job import last_renders
from ..registration import register_classes, unregister_classes
from .base import RenderPanel, split_layout, translated
from .presets import PHOTON_SPLAT_PT_presets


class PHOTON_SPLAT_PT_sampling(RenderPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw_header_preset(self, context: Any) -> None:
        PHOTON_SPLAT_PT_presets.draw_panel_header(self.layout)

    def draw(self, context: Any) -> None:
        pass


class PHOTON_SPLAT_PT_sampling_viewport(RenderPanel, bpy.types.Panel):
    bl_label = "Viewport"
    bl_parent_id = "PHOTON_SPLAT_PT_sampling"

    def draw(self, context: Any) -> None:
        layout, settings = split_layout(self), context.scene.photon_splat
        layout.prop(settings, "viewport_passes", text="Passes")
        layout.prop(settings, "viewport_time_limit", text="Time Limit")
        layout.prop(settings, "viewport_photons_per_pass", text="Photons per Pass")
        layout.prop(settings, "viewport_denoise", text="Denoise")


class PHOTON_SPLAT_PT_sampling_render(RenderPanel, bpy.types.Panel):
    bl_label = "Render"
    bl_parent_id = "PHOTON_SPLAT_PT_sampling"

    def draw(self, context: Any) -> None:
        layout, settings = split_layout(self), context.scene.photon_splat
        layout.prop(settings, "error_threshold")
        layout.prop(settings, "passes")
        layout.prop(settings, "time_limit")
        layout.prop(settings, "photons_per_pass")
        layout.prop(settings, "denoise")


class PHOTON_SPLAT_PT_sampling_advanced(RenderPanel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_parent_id = "PHOTON_SPLAT_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        layout, settings = split_layout(self), context.scene.photon_splat
        layout.prop(settings, "seed")
        layout.prop(settings, "radius_scale")
        layout.prop(settings, "point_spacing")
        layout.prop(settings, "boundary_correction")
        layout.prop(settings, "adaptive_indirect")
        layout.prop(settings, "final_gather")


class PHOTON_SPLAT_PT_light_paths(RenderPanel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        split_layout(self).prop(context.scene.photon_splat, "max_bounces")


class PHOTON_SPLAT_PT_film(RenderPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        layout, scene = split_layout(self), context.scene
        cycles = getattr(scene, "cycles", None)
        layout.prop(scene.render, "film_transparent", text="Transparent")
        if cycles is None:
            layout.prop(scene.render, "filter_size", text="Filter Width (px)")
            return
        column = layout.column()
        column.active = scene.render.film_transparent
        column.prop(cycles, "film_transparent_glass", text="Transparent Glass")
        column.prop(cycles, "film_transparent_roughness", text="Roughness Threshold")
        layout.prop(cycles, "film_exposure", text="Exposure")
        layout.prop(cycles, "pixel_filter_type", text="Pixel Filter")
        row = layout.row()
        row.active = cycles.pixel_filter_type != "BOX"
        row.prop(cycles, "filter_width", text="Filter Width (px)")


class PHOTON_SPLAT_PT_performance(RenderPanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        layout, scene = split_layout(self), context.scene
        layout.prop(scene.photon_splat, "backend")
        layout.label(text=graphics(scene.name), icon="INFO", translate=False)
        layout.prop(scene.render, "threads_mode")
        row = layout.row()
        row.enabled = scene.render.threads_mode == "FIXED"
        row.prop(scene.render, "threads")
        layout.prop(scene.render, "preview_pixel_size", text="Viewport Pixel Size")
        layout.prop(scene.render, "use_persistent_data")
        memory = translated("Memory: {now:,.0f} MiB now, {most:,.0f} MiB at most")
        layout.label(
            text=memory.format(
                now=current_memory_bytes() / 2**20, most=peak_memory_bytes() / 2**20
            ),
            translate=False,
        )


def graphics(scene: str) -> str:
    """What is known of the graphics card without asking it: its name, from the last render that
    used it.
    """
    last = last_renders.get(scene)
    if last and last.statistics:
        splatter, denoiser = last.statistics.get("gpu"), last.statistics.get("denoiser", "")
        name = splatter["renderer"] if splatter else denoiser
        if name not in ("", "CPU"):
            return translated("The last render used {name}").format(name=name)
    if not may_have_hardware():
        return translated("This machine shows no graphics card")
    return translated("The graphics card is named here after a render with it")


CLASSES = (
    PHOTON_SPLAT_PT_sampling,
    PHOTON_SPLAT_PT_sampling_viewport,
    PHOTON_SPLAT_PT_sampling_render,
    PHOTON_SPLAT_PT_sampling_advanced,
    PHOTON_SPLAT_PT_light_paths,
    PHOTON_SPLAT_PT_film,
    PHOTON_SPLAT_PT_performance,
)


def register() -> None:
    register_classes(CLASSES)


def unregister() -> None:
    unregister_classes(CLASSES)
