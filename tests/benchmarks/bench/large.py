"""What large scenes take before the first picture, beside Cycles in the same run: `python -m
tests.benchmarks.bench.large [SCENE ...]`.

Seconds and peak memory of a render call of one sample in 64 x 36 pixels, over what the same process
had before, which is Blender's own copy of the scene. Each figure is the least of three processes.

    strands  a million strands of four keys
    ground   a mesh of five million triangles that a texture displaces
    diced    a square that is subdivided adaptively to eight million, and displaced
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

ENGINES = ("PHOTON_SPLAT", "CYCLES")
SCENES = ("strands", "ground", "diced")
LIMIT = 1.2
"""Of Cycles' seconds, and of its memory."""
TRIES = 3
STRANDS, KEYS = 1_000_000, 4
SIDE = 1581  # faces of the ground
EDGE = 2.0 / 2000  # of the square's sides, when it is diced


def build(name: str) -> None:
    import bpy

    from blend_scenes.scripts import modelling as m

    scene = m.new_scene(64, 36)
    {"strands": _strands, "ground": _ground, "diced": _diced}[name]()
    m.add_camera((0, -2.5, 1.5), (0, 0, 0), lens=50.0)
    m.set_world((1.0, 1.0, 1.0))
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 1, False, False
    bpy.context.view_layer.update()


def _strands() -> None:
    import bpy

    from blend_scenes.scripts import modelling as m

    curves = bpy.data.hair_curves.new("Strands")
    curves.add_curves([KEYS] * STRANDS)
    chance = np.random.default_rng(1)
    roots = np.zeros((STRANDS, 1, 3), np.float32)
    roots[..., :2] = chance.uniform(-1, 1, (STRANDS, 1, 2))
    lean = chance.normal(0.0, 0.02, (STRANDS, 1, 3)).astype(np.float32)
    along = np.linspace(0, 1, KEYS, dtype=np.float32)[None, :, None]
    places = roots + along * np.array([0, 0, 0.1], np.float32) + along**2 * lean
    curves.attributes["position"].data.foreach_set("vector", places.ravel())
    radius = curves.attributes.get("radius") or curves.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.full(STRANDS * KEYS, 5e-4, np.float32))
    curves.materials.append(m.diffuse("Brown", (0.4, 0.25, 0.1)))
    m.add_object("Strands", curves)


def _moved() -> Any:
    from blend_scenes.scripts import modelling as m

    material, tree, output = m._node_material("Moved")
    add, link = tree.nodes.new, tree.links.new
    shader, node, noise = (
        add(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "Displacement", "TexNoise")
    )
    noise.inputs["Scale"].default_value = 8.0
    node.inputs["Scale"].default_value = 0.1
    link(noise.outputs[0], node.inputs["Height"])
    link(shader.outputs[0], output.inputs["Surface"])
    link(node.outputs[0], output.inputs["Displacement"])
    material.displacement_method = "DISPLACEMENT"
    return material


def _ground() -> None:
    import bpy

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=SIDE, y_subdivisions=SIDE, size=2.0)
    ground = bpy.context.object
    ground.data.materials.append(_moved())


def _diced() -> None:
    import bpy

    bpy.ops.mesh.primitive_plane_add(size=2.0)
    ground = bpy.context.object
    ground.data.materials.append(_moved())
    modifier = ground.modifiers.new("Adaptive", "SUBSURF")
    modifier.subdivision_type, modifier.levels, modifier.render_levels = "SIMPLE", 0, 0
    modifier.use_adaptive_subdivision, modifier.adaptive_space = True, "OBJECT"
    modifier.adaptive_object_edge_length = EDGE


def measure(name: str, engine: str) -> dict[str, float]:
    """Seconds and MiB of the render call."""
    import bpy
    import photon_splat
    from photon_splat.blender.job import observer
    from photon_splat.core.render.memory import current_memory_bytes

    photon_splat.register()
    build(name)
    scene = bpy.context.scene
    scene.render.engine = engine

    def settings(plain: Any) -> Any:
        return replace(
            plain, passes=1, photons_per_pass=1000, error_threshold=0.0, denoise=False, seed=1
        )

    observer.settings = settings
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    before, began, used = current_memory_bytes(), time.monotonic(), time.process_time()
    bpy.ops.render.render()
    return {
        "seconds": time.monotonic() - began,
        "cpu": time.process_time() - used,
        "MiB": (_peak() - before) / 2**20,
    }


def _peak() -> int:
    """Bytes; on Linux alone can it be told apart from that of building the scene."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def main(names: list[str]) -> int:
    bad = 0
    for name in names or SCENES:
        best: dict[str, dict[str, float]] = {}
        for _ in range(TRIES):
            for engine in ENGINES:
                command = [sys.executable, "-m", "tests.benchmarks.bench.large", "--one", name]
                said = subprocess.run(
                    [*command, engine], stdout=subprocess.PIPE, text=True, check=True
                )
                found = json.loads(said.stdout.strip().splitlines()[-1])
                kept = best.setdefault(engine, found)
                best[engine] = {key: min(value, kept[key]) for key, value in found.items()}
        ours, theirs = (best[engine] for engine in ENGINES)
        times = {key: round(ours[key] / theirs[key], 2) for key in ours}
        bad += times["seconds"] > LIMIT or times["MiB"] > LIMIT
        rounded = {e: {k: round(v, 1) for k, v in best[e].items()} for e in ENGINES}
        print(json.dumps({"scene": name, **rounded, "times": times}), flush=True)
    return int(bad > 0)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(*sys.argv[2:4])))
    else:
        sys.exit(main(sys.argv[1:]))
