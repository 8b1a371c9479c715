"""The sun of a Sky Texture in a world that is more than the sky: as bright as in Cycles."""

from __future__ import annotations

from typing import Any

import pytest

from tests.support import stage
from tests.support.corescene import shoot


def _camera_sees_grey(tree: Any, sky: Any, background: Any) -> None:
    asked, mixed = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeMix")
    mixed.data_type = "RGBA"
    mixed.inputs["B"].default_value = (0.2, 0.2, 0.2, 1.0)
    tree.links.new(asked.outputs["Is Camera Ray"], mixed.inputs["Factor"])
    tree.links.new(sky.outputs[0], mixed.inputs["A"])
    tree.links.new(mixed.outputs["Result"], background.inputs["Color"])


def _tinted(tree: Any, sky: Any, background: Any) -> None:
    tint = tree.nodes.new("ShaderNodeVectorMath")
    tint.operation = "MULTIPLY"
    tint.inputs[1].default_value = (1.0, 0.6, 0.3)
    tree.links.new(sky.outputs[0], tint.inputs[0])
    tree.links.new(tint.outputs[0], background.inputs["Color"])


def _turned_and_added(tree: Any, sky: Any, background: Any) -> None:
    place, turn, more, both = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("TexCoord", "Mapping", "Background", "AddShader")
    )
    turn.inputs["Rotation"].default_value = (0.3, 0.0, 1.0)
    tree.links.new(place.outputs["Generated"], turn.inputs["Vector"])
    tree.links.new(turn.outputs[0], sky.inputs[0])
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    output = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    tree.links.new(background.outputs[0], both.inputs[0])
    tree.links.new(more.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], output.inputs["Surface"])


@pytest.mark.parametrize("build", [_camera_sees_grey, _tinted, _turned_and_added])
def test_the_sun_is_there(build: Any) -> None:
    """A cube on a plane. Once the sun's disc was left out of such worlds, with a warning: a fifth
    of the light was there.
    """
    import bpy
    from photon_splat.export import export_scene

    from tests.reference.cycles.references import render_with_cycles

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24, 24)
    stage.plane("Floor", 4.0)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.5))
    stage.camera((0.0, 0.0, 6.0))
    stage.world(0.1)
    tree = bpy.context.scene.world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    if sky.sky_type in {"PREETHAM", "HOSEK_WILKIE"}:
        sky.sky_type = "NISHITA"
    sky.sun_elevation, sky.sun_rotation, sky.sun_size = 0.7, 0.8, 0.03
    build(tree, sky, next(node for node in tree.nodes if node.type == "BACKGROUND"))
    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    assert what.warnings == []
    ours = shoot(what, passes=48, seed=1).passes["Combined"][..., :3]
    cycles = render_with_cycles(512, 21)[..., :3]
    for channel in range(3):
        assert ours[..., channel].mean() == pytest.approx(cycles[..., channel].mean(), rel=0.01)
