"""Pictures of several views: each is that of its camera, in Blender's result too."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support import stage
from tests.support.blender import in_blender


def _room() -> Any:
    import bpy

    scene = stage.room(pixels=12)
    scene.camera.name = "Eye_L"
    right = bpy.data.objects.new("Eye_R", scene.camera.data.copy())
    right.data.lens = 30.0
    right.location = (0.4, 0.2, 3.0)
    scene.collection.objects.link(right)
    return scene


def _combined() -> list[np.ndarray]:
    import bpy

    with stage.watched() as results:
        bpy.ops.render.render()
    return [result.passes["Combined"] for result in results]


@in_blender
def test_cameras_of_a_set_are_rendered_as_they_are_by_themselves() -> None:
    import bpy

    scene = _room()
    alone = []
    for name in ("Eye_L", "Eye_R"):
        scene.camera = bpy.data.objects[name]
        alone += _combined()
    scene.camera = bpy.data.objects["Eye_L"]
    scene.render.use_multiview, scene.render.views_format = True, "MULTIVIEW"
    together = _combined()
    assert len(together) == 2
    for one, other in zip(alone, together, strict=True):
        assert np.array_equal(one, other)
    assert not np.array_equal(*together)


@in_blender
def test_eyes_stand_beside_each_other_and_are_moved_with_a_moving_camera() -> None:
    scene = _room()
    scene.render.use_multiview = True
    scene.camera.data.stereo.interocular_distance = 0.2
    scene.camera.data.stereo.convergence_mode = "PARALLEL"
    left, right = (what.camera for what in stage.exports())
    apart = right.matrix[:3, 3] - left.matrix[:3, 3]
    assert apart == pytest.approx(0.2 * left.matrix[:3, 0])
    assert left.stereo is None
    assert right.motion is None
    scene.render.use_motion_blur = True
    scene.camera.keyframe_insert("location", frame=0)
    scene.camera.location.z += 1.0
    scene.camera.keyframe_insert("location", frame=2)
    left, right = (what.camera for what in stage.exports())
    assert left.motion is not None
    assert right.motion is not None
    assert right.motion.matrices[:, :3, 3] - left.motion.matrices[:, :3, 3] == pytest.approx(
        np.tile(apart, (len(left.motion.matrices), 1))
    )


@in_blender
def test_eyes_all_around() -> None:
    scene = _room()
    scene.render.use_multiview = True
    data = scene.camera.data
    data.type, data.stereo.use_spherical_stereo = "PANO", True
    data.stereo.interocular_distance, data.stereo.convergence_distance = 0.1, 7.0
    left, right = (what.camera for what in stage.exports())
    assert left.stereo is not None
    assert right.stereo is not None
    assert (left.stereo.offset, right.stereo.offset) == pytest.approx((-0.05, 0.05))
    assert left.stereo.convergence == pytest.approx(7.0)
    assert left.stereo.merge is None
    assert np.array_equal(left.matrix, right.matrix)
    assert scene.render.use_spherical_stereo  # Blender shows its settings


@in_blender
def test_blender_gets_each_view(tmp_path: str) -> None:
    import bpy
    import OpenImageIO as oiio

    scene = _room()
    scene.render.use_multiview = True
    scene.camera.data.stereo.interocular_distance = 1.0
    image = scene.render.image_settings
    image.file_format, image.color_depth, image.views_format = "OPEN_EXR", "32", "INDIVIDUAL"
    scene.render.filepath = f"{tmp_path}/both.exr"
    wanted = _combined()
    bpy.ops.render.render(write_still=True)
    for suffix, picture in zip(("L", "R"), wanted, strict=True):
        pixels = oiio.ImageBuf(f"{tmp_path}/both_{suffix}.exr").get_pixels(oiio.FLOAT)
        assert np.allclose(pixels[::-1, :, :4], picture, atol=1e-6)


@in_blender
def test_parts_of_several_views_are_refused(tmp_path: str) -> None:
    import bpy

    scene = _room()
    scene.render.use_multiview = True
    scene.photon_splat_farm.use_checkpoint = True
    scene.photon_splat_farm.checkpoint = f"{tmp_path}/kept.psplat"
    with pytest.raises(RuntimeError, match="Parts and checkpoints hold one view"):
        bpy.ops.render.render()
    assert not list(Path(tmp_path).iterdir())
