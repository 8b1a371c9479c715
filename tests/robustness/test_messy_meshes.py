"""Meshes as strangers leave them: faces there twice or turned over, holes, faces inside, vertices
apart, triangles without area. Splatting agrees with the path tracer.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from photon_splat.core.scene import LightKind, Mesh, Scene

from tests.support import corescene as c

Shape = tuple[np.ndarray, list[tuple[int, ...]]]


def shape(mesh: Mesh, lift: float = 0.0) -> Shape:
    positions = mesh.positions.astype(float) + np.array([0.0, 0.0, lift])
    return positions, [tuple(int(i) for i in t) for t in mesh.triangles]


def grid(cells: int) -> Shape:
    """A wavy sheet of 1.2 m."""
    at = np.linspace(-0.6, 0.6, cells + 1)
    positions = np.array([(x, y, 0.4 + 0.1 * np.sin(3 * x)) for y in at for x in at])
    row = cells + 1
    corners = [j * row + i for j in range(cells) for i in range(cells)]
    faces = [t for q in corners for t in ((q, q + 1, q + row + 1), (q, q + row + 1, q + row))]
    return positions, faces


def some(rng: np.random.Generator, faces: list) -> list:
    share = rng.choice([0.2, 0.5, 1.0])
    return [face for face in faces if rng.random() < share]


def inner_faces(rng: np.random.Generator, positions: np.ndarray) -> list:
    corners = [rng.choice(len(positions), 3, replace=False) for _ in range(3)]
    return [tuple(int(i) for i in face) for face in corners]


def apart(positions: np.ndarray, faces: list) -> Shape:
    every = np.array([positions[i] for face in faces for i in face])
    return every, [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(len(faces))]


MESSES: tuple[Callable[[np.random.Generator, np.ndarray, list], Shape], ...] = (
    lambda rng, v, f: (v, f + some(rng, f)),
    lambda rng, v, f: (v, f + [face[::-1] for face in some(rng, f)]),
    lambda rng, v, f: (v, [face[::-1] if rng.random() < 0.3 else face for face in f]),
    lambda rng, v, f: (v, [face for face in f if rng.random() > 0.2] or f),
    lambda rng, v, f: (v, f + inner_faces(rng, v)),
    lambda rng, v, f: (v, f + [(face[0], face[1], face[0]) for face in some(rng, f)]),
    lambda rng, v, f: apart(v, f),
)


def messy_scene(seed: int) -> Scene:
    """A mesh with one to three messes over a floor, under one lamp of a random kind."""
    rng = np.random.default_rng(seed)
    shapes = (
        shape(c.globe(0.5, int(rng.integers(1, 4))), 0.6),
        grid(int(rng.integers(1, 8))),
        shape(c.box((-0.4, -0.4, 0.05), (0.4, 0.4, 0.8))),
    )
    positions, faces = shapes[rng.integers(len(shapes))]
    for _ in range(int(rng.integers(1, 4))):
        positions, faces = MESSES[rng.integers(len(MESSES))](rng, positions, faces)
    lamps = (
        c.lamp(LightKind.SUN, 3.0, (0.0, 0.0, 5.0), (1.0, 1.0, 0.0), angle=0.05),
        c.lamp(LightKind.POINT, 100.0, (1.0, -1.0, 2.0), radius=0.05),
        c.lamp(LightKind.AREA, 60.0, (-1.0, -1.0, 2.0), (0.0, 0.0, 0.3), size=(0.5, 0.5)),
    )
    things = [(c.mesh(positions, faces), c.lambert(0.8)), (c.quad(2.0), c.lambert(0.7))]
    view = c.perspective((0.0, -3.0, 2.0), (0.0, 0.0, 0.3), 48, 36)
    world = float(rng.choice([0.0, 0.5]))
    return c.scene(view, things, [lamps[rng.integers(len(lamps))]], world)


@pytest.mark.parametrize("seed", [*range(10), 54, 98])
def test_splatting_agrees_with_the_path_tracer_on_a_messy_mesh(seed: int) -> None:
    what = messy_scene(seed)
    splat = c.picture(what, c.BOTH[0], passes=12, photons_per_pass=50_000)
    reference = c.picture(what, c.BOTH[1], passes=64)
    assert splat.mean() == pytest.approx(reference.mean(), rel=0.01)
    assert splat.max() < 1.2 * reference.max()
