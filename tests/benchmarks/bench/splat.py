"""Seconds that the CPU splatter takes for a million photons: by radius, and by the number of
triangles. Needs bpy.
"""

from __future__ import annotations

from dataclasses import replace
from statistics import median
from typing import Any

import numpy as np
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Mesh, Scene

from tests.benchmarks.bench.scenes import from_blend

SIZE = (960, 540)
PHOTONS = 1_000_000
REPEATS = 5
RADII = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8)
"""Times the default: an 8-fold range."""
LIMIT, RADIUS_LIMIT, TRIANGLE_LIMIT = 0.060, 1.3, 1.1


def subdivided(scene: Scene, triangles: int) -> Scene:
    """`scene` with each triangle of the largest meshes cut into n x n alike, until there are about
    `triangles`.
    """
    count = sum(len(mesh.triangles) for mesh in scene.meshes)
    n = max(1, round((triangles / count) ** 0.5))
    return replace(scene, meshes=[_cut(mesh, n) for mesh in scene.meshes])


def _cut(mesh: Mesh, n: int) -> Mesh:
    i, j = (
        index.ravel() for index in np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    )
    inside = i + j <= n
    i, j = i[inside], j[inside]
    number = np.full((n + 2, n + 2), -1)
    number[i, j] = np.arange(len(i))
    a, b = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    up, down = a + b < n, a + b < n - 1
    small = np.concatenate(
        [
            np.stack([number[a[up], b[up]], number[a[up] + 1, b[up]], number[a[up], b[up] + 1]], 1),
            np.stack(
                [
                    number[a[down] + 1, b[down]],
                    number[a[down] + 1, b[down] + 1],
                    number[a[down], b[down] + 1],
                ],
                1,
            ),
        ]
    )
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    u, v = (i / n)[None, :, None], (j / n)[None, :, None]
    points = corners[:, None, 0] * (1 - u - v) + corners[:, None, 1] * u + corners[:, None, 2] * v
    # Neighbours share their vertices, as in a mesh that was subdivided.
    positions, same = np.unique(
        points.reshape(-1, 3).astype(np.float32), axis=0, return_inverse=True
    )
    whole = same.reshape(len(corners), len(i))[:, small].reshape(-1, 3)
    slots = None if mesh.slots is None else np.repeat(mesh.slots, len(small))
    return Mesh(mesh.name, positions, whole.astype(np.uint32), slots=slots)


def seconds_of(scene: Scene, radius: float = 1.0) -> dict[str, float]:
    """Seconds of splatting for PHOTONS stored photons, in batches as a render has them: median;
    blocks of points.
    """
    renderer = load().Renderer(0)
    fill_renderer(
        renderer,
        scene,
        RenderSettings(
            photons_per_pass=PHOTONS, radius_scale=radius, caustics=False, adaptive_samples=False
        ),
    )
    renderer.build()
    seconds = []
    for number in range(REPEATS + 1):
        renderer.trace_camera(number)
        renderer.place_points(number)
        before = renderer.statistics()
        first, stored, batch = 0, 0, renderer.paths_per_batch
        while stored < PHOTONS:
            renderer.trace_photons(first, batch)
            renderer.splat()
            first += batch
            stored = renderer.statistics()["photons"]["stored"] - before["photons"]["stored"]
        now = renderer.statistics()
        seconds.append((now["seconds"]["splat"] - before["seconds"]["splat"]) * PHOTONS / stored)
    return {"seconds": median(seconds[1:]), "blocks": int(now["visible_points"]) // 64}


def measure() -> dict[str, Any]:
    """See RADII and LIMIT."""
    scene = from_blend("cornell_box_1500", *SIZE)
    figures: dict[str, Any] = {
        f"radius x {radius:g}": seconds_of(scene, radius) for radius in RADII
    }
    by_radius = [figures[f"radius x {radius:g}"]["seconds"] for radius in RADII]
    spread = max(by_radius) / min(by_radius)
    few = figures["radius x 1"]["seconds"]
    big = subdivided(scene, 10_000_000)
    count = sum(len(big.meshes[m].triangles) for m in big.instances.mesh)
    many = seconds_of(big)["seconds"]
    figures |= {
        "seconds": few,
        "largest over least by radius": spread,
        f"{count:,} triangles": many,
        "by triangles": many / few,
    }
    return figures | {
        "kept": few <= LIMIT and spread <= RADIUS_LIMIT and many / few <= TRIANGLE_LIMIT
    }
