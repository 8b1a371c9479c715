"""Photon beams against the path tracer: caustics in fog and in cloudy water, of lights so large
that paths find them.
"""

from __future__ import annotations

import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import Scene

from tests.support import stage
from tests.support.corescene import picture
from tests.support.paths import ROOT

MOST = 0.02


def large_light(name: str) -> Scene:
    """blend_scenes/NAME.blend with a lamp of 1.2 m, or a sun of 34 degrees."""
    import bpy
    from photon_splat.export import export_scene

    bpy.ops.wm.open_mainfile(filepath=str(ROOT / "blend_scenes" / f"{name}.blend"))
    stage.resize(48, 30)
    for ob in stage.scene().objects:
        if ob.type == "LIGHT" and ob.data.type == "SUN":
            ob.data.angle = 0.6
        elif ob.type == "LIGHT":
            ob.data.shadow_soft_size = 0.6
    return export_scene(bpy.context.evaluated_depsgraph_get())


@pytest.mark.parametrize(("name", "samples"), [("fog_lens", 2000), ("cloudy_pool", 600)])
def test_the_mean_of_caustics_in_media_is_the_path_tracers(name: str, samples: int) -> None:
    what = large_light(name)
    reference = picture(what, Integrator.REFERENCE, passes=samples, seed=11)
    ours = picture(what, passes=24, seed=1)
    assert ours.mean() == pytest.approx(reference.mean(), rel=MOST)
