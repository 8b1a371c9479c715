"""Hands meshes, strands and what programs read from them to the native renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..scene import Mesh, Scene, Strands
from .convert import contiguous, naming

if TYPE_CHECKING:
    from photon_splat_native import Renderer


def add_meshes(renderer: Renderer, scene: Scene) -> None:
    """Meshes and strands with their motion, and what programs read from them."""
    grids: dict[int, int] = {}
    for index, mesh in enumerate(scene.meshes):
        with naming(f"mesh '{mesh.name}'"):
            if mesh.strands is not None:
                _add_strands(renderer, index, mesh.strands)
                add_mesh_shading(renderer, index, mesh)
                continue
            renderer.add_mesh(
                np.ascontiguousarray(mesh.positions, np.float32),
                np.ascontiguousarray(mesh.triangles, np.uint32),
                contiguous(mesh.corner_normals, np.float32),
                contiguous(mesh.uv, np.float32),
                contiguous(mesh.slots, np.uint16),
                contiguous(mesh.vertex_normals, np.float32),
            )
            add_mesh_shading(renderer, index, mesh)
            _add_grids(renderer, index, mesh, grids)
            if mesh.motion is not None:
                renderer.set_mesh_motion(
                    index,
                    np.ascontiguousarray(mesh.motion.positions, np.float32),
                    contiguous(mesh.motion.corner_normals, np.float32),
                    contiguous(mesh.motion.vertex_normals, np.float32),
                )


def _add_strands(renderer: Renderer, index: int, strands: Strands) -> None:
    renderer.add_strands(
        np.ascontiguousarray(strands.keys, np.float32),
        contiguous(strands.first, np.uint32),
        str(strands.shape),
        strands.subdivisions,
        contiguous(strands.slots, np.uint16),
        contiguous(strands.uv, np.float32),
    )
    if strands.motion is not None:
        renderer.set_strand_motion(index, np.ascontiguousarray(strands.motion, np.float32))


def add_mesh_shading(renderer: Renderer, index: int, mesh: Mesh) -> None:
    """What programs read from a mesh: its attributes and generated coordinates."""
    for attribute in mesh.shading.attributes:
        renderer.add_mesh_attribute(
            index, attribute.id, str(attribute.domain), np.ascontiguousarray(attribute.values)
        )
    if mesh.shading.generated is not None:
        renderer.set_generated(
            index, list(mesh.shading.generated.scale), list(mesh.shading.generated.offset)
        )


def _add_grids(renderer: Renderer, index: int, mesh: Mesh, known: dict[int, int]) -> None:
    """`known`: which grids the renderer has, by their ids in Python."""
    for own in mesh.shading.grids:
        grid = own.grid
        if id(grid) not in known:
            background = [*grid.background.tolist(), 0.0, 0.0, 0.0][:4]
            known[id(grid)] = renderer.add_grid(
                np.ascontiguousarray(grid.to_index, np.float64),
                [int(c) for c in grid.lower],
                np.ascontiguousarray(grid.table, np.int32),
                np.ascontiguousarray(grid.values, np.float32),
                background,
            )
        renderer.add_mesh_grid(index, own.id, known[id(grid)])
