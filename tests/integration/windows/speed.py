"""Processor time of the Cornell box by Cycles and by this engine, in turn: speed.py FILE.

Writes one JSON object: the least of several renders of each, in seconds, without the first. Time of
processors, unlike that on the wall, is hardly longer where others use the machine.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

ROUNDS = 2
SCENE = Path(__file__).resolve().parents[3] / "blend_scenes" / "cornell_box.blend"


def main(output: Path) -> None:
    import bpy
    import photon_splat

    bpy.ops.wm.open_mainfile(filepath=str(SCENE))
    photon_splat.register()
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 192
    scene.render.resolution_percentage = 100
    scene.cycles.samples, scene.cycles.use_denoising = 48, False
    scene.cycles.use_adaptive_sampling = False
    ours = scene.photon_splat
    ours.passes, ours.time_limit, ours.error_threshold, ours.denoise = 8, 0.0, 0.0, False
    ours.backend = "CPU"
    seconds: dict[str, list[float]] = {"CYCLES": [], "PHOTON_SPLAT": []}
    for _ in range(1 + ROUNDS):
        for engine, found in seconds.items():
            scene.render.engine = engine
            began = time.process_time()
            bpy.ops.render.render()
            found.append(time.process_time() - began)
    output.write_text(json.dumps({engine: min(found[1:]) for engine, found in seconds.items()}))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
    sys.stdout.flush()
    os._exit(0)
