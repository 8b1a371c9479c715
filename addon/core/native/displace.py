"""Moves the vertices of a mesh by shader programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..scene import Camera, Mesh, Texture
from ..scene.displacement import UNDISPLACED, UNDISPLACED_NORMALS, Displacement, Normals
from ..scene.shading import GENERATED, Domain, InstanceAttribute, MeshAttribute
from .library import load
from .materials import add_program, add_textures
from .meshes import add_mesh_shading
from .operations import textures_of

NOTHING = (-1, False)


def displaced(
    mesh: Mesh,
    normals: Normals,
    slots: Sequence[Displacement | None],
    matrix: NDArray[np.float64],
    attributes: Sequence[InstanceAttribute],
    textures: Sequence[Texture],
    camera: Camera,
    asked: frozenset[int],
) -> tuple[Mesh, int]:
    """`mesh` as the materials of its slots move it where it stands by `matrix`, and how many
    vertices had no finite place to go to and stay. It may have triangles without area.

    attributes  what programs read from the instance, a row each
    textures    by the indices that programs name
    asked       ids of what programs of surfaces read as it was before
    """
    with_old = _with_old_places(
        mesh, GENERATED in asked, any(slot is not None and slot.bumps for slot in slots)
    )
    renderer = load().Renderer(0)
    programs = [slot.program for slot in slots if slot is not None]
    named = {texture for program in programs for texture in textures_of(program)}
    unread = Texture("unread", np.zeros((1, 1, 4), np.uint8))
    add_textures(renderer, [t if i in named else unread for i, t in enumerate(textures)])
    of_slots = []
    for slot in slots:
        if slot is None:
            of_slots.append(NOTHING)
            continue
        of_slots.append((add_program(renderer, slot.program), slot.bumps))
    renderer.add_material(*[((0.0, 0.0, 0.0), -1, (0.0, 0.0, 0.0), -1)] * 2)
    renderer.add_mesh(
        with_old.positions,
        with_old.triangles,
        normals.corners,
        with_old.uv,
        with_old.slots,
        normals.vertices,
    )
    add_mesh_shading(renderer, 0, with_old)
    renderer.add_instances(
        np.zeros(1, np.uint32),
        np.ascontiguousarray(matrix, np.float64)[None],
        np.zeros(1, np.uint32),
        [[0]],
    )
    for attribute in attributes:
        renderer.add_instance_attribute(attribute.id, attribute.values)
    renderer.set_shading_view(
        np.ascontiguousarray(camera.matrix, np.float64),
        [float(c) for c in camera.screen],
        camera.orthographic,
    )
    positions, corner_normals, vertex_normals, lost = renderer.displace(
        0, of_slots, normals.smooth, normals.own_corners
    )
    moved = replace(
        with_old,
        positions=positions,
        corner_normals=corner_normals,
        vertex_normals=vertex_normals,
    )
    if UNDISPLACED_NORMALS in asked:
        shading = moved.shading
        old = MeshAttribute(UNDISPLACED_NORMALS, Domain.CORNER, _old_normals(moved, normals))
        moved.shading = replace(shading, attributes=[*shading.attributes, old])
    return moved, lost


def _old_normals(moved: Mesh, normals: Normals) -> NDArray[np.float32]:
    """(3 T, 3) smooth normals from before; of flat triangles theirs of now, as Cycles has it."""
    old = normals.corners
    if old is None:
        assert normals.vertices is not None
        old = normals.vertices[moved.triangles]
    if normals.smooth is not None:
        a, b, c = (moved.positions[moved.triangles[:, corner]] for corner in range(3))
        flat = np.repeat(np.cross(b - a, c - a)[:, None], 3, axis=1)
        flat /= np.maximum(np.linalg.norm(flat, axis=2, keepdims=True), 1e-30)
        old = np.where(normals.smooth[:, None, None], old, flat)
    return np.ascontiguousarray(old.reshape(-1, 3), np.float32)


def _with_old_places(mesh: Mesh, generated: bool, bumps: bool) -> Mesh:
    """`generated`: with Generated coordinates that do not move with the vertices; `bumps`: with
    their places too.
    """
    shading = mesh.shading
    added = []
    known = {attribute.id for attribute in shading.attributes}
    if generated and shading.generated is not None and GENERATED not in known:
        space = shading.generated
        scale, offset = (np.array(each, np.float32) for each in (space.scale, space.offset))
        places = mesh.positions * scale
        places += offset
        added.append(MeshAttribute(GENERATED, Domain.POINT, places))
    if bumps:
        added.append(MeshAttribute(UNDISPLACED, Domain.POINT, mesh.positions))
    return replace(mesh, shading=replace(shading, attributes=[*shading.attributes, *added]))
