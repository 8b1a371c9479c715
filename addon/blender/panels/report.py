"""What a render told: its figures, and what of the scene was approximated, with a click to where
that is.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

import bpy

from ...core.render.statistics import Statistics
from ..job import last_renders
from ..registration import add_handlers, register_classes, remove_handlers, unregister_classes
from ..told import names_in, told
from ..viewport.live import lives
from .base import RenderPanel, paragraph, translated


class PHOTON_SPLAT_OT_select(bpy.types.Operator):
    bl_idname = "photon_splat.select"
    bl_label = "Select What Was Approximated"
    bl_description = (
        "Select the objects that are named, or that use the materials named, and show the material"
    )
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    name: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Names", description="Of objects and materials, a line each"
    )

    @classmethod
    def poll(cls, context: Any) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Selecting objects needs Object Mode")
            return False
        return True

    def execute(self, context: Any) -> set[str]:
        names = self.name.split("\n")
        found = list(users(context, names))
        if not found:
            text = translated("No object of this view layer is named or uses '{name}'")
            self.report({"WARNING"}, text.format(name="', '".join(names)))
            return {"CANCELLED"}
        for ob in context.view_layer.objects:
            ob.select_set(False)
        for ob, slot in found:
            ob.select_set(True)
            if slot is not None:
                ob.active_material_index = slot
        context.view_layer.objects.active = found[0][0]
        return {"FINISHED"}


class PHOTON_SPLAT_PT_last_render(RenderPanel, bpy.types.Panel):
    bl_label = "Last Render"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.scene.name in last_renders

    def draw(self, context: Any) -> None:
        layout, last = self.layout, last_renders[context.scene.name]
        if last.error:
            paragraph(layout, last.error, "ERROR")
        column = layout.column(align=True)
        for line in statistics_lines(last.statistics):
            column.label(text=line, translate=False)


class PHOTON_SPLAT_PT_plan(RenderPanel, bpy.types.Panel):
    bl_label = "Scene Plan"
    bl_parent_id = "PHOTON_SPLAT_PT_last_render"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        last = last_renders.get(context.scene.name)
        return bool(super().poll(context) and last and last.statistics)

    def draw(self, context: Any) -> None:
        statistics = last_renders[context.scene.name].statistics
        for sentence in statistics["plan"]["sentences"] if statistics else ():
            paragraph(self.layout, sentence)


class PHOTON_SPLAT_PT_approximations(RenderPanel, bpy.types.Panel):
    bl_label = "Approximated"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(super().poll(context) and warnings(context.scene.name))

    def draw(self, context: Any) -> None:
        for warning in warnings(context.scene.name):
            row = self.layout.row(align=True)
            paragraph(row, warning, "INFO")
            names = named(warning)
            if names:
                row.operator(
                    PHOTON_SPLAT_OT_select.bl_idname, text="", icon="RESTRICT_SELECT_OFF"
                ).name = "\n".join(names)


def warnings(scene: str) -> list[str]:
    """Those of the last render, or of the viewports if there was none, one a kind."""
    last = last_renders.get(scene)
    if last is not None:
        return last.warnings
    return told(warning for live in lives for warning in live.warnings)


def named(warning: str) -> list[str]:
    """The objects and materials of this file that a warning names."""
    return [
        name for name in names_in(warning) if name in bpy.data.objects or name in bpy.data.materials
    ]


def users(context: Any, names: Collection[str]) -> Iterator[tuple[Any, int | None]]:
    """The objects of the view layer of those names, or with a material of such a name and its slot;
    those first that are named first.
    """
    place = {name: k for k, name in reversed(list(enumerate(names)))}
    found: list[tuple[int, int, Any, int | None]] = []
    for ob in context.view_layer.objects:
        slots = [
            (place[slot.material.name], k)
            for k, slot in enumerate(ob.material_slots)
            if slot.material and slot.material.name in place
        ]
        if slots or ob.name in place:
            first, slot = min(slots) if slots else (len(place), None)
            found.append((min(first, place.get(ob.name, len(place))), len(found), ob, slot))
    for _, _, ob, slot in sorted(found, key=lambda one: one[:2]):
        yield ob, slot


def statistics_lines(statistics: Statistics | None) -> Iterator[str]:
    """The figures of a render as short lines."""
    if statistics is None:
        return
    seconds, photons = statistics["seconds"], statistics["photons"]
    line = translated("{passes} passes {state} {seconds:.1f} s on {threads} threads, {backend}")
    yield line.format(
        passes=statistics["passes"],
        state=translated("cancelled after") if statistics["cancelled"] else translated("in"),
        seconds=seconds["total"],
        threads=statistics["threads"],
        backend=statistics["backend"],
    )
    if error := statistics["error"]["relative_rmse"]:
        line = translated("Estimated error {error:.2g} % of the mean brightness")
        yield line.format(error=100 * error)
    if left := statistics["error"].get("denoised"):
        line = translated("Denoised about {error:.2g} % of each pixel's brightness")
        yield line.format(error=100 * left)
    line = translated("{traced:,} photons traced, {stored:,} stored, {rays:,} rays")
    yield line.format(traced=photons["traced"], stored=photons["stored"], rays=statistics["rays"])
    for name, value in dict(seconds).items():
        if name != "total" and isinstance(value, float) and value >= 0.005:
            yield f"    {translated(name.capitalize())}: {value:.2f} s"
    yield translated("Peak memory {memory:,.0f} MiB").format(
        memory=statistics["peak_memory_bytes"] / 2**20
    )


CLASSES = (
    PHOTON_SPLAT_OT_select,
    PHOTON_SPLAT_PT_approximations,
    PHOTON_SPLAT_PT_last_render,
    PHOTON_SPLAT_PT_plan,
)


def _forget(*_: Any) -> None:
    """Another file has other scenes, maybe of the same names."""
    last_renders.clear()


HANDLERS = (("load_pre", _forget),)


def register() -> None:
    register_classes(CLASSES)
    add_handlers(HANDLERS)


def unregister() -> None:
    remove_handlers(HANDLERS)
    unregister_classes(CLASSES)
    last_renders.clear()
