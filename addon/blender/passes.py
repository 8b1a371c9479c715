"""The render passes as Blender sees them: one table for their registration and for the render
result.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..core.render.result import PASSES, PassInfo, light_group_pass
from ..export.labels import wanted as data_passes

SWITCHES = {
    "Depth": "use_pass_z",
    "Normal": "use_pass_normal",
    "Diffuse Direct": "use_pass_diffuse_direct",
    "Diffuse Indirect": "use_pass_diffuse_indirect",
    "Diffuse Color": "use_pass_diffuse_color",
    "Glossy Direct": "use_pass_glossy_direct",
    "Glossy Indirect": "use_pass_glossy_indirect",
    "Transmission Direct": "use_pass_transmission_direct",
    "Transmission Indirect": "use_pass_transmission_indirect",
    "Emission": "use_pass_emit",
}
"""Blender's own switches, properties of a view layer."""
OWN_SWITCHES = {
    "Photon Density": "use_pass_photon_density",
    "Surface ID": "use_pass_surface_id",
    "Error": "use_pass_error",
}
"""Our own switches, properties of a view layer's `photon_splat`."""


def wanted_passes(view_layer: Any) -> Iterator[PassInfo]:
    """The passes that a bpy.types.ViewLayer asks for; Combined and those of its light groups
    always.
    """
    own = getattr(view_layer, "photon_splat", None)
    for info in PASSES:
        if info.name in OWN_SWITCHES:
            if getattr(own, OWN_SWITCHES[info.name], False):
                yield info
        elif info.name not in SWITCHES or getattr(view_layer, SWITCHES[info.name]):
            yield info
    yield from data_passes(view_layer)
    for group in getattr(view_layer, "lightgroups", ()):
        yield light_group_pass(group.name)


def kind(info: PassInfo) -> str:
    """Blender's type of a pass."""
    return {1: "VALUE", 4: "COLOR"}.get(
        len(info.channels), "VECTOR" if info.channels in {"XYZ", "UVA"} else "COLOR"
    )
