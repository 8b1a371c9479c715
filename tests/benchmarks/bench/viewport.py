"""How fast the viewport is, without a window: python -m tests.benchmarks.bench.viewport
[SCENE.blend ...] [--edits N]

At 960x540: seconds from an edit to the first picture of it, of which Blender's own thread is held
by the export; pictures a second while the camera orbits. Medians. Drawing is not in it (make
viewport-test).
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests.support.paths import ROOT
from tests.support.window import Viewport, projection_matrix, viewport

WIDTH, HEIGHT = 960, 540


def main() -> None:
    import bpy
    import photon_splat

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "scenes",
        nargs="*",
        type=Path,
        default=[ROOT / f"blend_scenes/{name}.blend" for name in ("cornell_box", "interior")],
    )
    parser.add_argument("--edits", type=int, default=20, help="of each kind")
    options = parser.parse_args()
    photon_splat.register()
    for path in options.scenes:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()))
        bpy.context.scene.render.engine = "PHOTON_SPLAT"
        bpy.context.scene.photon_splat.viewport_passes = 2
        measure(path.stem, options.edits)
    photon_splat.unregister()


def measure(name: str, edits: int) -> None:
    import bpy

    scene = bpy.context.scene
    eye = np.array(scene.camera.matrix_world)
    x = 0.018 * 0.1 / 0.035
    window = projection_matrix(-x, x, -x * HEIGHT / WIDTH, x * HEIGHT / WIDTH, 0.1, 1000)
    lamp = bpy.data.lights.new("Edited", "POINT")
    lamp.energy = 1.0
    scene.collection.objects.link(bpy.data.objects.new("Edited", lamp))
    mesh = max(
        (ob for ob in scene.objects if ob.type == "MESH"), key=lambda ob: len(ob.data.vertices)
    )
    changes: dict[str, Callable[[int], Any]] = {
        "light": lambda k: setattr(lamp, "energy", 1.0 + k),
        "object moved": lambda k: setattr(mesh, "location", (0.001 * k, 0, 0)),
        "mesh": lambda k: (
            setattr(mesh.data.vertices[0], "co", (0.001 * k, 0, 0)),
            mesh.data.update(),
        ),
    }
    with viewport(width=WIDTH, height=HEIGHT, eye=eye, window=window) as v:
        wait(v, 0)
        for kind, change in changes.items():
            times, exports = [], []
            for k in range(edits):
                before, began = number(v), time.monotonic()
                change(k)
                bpy.context.view_layer.update()
                wait(v, before)
                times.append(time.monotonic() - began)
                exports.append(v.live.seconds["export"])
                time.sleep(0.3)
            print(
                f"{name}: {kind}: first picture after {np.median(times):.3f} s, export "
                f"{1000 * np.median(exports):.1f} ms"
            )
        v.settle()
        first, traced, began, k = (
            number(v),
            v.live.controller.counts.photon_paths,
            time.monotonic(),
            0,
        )
        while time.monotonic() - began < 3.0:
            k += 1
            turned = eye.copy()
            angle = 0.3 * math.sin(0.05 * k)
            turned[:3, :3] = (
                np.array(
                    [
                        [math.cos(angle), -math.sin(angle), 0],
                        [math.sin(angle), math.cos(angle), 0],
                        [0, 0, 1],
                    ]
                )
                @ eye[:3, :3]
            )
            v.context.region_data.view_matrix = np.linalg.inv(turned).astype(np.float32)
            v.draw()
            time.sleep(0.005)
        rate = (number(v) - first) / (time.monotonic() - began)
        step, traced = (
            v.live.controller.picture().step,
            v.live.controller.counts.photon_paths - traced,
        )  # type: ignore[union-attr]
        print(
            f"{name}: orbiting: {rate:.1f} pictures/s in pixels {step} wide, {traced} photon "
            "paths traced"
        )


def number(v: Viewport) -> int:
    picture = v.live.controller.picture()
    return picture.number if picture else 0


def wait(v: Viewport, before: int) -> None:
    while number(v) == before:
        v.draw()
        time.sleep(0.001)


if __name__ == "__main__":
    main()
