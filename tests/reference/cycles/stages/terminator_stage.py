"""Scenes for cases.py: coarse meshes with smooth normals in slanting light. See stage.py."""

from __future__ import annotations

from collections.abc import Sequence

import bmesh
import bpy

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage
from tests.support.stage import add_bumps

PLACE = (0.0, -0.1, 0.75)


def terminator(
    lamp: str = "sun",
    shape: str = "ball",
    offset: float | None = None,
    material: str = "plain",
    scale: Sequence[float] = (1.0, 1.0, 1.0),
    copies: int = 1,
    bumps: float = 0.0,
) -> None:
    """A coarse thing on the stage, lit from one side.

    shape     ball of few faces, saddle, bowl (open, seen from within), or half (of a ball: one half
              of its faces flat)
    offset    Shading > Geometry Offset; None: Blender's own
    material  plain, leaf (half translucent) or gloss
    copies    of one mesh
    bumps     of the material's displacement, as bumps alone, m
    """
    stage._stage(things=False)
    if lamp == "sun":
        stage._lamp("SUN", 3.0, aim=(1.0, -0.35, 0.45), angle=0.01)
    elif lamp == "area":
        stage._lamp("AREA", 30.0, (1.4, -0.6, 1.2), PLACE, size=0.4)
    else:
        stage._lamp("POINT", 40.0, (-1.2, -0.9, 1.4), shadow_soft_size=0.05)
    mesh = _mesh(shape)
    mesh.materials.append(_material(material))
    if bumps:
        add_bumps(mesh.materials[0], bumps)
    for k in range(copies):
        thing = bpy.data.objects.new("Coarse", mesh)
        bpy.context.scene.collection.objects.link(thing)
        thing.location = (PLACE[0] + (k - 0.5 * (copies - 1)) * 0.9, *PLACE[1:])
        thing.scale = [s * (1.0 if copies == 1 else 0.6) for s in scale]
        thing.rotation_euler = (0.2, 0.1 + k, 0.4)
        if offset is not None:
            thing.shadow_terminator_geometry_offset = offset
    bpy.context.scene.camera.data.lens = 75.0


def _mesh(shape: str) -> bpy.types.Mesh:
    data = bpy.data.meshes.new("Coarse")
    shaped = bmesh.new()
    if shape == "saddle":
        bmesh.ops.create_grid(shaped, x_segments=5, y_segments=5, size=0.6)
        for vertex in shaped.verts:
            vertex.co.z = 1.1 * (vertex.co.x**2 - vertex.co.y**2)
    else:
        bmesh.ops.create_uvsphere(shaped, u_segments=9, v_segments=6, radius=0.6)
    if shape == "bowl":
        gone = [v for v in shaped.verts if v.co.y < -0.05]
        bmesh.ops.delete(shaped, geom=gone, context="VERTS")
    for face in shaped.faces:
        face.smooth = shape != "half" or face.calc_center_median().z > 0
    shaped.to_mesh(data)
    shaped.free()
    return data


def _material(kind: str) -> bpy.types.Material:
    if kind == "plain":
        return m.diffuse("Plain", (0.7, 0.6, 0.5))
    material, tree, output = m._node_material(kind)
    first = tree.nodes.new("ShaderNodeBsdfDiffuse")
    second = tree.nodes.new(
        "ShaderNodeBsdfTranslucent" if kind == "leaf" else "ShaderNodeBsdfAnisotropic"
    )
    if kind == "gloss":
        second.inputs["Roughness"].default_value = 0.5
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(first.outputs[0], mix.inputs[1])
    tree.links.new(second.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return material
