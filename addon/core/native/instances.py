"""Hands instances to the native renderer: all but those that a scale of 0 flattens."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..scene import Scene

if TYPE_CHECKING:
    from photon_splat_native import Renderer


def add_instances(renderer: Renderer, scene: Scene) -> None:
    """After the meshes and materials that they refer to. Warns of what a scale of 0 flattens."""
    instances = scene.instances
    # Of surfaces that coincide rays meet the one that was added first; Cycles shows the object that
    # comes last.
    order = _order(find_flat(scene))

    def of(values: NDArray[Any], kind: Any) -> NDArray[Any]:
        return np.ascontiguousarray(values[order], kind)

    def some(values: NDArray[Any] | None, kind: Any) -> NDArray[Any] | None:
        return None if values is None else of(values, kind)

    renderer.add_instances(
        of(instances.mesh, np.uint32),
        of(instances.matrix, np.float64),
        of(instances.material_set, np.uint32),
        [[int(m) for m in materials] for materials in scene.material_sets],
        groups=some(instances.group, np.uint8),
        lit_groups=some(instances.lit_groups, np.uint64),
        blockers=some(instances.blockers, np.uint64),
        light_groups=some(instances.light_group, np.int16),
        seen_by=some(instances.seen_by, np.uint32),
        holdouts=some(instances.holdout, np.bool_),
        terminator_offsets=some(instances.terminator_offset, np.float32),
        catchers=some(instances.catcher, np.bool_),
        densities=some(instances.density, np.float32),
    )
    for at in np.flatnonzero(np.isin(order, list(instances.motion))):
        steps = instances.motion[int(order[at])]
        renderer.set_motion(int(at), np.ascontiguousarray(steps, np.float64))
    for attribute in instances.attributes:
        renderer.add_instance_attribute(
            attribute.id, np.ascontiguousarray(attribute.values[order], np.float32)
        )


def _order(flat: NDArray[np.bool_]) -> NDArray[np.int64]:
    return np.flatnonzero(~flat)[::-1]


def instance_order(scene: Scene) -> NDArray[np.int64]:
    """The instances that the renderer has, in its order, as indices of the scene's."""
    return _order(_is_flat(scene))


def name_of(scene: Scene, instance: int) -> str:
    """By which warnings name one of the scene's instances."""
    owners = scene.instances.owners
    return owners[instance] if owners else scene.meshes[scene.instances.mesh[instance]].name


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
