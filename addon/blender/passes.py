"""The render passes as Blender sees them: one table for their registration and for the render
result.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np

from ..core.render.result import (
    NOISY_PASS,
    PASSES,
    SHADOW_PASS,
    Passes,
    PassInfo,
    RenderResult,
    light_group_pass,
)
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
    "Glossy Color": "use_pass_glossy_color",
    "Transmission Direct": "use_pass_transmission_direct",
    "Transmission Indirect": "use_pass_transmission_indirect",
    "Transmission Color": "use_pass_transmission_color",
    "Emission": "use_pass_emit",
    "Environment": "use_pass_environment",
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


BEFORE_BLENDER_5 = {
    "Object Index": "IndexOB",
    "Material Index": "IndexMA",
    "Diffuse Direct": "DiffDir",
    "Diffuse Indirect": "DiffInd",
    "Diffuse Color": "DiffCol",
    "Glossy Direct": "GlossDir",
    "Glossy Indirect": "GlossInd",
    "Glossy Color": "GlossCol",
    "Transmission Direct": "TransDir",
    "Transmission Indirect": "TransInd",
    "Transmission Color": "TransCol",
    "Volume Direct": "VolumeDir",
    "Volume Indirect": "VolumeInd",
    "Emission": "Emit",
    "Environment": "Env",
    "Ambient Occlusion": "AO",
}
"""Names by which the compositor of an older Blender knows passes."""
NAMES = BEFORE_BLENDER_5 if bpy.app.version < (5, 0) else {}
OWN_NAMES = {theirs: own for own, theirs in NAMES.items()}


def blender_name(name: str) -> str:
    """Of a pass in this Blender."""
    return NAMES.get(name, name)


def own_name(name: str) -> str:
    """Of what this Blender calls so."""
    return OWN_NAMES.get(name, name)


def fill_passes(blender_result: Any, passes: Passes, view: int = 0) -> None:
    """Copy `passes` (row 0 at the bottom, as Blender has it) into those that the render result has
    of its `view`-th view.
    """
    for layer in blender_result.layers:
        for blender_pass in layer.passes:
            pixels = passes.get(own_name(blender_pass.name))
            if (
                blender_pass.view_id == view
                and pixels is not None
                and pixels.shape[2] == blender_pass.channels
            ):
                blender_pass.rect.foreach_set(np.ascontiguousarray(pixels, np.float32).reshape(-1))


def with_noisy(result: RenderResult) -> Passes:
    """The passes of a result, and NOISY_PASS: the picture itself where it was not denoised."""
    noisy = combined = result.passes["Combined"]
    if result.noisy is not None:
        noisy = np.concatenate([result.noisy, combined[..., 3:]], axis=2)
    return result.passes | {NOISY_PASS.name: noisy}


def wanted_passes(scene: Any, view_layer: Any) -> Iterator[PassInfo]:
    """The passes that a bpy.types.ViewLayer asks for; Combined and those of its light groups
    always.
    """
    for info in PASSES:
        switch = switch_of(view_layer, info.name)
        if switch is None or getattr(*switch, False):
            yield info
    if wants_shadow_pass(view_layer):
        yield SHADOW_PASS
    if scene.photon_splat.denoise:
        yield NOISY_PASS
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
