"""A room lit through a window by an even sky: the guide that finds it changes the noise, not the
light.
"""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.native.library import load
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import Material, Mesh, Scene
from photon_splat.core.scene.shading import Feature, Program

from tests.support import corescene as c


def _room() -> Scene:
    """A box of 2 m whose ceiling has a hole of 0.4 m, seen from above its floor; radiance 1 comes
    in.
    """
    box = c.box((-1, -1, -1), (1, 1, 1), inwards=True)
    middle = box.positions[box.triangles].mean(1)
    walls = Mesh("walls", box.positions, box.triangles[middle[:, 2] < 0.99])
    low, high = -0.2, 0.2
    ring = [(-1, -1), (1, -1), (1, 1), (-1, 1), (low, low), (high, low), (high, high), (low, high)]
    corners = np.array([(x, y, 1.0) for x, y in ring], np.float32)
    quads = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    ceiling = Mesh(
        "ceiling",
        corners,
        np.array([t for a, b, d, e in quads for t in ((a, d, b), (a, e, d))], np.int32),
    )
    view = c.perspective((0.0, 0.0, 0.9), (0.0, 0.0, -1.0), 48, 48, 1.4)
    what = c.scene(view, [(walls, c.lambert(0.5)), (ceiling, c.lambert(0.5))])
    what.world = (1.0, 1.0, 1.0)
    return what


@pytest.mark.parametrize("bounces", [0, 4])
def test_same_light_less_noise(bounces: int) -> None:
    what = _room()
    runs = {
        integrator: np.stack(
            [
                c.picture(
                    what,
                    passes=32,
                    max_bounces=bounces,
                    seed=seed,
                    integrator=integrator,
                    photons_per_pass=40_000,
                )[..., 0]
                for seed in range(4)
            ]
        ).astype(np.float64)
        for integrator in (Integrator.SPLAT, Integrator.REFERENCE)
    }
    guided, plain = runs[Integrator.SPLAT], runs[Integrator.REFERENCE]
    error = (
        guided.mean((1, 2)).std(ddof=1) ** 2 / 4 + plain.mean((1, 2)).std(ddof=1) ** 2 / 4
    ) ** 0.5
    assert guided.mean() == pytest.approx(plain.mean(), rel=0.004, abs=4 * error)
    assert guided.var(0, ddof=1).mean() < 0.25 * plain.var(0, ddof=1).mean()


def _pane() -> Program:
    """Transparent where it is seen from behind; else black."""
    operations = {name: made[0] for name, made in load().shader_operations().items()}
    white, register = 1 << 31, 0
    code = [
        *(operations["Backfacing"], register),
        *(operations["Transparent"], register, white),
        operations["End"],
    ]
    return Program(
        "pane", np.array(code, np.uint32), np.ones(3, np.float32), 1, Feature.TRANSPARENT
    )


def _mean(what: Scene, integrator: Integrator) -> np.ndarray:
    return np.array(
        [
            c.picture(
                what, passes=24, max_bounces=4, seed=seed, integrator=integrator,
                photons_per_pass=40_000,
            )[..., 0].mean(dtype=np.float64)
            for seed in range(3)
        ]
    )  # fmt: skip


def test_light_passes_a_pane_as_rays_back_along_its_way_see_it() -> None:
    """Rays from the room meet the pane's back and pass it; the light itself meets its front."""
    open_ = _room()
    closed = _room()
    pane = c.quad(0.2, 1.0)
    closed.meshes.append(pane)
    index = np.arange(3, dtype=np.uint32)
    closed.instances = type(closed.instances)(index, np.tile(np.eye(4), (3, 1, 1)), index.copy())
    closed.material_sets.append(np.array([2], np.int32))
    closed.materials.append(Material("pane", program=0))
    closed.programs = [_pane()]
    reference, ours = _mean(open_, Integrator.REFERENCE), _mean(closed, Integrator.SPLAT)
    error = (reference.std(ddof=1) ** 2 / 3 + ours.std(ddof=1) ** 2 / 3) ** 0.5
    assert ours.mean() == pytest.approx(reference.mean(), rel=0.004, abs=4 * error)
    pane.triangles[:] = pane.triangles[:, ::-1].copy()  # its back outside: no light comes in
    assert _mean(closed, Integrator.SPLAT).max() < 1e-3 * reference.mean()
