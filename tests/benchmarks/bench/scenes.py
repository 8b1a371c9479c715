"""Scenes for measurements: from .blend files, exported once, or made here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from photon_splat.core.scene import LightKind, Mesh, Scene

from tests.support import corescene as c
from tests.support.paths import ROOT


def from_blend(name: str, width: int | None = None, height: int | None = None) -> Scene:
    """blend_scenes/NAME.blend as the exporter sees it. Needs bpy."""
    return from_file(ROOT / "blend_scenes" / f"{name}.blend", width, height)


def from_file(path: Path, width: int | None = None, height: int | None = None) -> Scene:
    """Any .blend file as the exporter sees it; a width alone keeps its shape. Needs bpy."""
    import bpy
    from photon_splat.export import export_scene

    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    render = bpy.context.scene.render
    if width:
        x, y = render.resolution_x, render.resolution_y
        render.resolution_x, render.resolution_y = width, height or max(round(width * y / x), 1)
        render.resolution_percentage = 100
    return export_scene(bpy.context.evaluated_depsgraph_get())


def bumpy_globe_in_a_box() -> Scene:
    """131,072 untextured triangles of an uneven globe in a grey box, under an area lamp: rays go
    everywhere.
    """
    globe = c.globe(0.6, 7)
    p = globe.positions.astype(np.float64)
    p *= (
        1
        + 0.06
        * np.sin(9 * p[:, :1] / 0.6)
        * np.cos(8 * p[:, 1:2] / 0.6)
        * np.sin(7 * p[:, 2:] / 0.6 + 1)
    ).astype(np.float64)
    bumpy = Mesh("globe", p.astype(np.float32), globe.triangles)
    view = c.perspective((0.0, -0.95, 0.1), (0.0, 0.0, 0.0), 256, 256, 1.3)
    lamp = c.lamp(LightKind.AREA, 20.0, (0.0, 0.0, 0.98), size=(0.5, 0.5))
    return c.scene(
        view,
        [(c.box((-1, -1, -1), (1, 1, 1), inwards=True), c.lambert(0.7)), (bumpy, c.lambert(0.7))],
        [lamp],
    )
