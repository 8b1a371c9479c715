"""What passes of data ask for: names and numbers of objects and materials, and the world's mist."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..core.render.result import DATA_PASSES, aov_pass, matte_pass
from ..core.scene import Labels, Material

SWITCHES = {
    "Position": "use_pass_position",
    "UV": "use_pass_uv",
    "Mist": "use_pass_mist",
    "Object Index": "use_pass_object_index",
    "Material Index": "use_pass_material_index",
    "Vector": "use_pass_vector",
    "Ambient Occlusion": "use_pass_ambient_occlusion",
}
FOR_DENOISING = "denoising_store_passes"
"""The switch of Denoising Albedo and Denoising Normal, a property of a view layer's `cycles`."""
MATTES = {
    "CryptoObject": "use_pass_cryptomatte_object",
    "CryptoMaterial": "use_pass_cryptomatte_material",
    "CryptoAsset": "use_pass_cryptomatte_asset",
}
"""Blender's own switches, properties of a view layer."""
POWERS = {"QUADRATIC": 2.0, "LINEAR": 1.0, "INVERSE_QUADRATIC": 0.5}


def wanted(view_layer: Any) -> list[Any]:
    """The passes of data (PassInfo) that a bpy.types.ViewLayer asks for."""
    infos = [info for info in DATA_PASSES if _is_on(view_layer, info.name)]
    for name, switch in MATTES.items():
        if getattr(view_layer, switch):
            infos += [matte_pass(name, i) for i in range(passes_of_matte(view_layer))]
    return infos + [aov_pass(name, is_color) for name, is_color in aovs(view_layer)]


def _is_on(view_layer: Any, name: str) -> bool:
    if name in SWITCHES:
        return bool(getattr(view_layer, SWITCHES[name]))
    return getattr(getattr(view_layer, "cycles", None), FOR_DENOISING, False)


def aovs(view_layer: Any) -> list[tuple[str, bool]]:
    """Names of the passes that materials fill, and whether each is a colour."""
    return [(aov.name, aov.type == "COLOR") for aov in view_layer.aovs if aov.is_valid]


def passes_of_matte(view_layer: Any) -> int:
    """Each holds two ids of a pixel."""
    return math.ceil(view_layer.pass_cryptomatte_depth / 2)


class Labelled:
    """Collects labels, instance by instance."""

    def __init__(self) -> None:
        self._objects: list[str] = []
        self._assets: list[str] = []
        self._indices: list[int] = []

    def add(self, ob: Any) -> None:
        top = ob.original
        while top.parent is not None:
            top = top.parent
        self._objects.append(ob.original.name)
        self._assets.append(top.name)
        self._indices.append(int(ob.original.pass_index))

    def labels(
        self,
        view_layer: Any,
        scene: Any,
        materials: list[Material],
        programs: list[list[int]],
    ) -> Labels:
        mist = (0.0, 100.0, 1.0)
        if scene.world is not None:
            given = scene.world.mist_settings
            mist = (float(given.start), float(given.depth), POWERS[given.falloff])
        world = getattr(view_layer, "world_override", None) or scene.world
        distance = math.inf if world is None else float(world.light_settings.distance)
        return Labels(
            [info.name for info in wanted(view_layer)],
            2 * passes_of_matte(view_layer)
            if any(getattr(view_layer, switch) for switch in MATTES.values())
            else 0,
            np.array(self._indices, np.int32),
            self._objects,
            self._assets,
            np.array([material.pass_index for material in materials], np.int32),
            [material.name for material in materials],
            aovs(view_layer),
            programs,
            float(view_layer.pass_alpha_threshold),
            distance,
            mist=mist,
        )
