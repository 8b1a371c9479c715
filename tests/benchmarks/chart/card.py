"""Cycles on a graphics card."""

from __future__ import annotations

import bpy

KINDS = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")
"""Interfaces, the faster first where a card has several."""


def use_graphics_card() -> str:
    """The scene is rendered, and denoised, on all cards of the first kind that there is. Returns
    its name. RuntimeError where there is none.
    """
    preferences = bpy.context.preferences.addons["cycles"].preferences
    for kind in KINDS:
        try:
            preferences.compute_device_type = kind
        except TypeError:  # this Blender was built without it
            continue
        preferences.refresh_devices()
        cards = [device for device in preferences.devices if device.type == kind]
        if cards:
            for device in preferences.devices:
                device.use = device.type == kind
            bpy.context.scene.cycles.device = "GPU"
            bpy.context.scene.cycles.denoising_use_gpu = True
            return f"{kind}: {cards[0].name}"
    raise RuntimeError("Cycles finds no graphics card here")
