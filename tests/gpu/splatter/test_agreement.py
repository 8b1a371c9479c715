"""The GPU splatter against the native one: same photons, same points, same irradiance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from photon_splat.core.gpu import painter, splatter
from photon_splat.core.gpu.atlas import TILE, atlas_ranges

from tests.support import corescene as c
from tests.support import gpu_scenes as scenes
from tests.support.opengl import compare, expect_agreement, prepared, splat_on_gpu

pytestmark = pytest.mark.usefixtures("opengl")


@pytest.mark.parametrize("radius_scale", [0.25, 1.0, 4.0])
@pytest.mark.parametrize("scene", [scenes.room, scenes.floor])
def test_scenes(scene, radius_scale: float) -> None:
    compare(scene(), photons_per_pass=20_000, radius_scale=radius_scale)


def test_a_point_per_sample() -> None:
    compare(scenes.room(24), photons_per_pass=5_000, point_spacing=0.0)


EDGE = 1e-5


def at_the_edge(points: dict[str, np.ndarray], rows: np.ndarray) -> int:
    """Pairs of a photon at the rim of a point's kernel, or edge-on to its surface: photons at
    points, which stand in a lattice, are at the rim of many.
    """
    bits = rows.view(np.uint32)
    x, y = (bits[:, 4] & 255) / 127.0 - 1.0, (bits[:, 4] >> 8 & 255) / 127.0 - 1.0
    z = 1.0 - abs(x) - abs(y)
    below = z < 0.0
    x, y = (
        np.where(below, (1.0 - abs(b)) * np.where(a < 0.0, -1.0, 1.0), a)
        for a, b in ((x, y), (y, x))
    )
    normals = np.column_stack([x, y, z])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    found = 0
    for position, normal, radius, key in zip(
        *(points[name] for name in ("position", "normal", "radius", "key")), strict=True
    ):
        there = bits[:, 3] == key
        relative = ((rows[there, :3] - position) ** 2).sum(axis=1) / radius**2
        facing = normals[there] @ normal
        edge_on = (relative < 1.0 + EDGE) & (abs(facing) < EDGE)
        found += np.count_nonzero((abs(relative - 1.0) < EDGE) & (facing > -EDGE) | edge_on)
    return found


@pytest.fixture(scope="module")
def room():
    return prepared(scenes.room(), photons_per_pass=20_000)


@settings(
    max_examples=15,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(0, 3000),
    reach=st.sampled_from([0.0, 0.3, 1.0, 3.0]),
    spread=st.sampled_from([0.0, 1.0, 4.0]),
    strangers=st.sampled_from([0.0, 0.5]),
)
def test_random_photons(
    room, seed: int, count: int, reach: float, spread: float, strangers: float
) -> None:
    """Photons about the points, `reach` radii away, powers over `spread` factors of e, normals and
    some keys at random.
    """
    random = np.random.default_rng(seed)
    points = room.points()
    near = random.integers(0, len(points["key"]), count)
    rows = np.zeros((count, 8), np.float32)
    rows[:, :3] = (
        points["position"][near]
        + random.normal(0, reach, (count, 3)) * points["radius"][near, None]
    )
    bits = rows.view(np.uint32)
    bits[:, 3] = np.where(
        random.random(count) < strangers,
        random.permutation(points["key"])[near],
        points["key"][near],
    )
    bits[:, 4] = random.integers(0, 255, count) | random.integers(0, 255, count) << 8
    rows[:, 5:] = np.exp(random.normal(0, spread, (count, 3)))
    room.place_points(0)
    room.set_photon_rows(rows)
    room.splat()
    cpu = room.points()
    edge = at_the_edge(points, rows)
    expect_agreement(cpu, splat_on_gpu(room)[0], edge)


def test_several_atlases(room) -> None:
    room.place_points(0)
    room.trace_photons(0, 20_000)
    room.splat()
    cpu = room.points()
    gpu, statistics = splat_on_gpu(room, most_texels=2 * TILE)
    assert statistics["atlases"] == -(-room.block_count // 4) > 3
    expect_agreement(cpu, gpu)


@pytest.mark.parametrize("blocks", [0, 1, 4, 5, 1000])
def test_atlases_cover_all_blocks(blocks: int) -> None:
    ranges = list(atlas_ranges(blocks, 2 * TILE))
    assert [b for first, count, _ in ranges for b in range(first, first + count)] == list(
        range(blocks)
    )
    assert all(columns == 2 and count <= 4 for _, count, columns in ranges)


def test_pairs_are_bounded(room, monkeypatch: pytest.MonkeyPatch) -> None:
    """More pairs than buffers hold: several hand-overs, several draws each."""
    monkeypatch.setattr(splatter, "MOST_PAIRS", 20_000)
    monkeypatch.setattr(painter, "MOST_PAIRS", 1_000)
    monkeypatch.setattr(painter, "FEWEST_PAIRS", 1_000)
    handed: list[int] = []
    splat = painter.Painter.splat
    monkeypatch.setattr(
        painter.Painter,
        "splat",
        lambda self, batch: (handed.append(len(batch.order)), splat(self, batch))[1],
    )
    room.place_points(0)
    room.trace_photons(0, 20_000)
    room.splat()
    cpu = room.points()
    gpu, statistics = splat_on_gpu(room)
    assert statistics["batches"] == len(handed) > 3
    assert sum(handed) == statistics["pairs"]
    assert max(handed) <= 40_000
    expect_agreement(cpu, gpu)


def test_a_tile_full_of_photons() -> None:
    """All photons on one block: many runs."""
    renderer = prepared(scenes.floor(16), photons_per_pass=20_000)
    points = renderer.points()
    widest = np.argmax(points["radius"])
    some = renderer.photon_rows(0, 200, 200)
    there = some[some.view(np.uint32)[:, 3] == points["key"][widest]]
    rows = np.tile(there[:1], (50_000, 1))
    rows[:, :3] = points["position"][widest] + np.random.default_rng(1).normal(
        0, 0.2 * points["radius"][widest], (50_000, 3)
    )
    renderer.set_photon_rows(rows)
    renderer.splat()
    cpu = renderer.points()
    assert cpu["count"].max() > 10_000
    expect_agreement(cpu, splat_on_gpu(renderer)[0])


def test_whole_render() -> None:
    """Passes, camera and resolving included: the same picture but for rounding, and the same bit by
    bit when repeated.
    """
    pictures = {
        b: c.picture(scenes.room(24), passes=3, photons_per_pass=40_000, backend=b, seed=5)
        for b in ("CPU", "GPU")
    }
    assert np.abs(pictures["GPU"] - pictures["CPU"]).max() <= 1e-4 * pictures["CPU"].mean()
    assert np.array_equal(
        pictures["GPU"],
        c.picture(scenes.room(24), passes=3, photons_per_pass=40_000, backend="GPU", seed=5),
    )
