"""Inputs of closures beyond the range of their sliders, as links bring them: as bright as in
Cycles.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.support import stage
from tests.support.corescene import Integrator, shoot

PRINCIPLED, METALLIC = "ShaderNodeBsdfPrincipled", "ShaderNodeBsdfMetallic"
GLASS = "ShaderNodeBsdfGlass"
BLACK, FILM = {"Roughness": 0.3, "Base Color": (0.0, 0.0, 0.0)}, {"Thin Film Thickness": 450.0}


def _sheet(node: str, inputs: dict[str, Any]) -> None:
    """A square of one closure, given by links, under an area lamp on the other side."""
    import bpy
    from mathutils import Vector

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(16, 16)
    material, tree = stage.empty_material("Sheet")
    shader = tree.nodes.new(node)
    stage.surface(tree, shader)
    for name, value in inputs.items():
        if isinstance(value, tuple):
            given = tree.nodes.new("ShaderNodeCombineXYZ")
            for socket, component in zip(given.inputs, value, strict=True):
                socket.default_value = component
        else:
            given = tree.nodes.new("ShaderNodeValue")
            given.outputs[0].default_value = value
        tree.links.new(given.outputs[0], shader.inputs[name])
    stage.plane(half=2.0).data.materials[0] = material
    lamp, camera = stage.lamp("AREA", 300.0, (-4.0, 1.0, 3.0)), stage.camera((4.0, 0.3, 3.2))
    lamp.data.size, camera.data.angle = 3.0, 0.5
    for ob in (lamp, camera):
        ob.rotation_euler = Vector(ob.location).to_track_quat("Z", "Y").to_euler()
    bpy.context.view_layer.update()


@pytest.mark.parametrize(
    ("node", "inputs"),
    [
        (PRINCIPLED, {"Roughness": 0.4, "Coat Weight": 3.0, "Coat Tint": (0.5, 0.5, 0.5)}),
        (PRINCIPLED, {"Roughness": 0.4, "Coat Weight": 0.5, "Coat Tint": (1.4, 1.2, -0.3)}),
        (PRINCIPLED, {"Sheen Weight": 10.0, "Sheen Tint": (1.5, 0.6, -0.3)}),
        (METALLIC, {"Roughness": 0.5, "Anisotropy": -0.5}),
        (METALLIC, {"Roughness": 0.5, "Anisotropy": 1.5}),
    ],
)
def test_closures_out_of_range_are_as_bright_as_in_cycles(
    node: str, inputs: dict[str, Any]
) -> None:
    """Once wrong by 2 to 25 %."""
    _expect_cycles(node, inputs)


@pytest.mark.parametrize(
    ("node", "inputs"),
    [
        (PRINCIPLED, BLACK | FILM | {"IOR": 1.0}),
        (PRINCIPLED, BLACK | FILM | {"Specular IOR Level": 0.0}),
        (PRINCIPLED, BLACK | FILM | {"IOR": 1.0, "Transmission Weight": 1.0}),
        (GLASS, {"Roughness": 0.3, "IOR": 1.0} | FILM),
    ],
)
def test_a_film_reflects_where_nothing_under_it_does(node: str, inputs: dict[str, Any]) -> None:
    """As soap bubbles are made. Once black."""
    _expect_cycles(node, inputs, samples=400)


def _expect_cycles(node: str, inputs: dict[str, Any], samples: int = 96) -> None:
    import bpy
    from photon_splat.export import export_scene

    from tests.reference.agreement.run import beside_cycles

    _sheet(node, inputs)
    _, pictures = beside_cycles(export_scene(bpy.context.evaluated_depsgraph_get()), samples)
    means = [picture.mean((0, 1)) for picture in pictures]
    ours, cycles = means[0] + means[1], means[2] + means[3]
    assert cycles.all()
    assert ours == pytest.approx(cycles, rel=0.012)


@pytest.mark.parametrize("integrator", list(Integrator))
def test_light_below_zero_is_seen(integrator: Integrator) -> None:
    """As where vectors are shown by their emission. Once 0."""
    import bpy
    from photon_splat.export import export_scene

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(4, 4)
    material, tree = stage.empty_material("Vector")
    vector, emission = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("CombineXYZ", "Emission"))
    for socket, value in zip(vector.inputs, (-0.2, 0.3, -0.4), strict=True):
        socket.default_value = value
    tree.links.new(vector.outputs[0], emission.inputs[0])
    stage.surface(tree, emission)
    stage.plane(half=4.0).data.materials[0] = material
    stage.camera((0.0, 0.0, 2.0))
    bpy.context.view_layer.update()
    seen = shoot(export_scene(bpy.context.evaluated_depsgraph_get()), integrator, passes=2, seed=1)
    assert seen.passes["Combined"][..., :3] == pytest.approx(
        np.broadcast_to((-0.2, 0.3, -0.4), (4, 4, 3)), abs=1e-6
    )
