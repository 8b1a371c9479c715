"""Grids of smoke and fire: of mesh objects that are domains of gas."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.scene.grids import MOST_VALUES, Grid, MeshGrid, make_grid
from ...core.scene.shading import GeneratedSpace
from ..report import Report

COMPONENTS = {
    "density": 1,
    "color": 4,
    "flame": 1,
    "heat": 1,
    "temperature": 1,
    "velocity": 3,
}
"""Grids that Cycles knows by these names."""
COARSE = {"velocity", "heat"}
"""Those that noise does not refine."""
NO_CACHE = "Smoke domains left out, as nothing is baked or simulated for this frame: {}"


def gas_domain(ob: Any) -> Any:
    """The settings of the gas domain that an object is; None: it is none."""
    if ob.type != "MESH":
        return None
    for modifier in ob.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
            settings = modifier.domain_settings
            if settings is not None and settings.domain_type == "GAS":
                return settings
    return None


def generated(mesh: Any) -> GeneratedSpace:
    size = np.array(mesh.texspace_size, np.float64)
    scale = 0.5 / np.where(size != 0.0, size, 1.0)
    offset = 0.5 - np.array(mesh.texspace_location, np.float64) * scale
    return GeneratedSpace(tuple(scale.tolist()), tuple(offset.tolist()))


def read_domain(
    ob: Any, domain: Any, wanted: dict[int, str], frame: int, report: Report
) -> list[MeshGrid]:
    """What of the domain's grids is wanted and there."""
    if not domain.cache_frame_start <= frame <= domain.cache_frame_end:
        return []
    found = []
    any_values = False
    for number, name in wanted.items():
        if name not in COMPONENTS:
            continue
        values = _values(domain, name)
        if values is None:
            continue
        any_values = True
        if values.size > MOST_VALUES:
            report.warn("Smoke domains left out, as they are too large: {}", ob.name)
            return []
        found.append(MeshGrid(number, _grid(ob.data, values, float(domain.clipping))))
    if not any_values and any(name in COMPONENTS for name in wanted.values()):
        report.warn(NO_CACHE, ob.name)
    return found


def _values(domain: Any, name: str) -> NDArray[np.float32] | None:
    """(X, Y, Z, C); None: the cache does not have it in the domain's size."""
    array = getattr(domain, f"{name}_grid", None)
    size = np.array(domain.domain_resolution, np.int64)
    if domain.use_noise and name not in COARSE:
        size = size * int(domain.noise_scale)
    width = COMPONENTS[name]
    if array is None or len(array) == 0 or len(array) != int(size.prod()) * width:
        return None
    flat = np.empty(len(array), np.float32)
    array.foreach_get(flat)
    flat = np.nan_to_num(flat, nan=0.0, posinf=0.0, neginf=0.0)
    return flat.reshape(size[2], size[1], size[0], width).transpose(2, 1, 0, 3)


def _grid(mesh: Any, values: NDArray[np.float32], clipping: float) -> Grid:
    """Where Cycles puts it: by the mesh's texture space, and one voxel of a unit domain further."""
    size = np.array(values.shape[:3], np.float64)
    space = generated(mesh)
    scale, offset = np.array(space.scale), np.array(space.offset)
    to_object = np.eye(4)
    to_object[:3, :3] = np.diag(1.0 / (size * scale))
    to_object[:3, 3] = (0.5 / size - offset) / scale + 1.0 / size
    small = (np.abs(values) <= clipping).all(axis=3)
    values = np.where(small[..., None], np.float32(0.0), values)
    whole = np.zeros(
        tuple(int(-(-n // 8) * 8) for n in values.shape[:3]) + values.shape[3:], np.float32
    )
    whole[tuple(slice(n) for n in values.shape[:3])] = values

    def read(first: tuple[int, int, int], shape: tuple[int, int, int]) -> NDArray[np.float32]:
        return whole[tuple(slice(a, a + n) for a, n in zip(first, shape, strict=True))]

    last = tuple(n - 1 for n in values.shape[:3])
    background = np.zeros(values.shape[3], np.float32)
    return make_grid(read, (0, 0, 0), last, np.linalg.inv(to_object), background)[0]
