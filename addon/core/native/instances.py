"""Hands instances to the native renderer: all but those that a scale of 0 flattens."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..scene import ALL_GROUPS, ALL_RAYS, NO_LIGHT_GROUP, TERMINATOR_OFFSET, Scene

if TYPE_CHECKING:
    from photon_splat_native import Renderer


def add_instances(renderer: Renderer, scene: Scene) -> None:
    """After the meshes and materials that they refer to. Warns of what a scale of 0 flattens."""
    instances = scene.instances
    material_sets = [[int(m) for m in s] for s in scene.material_sets]
    matrices = np.ascontiguousarray(instances.matrix, np.float64)
    flat = find_flat(scene)
    count = len(flat)
    groups = np.zeros(count, int) if instances.group is None else instances.group
    lit = [ALL_GROUPS] * count if instances.lit_groups is None else instances.lit_groups.tolist()
    blockers = [ALL_GROUPS] * count if instances.blockers is None else instances.blockers.tolist()
    light_groups = (
        [NO_LIGHT_GROUP] * count
        if instances.light_group is None
        else instances.light_group.tolist()
    )
    seen_by = [ALL_RAYS] * count if instances.seen_by is None else instances.seen_by.tolist()
    holdout = [False] * count if instances.holdout is None else instances.holdout.tolist()
    catcher = [False] * count if instances.catcher is None else instances.catcher.tolist()
    offset = (
        [TERMINATOR_OFFSET] * count
        if instances.terminator_offset is None
        else instances.terminator_offset.tolist()
    )
    # Of surfaces that coincide rays meet the one that was added first; Cycles shows the object that
    # comes last.
    for i in _order(flat):
        materials = material_sets[int(instances.material_set[i])]
        linking = (int(groups[i]), lit[i], blockers[i], light_groups[i])
        renderer.add_instance(
            int(instances.mesh[i]),
            matrices[i],
            materials,
            *linking,
            seen_by[i],
            holdout[i],
            offset[i],
            catcher[i],
        )
        if instances.density is not None and instances.density[i] != 1.0:
            renderer.set_density(float(instances.density[i]))
        if int(i) in instances.motion:
            renderer.set_motion(np.ascontiguousarray(instances.motion[int(i)], np.float64))
    for attribute in instances.attributes:
        renderer.add_instance_attribute(
            attribute.id, np.ascontiguousarray(attribute.values[_order(flat)], np.float32)
        )


def _order(flat: NDArray[np.bool_]) -> NDArray[np.int64]:
    return np.flatnonzero(~flat)[::-1]


def instance_order(scene: Scene) -> NDArray[np.int64]:
    """The instances that the renderer has, in its order, as indices of the scene's."""
    return _order(_is_flat(scene))


def find_flat(scene: Scene) -> NDArray[np.bool_]:
    """(I,) which instances a scale of 0 flattens. The renderer gets none of them; `scene` gets
    warnings.
    """
    instances = scene.instances
    flat = _is_flat(scene)
    for name in sorted({scene.meshes[m].name for m in instances.mesh[flat]}):
        scene.warnings.append(
            f"Mesh '{name}' stands in the scene flattened to nothing (a scale of 0); those "
            "instances are left out."
        )
    return flat


def _is_flat(scene: Scene) -> NDArray[np.bool_]:
    flat: NDArray[np.bool_] = (
        np.linalg.det(scene.instances.matrix[:, :3, :3].astype(np.float32)) == 0
    )
    return flat
