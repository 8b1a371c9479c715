"""Large arrays that the native renderer keeps instead of copying them."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest
from photon_splat.core.native.library import load


def _grid(side: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions and triangles of a square."""
    places = np.stack(np.meshgrid(*[np.linspace(0, 1, side + 1)] * 2), -1).reshape(-1, 2)
    positions = np.zeros((len(places), 3), np.float32)
    positions[:, :2] = places
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    quads = np.stack([corner, corner + 1, corner + side + 2, corner + side + 1], 1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.uint32)
    return positions, triangles


@pytest.mark.parametrize(("side", "kept"), [(300, True), (30, False)])
@pytest.mark.parametrize("mirrored", [False, True])
def test_arrays_live_as_long_as_they_are_needed(side: int, kept: bool, mirrored: bool) -> None:
    """Those of a mesh that a mirroring turns round are copied when the scene is built; small ones
    at once.
    """
    positions, lent = _grid(side)
    lent = lent.copy()
    alive = weakref.ref(lent)
    renderer = load().Renderer(1)
    renderer.add_material(*[((0.5, 0.5, 0.5), -1, (0.0, 0.0, 0.0), -1)] * 2)
    renderer.add_mesh(positions, lent, None, None, None)
    matrix = np.diag([-1.0 if mirrored else 1.0, 1.0, 1.0, 1.0])
    renderer.add_instances(np.zeros(1, np.uint32), matrix[None], np.zeros(1, np.uint32), [[0]])
    del lent
    gc.collect()
    assert (alive() is not None) == kept
    renderer.build()
    gc.collect()
    assert (alive() is not None) == (kept and not mirrored)
    del renderer
    gc.collect()
    assert alive() is None


def test_gathering_says_what_does_not_exist() -> None:
    values, out = np.arange(6, dtype=np.uint32).reshape(3, 2), np.empty((2, 2), np.uint32)
    load().gather(values, np.array([2, 0], np.uint32), out)
    assert out.tolist() == [[4, 5], [0, 1]]
    with pytest.raises(ValueError, match="names an element that does not exist"):
        load().gather(values, np.array([2, 3], np.uint32), out)
