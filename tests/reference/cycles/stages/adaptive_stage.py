"""Scenes for cases.py: surfaces that are subdivided as finely as a camera sees them. See stage.py.

They need a Blender whose modifier has the settings: 5.0 or later.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import displacement_stage, stage

PLACE = displacement_stage.PLACE


def adaptive(
    shape: str = "cube",
    pixels: float = 0.25,
    edge: float = 0.0,
    level: int = 2,
    kind: str = "CATMULL_CLARK",
    height: str = "",
    method: str = "DISPLACEMENT",
    amount: float = 0.2,
    limit: int = 12,
    shading: str = "smooth",
    second: str = "",
    dicing_camera: bool = False,
    ground: bool = False,
    color: str = "plain",
    **modifier: Any,
) -> None:
    """A thing on the stage whose last modifier subdivides it adaptively.

    pixels, edge  length of edges in pixels, or else (`edge` > 0) in the mesh's own measure
    level         of the modifier, which says nothing then
    height        displaced by this (see displacement_stage.displaced); empty: not at all
    limit         Max Subdivisions
    dicing_camera  one that stands far away, so that all is coarse
    ground        the thing is a field that begins below the camera
    modifier      other properties of it
    """
    stage._stage(things=False)
    stage._lamp("AREA", 25.0, (1.2, -1.0, 1.7), PLACE, size=0.3)
    m.set_world((0.06, 0.07, 0.09))
    scene: Any = bpy.context.scene
    material = displacement_stage._material("Moved", color, "")
    if height:
        displacement_stage._displace(material, method, height, "OBJECT", amount, 0.5)
    thing = _shape(shape, material)
    thing.location = (0.0, 0.0, 0.0) if ground else PLACE
    thing.shadow_terminator_geometry_offset = 0.0
    displacement_stage._smooth(thing.data, shading != "flat")
    if second:
        displacement_stage._give_second(thing, second)
    last = thing.modifiers.new("Adaptive", "SUBSURF")
    last.subdivision_type = kind
    last.levels = last.render_levels = level
    last.use_adaptive_subdivision = True
    last.adaptive_space = "OBJECT" if edge else "PIXEL"
    last.adaptive_pixel_size = pixels
    if edge:
        last.adaptive_object_edge_length = edge
    for name, value in modifier.items():
        setattr(last, name, value)
    scene.cycles.max_subdivisions = limit
    if not ground:
        scene.camera.data.lens = 85.0
    if dicing_camera:
        far = m.add_object("Far", scene.camera.data.copy(), (0.0, -40.0, 1.0))
        scene.cycles.dicing_camera = far


def _shape(shape: str, material: bpy.types.Material) -> bpy.types.Object:
    if shape in {"grid", "coarse", "ball"}:
        return displacement_stage._shape(shape, material)
    if shape == "sheet":
        return displacement_stage._grid(3, material)
    if shape == "field":
        corners = [(-1.5, -2.2, 0.2), (1.5, -2.2, 0.2), (1.5, 2.0, 0.2), (-1.5, 2.0, 0.2)]
        thing = m.add_mesh("Thing", corners, [(0, 1, 2, 3)], material)
        layer = thing.data.uv_layers.new(name="UVMap")
        for k, uv in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
            layer.uv[k].vector = uv
        return thing
    if shape == "monkey":
        bpy.ops.mesh.primitive_monkey_add(size=1.1)
        thing = bpy.context.object
        thing.rotation_euler = (0.0, 0.0, 0.4)
        thing.data.materials.append(material)
        return thing
    if shape == "drum":
        turns = np.arange(6) * np.pi / 3
        ring = [(0.4 * np.cos(t), 0.4 * np.sin(t)) for t in turns]
        vertices = [(*p, -0.3) for p in ring] + [(*p, 0.3) for p in ring]
        sides = [(k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k) for k in range(6)]
        faces = [tuple(range(5, -1, -1)), tuple(range(6, 12)), *sides]
        return m.add_mesh("Thing", vertices, faces, material)
    thing = m.add_boxes("Thing", [((-0.4, -0.4, -0.4), (0.4, 0.4, 0.4))], material)
    thing.rotation_euler = (0.3, 0.2, 0.5)
    if shape in {"creased", "sharp"}:
        crease = thing.data.attributes.new("crease_edge", "FLOAT", "EDGE")
        half = 0.45 if shape == "creased" else 0.0
        values = [1.0 if k % 3 == 0 else half if k % 3 == 1 else 0.0 for k in range(12)]
        crease.data.foreach_set("value", values)
    if shape == "pinned":
        crease = thing.data.attributes.new("crease_vert", "FLOAT", "POINT")
        crease.data.foreach_set("value", [1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0])
    return thing
