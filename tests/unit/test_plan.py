"""The scene plan: it says what a scene lacks, leaves out nothing that is there, and what it leaves
out costs nothing.
"""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.render.plan import make_plan
from photon_splat.core.render.settings import Integrator, RenderSettings
from photon_splat.core.scene import CameraMotion, LightKind, Scene, Shutter

from tests.robustness.test_degenerate import room
from tests.support import corescene as c


def floor(
    albedo: float = 0.5, emission: float = 0.0, world: float = 0.0, lamp: float = 0.0
) -> Scene:
    lights = [c.lamp(LightKind.POINT, lamp)] if lamp else []
    return c.scene(
        c.ortho_down(2.0, 1.0, 8), [(c.quad(), c.lambert(albedo, emission))], lights, world
    )


@pytest.mark.parametrize(
    ("what", "settings", "sentence"),
    [
        (floor(), {}, "Nothing shines"),
        (floor(albedo=0.0, lamp=1.0), {}, "No surface reflects light"),
        (floor(lamp=1.0), {"max_bounces": 0}, "Only direct light is asked for"),
        (floor(lamp=1.0), {"photons_per_pass": 0}, "Photons are switched off"),
        (floor(lamp=1.0), {"integrator": Integrator.REFERENCE}, "The path tracer does everything"),
    ],
)
def test_what_needs_no_photons_traces_none(what: Scene, settings: dict, sentence: str) -> None:
    plan = make_plan(what, RenderSettings(**settings))
    assert not plan.flags["photons"]
    assert plan.sentences[0].startswith(sentence)
    statistics = c.shoot(what, passes=2, **settings).statistics
    assert statistics["photons"]["traced"] == 0
    assert statistics["plan"]["sentences"][0].startswith(sentence)


@pytest.mark.parametrize("what", [floor(emission=0.1), floor(world=0.1), floor(lamp=1.0)])
def test_any_light_is_enough(what: Scene) -> None:
    assert make_plan(what, RenderSettings()).flags["photons"]
    settings = {
        "passes": 2,
        "photons_per_pass": 1000,
        "adaptive_samples": False,
        "adaptive_indirect": False,
    }
    assert c.shoot(what, **settings).statistics["photons"]["traced"] == 2000


def test_what_moves_is_told() -> None:
    what = floor(lamp=1.0)
    assert "shutter" not in " ".join(make_plan(what, RenderSettings()).sentences)
    what.shutter = Shutter(np.ones(2, np.float32))
    what.instances.motion = {0: np.tile(np.eye(4), (3, 1, 1))}
    what.camera.motion = CameraMotion(np.tile(np.eye(4), (3, 1, 1)))
    sentences = make_plan(what, RenderSettings()).sentences
    assert "While the shutter is open 1 instance moves, the camera moves." in sentences


def test_words_and_flags() -> None:
    statistics = c.shoot(room(pixels=32), passes=2, photons_per_pass=20_000).statistics
    plan = statistics["plan"]
    text = " ".join(plan["sentences"])
    assert "The world is black" in text
    assert "No textures" in text
    assert "Surface edges cut" in text
    assert "Things or walls stand in" in text
    assert plan["flags"] == {
        "photons": True, "world": False, "textures": False,
        "boundary": True, "occlusion": True, "adaptive_radius": True,
        "adaptive_samples": True, "adaptive_indirect": True, "final_gather": False,
    }  # fmt: skip


def test_components_can_be_switched_off() -> None:
    what = room(pixels=24)
    plain = c.shoot(what, passes=12, photons_per_pass=20_000)
    for name in ("occlusion", "adaptive_radius", "adaptive_samples", "boundary_correction"):
        without = c.shoot(what, passes=12, photons_per_pass=20_000, **{name: False})
        assert not np.array_equal(plain.passes["Combined"], without.passes["Combined"]), name
        assert len(without.statistics["plan"]["sentences"]) > 0
    assert (
        c.shoot(what, passes=2, photons_per_pass=20_000, occlusion=False).statistics["discs"][
            "obstructed"
        ]
        == 0
    )
