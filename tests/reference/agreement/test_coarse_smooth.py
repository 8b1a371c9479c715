"""Coarse things that are shaded smooth, whose normals promise another shape than the mesh has: what
they let through and mirror onto a floor is as bright as in Cycles.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.support import stage


def _made_of(kind: str, **inputs: float) -> Any:
    made, tree = stage.empty_material(kind)
    shader = tree.nodes.new(f"ShaderNodeBsdf{kind}")
    for name, value in inputs.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    stage.surface(tree, shader)
    return made


def _cube() -> None:
    import bpy

    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0, 0, 0.55), rotation=(0, 0, 0.5))


def _cup() -> None:
    """Its rim and its foot have sharp edges."""
    import bpy

    bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=0.5, depth=1.0, location=(0, 0, 0.55))
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="FACE")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    top = max(bpy.context.object.data.polygons, key=lambda face: face.center.z)
    top.select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.inset(thickness=0.06)
    bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0, 0, -0.9)})
    bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize(
    ("shape", "material"),
    [
        (_cup, lambda: _made_of("Glass", Roughness=0.0, IOR=1.45)),
        (_cube, lambda: _made_of("Anisotropic", Roughness=0.0)),
        (_cube, lambda: _made_of("Principled", Roughness=0.6, Coat_Weight=1.0)),
    ],
    ids=["glass-cup", "mirror", "coat"],
)
def test_the_floor_around(shape: Callable[[], None], material: Callable[[], Any]) -> None:
    """Of the lamp and the world."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    stage.resize(64)
    stage.world(0.15)
    bpy.ops.mesh.primitive_plane_add(size=8.0)
    bpy.context.object.data.materials.append(stage.material("Floor", (0.7, 0.7, 0.7)))
    shape()
    thing = bpy.context.object
    thing.data.materials.append(material())
    for face in thing.data.polygons:
        face.use_smooth = True
    lamp = stage.lamp("AREA", 300, (1.2, 0.8, 4.0))
    lamp.data.size = 1.5
    stage.camera((0, 0, 5.0)).data.angle = 0.6
    ours, cycles = means_beside_cycles(512, passes=24, photons_per_pass=20_000)
    assert ours == pytest.approx(cycles, rel=0.006)
