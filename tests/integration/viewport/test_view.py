"""Where a viewport looks: perspective, orthographic, through the camera, borders, pixel size."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.support import stage
from tests.support.blender import in_blender
from tests.support.window import context, projection_matrix


def _view(made: Any, pixel: int = 1, bounds: np.ndarray | None = None, local: Any = None) -> Any:
    import bpy
    from photon_splat.blender.viewport.view import view_of

    scene = bpy.context.evaluated_depsgraph_get().scene_eval
    return view_of(made.region, made.space_data, made.region_data, scene, pixel, bounds, local)


def _through_camera(width: int, height: int, zoom: float = 1.0) -> Any:
    """A viewport of that size that looks through the scene's camera, whose frame fills 1 / zoom of
    it.
    """
    import bpy

    graph = bpy.context.evaluated_depsgraph_get()
    ob = graph.scene_eval.camera
    render = bpy.context.scene.render
    matrix = np.array(
        ob.calc_matrix_camera(graph, x=render.resolution_x, y=render.resolution_y), np.float64
    )
    matrix[0] /= zoom
    matrix[1] /= zoom
    made = context(width, height, np.array(ob.matrix_world), matrix)
    made.region_data.view_perspective = "CAMERA"
    return made


@pytest.mark.parametrize("sides", [(-0.5, 0.5, -0.3, 0.3), (-0.2, 0.9, -0.7, 0.1)])
@in_blender
def test_a_perspective_view(sides: list[float]) -> None:
    stage.scene()
    eye = np.eye(4)
    eye[:3, 3] = 1, 2, 3
    near = [side * 0.1 for side in sides]
    view = _view(
        context(80, 60, eye, projection_matrix(*near, 0.1, 100), clip_start=0.2, clip_end=50)
    )
    assert view.camera.screen == pytest.approx(sides, abs=1e-6)
    assert np.allclose(view.camera.matrix, eye, atol=1e-6)
    assert (view.camera.clip_start, view.camera.clip_end) == pytest.approx((0.2, 50))
    assert not view.camera.orthographic
    assert view.frame.region == (0, 0, 80, 60)


@in_blender
def test_an_orthographic_view_begins_outside_of_the_scene() -> None:
    eye = np.eye(4)
    eye[:3, 3] = 1, 2, 3
    made = context(
        80, 60, eye, projection_matrix(-4, 4, -3, 3, -100, 100, orthographic=True), clip_end=100
    )
    view = _view(made, bounds=np.array([[-1.0, -1, -1], [1, 1, 9]]))
    assert view.camera.orthographic
    assert view.camera.screen == pytest.approx((-4, 4, -3, 3), abs=1e-5)
    assert view.camera.clip_start == 0
    assert view.camera.matrix[2, 3] > 9
    assert view.camera.matrix[2, 3] - view.camera.clip_end == pytest.approx(3 - 100)
    assert np.allclose(view.camera.matrix[:2, 3], (1, 2))
    # Clipped as Blender clips it where the scene reaches farther.
    far = _view(made, bounds=np.array([[-1.0, -1, -1], [1, 1, 1e6]]))
    assert far.camera.matrix[2, 3] == pytest.approx(103)


SETTINGS: dict[str, dict[str, Any]] = {
    "plain": {},
    "tall": {"resolution": (40, 90)},
    "shifted": {"shift_x": 0.2, "shift_y": -0.1},
    "vertical": {"sensor_fit": "VERTICAL"},
    "orthographic": {"type": "ORTHO", "ortho_scale": 3.0},
    "pixel aspect": {"aspect": 2.0},
}


@pytest.mark.smoke
@pytest.mark.parametrize("name", SETTINGS)
@in_blender
def test_a_camera_view_is_the_rendered_one(name: str) -> None:
    """Where the frame fills the region, camera and window are those of a final render."""
    import bpy

    settings = dict(SETTINGS[name])
    ob = stage.camera((1, 2, 3))
    ob.rotation_euler = (0.3, 0.2, 0.1)
    ob.scale = (2, 2, 2)
    width, height = settings.pop("resolution", (90, 60))
    stage.resize(width, height)
    bpy.context.scene.render.pixel_aspect_x = settings.pop("aspect", 1.0)
    for key, value in settings.items():
        setattr(ob.data, key, value)
    bpy.context.view_layer.update()
    expected = stage.exported().camera
    matrix = np.array(
        ob.calc_matrix_camera(
            bpy.context.evaluated_depsgraph_get(),
            x=width,
            y=height,
            scale_x=bpy.context.scene.render.pixel_aspect_x,
        )
    )
    made = context(width, height, expected.matrix, matrix)
    made.region_data.view_perspective = "CAMERA"
    view = _view(made)
    assert view.camera.screen == pytest.approx(expected.screen, abs=2e-5)
    assert np.allclose(view.camera.matrix, expected.matrix)
    assert (view.camera.orthographic, view.camera.clip_start, view.camera.clip_end) == (
        expected.orthographic,
        expected.clip_start,
        expected.clip_end,
    )


@in_blender
def test_borders() -> None:
    ob = stage.camera()
    stage.resize(100, 50)
    import bpy

    ob.data.passepartout_alpha = 0.5
    bpy.context.view_layer.update()
    made = _through_camera(200, 100, zoom=2.0)
    assert _view(made).frame.border is None
    ob.data.passepartout_alpha = 1.0
    bpy.context.view_layer.update()
    assert _view(made).frame.border == (50, 25, 100, 50), "nothing is seen around the frame"
    render = bpy.context.scene.render
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = (
        0.0,
        0.5,
        0.2,
        0.6,
    )
    bpy.context.view_layer.update()
    assert _view(made).frame.border == (50, 35, 50, 20)
    sides = {
        f"render_border_{side}": value
        for side, value in (("min_x", 0.1), ("max_x", 0.5), ("min_y", 0.0), ("max_y", 1.0))
    }
    own = context(200, 100, use_render_border=True, **sides)
    assert _view(own).frame.border == (20, 0, 80, 100)


@in_blender
def test_depth_of_field_and_panoramas_come_through_the_camera() -> None:
    import bpy

    ob = stage.camera()
    stage.resize(100, 50)
    ob.data.dof.use_dof = True
    bpy.context.view_layer.update()
    assert _view(_through_camera(100, 50)).camera.aperture is not None
    ob.data.type = "PANO"
    bpy.context.view_layer.update()
    expected = stage.exported().camera
    ob.data.type = "PERSP"
    bpy.context.view_layer.update()
    made = _through_camera(200, 100, zoom=2.0)
    ob.data.type = "PANO"
    bpy.context.view_layer.update()
    view = _view(made)
    assert view.camera.panorama is not None
    left, right, bottom, top = expected.screen
    assert view.camera.screen == pytest.approx(
        (left - 0.5, right + 0.5, bottom - 0.5, top + 0.5), abs=1e-4
    )
    assert view.frame.border == (50, 25, 100, 50)


@in_blender
def test_a_viewport_with_a_camera_of_its_own_and_without_any() -> None:
    import bpy

    made = context(60, 60)
    made.region_data.view_perspective = "CAMERA"
    assert _view(made).camera.clip_end == 100, "no camera in the scene"
    ob = stage.camera((0, 0, 7))
    bpy.context.scene.camera = None
    bpy.context.view_layer.update()
    assert _view(made, local=ob).camera.matrix[2, 3] == 7


@in_blender
def test_pixels_and_film() -> None:
    import bpy
    from photon_splat.blender.viewport.live import pixel_size

    made = context()
    scene = bpy.context.scene
    for setting, width in (("AUTO", 1), ("1", 1), ("2", 2), ("4", 4), ("8", 8)):
        scene.render.preview_pixel_size = setting
        assert pixel_size(scene, made) == width
    scene.render.preview_pixel_size = "AUTO"
    made.preferences.system.pixel_size = 2.0
    assert pixel_size(scene, made) == 2
    scene.render.film_transparent = True
    bpy.context.view_layer.update()
    assert _view(made, 2).frame.transparent
    assert _view(made, 2).pixel == 2
    assert _view(made, 2) != _view(made, 1)
    assert _view(made, 2) == _view(made, 2)
