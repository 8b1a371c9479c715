"""Volume objects and smoke domains: grids, in the box around what they hold."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.scene import Mesh
from ...core.scene.grids import Grid, MeshGrid, TooLarge, box, held
from ...core.scene.shading import GeneratedSpace, MeshShading
from ..kept import identity
from ..report import Report
from . import smoke, vdb

NO_MODULE = (
    "Volumes left out, as this Blender has no openvdb module for Python to read their grids: {}"
)
NO_FILE = "Volumes left out, as their file cannot be read: {}"
TOO_LARGE = (
    "Volumes left out, as a grid of theirs holds more than 268 million numbers (1 GiB) or reaches "
    "over more than 16 million bricks of 8 x 8 x 8 voxels: {}"
)
NOT_FINITE = "Volumes with values that are no finite numbers, which are taken as 0: {}"

Wanted = dict[int, str]
"""Names of grids by the ids of attributes."""


def volume_mesh(ob: Any, wanted: Wanted, padding: int, frame: int, report: Report) -> Mesh | None:
    """The box around an object's grids as Cycles has it: what is above the clipping of those that
    its material asks for, and `padding` voxels more. None: there is nothing.
    """
    domain = smoke.gas_domain(ob)
    if domain is not None:
        grids = smoke.read_domain(ob, domain, wanted, frame, report)
        clipping, space = float(domain.clipping), smoke.generated(ob.data)
    else:
        grids = _read_volume(ob, wanted, report)
        clipping, space = float(ob.data.render.clipping), _generated(ob)
    if not grids:
        return None
    bounds = _bounds([own.grid for own in grids], clipping)
    if bounds is None:
        return None
    lower, upper, to_object = bounds
    positions, triangles = box(lower - padding, upper + padding, to_object)
    if not np.isfinite(positions).all():
        return None
    return Mesh(
        name=ob.data.name,
        positions=positions,
        triangles=triangles,
        shading=MeshShading(generated=space, grids=grids),
    )


def density_of(ob: Any, matrix: NDArray[np.float64]) -> float:
    """What a larger object thins its medium by, if its density is that of its own space."""
    if ob.type != "VOLUME" or ob.data.render.space != "OBJECT":
        return 1.0
    stretch = float(np.linalg.norm(matrix[:3, :3] @ np.full(3, 3.0**-0.5)))
    return 1.0 / stretch if stretch > 0.0 else 0.0


def is_volume(ob: Any) -> bool:
    """Whether an object stands for grids, and not for its mesh."""
    return ob.type == "VOLUME" or smoke.gas_domain(ob) is not None


def known_volume(ob: Any, frame: int) -> tuple[Any, ...]:
    """What makes an object's grids others than those of other objects, frames or settings."""
    domain = smoke.gas_domain(ob)
    if domain is not None:
        return (identity(ob), frame, float(domain.clipping))
    grids = ob.data.grids
    grids.load()  # only then it knows its file
    own = () if _has_own_file(ob) else (identity(ob), ob.data.as_pointer())
    return (*own, identity(ob.original.data), grids.frame_filepath, float(ob.data.render.clipping))


def _has_own_file(ob: Any) -> bool:
    """Whether an object's grids are those of its file: modifiers have neither made nor changed
    them.
    """
    return bool(
        ob.original.type == "VOLUME" and not len(ob.modifiers) and ob.data.grids.frame_filepath
    )


def _bounds(
    grids: list[Grid], clipping: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
    """Corners in the first grid's voxels, and the matrix from there to the object's coordinates."""
    corners = []
    to_index = grids[0].to_index
    for grid in grids:
        found = held(grid, clipping)
        if found is None:
            continue
        ends = np.stack(found).astype(np.float64)
        if grid.to_index is not to_index and not np.array_equal(grid.to_index, to_index):
            every = np.array(
                [[ends[k & 1, 0], ends[k >> 1 & 1, 1], ends[k >> 2, 2]] for k in range(8)]
            )
            matrix = to_index @ np.linalg.inv(grid.to_index)
            ends = every @ matrix[:3, :3].T + matrix[:3, 3]
        corners.append(ends)
    if not corners:
        return None
    every = np.concatenate(corners)
    return every.min(axis=0), every.max(axis=0), np.linalg.inv(to_index)


def _generated(ob: Any) -> GeneratedSpace:
    corners = np.array([tuple(corner) for corner in ob.bound_box], np.float64)
    lower, size = corners.min(axis=0), np.ptp(corners, axis=0)
    scale = np.divide(1.0, size, out=np.ones(3), where=size > 0.0)
    return GeneratedSpace(tuple(scale.tolist()), tuple((-lower * scale).tolist()))


def _read_volume(ob: Any, wanted: Wanted, report: Report) -> list[MeshGrid]:
    data = ob.data
    if not data.grids.load():
        if data.filepath:
            report.warn(NO_FILE, ob.name, missing=True)
        return []
    names = {grid.name for grid in data.grids}
    asked = {number: name for number, name in wanted.items() if name in names}
    if not asked:
        return []
    if vdb.module() is None:
        report.warn(NO_MODULE, ob.name)
        return []
    found = []
    with _file_of(ob) as path:
        for number, name in asked.items():
            try:
                read = vdb.read_grid(path, name)
            except vdb.Unreadable as error:
                report.warn(f"Volumes without their grid '{name}' ({error}): {{}}", ob.name)
                continue
            except TooLarge:
                report.warn(TOO_LARGE, ob.name)
                return []
            if read is None:
                continue
            if read[1]:
                report.warn(NOT_FINITE, ob.name)
            found.append(MeshGrid(number, read[0]))
    return found


@contextmanager
def _file_of(ob: Any) -> Iterator[str]:
    """A file that holds an object's grids as they are now: its own, or a temporary one where
    modifiers have made or changed them.
    """
    grids = ob.data.grids
    if _has_own_file(ob):
        yield bpy.path.abspath(grids.frame_filepath)
        return
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "grids.vdb"))
        grids.save(filepath=path)
        yield path
