"""Hands a `Scene` to the native renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..render.plan import Plan, make_plan
from ..render.settings import RenderSettings
from ..scene import Scene
from .bounds import focus
from .camera import place_camera
from .instances import add_instances
from .lights import add_lights
from .materials import add_materials
from .meshes import add_meshes
from .options import set_options

if TYPE_CHECKING:
    from photon_splat_native import Renderer


def fill_renderer(
    renderer: Renderer, scene: Scene, settings: RenderSettings, plan: Plan | None = None
) -> None:
    """Copies everything into `renderer`; `plan`: that of scene and settings, if it has been made.
    ValueError, with one sentence, for data that is not finite or does not fit.
    """
    origin, near = focus(scene)
    if not np.isfinite(origin).all():
        raise ValueError("the scene has an instance whose position in the world is not finite")
    renderer.set_origin([float(c) for c in origin], near)
    if scene.shutter is not None:
        renderer.set_shutter(
            np.ascontiguousarray(scene.shutter.curve, np.float32), scene.shutter.rolling
        )
    add_materials(renderer, scene)
    add_meshes(renderer, scene)
    add_instances(renderer, scene)
    add_lights(renderer, scene)
    place_camera(renderer, scene.camera, scene.frame)
    set_options(renderer, settings, plan or make_plan(scene, settings))


def replace_shading(renderer: Renderer, scene: Scene) -> None:
    """Replaces materials, textures, lights and world of a renderer whose geometry is that of
    `scene`.
    """
    renderer.clear_shading()
    add_materials(renderer, scene)
    add_lights(renderer, scene)
    renderer.relight()
