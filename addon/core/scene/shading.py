"""Shader programs and what they read from meshes and instances, as plain data. See
native/src/shading/ops.def for the operations.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntFlag, StrEnum

import numpy as np
from numpy.typing import NDArray

from .grids import MeshGrid

# The id of the attribute that holds Generated coordinates where they are no linear function of the
# position.
GENERATED = 0


class Feature(IntFlag):
    """What a run of a program may produce; the bits of native/src/shading/program.h."""

    EMITS = 1
    TRANSPARENT = 2
    GATHERS = 4
    REST = 8
    SHARP = 16
    CONSTANT_EMISSION = 32
    TRANSMITS = 64
    SUBSURFACE = 128


@dataclass(slots=True)
class Program:
    """Code of a shader that native code runs at every hit.

    code       (N,) uint32 instructions, constants (K,) float32; `registers` floats of scratch space
    wants      ids of the mesh attributes that it reads; `wants_instances` likewise of instances
    """

    name: str
    code: NDArray[np.uint32]
    constants: NDArray[np.float32]
    registers: int
    features: Feature
    wants: frozenset[int] = frozenset()
    wants_instances: frozenset[int] = frozenset()


class Domain(StrEnum):
    """What a mesh attribute has a row for: positions, corners of triangles (three each) or
    triangles.
    """

    POINT = "point"
    CORNER = "corner"
    FACE = "face"


@dataclass(slots=True)
class MeshAttribute:
    """`values` (N, 1..4) float32, or (N, 4) uint8 of an sRGB-encoded colour with a linear alpha.
    `id` means the same on all meshes.
    """

    id: int
    domain: Domain
    values: NDArray


@dataclass(slots=True)
class InstanceAttribute:
    """`values` (I, 1..4) float32, a row per instance."""

    id: int
    values: NDArray[np.float32]


@dataclass(slots=True)
class GeneratedSpace:
    """Generated coordinates of a mesh are its own coordinates times `scale` plus `offset`."""

    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(slots=True)
class MeshShading:
    """What programs read from one mesh beyond its geometry; `generated` None: nobody asks. `grids`:
    of volumes, whose bounds the mesh is.
    """

    attributes: list[MeshAttribute] = field(default_factory=list)
    generated: GeneratedSpace | None = None
    grids: list[MeshGrid] = field(default_factory=list)
