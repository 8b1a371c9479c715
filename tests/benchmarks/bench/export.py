"""Seconds that the export of a million triangles takes, flat and smooth, with a UV map. Needs
bpy.
"""

from __future__ import annotations

import time
from statistics import median
from typing import Any

import numpy as np

SECONDS_LIMIT = 0.25
COLUMNS, ROWS = 1000, 500
REPEATS = 5


def _wavy_sheet(smooth: bool) -> None:
    """A scene with a camera and a sheet of half a million quads, not quite flat."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=COLUMNS, y_subdivisions=ROWS, size=10)
    mesh = bpy.context.object.data
    places = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", places)
    p = places.reshape(-1, 3)
    p[:, 2] = 0.2 * np.sin(3 * p[:, 0]) * np.cos(4 * p[:, 1])
    mesh.vertices.foreach_set("co", places)
    mesh.update()
    if smooth:
        mesh.shade_smooth()
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)


def measure() -> dict[str, Any]:
    """Median seconds of `REPEATS` exports of each kind after one that warms Blender's caches, which
    is given, too.
    """
    import bpy
    from photon_splat.export import export_scene

    figures: dict[str, Any] = {}
    for kind in ("flat", "smooth"):
        _wavy_sheet(kind == "smooth")
        seconds = []
        for _ in range(REPEATS + 1):
            depsgraph = bpy.context.evaluated_depsgraph_get()
            began = time.perf_counter()
            scene = export_scene(depsgraph)
            seconds.append(time.perf_counter() - began)
        triangles = sum(len(scene.meshes[m].triangles) for m in scene.instances.mesh)
        figures[kind] = {
            "triangles": triangles,
            "first_seconds": seconds[0],
            "seconds": median(seconds[1:]),
        }
    return figures | {
        "kept": all(max(f["first_seconds"], f["seconds"]) < SECONDS_LIMIT for f in figures.values())
    }
