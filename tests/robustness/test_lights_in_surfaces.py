"""Area lamps and emissive meshes in the plane of a surface: one answer of all estimators, and a
warning that names both.
"""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.render.result import RenderResult
from photon_splat.core.render.settings import FinalGather, Integrator
from photon_splat.core.scene import LightKind, Scene

from tests.support import corescene as c


def room(below: float, glowing: bool = False, ground: float = 0.0, albedo: float = 0.0) -> Scene:
    """A closed room, `below` m under the ceiling an area lamp or a mesh of that albedo; its name is
    Panel. It may stand on ground of that size.
    """
    view = c.perspective((0.0, -1.3, 1.2), (0.0, 0.5, 1.2), 16, 16, 1.3)
    walls = c.box((-1.5, -1.5, 0.0), (1.5, 1.5, 2.5), inwards=True)
    if glowing:
        sheet = c.quad(0.35, 2.5 - below)
        sheet.name = "Panel"
        things = [(sheet, c.lambert(albedo, 4.0)), (walls, c.lambert(0.6))]
        if ground:
            things.append((c.quad(ground / 2, -0.1), c.lambert(0.6)))
        return c.scene(view, things)
    lamp = c.lamp(LightKind.AREA, 30.0, (0.2, -0.1, 2.5 - below), size=(0.7, 0.7))
    lamp.name = "Panel"
    return c.scene(view, [(walls, c.lambert(0.6))], [lamp])


def shoot(
    what: Scene, integrator: Integrator, gather: FinalGather = FinalGather.OFF
) -> RenderResult:
    return c.shoot(what, integrator, passes=32, photons_per_pass=20_000, final_gather=gather)


def means(below: float, glowing: bool = False, ground: float = 0.0) -> list[float]:
    """Mean radiance by splatting without and with final gathering, and by the path tracer."""
    ways = (
        (Integrator.SPLAT, FinalGather.OFF),
        (Integrator.SPLAT, FinalGather.ON),
        (Integrator.REFERENCE, FinalGather.OFF),
    )
    what = room(below, glowing, ground)
    return [float(shoot(what, *way).passes["Combined"][..., :3].mean()) for way in ways]


@pytest.mark.parametrize("glowing", [False, True], ids=["lamp", "mesh"])
def test_all_estimators_agree_on_a_light_in_the_ceiling(glowing: bool) -> None:
    clear, within = means(0.01, glowing), means(0.0, glowing)
    assert clear[:2] == pytest.approx([clear[2]] * 2, rel=0.02)
    assert within[:2] == pytest.approx([within[2]] * 2, rel=0.06)
    assert within[2] < 0.9 * clear[2]


def test_a_lamp_just_above_the_ceiling_lights_nothing() -> None:
    assert not any(means(-1e-5))


def test_a_lamp_just_below_the_ceiling_lights_as_any_other() -> None:
    assert np.allclose(means(2e-6), means(0.01), rtol=0.02)


@pytest.mark.parametrize("glowing", [False, True], ids=["lamp", "mesh"])
def test_the_warning_names_light_and_mesh(glowing: bool) -> None:
    warnings = shoot(room(0.0, glowing), Integrator.SPLAT).statistics["warnings"]
    assert len(warnings) == 1
    assert "'Panel' in 'box'" in warnings[0]
    assert not shoot(room(0.01, glowing), Integrator.SPLAT).statistics["warnings"]


def test_on_wide_ground_a_panel_close_to_the_ceiling_is_not_in_it() -> None:
    """What light samples pass over grows with the distance. On ground of 120 m that was taken for
    the panel's distance from the ceiling, and two thirds of its light were left.
    """
    what = room(0.001, glowing=True, ground=120.0)
    assert not shoot(what, Integrator.SPLAT).statistics["warnings"]
    assert means(0.001, True, 120.0) == pytest.approx(means(0.001, True), rel=0.02)


def test_a_panel_close_to_the_ceiling_lights_it_above_itself_alone() -> None:
    """The gap has a light of its own, which discs beside it took for theirs: 1.08 of it there."""
    what = room(0.001, glowing=True, albedo=0.8)
    what.camera, what.frame = c.perspective((0.0, -1.3, 0.6), (0.0, 0.3, 2.5), 24, 24, 1.3)
    paths = c.shoot(what, Integrator.REFERENCE, passes=1000).passes["Combined"][..., :3]
    ceiling = paths.max(axis=-1) < 0.5
    shots = [c.shoot(what, passes=8, photons_per_pass=5_000, seed=seed) for seed in (1, 2, 3)]
    splat = np.mean([shot.passes["Combined"][..., :3] for shot in shots], axis=0)
    assert splat[ceiling].mean() == pytest.approx(paths[ceiling].mean(), rel=0.03)
