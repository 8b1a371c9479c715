"""What lets rays of shadows pass and not others: light comes the way that Cycles finds it."""

from __future__ import annotations

import math

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.support import stage
from tests.support.corescene import Integrator


def _wall(material: object, place: stage.Point, turn: stage.Point, size: stage.Point) -> object:
    import bpy

    bpy.ops.mesh.primitive_plane_add(size=1, location=place, rotation=turn)
    wall = bpy.context.object
    wall.scale = size
    wall.data.materials.append(material)
    return wall


def _room_with_a_hole() -> None:
    """4 x 4 x 3 m, open at +X between y -1 and 1, z 1 and 2.5; a camera looks at the far corner."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24, 24)
    white = stage.material("Wall", (0.7, 0.7, 0.7))
    up, side = math.pi / 2, (0.0, math.pi / 2, 0.0)
    for height in (0.0, 3.0):
        _wall(white, (0, 0, height), (0, 0, 0), (4, 4, 1))
    for y in (-2, 2):
        _wall(white, (0, y, 1.5), (up, 0, 0), (4, 3, 1))
    _wall(white, (-2, 0, 1.5), side, (3, 4, 1))
    _wall(white, (2, 0, 0.5), side, (1, 4, 1))
    _wall(white, (2, 0, 2.75), side, (0.5, 4, 1))
    for y in (-1.5, 1.5):
        _wall(white, (2, y, 1.75), side, (1.5, 1, 1))
    seen_from = stage.camera((-1.8, 0, 1.5))
    seen_from.rotation_euler = (up, 0, 0.6 - up)
    seen_from.data.angle = 1.4


def _glass_unless(kind: str) -> object:
    """Architects' glass: clear for rays of this kind."""
    made, tree = stage.empty_material("Glass")
    glass, clear, mixed, asked = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("BsdfGlass", "BsdfTransparent", "MixShader", "LightPath")
    )
    glass.inputs["Roughness"].default_value = 0.0
    tree.links.new(asked.outputs[f"Is {kind} Ray"], mixed.inputs[0])
    tree.links.new(glass.outputs[0], mixed.inputs[1])
    tree.links.new(clear.outputs[0], mixed.inputs[2])
    stage.surface(tree, mixed)
    return made


def _varied_world() -> None:
    import bpy

    stage.world(1.0)
    tree = bpy.context.scene.world.node_tree
    place, noise = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise"))
    tree.links.new(place.outputs["Generated"], noise.inputs["Vector"])
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(noise.outputs[0], background.inputs["Color"])


def _beside_cycles(integrator: Integrator, samples: int = 1024) -> tuple[float, float]:
    passes = 256 if integrator == Integrator.REFERENCE else 48
    return means_beside_cycles(samples, integrator, passes=passes)


@pytest.mark.parametrize("integrator", list(Integrator))
@pytest.mark.parametrize("varied", [False, True])
def test_a_window_of_glass_that_shadow_rays_pass(varied: bool, integrator: Integrator) -> None:
    """Cycles takes no light samples of a constant world: there the glass keeps off what is not
    refracted. Of a varied one they bring their part, and rays that meet the glass the rest. Once
    photons brought all of it straight, 1.3 times the light.
    """
    import bpy

    _room_with_a_hole()
    bpy.ops.mesh.primitive_cube_add(size=1, location=(2, 0, 1.75))
    pane = bpy.context.object
    pane.scale = (0.02, 2, 1.5)
    pane.data.materials.append(_glass_unless("Shadow"))
    _varied_world() if varied else stage.world(1.0)
    ours, cycles = _beside_cycles(integrator)
    assert ours == pytest.approx(cycles, rel=0.02)


@pytest.mark.parametrize("integrator", list(Integrator))
def test_a_window_of_glass_that_diffuse_rays_pass(integrator: Integrator) -> None:
    """Cycles' diffuse rays find a constant world through it. Light samples that were aimed where it
    had been found met the glass, and .63 of the light was left.
    """
    _room_with_a_hole()
    pane = _wall(_glass_unless("Diffuse"), (2, 0, 1.75), (0, math.pi / 2, 0), (1.5, 2, 1))
    assert pane is not None
    stage.world(1.0)
    ours, cycles = _beside_cycles(integrator)
    assert ours == pytest.approx(cycles, rel=0.02)


@pytest.mark.parametrize("integrator", list(Integrator))
def test_a_constant_world_stays_out_of_a_room_that_casts_no_shadow(integrator: Integrator) -> None:
    import bpy

    _room_with_a_hole()
    pane = _wall(stage.material("Pane"), (2, 0, 1.75), (0, math.pi / 2, 0), (1.5, 2, 1))
    assert pane is not None
    for thing in bpy.context.scene.objects:
        thing.visible_shadow = False
    stage.world(1.0)
    ours, cycles = _beside_cycles(integrator, 32)
    assert cycles < 1e-4
    assert ours < 1e-4


@pytest.mark.parametrize("integrator", list(Integrator))
def test_fog_that_casts_no_shadow_lights_the_walls(integrator: Integrator) -> None:
    """Photons straight from a lamp do not see such a box; what it scatters was missing, .8 of the
    light was left.
    """
    import bpy

    _room_with_a_hole()
    fog, tree = stage.empty_material("Fog")
    scatter = tree.nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Density"].default_value = 0.6
    stage.output(tree, scatter, "Volume")
    bpy.ops.mesh.primitive_cube_add(size=1, location=(1.0, 0, 1.0))
    box = bpy.context.object
    box.scale = (1.6, 2.4, 1.8)
    box.data.materials.append(fog)
    box.visible_shadow = False
    stage.world(0.0)
    sun = stage.lamp("SUN", 10.0)
    sun.data.angle = 0.2
    sun.rotation_euler = (0.0, 1.1, 0.0)
    ours, cycles = _beside_cycles(integrator)
    assert ours == pytest.approx(cycles, rel=0.02)
