"""Random materials for tests/support/random_stage.py. Runs inside Blender."""

from __future__ import annotations

import random
from typing import Any

from tests.support import stage

COLORS = "Col"
"""A colour attribute that some ask for."""
SHADERS = {
    "Diffuse": "BsdfDiffuse",
    "Translucent": "BsdfTranslucent",
    "Glossy": "BsdfAnisotropic",
    "Toon": "BsdfToon",
    "Sheen": "BsdfSheen",
    "Emission": "Emission",
    "Principled": "BsdfPrincipled",
    "Metal": "BsdfPrincipled",
    "Alpha": "BsdfPrincipled",
    "Textured": "BsdfPrincipled",
    "Coloured": "BsdfPrincipled",
}
ASKED = ("Is Shadow Ray", "Is Camera Ray", "Is Diffuse Ray", "Is Glossy Ray", "Ray Depth")


def color(chance: random.Random, low: float = 0.1, high: float = 0.9) -> tuple[float, ...]:
    return (*(chance.uniform(low, high) for _ in range(3)), 1)


def material(chance: random.Random) -> Any:
    kind = chance.choice(list(SHADERS))
    made, tree = stage.empty_material(kind)
    shader = tree.nodes.new(f"ShaderNode{SHADERS[kind]}")
    shader.inputs[0].default_value = color(chance)
    values = {"Diffuse": ("Roughness", 0.5), "Glossy": ("Roughness", 0.5)}
    values |= {"Emission": ("Strength", 2.0), "Metal": ("Metallic", 1.0), "Alpha": ("Alpha", 0.6)}
    if kind in values:
        name, value = values[kind]
        shader.inputs[name].default_value = value
    if SHADERS[kind] == "BsdfPrincipled":
        shader.inputs["Roughness"].default_value = chance.uniform(0.3, 1)
        shader.inputs["Coat Weight"].default_value = chance.choice([0, 0, 0.5])
        shader.inputs["Coat Roughness"].default_value = 0.3
        shader.inputs["Sheen Weight"].default_value = chance.choice([0, 0, 0.5])
    if kind == "Toon":
        shader.component = chance.choice(["DIFFUSE", "GLOSSY"])
    if kind == "Textured":
        _texture(chance, tree, shader)
    if kind == "Coloured":
        colors = tree.nodes.new("ShaderNodeVertexColor")
        colors.layer_name = COLORS
        tree.links.new(colors.outputs[0], shader.inputs[0])
    if kind != "Emission" and chance.random() < 0.12:
        shader = _asking(chance, tree, shader)
    if chance.random() < 0.1:
        geometry, mix, other = (
            tree.nodes.new(f"ShaderNode{name}")
            for name in ("NewGeometry", "MixShader", "BsdfDiffuse")
        )
        other.inputs[0].default_value = color(chance)
        tree.links.new(geometry.outputs["Backfacing"], mix.inputs[0])
        tree.links.new(shader.outputs[0], mix.inputs[1])
        tree.links.new(other.outputs[0], mix.inputs[2])
        shader = mix
    stage.surface(tree, shader)
    return made


def _texture(chance: random.Random, tree: Any, shader: Any) -> None:
    place, mapping, texture = (
        tree.nodes.new(f"ShaderNode{name}")
        for name in (
            "TexCoord",
            "Mapping",
            chance.choice(["TexChecker", "TexBrick", "TexVoronoi", "TexWave", "TexNoise"]),
        )
    )
    mapping.inputs["Scale"].default_value = (chance.uniform(0.5, 3), chance.uniform(0.5, 3), 1)
    mapping.inputs["Rotation"].default_value = (0, 0, chance.uniform(-2, 2))
    where = ["UV", "Generated", "Object", "Camera", "Window", "Reflection"]
    tree.links.new(place.outputs[chance.choice(where)], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs[0], shader.inputs[0])
    if chance.random() < 0.3:
        bump = tree.nodes.new("ShaderNodeBump")
        bump.inputs["Distance"].default_value = 0.05
        tree.links.new(texture.outputs[0], bump.inputs["Height"])
        tree.links.new(bump.outputs[0], shader.inputs["Normal"])


def _asking(chance: random.Random, tree: Any, shader: Any) -> Any:
    """Transparent to some kind of ray."""
    path, mix, clear = (
        tree.nodes.new(f"ShaderNode{name}")
        for name in ("LightPath", "MixShader", "BsdfTransparent")
    )
    tree.links.new(path.outputs[chance.choice(ASKED)], mix.inputs[0])
    tree.links.new(shader.outputs[0], mix.inputs[1])
    tree.links.new(clear.outputs[0], mix.inputs[2])
    return mix
