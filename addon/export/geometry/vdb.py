"""Grids of OpenVDB files, by the module that Blender ships for Python."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.scene.grids import MOST_VALUES, Grid, TooLarge, make_grid

NAMES = ("openvdb", "pyopenvdb")  # the second one: before Blender 4.4
FOLDERS = ("python/lib/python*/site-packages", "python/lib/site-packages")


class Unreadable(ValueError):
    """A grid that is of no kind that can be rendered; says why."""


@cache
def module() -> ModuleType | None:
    """None where this Blender has none."""
    for name in NAMES:
        if name in sys.modules:
            return sys.modules[name]
        try:
            return importlib.import_module(name)
        except ImportError:
            pass
        for place in _places():
            # the bpy package keeps it outside of Python's path
            for folder in FOLDERS:
                for file in sorted(place.glob(f"{folder}/{name}*")):
                    if file.suffix in {".so", ".pyd"}:
                        return _loaded(name, file)
    return None


def _places() -> list[Path]:
    """Folders of this Blender."""
    found = (bpy.utils.resource_path(kind) for kind in ("LOCAL", "SYSTEM"))
    return [Path(path) for path in found if path]


def _loaded(name: str, file: Path) -> ModuleType | None:
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        return None
    found = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(found)
    except ImportError:
        return None
    sys.modules[name] = found
    return found


def read_grid(path: str, name: str) -> tuple[Grid, int] | None:
    """The grid of that name in a file, and how many of its numbers were not finite; None: it has no
    voxels. Raises Unreadable, TooLarge.
    """
    vdb = module()
    assert vdb is not None
    try:
        grid = vdb.read(path, name)
    except Exception as error:  # each binding raises other ones
        raise Unreadable(str(error).strip().splitlines()[0]) from error
    if grid.activeVoxelCount() == 0:
        return None
    return _converted(grid)


def _converted(grid: Any) -> tuple[Grid, int]:
    background = np.atleast_1d(np.array(grid.background, np.float32))
    if len(background) not in {1, 3, 4}:
        raise Unreadable(f"its values have {len(background)} components")
    if grid.activeVoxelCount() * len(background) > MOST_VALUES:
        raise TooLarge
    is_bool = isinstance(grid.background, bool)

    def read(first: tuple[int, int, int], shape: tuple[int, int, int]) -> NDArray[np.float32]:
        wide = (*shape, len(background)) if len(background) > 1 else shape
        values = np.empty(wide, bool if is_bool else np.float32)
        grid.copyToArray(values, ijk=first)
        return values.astype(np.float32, copy=False).reshape(*shape, len(background))

    lower, upper = grid.evalActiveVoxelBoundingBox()
    to_object = matrix_of(grid.transform)
    if not np.isfinite(background).all():
        background = np.nan_to_num(background, nan=0.0, posinf=0.0, neginf=0.0)
    return make_grid(read, tuple(lower), tuple(upper), np.linalg.inv(to_object), background)


def matrix_of(transform: Any) -> NDArray[np.float64]:
    """(4, 4) from voxels to the object's coordinates."""
    at = [
        np.array(transform.indexToWorld(p), np.float64)
        for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1))
    ]
    matrix = np.eye(4)
    matrix[:3, 3] = at[0]
    for axis in range(3):
        matrix[:3, axis] = at[axis + 1] - at[0]
    size = np.abs(matrix[:3, :3]).max()
    if np.abs(matrix[:3, :3].sum(axis=1) + at[0] - at[4]).max() > 1e-4 * size:
        raise Unreadable("its voxels stand in no regular grid")
    if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix[:3, :3] / size)) < 1e-12:
        raise Unreadable("its voxels have no size")
    return matrix
