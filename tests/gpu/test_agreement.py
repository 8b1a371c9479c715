"""The GPU splatter against the native one: same photons, same points, same irradiance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from photon_splat.core.gpu import painter, splatter
from photon_splat.core.gpu.atlas import TILE, atlas_ranges

from tests import corescene as c
from tests.gpu import scenes
from tests.opengl import compare, expect_agreement, prepared, splat_on_gpu

pytestmark = pytest.mark.usefixtures("opengl")


@pytest.mark.parametrize("radius_scale", [0.25, 1.0, 4.0])
@pytest.mark.parametrize("scene", [scenes.room, scenes.floor])
def test_scenes(scene, radius_scale: float) -> None:
    compare(scene(), photons_per_pass=20_000, radius_scale=radius_scale)


def test_a_point_per_sample() -> None:
    compare(scenes.room(24), photons_per_pass=5_000, point_spacing=0.0)


@pytest.fixture(scope="module")
def room():
    return prepared(scenes.room(), photons_per_pass=20_000)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(0, 3000),
    reach=st.sampled_from([0.0, 0.3, 1.0, 3.0]),
    spread=st.sampled_from([0.0, 1.0, 4.0]),
    strangers=st.sampled_from([0.0, 0.5]),
)
def test_random_photons(room, seed: int, count: int, reach: float, spread: float, strangers: float) -> None:
    """Photons about the points, `reach` radii away, powers over `spread` factors of e, normals and some keys at random."""
    random = np.random.default_rng(seed)
    points = room.points()
    near = random.integers(0, len(points["key"]), count)
    records = np.zeros((count, 8), np.float32)
    records[:, :3] = points["position"][near] + random.normal(0, reach, (count, 3)) * points["radius"][near, None]
    bits = records.view(np.uint32)
    bits[:, 3] = np.where(random.random(count) < strangers, random.permutation(points["key"])[near], points["key"][near])
    bits[:, 4] = random.integers(0, 255, count) | random.integers(0, 255, count) << 8
    records[:, 5:] = np.exp(random.normal(0, spread, (count, 3)))
    room.make_points(0)
    room.set_photon_records(records)
    room.splat()
    cpu = room.points()
    expect_agreement(cpu, splat_on_gpu(room)[0])


def test_several_atlases(room) -> None:
    room.make_points(0)
    room.trace_photons(0, 0, 20_000)
    room.splat()
    cpu = room.points()
    gpu, statistics = splat_on_gpu(room, most_texels=2 * TILE)
    assert statistics["atlases"] == -(-room.block_count // 4) > 3
    expect_agreement(cpu, gpu)


@pytest.mark.parametrize("blocks", [0, 1, 4, 5, 1000])
def test_atlases_cover_all_blocks(blocks: int) -> None:
    ranges = list(atlas_ranges(blocks, 2 * TILE))
    assert [b for first, count, _ in ranges for b in range(first, first + count)] == list(range(blocks))
    assert all(columns == 2 and count <= 4 for _, count, columns in ranges)


def test_pairs_are_bounded(room, monkeypatch: pytest.MonkeyPatch) -> None:
    """More pairs than buffers hold: several hand-overs, several draws each."""
    monkeypatch.setattr(splatter, "MOST_PAIRS", 20_000)
    monkeypatch.setattr(painter, "MOST_PAIRS", 1_000)
    monkeypatch.setattr(painter, "FEWEST_PAIRS", 1_000)
    handed: list[int] = []
    splat = painter.Painter.splat
    monkeypatch.setattr(painter.Painter, "splat", lambda self, batch: (handed.append(len(batch.order)), splat(self, batch))[1])
    room.make_points(0)
    room.trace_photons(0, 0, 20_000)
    room.splat()
    cpu = room.points()
    gpu, statistics = splat_on_gpu(room)
    assert statistics["batches"] == len(handed) > 3
    assert sum(handed) == statistics["pairs"]
    assert max(handed) <= 40_000
    expect_agreement(cpu, gpu)


def test_whole_render() -> None:
    """Passes, camera and resolving included: the same picture but for rounding."""
    pictures = {b: c.picture(scenes.room(24), passes=3, photons_per_pass=40_000, backend=b, seed=5) for b in ("CPU", "GPU")}
    assert np.abs(pictures["GPU"] - pictures["CPU"]).max() <= 1e-4 * pictures["CPU"].mean()
    assert np.array_equal(pictures["GPU"], c.picture(scenes.room(24), passes=3, photons_per_pass=40_000, backend="GPU", seed=5))
