"""The engine's panels in the properties editor, and Blender's own panels that fit it."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from typing import Any

import bpy

from .engine import ENGINE
from .job import last_renders

LINE_WIDTH = 60  # characters
# Panels of other engines that show just what this one reads, too.
BORROWED = {
    "DATA_PT_EEVEE_light",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
    "VIEWLAYER_PT_override",
}
# Made for engines without settings of their own.
NOT_OURS = {"VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes", "RENDER_PT_gpencil", "RENDER_PT_simplify_greasepencil"}


class RenderPanel:
    """What the panels in the render tab have in common."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES


class PHOTON_SPLAT_PT_sampling(RenderPanel, bpy.types.Panel):
    bl_label = "Photons"

    def draw(self, context: Any) -> None:
        layout, settings = _layout(self), context.scene.photon_splat
        layout.prop(settings, "passes")
        layout.prop(settings, "time_limit")
        layout.prop(settings, "error_threshold")
        layout.prop(settings, "photons_per_pass")
        layout.prop(settings, "max_bounces")
        layout.prop(settings, "seed")


class PHOTON_SPLAT_PT_estimate(RenderPanel, bpy.types.Panel):
    bl_label = "Estimate"

    def draw(self, context: Any) -> None:
        layout, settings = _layout(self), context.scene.photon_splat
        layout.prop(settings, "radius_scale")
        layout.prop(settings, "boundary_correction")
        layout.prop(settings, "point_spacing")


class PHOTON_SPLAT_PT_film(RenderPanel, bpy.types.Panel):
    bl_label = "Film"

    def draw(self, context: Any) -> None:
        layout, render = _layout(self), context.scene.render
        layout.prop(render, "film_transparent", text="Transparent")
        layout.prop(render, "filter_size", text="Filter Width (px)")


class PHOTON_SPLAT_PT_performance(RenderPanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        layout, render = _layout(self), context.scene.render
        layout.prop(context.scene.photon_splat, "backend")
        layout.prop(render, "threads_mode")
        row = layout.row()
        row.enabled = render.threads_mode == "FIXED"
        row.prop(render, "threads")


class PHOTON_SPLAT_PT_last_render(RenderPanel, bpy.types.Panel):
    bl_label = "Last Render"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.scene.name in last_renders

    def draw(self, context: Any) -> None:
        layout, last = self.layout, last_renders[context.scene.name]
        if last.error:
            _paragraph(layout, last.error, "ERROR")
        for line in statistics_lines(last.statistics):
            layout.label(text=line)
        for warning in last.warnings:
            _paragraph(layout, warning, "INFO")


class PHOTON_SPLAT_PT_passes(RenderPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: Any) -> None:
        layout, view_layer = _layout(self), context.view_layer
        column = layout.column(heading="Data")
        column.prop(view_layer, "use_pass_z", text="Depth")
        column.prop(view_layer, "use_pass_normal")
        column.prop(view_layer.photon_splat, "use_pass_surface_id")
        column = layout.column(heading="Light")
        column.prop(view_layer, "use_pass_diffuse_direct", text="Diffuse Direct")
        column.prop(view_layer, "use_pass_diffuse_indirect", text="Diffuse Indirect")
        column.prop(view_layer, "use_pass_diffuse_color", text="Diffuse Color")
        column.prop(view_layer, "use_pass_emit", text="Emission")
        column.prop(view_layer.photon_splat, "use_pass_photon_density")
        column.prop(view_layer.photon_splat, "use_pass_error")


CLASSES = (
    PHOTON_SPLAT_PT_sampling,
    PHOTON_SPLAT_PT_estimate,
    PHOTON_SPLAT_PT_film,
    PHOTON_SPLAT_PT_performance,
    PHOTON_SPLAT_PT_last_render,
    PHOTON_SPLAT_PT_passes,
)


def statistics_lines(statistics: dict[str, Any]) -> Iterator[str]:
    """The statistics of a render as short lines."""
    if not statistics:
        return
    seconds, photons = statistics.get("seconds", {}), statistics.get("photons", {})
    state = "cancelled after" if statistics.get("cancelled") else "in"
    yield f"{statistics.get('passes', 0)} passes {state} {seconds.get('total', 0.0):.1f} s on {statistics.get('threads', 0)} threads"
    yield f"{photons.get('traced', 0):,} photons traced, {photons.get('stored', 0):,} stored, {statistics.get('rays', 0):,} rays"
    yield ", ".join(f"{name} {value:.2f} s" for name, value in seconds.items() if name != "total" and value >= 0.005)
    yield f"Peak memory {statistics.get('peak_memory_bytes', 0) / 2**20:,.0f} MiB"


def _layout(panel: Any) -> Any:
    panel.layout.use_property_split = True
    panel.layout.use_property_decorate = False
    return panel.layout


def _paragraph(layout: Any, text: str, icon: str) -> None:
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, LINE_WIDTH)):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")


def _blender_panels() -> Iterator[Any]:
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        name = panel.__name__
        if isinstance(engines, set) and name not in NOT_OURS and (name in BORROWED or "BLENDER_RENDER" in engines):
            yield panel


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for panel in _blender_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister() -> None:
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if panel not in CLASSES and isinstance(engines, set):
            engines.discard(ENGINE)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    last_renders.clear()
