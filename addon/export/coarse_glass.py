"""Glass whose smooth normals promise another shape than its mesh has."""

from __future__ import annotations

import numpy as np

from ..core.scene import NO_PROGRAM, Mesh, Scene
from ..core.scene.shading import Feature
from .mesh_materials import materials_of_meshes
from .report import Report

BENT = 0.87
"""Cosine, of 30 degrees, between a triangle and its normals."""
MOST_BENT = 0.25
"""Of a mesh's area."""
MOST_TRIANGLES = 1_000_000
"""A mesh of more is not looked at: it is hardly coarse, and the look takes memory."""
SENTENCE = (
    "Glass so coarse and yet shaded smooth (as a cube would be) may throw a few percent too "
    "little light: {}"
)


def report_coarse_glass(scene: Scene, report: Report) -> None:
    """Names its meshes. A camera path's mirror direction depends there on where it comes from
    (Cycles keeps it above the surface), in a way that no photon can take back.
    """
    glass = {
        index
        for index, material in enumerate(scene.materials)
        if material.program != NO_PROGRAM
        and scene.programs[material.program].features & Feature.TRANSMITS
        and scene.programs[material.program].features & Feature.SHARP
    }
    if not glass:
        return
    for mesh, materials in materials_of_meshes(scene):
        if mesh.strands is None and glass & materials and bent_share(mesh) > MOST_BENT:
            report.warn(SENTENCE, mesh.name)


def bent_share(mesh: Mesh) -> float:
    """The share of the area whose normals are bent off by more than 30 degrees."""
    if not 0 < len(mesh.triangles) <= MOST_TRIANGLES:
        return 0.0
    normals = mesh.normals()
    if normals is None:
        return 0.0
    a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    area = np.linalg.norm(face, axis=-1)
    cosine = np.einsum("tci,ti->t", normals, face) / (3.0 * np.maximum(area, 1e-30))
    return float(area[cosine < BENT].sum() / max(area.sum(), 1e-30))
