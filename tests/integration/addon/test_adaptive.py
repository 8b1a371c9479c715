"""Adaptive subdivision as files ask for it, and what stays untouched."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from photon_splat.core.scene import Mesh

from tests.support import stage
from tests.support.blender import in_blender


def _sheet(kind: str = "SIMPLE") -> tuple[Any, Any]:
    """A square below the camera that is subdivided by pixels of a small picture; with its
    modifier.
    """
    import bpy

    stage.camera((0, 0, 4))
    stage.resize(32)
    ob = stage.plane("Sheet")
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = kind
    modifier.levels, modifier.render_levels = 1, 1
    cycles = bpy.context.scene.cycles
    cycles.dicing_rate, cycles.max_subdivisions, cycles.offscreen_dicing_scale = 1.0, 12, 1.0
    _switch(ob, modifier, True)
    return ob, modifier


def _switch(ob: Any, modifier: Any, on: bool) -> None:
    """Before Blender 5.0 it is an experimental feature of Cycles, and belongs to the object."""
    import bpy

    if bpy.app.version < (5, 0, 0):
        bpy.context.scene.cycles.feature_set = "EXPERIMENTAL"
        ob.cycles.use_adaptive_subdivision = on
    else:
        modifier.use_adaptive_subdivision = on


def _rate(ob: Any, modifier: Any, pixels: float) -> None:
    import bpy

    if bpy.app.version < (5, 0, 0):
        ob.cycles.dicing_rate = pixels
    else:
        modifier.adaptive_pixel_size = pixels


def _mesh() -> Mesh:
    """Of the one object; what modifiers have made has no name of its own in Blender 4.5."""
    what = stage.exported()
    assert what.warnings == []
    (mesh,) = what.meshes
    return mesh


def _edge(mesh: Mesh) -> float:
    a, b = (mesh.positions[mesh.triangles[:, k]] for k in (0, 1))
    return float(np.linalg.norm(a - b, axis=1).mean())


@pytest.mark.smoke
@in_blender
def test_edges_are_pixels() -> None:
    ob, modifier = _sheet()
    pixel = 4.0 * 36.0 / 50.0 / 32.0
    fine = _mesh()
    assert 0.6 * pixel < _edge(fine) < 1.4 * pixel
    _rate(ob, modifier, 4.0)
    assert 2.0 < _edge(_mesh()) / _edge(fine) < 6.0
    _switch(ob, modifier, False)
    assert len(_mesh().triangles) == 8


@in_blender
def test_the_scene_s_settings_count() -> None:
    import bpy

    _sheet()
    cycles, fine = bpy.context.scene.cycles, len(_mesh().triangles)
    cycles.dicing_rate = 4.0
    assert len(_mesh().triangles) < fine / 8
    cycles.dicing_rate, cycles.max_subdivisions = 1.0, 2
    assert len(_mesh().triangles) == 2 * 16  # from the square without its modifier
    cycles.max_subdivisions = 12
    far = stage.add("Far", bpy.data.cameras.new("Far"), (0, 0, 40))
    cycles.dicing_camera = far
    assert len(_mesh().triangles) < fine / 30


@in_blender
def test_edges_in_the_object_s_own_measure() -> None:
    import bpy

    if bpy.app.version < (5, 0, 0):
        return
    ob, modifier = _sheet()
    ob.scale = (3.0, 3.0, 3.0)
    modifier.adaptive_space, modifier.adaptive_object_edge_length = "OBJECT", 0.1
    assert 0.06 < _edge(_mesh()) < 0.14


@in_blender
def test_the_level_says_nothing() -> None:
    """The surface is found from where the modifier's own level has brought it."""
    _, modifier = _sheet("CATMULL_CLARK")
    extents = []
    for level in (0, 1, 3):
        modifier.render_levels = level
        extents.append(np.abs(_mesh().positions).max())
    assert extents == pytest.approx([extents[0]] * 3, rel=1e-5)
    assert extents[0] < 0.95


@in_blender
def test_what_it_is_made_of_stays_as_it_is() -> None:
    """Also where the export is stopped."""
    import bpy
    from photon_splat.export import export_scene
    from photon_splat.export.cancelled import Cancelled, Watch

    ob, modifier = _sheet("CATMULL_CLARK")

    def state() -> list[Any]:
        values = [getattr(modifier, p.identifier) for p in modifier.bl_rna.properties]
        counts = [len(getattr(bpy.data, kind)) for kind in ("objects", "meshes", "scenes")]
        places = [tuple(v.co) for v in ob.data.vertices]
        return [[v for v in values if isinstance(v, (int, float, str))], counts, places]

    before = state()
    _mesh()
    assert state() == before
    for after in (1, 3, 5, 7):
        left = [after]

        def stopped(left: list[int] = left) -> bool:
            left[0] -= 1
            return left[0] < 0

        with suppress(Cancelled):
            export_scene(bpy.context.evaluated_depsgraph_get(), watch=Watch(stopped))
        assert state() == before


@in_blender
def test_what_has_not_changed_is_not_made_again() -> None:
    import bpy
    from photon_splat.export import export_scene
    from photon_splat.export.kept import Kept

    ob, _ = _sheet()
    kept = Kept()

    def positions() -> Any:
        scene = export_scene(bpy.context.evaluated_depsgraph_get(), kept=kept)
        (mesh,) = scene.meshes
        return mesh.positions

    first = positions()
    assert positions() is first
    ob.location.z = 1.0
    assert positions() is not first


@in_blender
def test_no_memory_is_told() -> None:
    from photon_splat.export.geometry import displacement

    _sheet()
    kept, displacement.MAX_TRIANGLES = displacement.MAX_TRIANGLES, 100
    try:
        what = stage.exported()
    finally:
        displacement.MAX_TRIANGLES = kept
    warning = stage.the_one_warning(what)
    assert warning.startswith("Adaptive subdivision ends at ")
    assert warning.endswith(
        " triangles, coarser than its pixel size asks for; there is no memory for more: 'Sheet'"
    )


@in_blender
def test_a_changing_shape_keeps_still() -> None:
    import bpy

    ob, _ = _sheet()
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Up")
    key.data[0].co.z = 1.0
    key.value = 0.0
    key.keyframe_insert("value", frame=1)
    key.value = 1.0
    key.keyframe_insert("value", frame=3)
    bpy.context.scene.render.use_motion_blur = True
    bpy.context.scene.frame_set(2)
    what = stage.exported()
    assert stage.the_one_warning(what) == (
        "Motion blur: meshes that are subdivided adaptively keep their shape: 'Sheet'"
    )


@in_blender
def test_viewports_dice_for_the_scene_s_camera() -> None:
    """Wherever they look from; without a camera the modifier's own level is shown."""
    import bpy
    from photon_splat.blender.viewport.live import NOWHERE
    from photon_splat.core.scene import Frame
    from photon_splat.export import export_contents
    from photon_splat.export.report import Report

    _sheet()
    scene = bpy.context.scene
    scene.cycles.preview_dicing_rate = 1.0

    def shown() -> Mesh:
        graph = bpy.context.evaluated_depsgraph_get()
        return export_contents(graph, NOWHERE, Frame(1, 1), Report()).meshes[0]

    pixel = 4.0 * 36.0 / 50.0 / 32.0
    assert 0.6 * pixel < _edge(shown()) < 1.4 * pixel
    scene.camera = None
    assert len(shown().triangles) == 8
