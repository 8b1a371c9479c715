"""From F12 to the first pixels: one pass of the Cornell box and of a sheet of a million triangles.
Needs bpy.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from tests.benchmarks.bench.export import _wavy_sheet
from tests.benchmarks.bench.scenes import ROOT

LIMITS = {"cornell_box": 0.25, "sheet_1M": 1.0}
RENDERS = 4


def measure() -> dict[str, Any]:
    """Seconds of the render call, export and acceleration structure included, for one pass; the
    first of a process, then the least.
    """
    import bpy
    import photon_splat
    from photon_splat.blender.job import last_renders, observer

    photon_splat.register()
    observer.settings = lambda settings: replace(
        settings, passes=1, time_limit=0.0, error_threshold=0.0, denoise=False
    )
    figures: dict[str, Any] = {}
    for name, size in (("cornell_box", (512, 512)), ("sheet_1M", (960, 540))):
        if name == "cornell_box":
            bpy.ops.wm.open_mainfile(filepath=str(ROOT / "blend_scenes" / "cornell_box.blend"))
        else:
            _wavy_sheet(smooth=True)
            _light_and_aim()
        scene = bpy.context.scene
        scene.render.engine = "PHOTON_SPLAT"
        scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = (
            *size,
            100,
        )
        seconds = []
        for _ in range(RENDERS):
            began = time.monotonic()
            bpy.ops.render.render()
            seconds.append(time.monotonic() - began)
        stages = {
            stage: round(s, 3)
            for stage, s in last_renders[scene.name].statistics["seconds"].items()
        }
        figures[name] = {
            "first_seconds": seconds[0],
            "least_seconds": min(seconds),
            "stages": stages,
        }
    return figures | {
        "kept": all(figures[name]["least_seconds"] < limit for name, limit in LIMITS.items())
    }


def _light_and_aim() -> None:
    import bpy
    from mathutils import Vector

    scene = bpy.context.scene
    light = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
    light.data.energy, light.data.size, light.location = 500.0, 1.0, (2.0, -1.0, 4.0)
    scene.collection.objects.link(light)
    camera = scene.camera
    camera.location = (0.0, -9.0, 4.0)
    camera.rotation_euler = (
        (-camera.location + Vector((0.0, 0.0, 0.2))).to_track_quat("-Z", "Y").to_euler()
    )
