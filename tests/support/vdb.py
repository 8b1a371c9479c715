"""OpenVDB files for tests, by the module that Blender ships."""

from __future__ import annotations

import atexit
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from photon_splat.export.geometry import vdb

Place = tuple[float, float, float]


def lattice(count: int = 24) -> tuple[NDArray, NDArray, NDArray]:
    """x, y and z from -1 to 1 at the voxels of a cube."""
    x = np.linspace(-1.0, 1.0, count)
    return np.meshgrid(x, x, x, indexing="ij")  # type: ignore[return-value]


def blob(count: int = 24) -> NDArray[np.float32]:
    """A lumpy ball: 1 in its middle, 0 outside of it."""
    x, y, z = lattice(count)
    edge = 0.85 + 0.15 * np.sin(5.0 * x) * np.sin(4.0 * y + 1.0) * np.cos(6.0 * z)
    return np.clip(2.0 * (edge - np.sqrt(x * x + y * y + z * z)), 0.0, 1.0).astype(np.float32)


def grid(
    name: str,
    values: NDArray,
    voxel: float = 0.05,
    corner: Place = (0.0, 0.0, 0.0),
    first: tuple[int, int, int] = (0, 0, 0),
) -> Any:
    """An OpenVDB grid of values (X, Y, Z) or (X, Y, Z, 3), its first voxel, of number `first`, at
    `corner`.
    """
    library = vdb.module()
    assert library is not None
    made = (library.FloatGrid if values.ndim == 3 else library.Vec3SGrid)()
    made.copyFromArray(np.ascontiguousarray(values, np.float32), ijk=first)
    made.transform = library.createLinearTransform(voxelSize=voxel)
    made.transform.postTranslate(tuple(c - voxel * f for c, f in zip(corner, first, strict=True)))
    made.name = name
    return made


def write(path: Path, *grids: Any) -> str:
    library = vdb.module()
    assert library is not None
    library.write(str(path), grids=list(grids))
    return str(path)


def folder() -> Path:
    """A temporary one, gone when the process ends."""
    made = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    return Path(made)


def sphere_of(
    function: Callable[[NDArray, NDArray, NDArray], NDArray], count: int = 24
) -> NDArray[np.float32]:
    """What a function says of x, y and z from -1 to 1."""
    return np.asarray(function(*lattice(count)), np.float32)
