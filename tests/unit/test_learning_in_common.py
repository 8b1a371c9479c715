"""What a part of a picture learns before its passes takes little beside them."""

from __future__ import annotations

import pytest
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.parts import Part
from photon_splat.core.render.settings import FinalGather, RenderSettings
from photon_splat.core.scene import LightKind

from tests.support import corescene as c

PATHS = 5000
COMMON_PASSES = 4


def test_without_time_passes_in_common_are_no_larger_than_a_first_pass() -> None:
    """Of a picture whose paths gather, which has more samples of each pixel in its later passes.
    The first pass of the part has no pilot of its own.
    """
    room = c.box((-2, -2, 0), (2, 2, 2), inwards=True)
    scene = c.scene(
        c.perspective((0, -1.9, 1.0), (0, 0, 0.8), 32, 32, 1.2),
        [(room, c.lambert(0.7))],
        [c.lamp(LightKind.POINT, 60.0, (1.2, 1.2, 1.6))],
    )
    renderer = load().Renderer(0)
    Part(1, 2).tell(renderer)
    settings = RenderSettings(photons_per_pass=PATHS, final_gather=FinalGather.ON)
    fill_renderer(renderer, scene, settings)
    renderer.build()
    seconds = renderer.learn_in_common(seconds=0.0)
    assert all(of_one > 0 for of_one in seconds)
    learnt = renderer.statistics()["photons"]
    assert learnt["traced"] == 0
    assert 0 < learnt["pilot"] <= (COMMON_PASSES + 2) * PATHS  # what chooses radii among them
    assert renderer.learn_in_common() == (0.0, 0.0)
    samples, _ = renderer.next_pass
    assert samples > 4
    renderer.limit_pass(1.0, 1.0)
    renderer.render_pass(0)
    done = renderer.statistics()["photons"]
    assert done["pilot"] == learnt["pilot"]
    assert PATHS / 8 < done["traced"] <= PATHS
    assert renderer.film(["samples"])["samples"].max() == pytest.approx(1.0)
