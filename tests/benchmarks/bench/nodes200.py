"""What a hit on a shader of 200 nodes costs, beside Cycles' on the same one: `python -m
tests.benchmarks.bench.nodes200`.

Processor time of all threads, so that other work on the machine does not count; of two numbers of
samples, so that start-up does not. The picture is a plane that fills the view and shines, so that
every sample is one hit and one run of the shader.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import replace
from typing import Any

SIZE = 128
SAMPLES = (16, 144)
LIMIT = 2.0
"""Of Cycles' time per hit."""


def build(blocks: int) -> int:
    """A file with a plane of `blocks` blocks of ten nodes in a row; how many nodes that are."""
    import bpy

    from blend_scenes.scripts import modelling as m

    m.new_scene(SIZE, SIZE)
    material, tree, output = m._node_material("Two hundred")
    add, link = tree.nodes.new, tree.links.new
    where = add("ShaderNodeTexCoord").outputs["Object"]
    color: Any = None
    for k in range(blocks):
        mapping = add("ShaderNodeMapping")
        mapping.inputs["Rotation"].default_value = (0.1 * k, 0.2, 0.3)
        noise = add("ShaderNodeTexNoise")
        noise.inputs["Scale"].default_value = 3.0 + k
        wave, ramp, mix = add("ShaderNodeMath"), add("ShaderNodeValToRGB"), add("ShaderNodeMix")
        hue, bright, gamma = (
            add("ShaderNodeHueSaturation"),
            add("ShaderNodeBrightContrast"),
            add("ShaderNodeGamma"),
        )
        shift, rescale = add("ShaderNodeVectorMath"), add("ShaderNodeMapRange")
        wave.operation, shift.operation, mix.data_type = "SINE", "MULTIPLY_ADD", "RGBA"
        hue.inputs["Hue"].default_value = 0.5 + 0.01 * k
        bright.inputs["Contrast"].default_value = 0.01
        gamma.inputs["Gamma"].default_value = 1.05
        shift.inputs[1].default_value = (1.01, 0.99, 1.0)
        link(where, mapping.inputs["Vector"])
        link(mapping.outputs["Vector"], noise.inputs["Vector"])
        link(noise.outputs[0], rescale.inputs["Value"])
        link(rescale.outputs[0], wave.inputs[0])
        link(wave.outputs[0], ramp.inputs[0])
        link(ramp.outputs["Color"], hue.inputs["Color"])
        link(hue.outputs[0], bright.inputs["Color"])
        link(bright.outputs[0], gamma.inputs["Color"])
        first, second, result = mix.inputs[6], mix.inputs[7], mix.outputs[2]
        link(gamma.outputs[0], second)
        if color is not None:
            link(color, first)
        color = result
        link(mapping.outputs["Vector"], shift.inputs[0])
        where = shift.outputs[0]
    emission = add("ShaderNodeEmission")
    if color is not None:
        link(color, emission.inputs["Color"])
    link(emission.outputs[0], output.inputs["Surface"])
    m.add_picture("Plane", [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], material)
    m.add_camera((0, 0, 2), (0, 0, 0), lens=50.0)
    return len(bpy.data.materials["Two hundred"].node_tree.nodes) - 1  # but for the output


def seconds(engine: str, samples: int) -> float:
    """Processor seconds of a render call."""
    import bpy
    from photon_splat.blender.job import observer
    from photon_splat.core.render.settings import Integrator

    scene = bpy.context.scene
    scene.render.engine = engine
    if engine == "CYCLES":
        cycles = scene.cycles
        cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising, cycles.max_bounces = (
            samples,
            False,
            False,
            0,
        )
    else:
        observer.settings = lambda plain: replace(
            plain,
            integrator=Integrator.REFERENCE,
            passes=samples,
            time_limit=0.0,
            error_threshold=0.0,
            denoise=False,
            max_bounces=0,
        )
    began = time.process_time()
    bpy.ops.render.render()
    return time.process_time() - began


def microseconds_per_hit(engine: str, blocks: int) -> float:
    build(blocks)
    seconds(engine, 1)
    low, high = (min(seconds(engine, n) for _ in range(3)) for n in SAMPLES)
    return 1e6 * (high - low) / ((SAMPLES[1] - SAMPLES[0]) * SIZE * SIZE)


def main() -> int:
    import photon_splat

    photon_splat.register()
    nodes = build(20)
    figures: dict[str, Any] = {"nodes": nodes}
    for name, engine in (("ours", "PHOTON_SPLAT"), ("cycles", "CYCLES")):
        whole, bare = microseconds_per_hit(engine, 20), microseconds_per_hit(engine, 0)
        figures[name] = {"us_per_hit": round(whole, 2), "of_it_shader": round(whole - bare, 2)}
    ratio = figures["ours"]["us_per_hit"] / figures["cycles"]["us_per_hit"]
    print(json.dumps(figures | {"times_cycles": round(ratio, 2), "limit": LIMIT}))
    return 0 if ratio <= LIMIT else 1


if __name__ == "__main__":
    sys.exit(main())
