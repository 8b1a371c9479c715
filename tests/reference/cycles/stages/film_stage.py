"""Scenes for cases.py: what Cycles' film and a view layer's own switches do to a picture."""

from __future__ import annotations

from typing import Any

import bpy

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage


def film(transparent: bool = False, **settings: Any) -> None:
    """The stage in a coloured world and the light of a lamp, with Cycles' `settings` of its film.
    Glass balls of three roughnesses stand against the world.
    """
    _in_world()
    render, cycles = bpy.context.scene.render, bpy.context.scene.cycles
    render.film_transparent = transparent
    for name, value in settings.items():
        setattr(cycles, f"film_{name}" if hasattr(cycles, f"film_{name}") else name, value)


def layer_without(switch: str) -> None:
    """The same in a view layer without `switch`: use_sky or use_solid."""
    _in_world()
    setattr(bpy.context.view_layer, switch, False)


def _in_world() -> None:
    stage._stage()
    m.set_world((0.3, 0.5, 0.9))
    for name, roughness, x in (("Clear", 0.0, -0.9), ("Satin", 0.08, 0.0), ("Frosted", 0.4, 0.9)):
        glass = m.glass(name, 1.4)
        glass.node_tree.nodes["Glass BSDF"].inputs["Roughness"].default_value = roughness
        m.add_sphere(name, 0.33, glass, (x, -0.9, 0.36), 48)
    stage._lamp("AREA", 40.0, stage.HIGH, (0.0, 0.0, 0.0), size=0.5)
