"""Persistent Data: what a render leaves for the next one, and that no picture shows it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support import stage
from tests.support.blender import in_blender

PASSES, PHOTONS = 3, 4000


def corner(persistent: bool = True) -> Any:
    """A red wall on a grey floor, with a lamp. Returns the scene."""
    made = stage.room(24, PASSES, PHOTONS)
    wall = stage.plane("Wall", half=1.0, location=(-1.0, 0.0, 1.0))
    wall.rotation_euler = (0.0, 1.5708, 0.0)
    wall.data.materials[0] = stage.material("Red", (0.8, 0.1, 0.1))
    made.render.use_persistent_data = persistent
    return made


def shoot() -> tuple[np.ndarray, dict[str, Any]]:
    """Combined and statistics of a render."""
    import bpy

    with stage.watched() as results:
        bpy.ops.render.render()
    return results[-1].passes["Combined"], results[-1].statistics


def named(name: str) -> Any:
    import bpy

    return bpy.data.objects[name]


@in_blender
def test_the_mean_is_that_of_an_ordinary_render() -> None:
    made = corner()
    made.photon_splat.passes, made.photon_splat.photons_per_pass = 8, 40_000
    shoot()
    named("Camera").location.x += 0.25
    kept, statistics = shoot()
    assert statistics["photons"]["traced"] == 0
    made.render.use_persistent_data = False
    ordinary, statistics = shoot()
    assert statistics["reused"] == {"geometry": False, "photons": 0}
    for channel in range(3):
        assert kept[..., channel].mean() == pytest.approx(ordinary[..., channel].mean(), rel=0.01)
    assert np.abs(kept - ordinary)[..., :3].mean() < 0.05 * ordinary[..., :3].mean()


@in_blender
def test_a_material_that_sees_the_camera_has_its_photons_traced_again() -> None:
    from photon_splat.blender import persistent

    corner()
    made, tree = stage.empty_material("Window")
    shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Window"], shader.inputs["Color"])
    stage.surface(tree, shader)
    named("Wall").data.materials[0] = made
    shoot()
    named("Camera").location.x += 0.25
    picture, statistics = shoot()
    assert statistics["reused"] == {"geometry": True, "photons": 0}
    persistent.free()
    assert np.array_equal(picture, shoot()[0])


@in_blender
def test_nothing_is_kept_without_persistent_data() -> None:
    from photon_splat.blender import persistent

    made = corner(persistent=False)
    for _ in range(2):
        _, statistics = shoot()
        assert statistics["reused"] == {"geometry": False, "photons": 0}
        assert statistics["photons"]["kept_bytes"] == 0
        assert not persistent.holds()
    made.render.use_persistent_data = True
    shoot()
    assert persistent.holds()
    made.render.use_persistent_data = False
    assert not persistent.holds()


@in_blender
def test_it_is_given_back_when_a_file_is_loaded_and_with_the_extension() -> None:
    import bpy
    from photon_splat.blender import persistent

    corner()
    shoot()
    assert persistent.holds()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert not persistent.holds()
    stage.scene().render.engine = "PHOTON_SPLAT"
    corner()
    shoot()
    assert persistent.holds()
    persistent.unregister()
    try:
        assert not persistent.holds()
    finally:
        persistent.register()


@in_blender
def test_a_render_that_was_cancelled_or_failed_does_not_spoil_the_next() -> None:
    import bpy
    from photon_splat.blender import job, persistent

    corner()
    shoot()
    camera, polled = stage.scene().camera, []
    camera.location.x += 0.3
    job.observer.should_cancel = lambda: bool(polled.append(0)) or True
    shoot()
    assert polled
    job.observer.should_cancel = lambda: False
    named("Wall").data.vertices[0].co.z += 0.4
    named("Wall").data.update()
    stage.scene().camera = None
    with pytest.raises(RuntimeError, match="camera"):
        bpy.ops.render.render()
    stage.scene().camera = camera
    picture, _ = shoot()
    persistent.free()
    assert np.array_equal(picture, shoot()[0])


@in_blender
def test_every_view_layer_has_its_own() -> None:
    import bpy
    from photon_splat.blender import persistent

    made = corner()
    layer = made.view_layers.new("Without wall")
    collection = bpy.data.collections.new("Wall")
    made.collection.children.link(collection)
    collection.objects.link(named("Wall"))
    made.collection.objects.unlink(named("Wall"))
    layer.layer_collection.children["Wall"].exclude = True

    def shoot_both() -> list[Any]:
        with stage.watched() as results:
            bpy.ops.render.render()
        return results

    shoot_both()
    named("Camera").location.x += 0.25
    second = shoot_both()
    assert [result.statistics["photons"]["traced"] for result in second] == [0, 0]
    named("Wall").data.vertices[0].co.z += 0.4
    named("Wall").data.update()
    third = shoot_both()
    assert [result.statistics["reused"]["geometry"] for result in third] == [False, True]
    persistent.free()
    for kept, fresh in zip(third, shoot_both(), strict=True):
        assert np.array_equal(kept.passes["Combined"], fresh.passes["Combined"])


@in_blender
def test_an_animation_traces_its_photons_once(tmp_path: Path) -> None:
    import bpy

    made = corner()
    camera = made.camera
    made.frame_start, made.frame_end = 1, 3
    for frame in (1, 3):
        camera.location.x = 0.1 * frame
        camera.keyframe_insert("location", frame=frame)
    made.render.filepath = f"{tmp_path}/"
    with stage.watched() as results:
        bpy.ops.render.render(animation=True)
    assert [result.statistics["photons"]["traced"] for result in results] == [
        PASSES * PHOTONS,
        0,
        0,
    ]
    assert not np.array_equal(results[0].passes["Combined"], results[2].passes["Combined"])
