"""UV maps that have no area, although a tree takes tangents from them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import read_copy
from ..nodes.node import Want
from ..report import Report


def report_flat_uv_maps(
    ob: Any, wants: dict[int, Want], askers: dict[int, list[tuple[str, str]]], report: Report
) -> None:
    """Names materials and nodes that take tangents from a UV map of `ob` (a mesh object) of which
    no triangle has an area.
    """
    if not askers or ob.data.is_editmode:
        return
    layers = ob.data.uv_layers
    active = next((layer.name for layer in layers if layer.active_render), "")
    used = {
        f"Material '{slot.material.name}'"
        for slot in ob.material_slots
        if slot.material is not None
    }
    flat: dict[str, bool] = {}
    for number, nodes in askers.items():
        layer = wants[number].name or active
        for owner, node in nodes:
            if owner not in used or layer not in layers:
                continue
            if layer not in flat:
                flat[layer] = _is_flat(ob.data, layers[layer])
            if flat[layer]:
                said = (
                    f"no face of the UV map '{layer}' has an area, so that tangents along it "
                    "have no direction, on"
                )
                report.warn(f"{owner}, node '{node}': {said} {{}}", ob.name)


def _is_flat(mesh: Any, layer: Any) -> bool:
    """True where there are triangles and all have an area of zero in the UV map, beside
    rounding.
    """
    mesh.calc_loop_triangles()
    if len(mesh.loop_triangles) == 0 or len(layer.uv) == 0:
        return False
    a, b, c = np.moveaxis(
        read_copy(layer.uv, "vector", np.float32, 2)[
            read_copy(mesh.loop_triangles, "loops", np.int32, 3)
        ],
        1,
        0,
    )
    (ux, uy), (vx, vy) = (b - a).astype(np.float64).T, (c - a).astype(np.float64).T
    size = max(float(np.abs(np.stack([ux, uy, vx, vy])).max()), 1e-30)
    return bool((np.abs(ux * vy - uy * vx) <= 1e-7 * size * size).all() and np.isfinite(size))
