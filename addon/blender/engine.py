"""The render engine as Blender sees it. It only delegates: Blender makes and drops engines as it
likes.
"""

from __future__ import annotations

from typing import Any

import bpy

from .job import render_view_layer
from .passes import blender_name, kind, wanted_passes
from .registration import register_classes, unregister_classes
from .viewport import live_of

ENGINE = "PHOTON_SPLAT"


class PhotonSplatEngine(bpy.types.RenderEngine):
    """Photon splatting for final renders and previews."""

    bl_idname = ENGINE
    bl_label = "Photon Splat"
    bl_use_preview = True
    bl_use_postprocess = True
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False
    bl_use_spherical_stereo = True

    def render(self, depsgraph: Any) -> None:
        render_view_layer(self, depsgraph)

    def update_render_passes(self, scene: Any = None, renderlayer: Any = None) -> None:
        for info in wanted_passes(scene, renderlayer):
            self.register_pass(
                scene,
                renderlayer,
                blender_name(info.name),
                len(info.channels),
                info.channels,
                kind(info),
            )

    def view_update(self, context: Any, depsgraph: Any) -> None:
        live_of(self).update(context, depsgraph)

    def view_draw(self, context: Any, depsgraph: Any) -> None:
        live = live_of(self)
        if live.is_new:  # Blender has loaded a file or the like since its last update
            live.update(context, depsgraph)
        live.draw(self, context, depsgraph)


def register() -> None:
    register_classes([PhotonSplatEngine])


def unregister() -> None:
    unregister_classes([PhotonSplatEngine])
