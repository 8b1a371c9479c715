"""Which materials the meshes of an exported scene are made of."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..core.scene import Mesh, Scene


def materials_of_meshes(scene: Scene) -> Iterator[tuple[Mesh, set[int]]]:
    """Each mesh with indices into `scene.materials`, once for each set of materials that it has."""
    rows = set(
        zip(scene.instances.mesh.tolist(), scene.instances.material_set.tolist(), strict=True)
    )
    for index, materials in sorted(rows):
        mesh = scene.meshes[index]
        of_slots = scene.material_sets[materials]
        if mesh.strands is None:  # other slots may be those of its hair
            used = np.unique(mesh.slots) if mesh.slots is not None else [0]
            of_slots = of_slots[np.minimum(used, len(of_slots) - 1)]
        yield mesh, set(of_slots.tolist())
