"""Scenes of blend_scenes/ under the cameras of reference.VIEWS; and what Cycles sees where formulas
do not reach. Needs bpy.
"""

from __future__ import annotations

import sys

import numpy as np

from tests.reference.caustics.reference import FILTER, FOLDER, PIXELS, VIEWS


def open_view(name: str, *, surface_only: bool = True, pixels: int = PIXELS) -> None:
    """Open the scene and look straight down, through everything above the watched surface unless
    `surface_only` is off.
    """
    import bpy

    from tests.reference.cycles.stages import stage

    view = VIEWS[name]
    stage.open_scene(view.scene)
    scene = bpy.context.scene
    camera, render = scene.camera, scene.render
    height = 2.5
    camera.matrix_world = camera.matrix_world.Translation((*view.middle, height))
    camera.data.type, camera.data.ortho_scale, camera.data.sensor_fit = "ORTHO", view.size, "AUTO"
    camera.data.clip_start = height - view.below if surface_only else 0.1
    render.resolution_x = render.resolution_y = pixels
    scene.cycles.filter_width = FILTER
    bpy.context.view_layer.update()


def without_bent_light(pixels: int, samples: int) -> np.ndarray:
    """The small glass seen by Cycles when the lamp shows neither in nor through the glass: all
    light but the caustic; two halves.
    """
    import bpy

    from tests.reference.cycles.references import render_with_cycles

    halves = []
    for seed in (1, 2):
        open_view("small_glass", pixels=pixels)
        lamp = bpy.data.objects["Lamp"]
        lamp.visible_glossy = lamp.visible_transmission = False
        halves.append(render_with_cycles(samples, seed)[..., :3])
    return np.stack(halves)


def main() -> None:
    halves = without_bent_light(PIXELS, 1024)
    np.savez_compressed(
        FOLDER / "small_glass_rest.npz",
        half_1=halves[0].astype(np.float16),
        half_2=halves[1].astype(np.float16),
    )
    print(f"small_glass_rest: mean {np.mean(halves):.4f}", file=sys.stderr)


if __name__ == "__main__":
    main()
