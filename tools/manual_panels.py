"""Runs inside a Blender with a window, which it fills with one Properties editor: renders a scene
and takes pictures of the panels. blender --python manual_panels.py -- OUTPUT_FOLDER
"""

from __future__ import annotations

import os
import subprocess
import sys
import traceback
from collections.abc import Iterator
from typing import Any

import bpy

FOLDER = sys.argv[sys.argv.index("--") + 1]


def properties() -> Any:
    return bpy.context.window_manager.windows[0].screen.areas[0]


def fill_window() -> None:
    """Leaves no other editor and no bar in the window."""
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "PROPERTIES"
    with bpy.context.temp_override(window=window, screen=window.screen, area=area):
        bpy.ops.screen.screen_full_area(use_hide_panels=True)


def show(tab: str, name: str) -> Iterator[float]:
    properties().spaces.active.context = tab
    yield 0.5
    bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=2)
    yield 0.5
    subprocess.run(["import", "-window", "root", f"{FOLDER}/{name}.png"], check=True)


def something_unsupported() -> None:
    """A node that the panel Approximated names."""
    tree = bpy.data.materials["Glaze"].node_tree
    portal = tree.nodes.new("ShaderNodeBsdfRayPortal")
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(portal.outputs[0], output.inputs["Surface"])


def steps() -> Iterator[float]:
    bpy.ops.wm.open_mainfile(filepath="blend_scenes/interior.blend")
    yield 1.0
    fill_window()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 640, 360
    something_unsupported()
    bpy.ops.render.render()
    yield 1.0
    yield from show("RENDER", "render_properties")
    layer = bpy.context.view_layer
    for name in ("Sun", "Sky"):
        if name not in layer.lightgroups:
            layer.lightgroups.add(name=name)
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_indirect = True
    layer.photon_splat.use_pass_error = True
    yield from show("VIEW_LAYER", "view_layer")


def tick(work: Iterator[float] = steps()) -> float | None:  # noqa: B008
    try:
        return next(work)
    except StopIteration:
        status = 0
    except BaseException:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    os._exit(status)


bpy.app.timers.register(tick, first_interval=2.0, persistent=True)
