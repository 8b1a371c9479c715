"""Meshes, and where in the world they stand."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .motion import MeshMotion
from .shading import InstanceAttribute, MeshShading
from .strands import Strands


@dataclass(slots=True)
class Mesh:
    """A triangle mesh in its own coordinates, in memory once however often it is instanced.

    positions       (V, 3) float32
    triangles       (T, 3) uint32, indices into positions; counter-clockwise seen from the front
    corner_normals  (T, 3, 3) float32 unit shading normals per corner, or None
    vertex_normals  (V, 3) float32 instead, where all corners at a vertex have the same; neither:
                    flat everywhere
    uv              (T, 3, 2) float32 of the render-active UV map, or None
    slots           (T,) uint16 material slot per triangle, or None: all 0

    shading         what shader programs read beyond that
    motion          how its shape changes while the shutter is open, or None
    strands         curves or points instead of triangles, or None

    No NaN, no infinity, no triangle of zero area (the exporter drops those and says so).
    """

    name: str
    positions: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    corner_normals: NDArray[np.float32] | None = None
    uv: NDArray[np.float32] | None = None
    slots: NDArray[np.uint16] | None = None
    shading: MeshShading = field(default_factory=MeshShading)
    vertex_normals: NDArray[np.float32] | None = None
    motion: MeshMotion | None = None
    strands: Strands | None = None

    def normals(self) -> NDArray[np.float32] | None:
        """(T, 3, 3) unit shading normals per corner, however they are kept, or None: flat
        everywhere.
        """
        return (
            self.corner_normals
            if self.vertex_normals is None
            else self.vertex_normals[self.triangles]
        )

    @property
    def moves(self) -> bool:
        """Whether its shape changes while the shutter is open."""
        return self.motion is not None or (
            self.strands is not None and self.strands.motion is not None
        )

    def release(self) -> None:
        """Lets go of the arrays, which native code has by now. Motion and strands stay."""
        self.positions, self.triangles = self.positions[:0].copy(), self.triangles[:0].copy()
        self.corner_normals = self.vertex_normals = self.uv = self.slots = None
        self.shading = MeshShading()

    @classmethod
    def of_strands(cls, name: str, strands: Strands) -> Mesh:
        return cls(name, np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32), strands=strands)


@dataclass(slots=True)
class Instances:
    """Meshes placed in the world, as arrays over instances (I of them).

    mesh          (I,) uint32 index into Scene.meshes
    matrix        (I, 4, 4) float64 local to world; negative determinants (mirroring) are fine
    material_set  (I,) uint32 index into Scene.material_sets
    attributes    what shader programs read from instances
    group         (I,) uint8 in 0..63, of light linking; None: all 0
    lit_groups    (I,) uint64, bits of the groups that an instance lights if it shines; None: all
    blockers      (I,) uint64, bits of the groups that cast shadows in its light then; None: all
    light_group   (I,) int16 index into Scene.light_groups of its light, -1: none; None: all -1
    seen_by       (I,) uint32, the rays (`Ray`) that meet an instance; None: all rays meet all
    holdout       (I,) bool, a hole in the picture where the camera sees it; None: nowhere
    catcher       (I,) bool, a shadow catcher: shows the camera what other things take from its
                  light, and no more; None: nowhere
    terminator_offset  (I,) float32, cosine below which shadow rays start off the surface that
                  smooth normals promise (0: nowhere); None: 0.1 everywhere
    density       (I,) float32, coefficients of media over what programs say; None: all 1
    motion        (S, 4, 4) matrices at steps of the shutter's opening, of those that move
    owners        by which warnings name them: the user's objects; empty: by their meshes
    """

    mesh: NDArray[np.uint32]
    matrix: NDArray[np.float64]
    material_set: NDArray[np.uint32]
    attributes: list[InstanceAttribute] = field(default_factory=list)
    group: NDArray[np.uint8] | None = None
    lit_groups: NDArray[np.uint64] | None = None
    blockers: NDArray[np.uint64] | None = None
    light_group: NDArray[np.int16] | None = None
    seen_by: NDArray[np.uint32] | None = None
    holdout: NDArray[np.bool_] | None = None
    catcher: NDArray[np.bool_] | None = None
    terminator_offset: NDArray[np.float32] | None = None
    density: NDArray[np.float32] | None = None
    motion: dict[int, NDArray[np.float64]] = field(default_factory=dict)
    owners: list[str] = field(default_factory=list)

    @classmethod
    def empty(cls) -> Instances:
        return cls(np.zeros(0, np.uint32), np.zeros((0, 4, 4)), np.zeros(0, np.uint32))
