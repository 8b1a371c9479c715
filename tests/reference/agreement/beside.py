"""The means of the open scene's picture, ours and Cycles'."""

from __future__ import annotations

from tests.support.corescene import Integrator, shoot


def means_beside_cycles(
    samples: int, integrator: Integrator = Integrator.SPLAT, **settings: object
) -> tuple[float, float]:
    """Ours and Cycles', which takes so many samples; `settings` as of shoot()."""
    import bpy
    from photon_splat.export import export_scene

    from tests.reference.cycles.references import render_with_cycles

    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    ours = shoot(what, integrator, seed=1, **settings).passes["Combined"][..., :3]
    return float(ours.mean()), float(render_with_cycles(samples, 21)[..., :3].mean())
