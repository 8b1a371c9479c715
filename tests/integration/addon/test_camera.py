"""The exported camera against Blender's own idea of its frame."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from photon_splat.core.scene import PixelFilter

from tests.support import stage
from tests.support.blender import in_blender

LENSES: list[dict[str, Any]] = [
    {},
    {"lens": 85.0, "sensor_width": 24.0},
    {"sensor_fit": "VERTICAL", "sensor_height": 15.0},
    {"sensor_fit": "HORIZONTAL", "sensor_width": 20.0},
    {"shift_x": 0.3, "shift_y": -0.2},
    {"sensor_fit": "VERTICAL", "shift_x": 0.3, "shift_y": -0.2},
    {"type": "ORTHO", "ortho_scale": 3.5},
    {"type": "ORTHO", "ortho_scale": 3.5, "shift_x": 0.3, "shift_y": 0.1, "sensor_fit": "VERTICAL"},
]
FRAMES = [
    (40, 40, 1.0, 1.0),
    (60, 20, 1.0, 1.0),
    (20, 60, 1.0, 1.0),
    (40, 36, 1.0, 2.0),
    (40, 36, 1.5, 1.0),
]


@pytest.mark.parametrize(
    "lens", LENSES, ids=lambda lens: ",".join(f"{k}={v}" for k, v in lens.items()) or "plain"
)
@in_blender
def test_screen_is_blenders_view_frame(lens: dict[str, Any]) -> None:
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector
    from photon_splat.export.camera import export_camera
    from photon_splat.export.report import Report

    scene = stage.scene()
    ob = stage.camera((1, 2, 3))
    ob.rotation_euler = (0.3, 0.5, 0.7)
    for name, value in lens.items():
        setattr(ob.data, name, value)
    for width, height, aspect_x, aspect_y in FRAMES:
        stage.resize(width, height)
        scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = aspect_x, aspect_y
        import bpy

        bpy.context.view_layer.update()
        camera = export_camera(ob, scene, Report())
        left, right, bottom, top = camera.screen
        depth = 1.0 if camera.orthographic else -ob.data.view_frame(scene=scene)[0].z
        corners = [(x / depth, y / depth) for x, y, _ in ob.data.view_frame(scene=scene)]
        assert np.allclose(
            corners, [(right, top), (right, bottom), (left, bottom), (left, top)], atol=1e-5
        ), (width, height)

        point = np.array([0.4, -0.3, -2.0])
        seen = world_to_camera_view(
            scene, ob, Vector(camera.matrix[:3, :3] @ point + camera.matrix[:3, 3])
        )
        x, y = point[:2] if camera.orthographic else point[:2] / 2.0
        assert seen.x == pytest.approx((x - left) / (right - left), abs=1e-4)
        assert seen.y == pytest.approx((y - bottom) / (top - bottom), abs=1e-4)
        assert seen.z == pytest.approx(2.0, abs=1e-4)


@in_blender
def test_scale_and_shear_of_the_camera_are_taken_away() -> None:
    from photon_splat.export.camera import export_camera
    from photon_splat.export.report import Report

    parent = stage.add("Parent")
    parent.scale = (1, 1, 3)
    ob = stage.camera()
    ob.parent = parent
    ob.rotation_euler = (0.6, 0.2, 0.1)
    ob.scale = (2, 2, 2)
    import bpy

    bpy.context.view_layer.update()
    report = Report()
    matrix = export_camera(ob, stage.scene(), report).matrix[:3, :3]
    assert np.allclose(matrix.T @ matrix, np.eye(3), atol=1e-6)
    assert np.linalg.det(matrix) == pytest.approx(1)
    assert report.messages() == ["Camera 'Camera' is sheared by a parent; the shear is left out"]


@in_blender
def test_resolution_border_and_clipping() -> None:
    ob = stage.camera()
    ob.data.clip_start, ob.data.clip_end = 0.25, 50
    render = stage.scene().render
    stage.resize(50, 30)
    render.resolution_percentage = 50
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = (
        0.2,
        0.6,
        0.0,
        0.5,
    )
    render.film_transparent = True
    cycles = render.id_data.cycles
    cycles.filter_width, cycles.pixel_filter_type = 2.5, "GAUSSIAN"
    cycles.film_exposure, cycles.film_transparent_glass = 1.5, True
    cycles.film_transparent_roughness = 0.2
    what = stage.exported()
    assert (what.frame.width, what.frame.height) == (25, 15)
    assert what.frame.border == (5, 0, 10, 7)
    assert what.frame.transparent
    assert what.frame.filter_width == 2.5
    assert what.frame.pixel_filter is PixelFilter.GAUSSIAN
    assert what.frame.exposure == 1.5
    assert what.frame.transparent_glass == pytest.approx(0.2)
    assert (what.camera.clip_start, what.camera.clip_end) == (0.25, 50)


@in_blender
def test_a_scene_without_a_camera_says_so() -> None:
    from photon_splat.export.camera import export_camera
    from photon_splat.export.report import Report

    with pytest.raises(
        ValueError,
        match="Scene 'Scene' has no camera: add one, or set an object as the scene's active camera",
    ):
        export_camera(None, stage.scene(), Report())


@in_blender
def test_a_camera_of_a_type_that_nobody_knows() -> None:
    from types import SimpleNamespace

    from photon_splat.export.camera import export_camera
    from photon_splat.export.report import Report

    ob = SimpleNamespace(name="Odd", type="CAMERA", data=SimpleNamespace(type="CUSTOM"))
    with pytest.raises(
        ValueError,
        match="Camera 'Odd' is of type CUSTOM; there are perspective, orthographic and panoramic "
        "cameras",
    ):
        export_camera(ob, stage.scene(), Report())


@in_blender
def test_aperture_and_focus() -> None:
    ob = stage.camera((1, 2, 3))
    dof = ob.data.dof
    ob.data.lens = 80.0
    assert stage.exported().camera.aperture is None
    dof.use_dof = True
    (
        dof.aperture_fstop,
        dof.focus_distance,
        dof.aperture_blades,
        dof.aperture_rotation,
        dof.aperture_ratio,
    ) = 2.0, 4.0, 6, 0.5, 1.5
    lens = stage.exported().camera.aperture
    assert (lens.radius, lens.focus, lens.blades, lens.rotation, lens.ratio) == (
        pytest.approx(0.02),
        4.0,
        6,
        0.5,
        1.5,
    )
    ob.data.type = "ORTHO"
    assert stage.exported().camera.aperture.radius == pytest.approx(0.25)
    # Only the distance along the viewing axis counts, whatever the scale of the camera.
    ob.rotation_euler, ob.scale = (0.0, 0.0, 0.0), (2.0, 2.0, 2.0)
    target = stage.add("Target")
    target.location = (5, -3, 1)
    dof.focus_object = target
    assert stage.exported().camera.aperture.focus == pytest.approx(2.0)


@in_blender
def test_the_bone_in_focus() -> None:
    import bpy

    ob = stage.camera((0, 0, 5))
    ob.rotation_euler = (0.0, 0.0, 0.0)
    data = bpy.data.armatures.new("Arm")
    arm = bpy.data.objects.new("Arm", data)
    bpy.context.scene.collection.objects.link(arm)
    bpy.context.view_layer.objects.active = arm
    bpy.ops.object.mode_set(mode="EDIT")
    bone = data.edit_bones.new("Tip")
    bone.head, bone.tail = (0, 0, 2), (0, 1, 2)
    bpy.ops.object.mode_set(mode="OBJECT")
    dof = ob.data.dof
    dof.use_dof, dof.focus_object, dof.focus_subtarget = True, arm, "Tip"
    assert stage.exported().camera.aperture.focus == pytest.approx(3.0)


@in_blender
def test_a_panorama_and_its_settings() -> None:
    from photon_splat.core.scene import PanoramaKind

    data = stage.camera().data
    data.type = "PANO"
    stage.resize(80, 40)
    for kind in PanoramaKind:
        data.panorama_type = kind.upper()
        assert stage.exported().camera.panorama.kind is kind
    data.shift_x, data.sensor_width, data.sensor_fit = 0.25, 30.0, "AUTO"
    camera = stage.exported().camera
    assert camera.screen == (0.25, 1.25, 0.0, 1.0)
    assert camera.panorama.sensor == pytest.approx((30.0, 15.0))
    data.sensor_fit, data.sensor_height = "VERTICAL", 10.0
    assert stage.exported().camera.panorama.sensor == pytest.approx((20.0, 10.0))


@in_blender
def test_all_scenes_of_a_compositor_have_the_frame_of_the_one_that_is_rendered() -> None:
    import bpy

    made = stage.room()
    stage.resize(48, 32)
    made.render.use_border, made.render.border_max_x = True, 0.5
    other = bpy.data.scenes.new("Other")
    other.render.engine = made.render.engine
    other.render.resolution_x, other.render.resolution_y = 20, 90
    other.render.resolution_percentage = 50
    other.render.use_border, other.render.border_max_y = True, 0.25
    other.camera = stage.add("Eye", bpy.data.cameras.new("Eye"), collection=other.collection)
    tree, end = stage.compositor(made)
    layers = tree.nodes.new("CompositorNodeRLayers")
    layers.scene = other
    tree.links.new(layers.outputs["Image"], end.inputs[0])
    seen = stage.exports()
    assert seen
    for what in seen:
        assert (what.frame.width, what.frame.height) == (48, 32)
        assert what.frame.region == (0, 0, 24, 32)
        left, right, bottom, top = what.camera.screen
        assert (right - left) / (top - bottom) == pytest.approx(1.5)
