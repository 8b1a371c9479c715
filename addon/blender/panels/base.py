"""What the panels have in common."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy

from ..engine import ENGINE

LINE_WIDTH = 60  # characters


class RenderPanel:
    """A panel in the properties editor's render tab."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES


def split_layout(panel: Any) -> Any:
    """The panel's layout, with names at the left and values at the right."""
    panel.layout.use_property_split = True
    panel.layout.use_property_decorate = False
    return panel.layout


def paragraph(layout: Any, text: str, icon: str = "NONE") -> None:
    """`text` over as many lines as it takes."""
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, LINE_WIDTH)):
        column.label(text=line, icon=icon if number == 0 else "BLANK1", translate=False)


def translated(text: str) -> str:
    """A string of the interface in the user's language, where there is a translation of it."""
    return str(bpy.app.translations.pgettext_iface(text))
