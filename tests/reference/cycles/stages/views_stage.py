"""Scenes for cases.py: one view of a picture that has several."""

from __future__ import annotations

from typing import Any

import bpy

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage


def stereo(eye: str, kind: str = "PERSP", dof: bool = False, **settings: Any) -> None:
    """What the eye `left` or `right` sees of near things; settings: of the camera's stereo."""
    _near_things()
    scene = bpy.context.scene
    scene.render.use_multiview, scene.render.views_format = True, "STEREO_3D"
    for view in scene.render.views:
        view.use = view.name == eye
    data = scene.camera.data
    data.type = kind
    if kind == "PANO":
        data.panorama_type = "EQUIRECTANGULAR"
    if dof:
        data.dof.use_dof = True
        data.dof.focus_distance, data.dof.aperture_fstop = 1.4, 0.15
    data.stereo.interocular_distance = 0.3
    for name, value in settings.items():
        setattr(data.stereo, name, value)


def one_camera_of_two(suffix: str) -> None:
    """What the camera with that suffix sees, whose own lens is another."""
    _near_things()
    scene = bpy.context.scene
    scene.render.use_multiview, scene.render.views_format = True, "MULTIVIEW"
    for view in scene.render.views:
        view.use = view.camera_suffix == suffix
    left = scene.camera
    left.name = "Eye_L"
    right = left.copy()
    right.data = left.data.copy()
    right.name, right.data.lens = "Eye_R", 35.0
    right.location.x += 0.4
    right.rotation_euler.z += 0.15
    bpy.context.scene.collection.objects.link(right)


def _near_things() -> None:
    stage._stage()
    m.set_world((0.3, 0.5, 0.9), 0.5)
    stage._lamp("AREA", 40.0, stage.HIGH, size=0.6)
    stage._look((0.1, -1.3, 0.8), (-0.1, 0.3, 0.5))
