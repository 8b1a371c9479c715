"""Random Blender scenes of what light passes through or is caught by: glass, gloss, coats, mixed
shaders, subsurface scattering, media in things and all around. Runs inside Blender.

Lights are large, so that a path tracer finds the light that sharp lobes gather.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

from tests.support import stage

SIZE = (96, 72)


def build(chance: random.Random) -> Any:
    """A scene of its own on an emptied file; returns it."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    made = stage.scene()
    stage.resize(*SIZE)
    room = chance.random() < 0.5
    _ground(chance, room)
    for _ in range(chance.randint(2, 5)):
        _thing(chance)
    for _ in range(chance.randint(1, 2)):
        _lamp(chance, room)
    stage.world(0.0 if room else chance.choice([0, 0.3, 1]))
    if chance.random() < 0.35:
        _fog(chance, made, room)
    ob = stage.camera((chance.uniform(-1, 1), -3.7, chance.uniform(0.6, 2.4)))
    ob.rotation_euler = (math.pi / 2 - math.atan2(ob.location.z - 0.7, 3.7), 0, 0)
    ob.data.angle = 0.9
    return made


def _color(chance: random.Random, low: float = 0.1, high: float = 0.95) -> tuple[float, ...]:
    return (*(chance.uniform(low, high) for _ in range(3)), 1)


def _ground(chance: random.Random, room: bool) -> None:
    import bpy

    if room:
        bpy.ops.mesh.primitive_cube_add(size=8, location=(0, 0, 4))
    else:
        bpy.ops.mesh.primitive_plane_add(size=chance.choice([5, 40]))
    kind = chance.choice([_plastic, _plastic, _coated, _brushed])
    bpy.context.object.data.materials.append(_material(kind, chance))


def _thing(chance: random.Random) -> None:
    import bpy

    mesh = bpy.ops.mesh
    chance.choice(
        [
            lambda: mesh.primitive_cube_add(size=0.9),
            lambda: mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.5),
            lambda: mesh.primitive_torus_add(major_radius=0.45, minor_radius=0.18),
            lambda: mesh.primitive_monkey_add(size=1),
            lambda: mesh.primitive_cylinder_add(vertices=32, radius=0.4, depth=0.8),
        ]
    )()
    ob = bpy.context.object
    ob.location = (chance.uniform(-1.2, 1.2), chance.uniform(-1.2, 1.2), chance.uniform(0.3, 1.4))
    ob.rotation_euler = [chance.uniform(-3, 3) for _ in range(3)]
    ob.scale = [chance.choice([0.6, 1, 1.3])] * 3
    for face in ob.data.polygons:
        face.use_smooth = True
    if chance.random() < 0.15:
        ob.scale = [1.6] * 3
        ob.data.materials.append(_cloud(chance))
        return
    shaders = [_glass, _glass, _metal, _plastic, _coated, _skin, _frosted, _leaf, _mixed, _glowing]
    kind = chance.choice(shaders)
    made = _material(kind, chance)
    if kind in (_glass, _frosted) and chance.random() < 0.3:
        _fill(made.node_tree, chance, chance.choice([0.3, 1, 4]))
    ob.data.materials.append(made)


def _lamp(chance: random.Random, room: bool) -> None:
    kind = chance.choice(["POINT", "SPOT", "AREA"] + ([] if room else ["SUN"]))
    place = (chance.uniform(-2, 2), chance.uniform(-3, 1), chance.uniform(2.2, 3.6))
    ob = stage.lamp(kind, chance.uniform(0.5, 1.5) * (2 if kind == "SUN" else 150), place)
    ob.rotation_euler = (chance.uniform(-0.3, 0.9), chance.uniform(-0.5, 0.5), 0)
    data = ob.data
    data.color = _color(chance, 0.4)[:3]
    if kind in {"POINT", "SPOT"}:
        data.shadow_soft_size = chance.choice([0.25, 0.5])
    if kind == "SPOT":
        data.spot_size, data.spot_blend = chance.uniform(0.8, 2), chance.random()
    if kind == "AREA":
        data.shape, data.size, data.size_y = "RECTANGLE", chance.uniform(0.6, 2), 0.8
    if kind == "SUN":
        data.angle = chance.choice([0.3, 1])


def _fog(chance: random.Random, made: Any, room: bool) -> None:
    """Through all of the world where that leaves lamps their light, else in a box."""
    import bpy

    if room and chance.random() < 0.5:
        tree = made.world.node_tree
        stage.output(tree, _scatter(tree, chance, chance.choice([0.03, 0.1])), "Volume")
        return
    bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 0, 1))
    ob = bpy.context.object
    ob.scale = (chance.uniform(1, 1.8), chance.uniform(1, 1.5), chance.uniform(0.7, 1.3))
    fog, tree = stage.empty_material("Fog")
    _fill(tree, chance, chance.choice([0.1, 0.3, 1]))
    ob.data.materials.append(fog)


def _cloud(chance: random.Random) -> Any:
    """A medium without a surface, sometimes not the same everywhere."""
    made, tree = stage.empty_material("Cloud")
    shader = _fill(tree, chance, chance.choice([1, 3, 10]))
    if chance.random() < 0.5:
        place, noise, times = (
            tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise", "Math")
        )
        noise.inputs["Scale"].default_value = 4
        times.operation = "MULTIPLY"
        times.inputs[1].default_value = shader.inputs["Density"].default_value * 2
        tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
        tree.links.new(noise.outputs[0], times.inputs[0])
        tree.links.new(times.outputs[0], shader.inputs["Density"])
    return made


def _fill(tree: Any, chance: random.Random, density: float) -> Any:
    shader = _scatter(tree, chance, density)
    stage.output(tree, shader, "Volume")
    return shader


def _scatter(tree: Any, chance: random.Random, density: float) -> Any:
    if chance.random() < 0.3:
        shader = tree.nodes.new("ShaderNodeVolumePrincipled")
        shader.inputs["Absorption Color"].default_value = _color(chance, 0.0)
    else:
        shader = tree.nodes.new("ShaderNodeVolumeScatter")
    shader.inputs["Color"].default_value = _color(chance, 0.5)
    shader.inputs["Density"].default_value = density
    shader.inputs["Anisotropy"].default_value = chance.choice([-0.3, 0, 0.5, 0.8])
    return shader


def _material(kind: Callable[[Any, random.Random], Any], chance: random.Random) -> Any:
    made, tree = stage.empty_material(kind.__name__)
    stage.surface(tree, kind(tree, chance))
    if chance.random() < 0.3:
        _bumps(made, chance)
    return made


def _bumps(made: Any, chance: random.Random) -> None:
    """Of all closures, or of one, told by a node of its own."""
    tree = made.node_tree
    place, noise = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise"))
    noise.inputs["Scale"].default_value = chance.choice([2, 5, 10])
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    height = chance.choice([0.02, 0.1, 0.3])
    if chance.random() < 0.5:
        bump = tree.nodes.new("ShaderNodeDisplacement")
        bump.inputs["Scale"].default_value = height
        tree.links.new(noise.outputs[0], bump.inputs["Height"])
        stage.output(tree, bump, "Displacement")
        made.displacement_method = "BUMP"
        return
    bump = tree.nodes.new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = height
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    shader = next(node for node in tree.nodes if "Normal" in node.inputs and node != bump)
    tree.links.new(bump.outputs[0], shader.inputs["Normal"])


def _principled(tree: Any, chance: random.Random, **inputs: Any) -> Any:
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = _color(chance)
    for name, value in inputs.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    return shader


def _glass(tree: Any, chance: random.Random) -> Any:
    shader = tree.nodes.new("ShaderNodeBsdfGlass")
    shader.inputs["Color"].default_value = _color(chance, 0.6, 1.0)
    shader.inputs["Roughness"].default_value = 0
    shader.inputs["IOR"].default_value = chance.choice([1.1, 1.33, 1.5, 1.5, 2.4])
    return shader


def _frosted(tree: Any, chance: random.Random) -> Any:
    return _principled(
        tree,
        chance,
        Transmission_Weight=chance.choice([0.5, 1, 1]),
        Roughness=chance.choice([0.05, 0.2, 0.5]),
        IOR=chance.choice([1.3, 1.5]),
        Alpha=chance.choice([1, 1, 0.6]),
    )


def _metal(tree: Any, chance: random.Random) -> Any:
    return _principled(tree, chance, Metallic=1, Roughness=chance.choice([0, 0.1, 0.25, 0.5]))


def _brushed(tree: Any, chance: random.Random) -> Any:
    return _principled(tree, chance, Metallic=1, Roughness=0.35, Anisotropic=chance.random())


def _plastic(tree: Any, chance: random.Random) -> Any:
    return _principled(tree, chance, Roughness=chance.choice([0, 0.1, 0.3, 0.6, 1]))


def _coated(tree: Any, chance: random.Random) -> Any:
    return _principled(
        tree, chance, Roughness=0.6, Coat_Weight=1, Coat_Roughness=chance.choice([0, 0.1])
    )


def _skin(tree: Any, chance: random.Random) -> Any:
    shader = _principled(
        tree,
        chance,
        Subsurface_Weight=chance.choice([0.5, 1, 1]),
        Subsurface_Scale=chance.choice([0.02, 0.1, 0.5]),
        Roughness=chance.choice([0.1, 0.5]),
    )
    shader.subsurface_method = chance.choice(["BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN"])
    return shader


def _leaf(tree: Any, chance: random.Random) -> Any:
    return _mix(tree, chance, "ShaderNodeBsdfTranslucent", "ShaderNodeBsdfDiffuse")


def _mixed(tree: Any, chance: random.Random) -> Any:
    kinds = ("Transparent", "Glossy", "Diffuse", "Translucent", "Refraction", "Sheen")
    one, other = (f"ShaderNodeBsdf{kind}" for kind in chance.sample(kinds, 2))
    return _mix(tree, chance, one, other)


def _mix(tree: Any, chance: random.Random, one: str, other: str) -> Any:
    """By a share, by Fresnel's, or by which side is seen."""
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = chance.random()
    for place, kind in ((1, one), (2, other)):
        shader = tree.nodes.new(kind)
        shader.inputs["Color"].default_value = _color(chance)
        if "Roughness" in shader.inputs and kind != "ShaderNodeBsdfDiffuse":
            shader.inputs["Roughness"].default_value = chance.choice([0.1, 0.3])
        tree.links.new(shader.outputs[0], mix.inputs[place])
    by = chance.choice(["", "", "ShaderNodeFresnel", "ShaderNodeNewGeometry"])
    if by:
        node = tree.nodes.new(by)
        tree.links.new(node.outputs["Backfacing" if "Geometry" in by else 0], mix.inputs[0])
    return mix


def _glowing(tree: Any, chance: random.Random) -> Any:
    return _principled(
        tree, chance, Emission_Color=_color(chance), Emission_Strength=chance.uniform(0.5, 4)
    )
