"""The scene for the rivals, from our own exporter: `python -m tests.benchmarks.chart.rivals.export
SCENE.blend WIDTH HEIGHT OUT.pickle`.

Writes, by method, what its describe() makes of the scene: plain data that the rivals' own Python
reads, or why there is none.
"""

from __future__ import annotations

import os
import pickle
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests.benchmarks.chart.rivals import RIVALS, of
from tests.benchmarks.chart.rivals.exact import NoCounterpartError, exact

if TYPE_CHECKING:
    from photon_splat.core.scene import Scene

BOUNCES = 64


def main(arguments: list[str]) -> None:
    import bpy
    import photon_splat
    from photon_splat.export import export_scene

    blend, width, height, output = arguments
    photon_splat.register()
    bpy.ops.wm.open_mainfile(filepath=blend)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = (
        int(width),
        int(height),
        100,
    )
    render.use_border = False
    Path(output).write_bytes(
        pickle.dumps(described(export_scene(bpy.context.evaluated_depsgraph_get())))
    )


def described(scene: Scene) -> dict[str, dict[str, Any] | str]:
    try:
        said = exact(scene)
    except NoCounterpartError as error:
        return dict.fromkeys(RIVALS, str(error))
    made: dict[str, dict[str, Any] | str] = {}
    for method in RIVALS:
        try:
            made[method] = of(method).describe(said, method, BOUNCES)
        except NoCounterpartError as error:
            made[method] = str(error)
    return made


if __name__ == "__main__":
    main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # Blender may hang or die at exit
