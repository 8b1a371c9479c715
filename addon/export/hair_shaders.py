"""Hair shaders on what is no hair."""

from __future__ import annotations

from ..core.native.operations import operations_of
from ..core.scene import NO_PROGRAM, Scene
from ..core.scene.shading import Program
from .mesh_materials import materials_of_meshes
from .report import Report

HAIR = ("Hair", "PrincipledHair")
"""Operations that need a direction along the strand."""


def report_hair_shaders(scene: Scene, report: Report) -> None:
    """Names the materials with hair shaders that points or meshes have."""
    hair = {
        index
        for index, material in enumerate(scene.materials)
        if material.program != NO_PROGRAM and has_hair(scene.programs[material.program])
    }
    if not hair:
        return
    for mesh, materials in materials_of_meshes(scene):
        strands = mesh.strands
        if strands is not None and strands.first is not None:
            continue
        sentence = (
            "Hair shaders on points are black: {}"
            if strands is not None
            else "Hair shaders on meshes are a fifth and more brighter or darker than in Cycles: {}"
        )
        for index in sorted(hair & materials):
            report.warn(sentence, scene.materials[index].name)


def has_hair(program: Program) -> bool:
    return any(name in HAIR for name, _ in operations_of(program))
