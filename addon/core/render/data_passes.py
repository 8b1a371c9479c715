"""Passes that tell what is seen: from camera rays of their own, beside the film."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..native.instances import instance_order
from ..scene import Labels, Neighbours, Scene
from .cryptomatte import id_of, metadata
from .result import CRYPTOMATTES, DATA_ARRAYS, WANTED_ARRAYS, Passes, matte_pass

SAMPLES = 64
"""Of each pixel: coverage is known to 1/64, Cycles' of a render of that many samples."""
OF_ONE_SAMPLE = {"Position", "Object Index", "Material Index"}
"""Passes that hold what the first sample meets; the others are means."""


def asks_ambient(labels: Labels) -> bool:
    """Whether the film is to tell how open it is above what is seen."""
    return "Ambient Occlusion" in labels.passes


def asks_rays(labels: Labels) -> bool:
    """Whether any pass is wanted that data_passes() makes."""
    return not WANTED_ARRAYS.keys() >= set(labels.passes)


def data_passes(renderer: Any, scene: Scene, labels: Labels) -> Passes:
    """The wanted passes of `scene`, from its renderer, which has been built."""
    order = instance_order(scene)

    def ids(names: list[str]) -> np.ndarray:
        known = {name: id_of(name) for name in dict.fromkeys(names)}
        return np.array([known[name] for name in names], np.float32)

    means = labels.aovs or any(
        name not in OF_ONE_SAMPLE and name not in WANTED_ARRAYS for name in labels.passes
    )
    if labels.neighbours is not None:
        _set_frames(renderer, order, labels.neighbours)
    arrays = renderer.data_passes(
        object_index=np.ascontiguousarray(labels.object_index[order], np.int32),
        object_id=ids(labels.objects)[order],
        asset_id=ids(labels.assets)[order],
        material_index=np.ascontiguousarray(labels.material_index, np.int32),
        material_id=ids(labels.materials),
        levels=labels.levels,
        mist=list(labels.mist),
        alpha_threshold=labels.alpha_threshold,
        programs=labels.aov_programs,
        samples=SAMPLES if means else 1,
    )
    found = {name: arrays[array] for name, array in DATA_ARRAYS.items() if name in labels.passes}
    for name, array in CRYPTOMATTES.items():
        for rank in range(0, labels.levels, 2):
            info = matte_pass(name, rank // 2)
            if info.name in labels.passes:
                found[info.name] = np.ascontiguousarray(arrays[array][..., 2 * rank : 2 * rank + 4])
    for (name, is_color), values in zip(labels.aovs, arrays["values"], strict=True):
        found[name] = values if is_color else np.ascontiguousarray(values[..., :1])
    return found


def _set_frames(renderer: Any, order: np.ndarray, frames: Neighbours) -> None:
    """`order`: rows of the scene's instances as the renderer has them."""
    place = {int(row): i for i, row in enumerate(order)}
    moves = {place[row]: matrices for row, matrices in frames.moves.items() if row in place}
    renderer.set_frames(
        np.fromiter(moves, np.int32, len(moves)),
        np.array(list(moves.values()), np.float64).reshape(-1, 2, 4, 4),
        [(mesh, np.ascontiguousarray(by, np.float32)) for mesh, by in frames.shapes.items()],
        np.ascontiguousarray(frames.camera, np.float64),
        [float(zoom) for zoom in frames.zoom],
    )


def matte_names(labels: Labels) -> dict[str, list[str]]:
    """The things in each of the wanted mattes, by its name."""
    named = {
        "CryptoObject": labels.objects,
        "CryptoAsset": labels.assets,
        "CryptoMaterial": labels.materials,
    }
    return {
        name: things for name, things in named.items() if matte_pass(name, 0).name in labels.passes
    }


def manifests(labels: Labels, layer: str = "") -> dict[str, str]:
    """Metadata of the wanted mattes; `layer` is what stands before their names in a file."""
    told: dict[str, str] = {}
    for name, things in matte_names(labels).items():
        told |= metadata(f"{layer}{name}", things)
    return told
