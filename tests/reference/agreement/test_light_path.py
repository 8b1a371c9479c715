"""What shines by the ray that sees it: as bright as in Cycles."""

from __future__ import annotations

import math
from typing import Any

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.support import stage
from tests.support.corescene import Integrator, shoot


def _open() -> Any:
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24, 24)
    stage.plane("Floor", 3.0)
    stage.world(0.0)
    seen_from = stage.camera((0.0, -3.0, 1.5))
    seen_from.rotation_euler = (1.1, 0.0, 0.0)
    seen_from.data.angle = 0.9
    return bpy.context.scene


def _node(tree: Any, kind: str, **inputs: Any) -> Any:
    """inputs: `_0`, `_1` ... by number: sockets or values."""
    made = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        socket = made.inputs[int(name[1:])]
        if hasattr(value, "node"):
            tree.links.new(value, socket)
        else:
            socket.default_value = value
    return made


def _math(tree: Any, operation: str, first: Any, second: Any) -> Any:
    made = _node(tree, "Math", _0=first, _1=second)
    made.operation = operation
    return made.outputs[0]


def _shines(strength: Any, place: stage.Point, size: float) -> Any:
    """A plane that looks down; strength(tree, Light Path) -> a socket."""
    import bpy

    made, tree = stage.empty_material("Shines")
    path = tree.nodes.new("ShaderNodeLightPath").outputs
    stage.surface(tree, _node(tree, "Emission", _1=strength(tree, path)))
    bpy.ops.mesh.primitive_plane_add(size=size, location=place, rotation=(math.pi, 0.0, 0.0))
    bpy.context.object.data.materials.append(made)
    return made


def _beside_cycles(integrator: Integrator, samples: int = 1024) -> tuple[float, float]:
    passes = 256 if integrator == Integrator.REFERENCE else 64
    return means_beside_cycles(samples, integrator, passes=passes)


@pytest.mark.parametrize("integrator", list(Integrator))
def test_light_that_fades_with_the_length_of_rays(integrator: Integrator) -> None:
    """Light samples took the length for 0: six times too bright. A ceiling brings it again."""
    import bpy

    _open()
    bpy.ops.mesh.primitive_plane_add(size=6.0, location=(0.0, 0.0, 2.4))
    _shines(
        lambda tree, path: _math(tree, "DIVIDE", 6.0, _math(tree, "ADD", path["Ray Length"], 0.3)),
        (0.0, 0.0, 2.0),
        1.0,
    )
    ours, cycles = _beside_cycles(integrator)
    assert ours == pytest.approx(cycles, rel=0.015)


@pytest.mark.parametrize("integrator", list(Integrator))
def test_light_that_mirrors_alone_see(integrator: Integrator) -> None:
    """On a floor by a mirror: photons bring none of it, as no light sample does."""
    import bpy

    _open()
    _shines(
        lambda tree, path: _math(tree, "MULTIPLY", path["Is Singular Ray"], 8.0),
        (0.0, 1.0, 2.0),
        1.0,
    )
    made, tree = stage.empty_material("Mirror")
    mirror = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    mirror.inputs["Roughness"].default_value = 0.0
    stage.surface(tree, mirror)
    bpy.ops.mesh.primitive_plane_add(
        size=2.5, location=(0.0, 2.0, 1.0), rotation=(math.pi / 2, 0.0, 0.0)
    )
    bpy.context.object.data.materials.append(made)
    ours, cycles = _beside_cycles(integrator, 4096)
    assert cycles > 0.001
    assert ours == pytest.approx(cycles, rel=0.02)


@pytest.mark.parametrize("integrator", list(Integrator))
def test_a_world_that_only_passed_rays_see(integrator: Integrator) -> None:
    """Behind a film, by Transparent Depth. Such a world was taken for a black one."""
    import bpy

    scene = _open()
    tree = scene.world.node_tree
    asked = tree.nodes.new("ShaderNodeLightPath").outputs["Transparent Depth"]
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    tree.links.new(_math(tree, "GREATER_THAN", asked, 0.5), background.inputs["Strength"])
    made, film = stage.empty_material("Film")
    stage.surface(film, film.nodes.new("ShaderNodeBsdfTransparent"))
    bpy.ops.mesh.primitive_plane_add(size=2.0, location=(0.0, 0.0, 1.0))
    bpy.context.object.data.materials.append(made)
    ours, cycles = _beside_cycles(integrator)
    assert cycles > 0.01
    assert ours == pytest.approx(cycles, rel=0.015)


@pytest.mark.parametrize("integrator", list(Integrator))
def test_what_is_clear_but_for_singular_rays_casts_no_shadow(integrator: Integrator) -> None:
    """A ball that mirrors show and light passes. Photons lost light in it by chance."""
    import bpy

    scene = _open()
    bpy.ops.mesh.primitive_plane_add(size=6.0, location=(0.0, 0.0, 2.4))
    made, tree = stage.empty_material("Ball")
    asked = tree.nodes.new("ShaderNodeLightPath").outputs["Is Singular Ray"]
    mixed = _node(tree, "MixShader", _0=asked)
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    dark = _node(tree, "BsdfDiffuse", _0=(0.0, 0.0, 0.0, 1.0))
    tree.links.new(clear.outputs[0], mixed.inputs[1])
    tree.links.new(dark.outputs[0], mixed.inputs[2])
    stage.surface(tree, mixed)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.7, location=(0.0, 0.5, 1.0))
    bpy.context.object.data.materials.append(made)
    stage.lamp("POINT", 60.0, (0.0, 0.5, 2.2)).data.shadow_soft_size = 0.1
    assert scene is not None
    ours, cycles = _beside_cycles(integrator)
    assert ours == pytest.approx(cycles, rel=0.01)


def test_fire_counts_in_the_light_group_of_its_object() -> None:
    import bpy
    import numpy as np
    from photon_splat.export import export_scene

    scene = _open()
    made, tree = stage.empty_material("Fire")
    stage.output(tree, _node(tree, "Emission", _1=2.0), "Volume")
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(0.0, 0.5, 0.6))
    fire = bpy.context.object
    fire.data.materials.append(made)
    scene.view_layers[0].lightgroups.add().name = "Fires"
    fire.lightgroup = "Fires"
    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    passes = shoot(what, passes=4, seed=1).passes
    picture = passes["Combined"][..., :3]
    assert picture.mean() > 0.01
    assert np.allclose(passes["Combined_Fires"][..., :3], picture, rtol=1e-3, atol=1e-5)
