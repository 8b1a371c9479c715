"""The render passes as Blender sees them: one table for their registration and for the render
result.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..core.render.result import PASSES, SHADOW_PASS, PassInfo, light_group_pass
from ..export.labels import wanted as data_passes
from ..export.visibility import wants_shadow_pass

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
CYCLES_SWITCHES = {
    "Volume Direct": "use_pass_volume_direct",
    "Volume Indirect": "use_pass_volume_indirect",
}
"""Those of Cycles, properties of a view layer's `cycles`."""
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
    for info in PASSES:
        switch = switch_of(view_layer, info.name)
        if switch is None or getattr(*switch, False):
            yield info
    if wants_shadow_pass(view_layer):
        yield SHADOW_PASS
    yield from data_passes(view_layer)
    for group in getattr(view_layer, "lightgroups", ()):
        yield light_group_pass(group.name)


def switch_of(view_layer: Any, name: str) -> tuple[Any, str] | None:
    """What switches a pass of the film on, and the name of its property there; None: nothing does.
    The first may be missing.
    """
    if name in OWN_SWITCHES:
        return getattr(view_layer, "photon_splat", None), OWN_SWITCHES[name]
    if name in CYCLES_SWITCHES:
        return getattr(view_layer, "cycles", None), CYCLES_SWITCHES[name]
    return (view_layer, SWITCHES[name]) if name in SWITCHES else None


def kind(info: PassInfo) -> str:
    """Blender's type of a pass."""
    if info.channels in {"XYZ", "UVA", "XYZW"}:
        return "VECTOR"
    return "VALUE" if len(info.channels) == 1 else "COLOR"
