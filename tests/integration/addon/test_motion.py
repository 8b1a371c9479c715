"""Motion blur on its way from Blender: what moves, when, and that Blender is left as it was."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.support import stage
from tests.support.blender import in_blender


def blurred(shutter: float = 1.0, position: str = "CENTER") -> Any:
    """The scene, with motion blur on, at frame 5."""
    scene = stage.scene()
    scene.frame_set(5)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = shutter
    scene.render.motion_blur_position = position
    return scene


def keyed(owner: Any, path: str, values: dict[int, Any]) -> None:
    """Animates a property linearly."""
    for frame, value in values.items():
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)
    for curve in _curves(owner.id_data.animation_data.action):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    stage.scene().frame_set(stage.scene().frame_current)


def _curves(action: Any) -> Iterator[Any]:
    if hasattr(action, "fcurves"):  # before Blender 5
        yield from action.fcurves
        return
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                yield from bag.fcurves


def slide(ob: Any) -> Any:
    """At x = frame."""
    keyed(ob, "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    return ob


def rise(ob: Any) -> None:
    """Its vertices at z = frame, by a shape key."""
    ob.shape_key_add(name="Basis")
    raised = ob.shape_key_add(name="Raised")
    for point in raised.data:
        point.co.z += 10.0
    keyed(raised, "value", {0: 0.0, 10: 1.0})


@pytest.mark.smoke
@in_blender
def test_a_moving_object_is_looked_at_while_the_shutter_is_open() -> None:
    scene = blurred(shutter=0.5)
    slide(stage.plane())
    exported = stage.exported()
    assert list(exported.instances.motion) == [0]
    steps = exported.instances.motion[0]
    assert np.allclose(steps[:, 0, 3], (4.75, 5.0, 5.25), atol=1e-5)
    assert np.allclose(exported.instances.matrix[0], steps[1])
    assert exported.shutter is not None
    assert exported.shutter.rolling < 0
    assert exported.camera.motion is None
    assert exported.warnings == []
    assert (scene.frame_current, scene.frame_subframe) == (5, 0.0)
    assert scene.objects["Plane"].location.x == pytest.approx(5.0)


@in_blender
def test_the_shutter_opens_about_after_or_before_the_frame() -> None:
    slide(stage.plane())
    for position, middle in (("START", 5.5), ("CENTER", 5.0), ("END", 4.5)):
        blurred(position=position)
        exported = stage.exported()
        assert exported.instances.matrix[0][0, 3] == pytest.approx(middle, abs=1e-5)
        steps = exported.instances.motion[0][:, 0, 3]
        assert np.allclose(steps, (middle - 0.5, middle, middle + 0.5), atol=1e-5)


@in_blender
def test_a_still_scene_is_exported_and_rendered_as_without_motion_blur() -> None:
    import bpy
    from photon_splat.blender import job
    from photon_splat.core.scene import same

    scene = stage.room(pixels=12, passes=2)
    stage.plane("Wall", location=(1, 0, 1)).rotation_euler = (0, 1.2, 0)
    keyed(scene.objects["Plane"], "location", {0: (0, 0, 0), 10: (0, 0, 0)})
    exports, pictures = [], []
    for on in (False, True):
        scene.render.use_motion_blur = on
        exports.append(stage.exported())
    job.observer.on_result = lambda result, frame: pictures.append(result.passes)
    for on in (False, True):
        scene.render.use_motion_blur = on
        bpy.ops.render.render()
    assert exports[1].shutter is None
    assert same(*exports)
    assert pictures[0].keys() == pictures[1].keys()
    assert pictures[0]["Combined"].any()
    for name, picture in pictures[0].items():
        assert picture.tobytes() == pictures[1][name].tobytes(), name


@in_blender
def test_a_picture_of_what_moves_is_blurred() -> None:
    import bpy
    from photon_splat.blender import job

    scene = stage.room(pixels=16, passes=4)
    thing = slide(stage.plane("Thing", 0.2))
    keyed(thing, "location", {0: (-5, 0, 1), 10: (5, 0, 1)})
    blurred(shutter=2.0)
    normals = []
    job.observer.on_result = lambda result, frame: normals.append(result.passes["Depth"])
    for on in (True, False):
        scene.render.use_motion_blur = on
        bpy.ops.render.render()
    seen, still = (int((depth < 3.5).sum()) for depth in normals)
    assert still > 0
    assert not np.array_equal(*normals)
    assert seen != still


@in_blender
def test_objects_say_whether_and_how_finely_they_are_blurred() -> None:
    blurred()
    still, fine = slide(stage.plane("Still")), slide(stage.plane("Fine"))
    still.cycles.use_motion_blur = False
    fine.cycles.motion_steps = 3
    motion = stage.exported().instances.motion
    assert list(motion) == [1]
    assert np.allclose(motion[1][:, 0, 3], 4.5 + np.arange(9) / 8, atol=1e-5)


@in_blender
def test_an_instancer_has_a_say_in_its_instances() -> None:
    import bpy

    blurred()
    group = bpy.data.collections.new("Group")
    stage.plane(collection=group)
    stands = [stage.add(f"Stand {k}") for k in range(2)]
    for stand in stands:
        stand.instance_type, stand.instance_collection = "COLLECTION", group
        slide(stand)
    stands[1].cycles.use_motion_blur = False
    motion = stage.exported().instances.motion
    assert len(motion) == 1
    stands[1].cycles.use_motion_blur = True
    stands[0].cycles.motion_steps = 2
    assert sorted(len(steps) for steps in stage.exported().instances.motion.values()) == [3, 5]


@in_blender
def test_a_mesh_that_deforms_has_its_vertices_at_all_steps() -> None:
    blurred(shutter=2.0)
    ob = stage.plane()
    rise(ob)
    exported = stage.exported()
    motion = exported.meshes[0].motion
    assert motion is not None
    assert np.allclose(motion.positions[:, :, 2], np.array([[4.0], [5.0], [6.0]]), atol=1e-5)
    assert np.array_equal(motion.positions[1], exported.meshes[0].positions)
    assert exported.instances.motion == {}
    assert exported.shutter is not None
    ob.cycles.use_deform_motion = False
    assert stage.exported().meshes[0].motion is None


@in_blender
def test_text_and_curves_deform_by_their_own_settings() -> None:
    import bpy

    blurred(shutter=2.0)
    letters = bpy.data.curves.new("Letters", "FONT")
    letters.body, letters.extrude = "X", 0.1
    stage.add("Text", letters)
    keyed(letters, "size", {0: 1.0, 10: 11.0})
    bow = bpy.data.curves.new("Bow", "CURVE")
    bow.dimensions = "3D"
    line = bow.splines.new("POLY")
    line.points.add(1)
    line.points[1].co = (3.0, 0.0, 0.0, 1.0)
    stage.add("Tube", bow)
    keyed(bow, "bevel_depth", {0: 0.0, 10: 1.0})
    exported = stage.exported()
    wide = [np.ptp(mesh.motion.positions, axis=1) for mesh in exported.meshes if mesh.motion]
    assert len(wide) == 2
    text, tube = sorted(wide, key=lambda sides: -float(sides[1, 1]))
    assert np.allclose(text[:, 1] / text[1, 1], np.array([5, 6, 7]) / 6, atol=1e-5)
    assert np.allclose(tube[:, 2], (0.8, 1.0, 1.2), atol=1e-5)
    assert exported.warnings == []


@pytest.mark.parametrize("how", ["born", "stiff"])
@in_blender
def test_any_instance_of_a_mesh_tells_how_it_deforms(how: str) -> None:
    import bpy

    scene = blurred(shutter=2.0)
    group = bpy.data.collections.new("Group")
    ob = stage.plane(collection=group)
    rise(ob)
    stands = [stage.add(f"Stand {k}", location=(k, 0, 0)) for k in range(2)]
    for stand in stands:
        stand.instance_type, stand.instance_collection = "COLLECTION", group
    if how == "stiff":
        stands[0].cycles.use_deform_motion = False
    else:
        keyed(stands[0], "hide_render", {0: True, 5: False})
        keyed(stands[0], "hide_viewport", {0: True, 5: False})
    scene.frame_set(5)
    (mesh,) = stage.exported().meshes
    assert mesh.motion is not None
    assert np.allclose(mesh.motion.positions[:, 0, 2], (4.0, 5.0, 6.0), atol=1e-5)


@in_blender
def test_normals_of_smooth_meshes_move_with_them() -> None:
    blurred(shutter=2.0)
    ob = stage.plane()
    for polygon in ob.data.polygons:
        polygon.use_smooth = True
    ob.shape_key_add(name="Basis")
    raised = ob.shape_key_add(name="Raised")
    raised.data[0].co.z += 3.0
    keyed(raised, "value", {0: 0.0, 10: 1.0})
    mesh = stage.exported().meshes[0]
    assert mesh.motion is not None
    own, steps = (
        (mesh.vertex_normals, mesh.motion.vertex_normals)
        if mesh.vertex_normals is not None
        else (mesh.corner_normals, mesh.motion.corner_normals)
    )
    assert own is not None
    assert steps is not None
    assert np.array_equal(steps[1], own)
    assert not np.allclose(steps[0], steps[2], atol=0.05)


@in_blender
def test_a_mesh_whose_vertices_change_in_number_keeps_its_shape_and_is_named() -> None:
    blurred(shutter=2.0)
    ob = stage.plane()
    other = stage.add("Offset")
    other.location.x = 3.0
    modifier = ob.modifiers.new("Array", "ARRAY")
    modifier.use_object_offset, modifier.offset_object = True, other
    keyed(modifier, "count", {4: 2, 6: 4})
    exported = stage.exported()
    assert all(mesh.motion is None for mesh in exported.meshes)
    assert exported.warnings == [
        "Motion blur: meshes keep their shape, as their number of vertices changes: 'Plane'"
    ]


@in_blender
def test_cameras_move_turn_and_zoom() -> None:
    blurred(shutter=2.0)
    ob = stage.camera()
    keyed(ob, "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    keyed(ob.data, "lens", {4: 25.0, 5: 50.0, 6: 100.0})
    camera = stage.exported().camera
    assert camera.motion is not None
    assert np.allclose(camera.motion.matrices[:, 0, 3], (4, 5, 6), atol=1e-5)
    assert np.allclose(camera.motion.matrices[1], camera.matrix)
    assert np.allclose(camera.motion.zoom, (2.0, 0.5))
    ob.cycles.use_motion_blur = False
    assert stage.exported().camera.motion is None


@in_blender
def test_the_shutters_curve_and_its_rolling_are_taken_over() -> None:
    scene = blurred()
    slide(stage.plane())
    points = scene.render.motion_blur_shutter_curve.curves[0].points
    while len(points) > 2:
        points.remove(points[1])
    for point, x, y in ((points[0], 0.0, 0.0), (points[1], 1.0, 1.0)):
        point.location, point.handle_type = (x, y), "VECTOR"
    scene.render.motion_blur_shutter_curve.update()
    scene.cycles.rolling_shutter_type, scene.cycles.rolling_shutter_duration = "TOP", 0.25
    shutter = stage.exported().shutter
    assert shutter is not None
    assert np.allclose(shutter.curve, np.linspace(0, 1, len(shutter.curve)), atol=0.01)
    assert shutter.rolling == pytest.approx(0.25)


@in_blender
def test_a_view_layer_can_do_without() -> None:
    import bpy

    blurred()
    slide(stage.plane())
    bpy.context.view_layer.use_motion_blur = False
    exported = stage.exported()
    assert exported.shutter is None
    assert exported.instances.motion == {}


@in_blender
def test_particles_that_are_not_there_all_the_time_are_hidden() -> None:
    from photon_splat.core.scene import same

    scene = stage.scene()
    scene.frame_start, scene.frame_end = 1, 10
    ball = stage.plane("Ball", 0.1, location=(50, 0, 0))
    base = stage.plane("Base")
    settings = base.modifiers.new("Fountain", "PARTICLE_SYSTEM").particle_system.settings
    settings.count, settings.frame_start, settings.frame_end = 20, 1.0, 9.0
    settings.lifetime = 4.0
    settings.render_type, settings.instance_object = "OBJECT", ball
    for frame in range(1, 6):
        scene.frame_set(frame)
    scene.render.use_motion_blur = False
    before = stage.exported()
    blurred()
    after = stage.exported()
    lost = len(before.instances.mesh) - len(after.instances.mesh)
    assert 0 < lost < 20
    count = len(after.instances.mesh)
    assert max(after.instances.motion) < count
    for row, steps in after.instances.motion.items():
        assert same(steps[1], after.instances.matrix[row])


@in_blender
def test_the_frame_comes_back_after_an_error_and_after_a_cancellation() -> None:
    import bpy
    from photon_splat.blender import job
    from photon_splat.export.motion import Moving

    scene = blurred()
    stage.room(pixels=4)
    slide(stage.plane("Slider"))
    seen = []
    plain = Moving.see

    def fail(self: Any, *arguments: Any) -> None:
        seen.append(scene.frame_subframe)
        raise RuntimeError("on purpose")

    try:
        Moving.see = fail  # type: ignore[method-assign]
        with pytest.raises(RuntimeError, match="on purpose"):
            bpy.ops.render.render()
    finally:
        Moving.see = plain  # type: ignore[method-assign]
    assert seen == [0.5]
    assert (scene.frame_current, scene.frame_subframe) == (5, 0.0)
    job.observer.should_cancel = lambda: scene.frame_subframe != 0.0
    bpy.ops.render.render()
    assert (scene.frame_current, scene.frame_subframe) == (5, 0.0)
    assert scene.objects["Slider"].location.x == pytest.approx(5.0)


@in_blender
def test_persistent_data_follows_what_moves_from_frame_to_frame() -> None:
    scene = blurred()
    scene.render.use_persistent_data = True
    ob = stage.plane()
    rise(ob)
    slide(ob)
    scene.frame_start, scene.frame_end = 4, 6
    for exported, middle in zip(stage.exports(animation=True), (4.0, 5.0, 6.0), strict=True):
        motion = exported.meshes[0].motion
        assert motion is not None
        assert np.allclose(motion.positions[:, 0, 2], middle + np.array([-0.5, 0, 0.5]), atol=1e-5)
        steps = exported.instances.motion[0]
        assert np.allclose(steps[:, 0, 3], middle + np.array([-0.5, 0, 0.5]), atol=1e-5)


@in_blender
def test_velocities_of_vertices_stand_for_their_motion() -> None:
    scene = blurred(shutter=0.5)
    scene.render.fps, scene.render.fps_base = 24, 1.0
    ob = stage.plane()
    for own in ob.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT").data:
        own.vector = (24.0, 0.0, 48.0)
    mesh = stage.exported().meshes[0]
    assert mesh.motion is not None
    assert np.allclose(mesh.motion.positions[2] - mesh.positions, (0.25, 0, 0.5), atol=1e-6)
    assert np.allclose(mesh.motion.positions[0] - mesh.positions, (-0.25, 0, -0.5), atol=1e-6)
    ob.cycles.use_deform_motion = False
    assert stage.exported().meshes[0].motion is None
