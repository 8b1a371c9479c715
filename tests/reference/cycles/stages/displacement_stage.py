"""Scenes for cases.py: surfaces whose vertices their materials move. See stage.py."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, radians
from typing import Any

import bpy
import numpy as np
from mathutils import Vector

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage

PLACE = (0.0, -0.1, 0.62)


def displaced(
    shape: str = "grid",
    method: str = "DISPLACEMENT",
    height: str = "noise",
    space: str = "OBJECT",
    amount: float = 0.3,
    midlevel: float = 0.5,
    shading: str = "smooth",
    scale: Sequence[float] = (1.0, 1.0, 1.0),
    color: str = "plain",
    second: str = "",
    normal_map: str = "",
) -> None:
    """A thing that a material moves, on the stage.

    shape      grid, coarse (one of few faces), ball, box (subdivided) or plate (by a modifier)
    height     noise (Generated), object (the same by Object coordinates), image or vector
    space      of the Displacement node, or of Vector Displacement for a vector
    shading    smooth, flat, sharp (edges) or custom (split normals)
    color      plain, places (of Object and Generated coordinates), or shining
    second     another material for a half of the faces: plain, moved or both
    normal_map  base of a Normal Map, if any
    """
    stage._stage(things=False)
    stage._lamp("AREA", 25.0, (1.2, -1.0, 1.7), PLACE, size=0.3)
    m.set_world((0.06, 0.07, 0.09))
    material = _material("Moved", color, normal_map)
    _displace(material, method, height, space, amount, midlevel)
    thing = _shape(shape, material)
    thing.location, thing.scale = PLACE, scale
    thing.shadow_terminator_geometry_offset = 0.0  # a trick of Cycles' for coarse meshes
    _shade(thing, shading)
    if second:
        _give_second(thing, second)
    bpy.context.scene.camera.data.lens = 85.0
    if color == "shining":
        for lamp in [ob for ob in bpy.data.objects if ob.type == "LIGHT"]:
            bpy.data.objects.remove(lamp)


def displaced_copies(linked: str = "DATA", space: str = "OBJECT") -> None:
    """One mesh that stands in four places, differently large, turned and mirrored; by slots of
    the objects (`linked` OBJECT) with different materials.
    """
    stage._stage(things=False)
    stage._lamp("AREA", 25.0, (1.2, -1.0, 1.7), PLACE, size=0.3)
    materials = [_material(f"Moved {k}", "plain", "") for k in range(4)]
    for k, material in enumerate(materials):
        _displace(material, "DISPLACEMENT", "noise", space, 0.25 + 0.2 * k, 0.5)
    mesh = _shape("ball", materials[0]).data
    bpy.data.objects.remove(bpy.data.objects["Thing"])
    _smooth(mesh, True)
    scales = [(0.6, 0.6, 0.6), (0.35, 0.5, 0.8), (-0.6, 0.6, 0.6), (0.4, 0.4, 0.4)]
    for k, scale in enumerate(scales):
        thing = m.add_object(f"Copy {k}", mesh, (-0.9 + 0.6 * k, -0.2, 0.45), 0.7 * k)
        thing.scale = scale
        thing.shadow_terminator_geometry_offset = 0.0
        if linked == "OBJECT":
            thing.material_slots[0].link = "OBJECT"
            thing.material_slots[0].material = materials[k]


def _shape(shape: str, material: bpy.types.Material) -> bpy.types.Object:
    if shape == "grid":
        return _grid(32, material)
    if shape == "coarse":
        return _grid(9, material)
    if shape == "plate":
        thing = _grid(2, material)
        modifier = thing.modifiers.new("Subdivide", "SUBSURF")
        modifier.levels = modifier.render_levels = 4
        return thing
    if shape == "ball":
        thing = m.add_sphere("Thing", 0.45, material, (0.0, 0.0, 0.0), 40)
        _wrap(thing.data)
        return thing
    thing = m.add_boxes("Thing", [((-0.35, -0.35, -0.35), (0.35, 0.35, 0.35))], material)
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=9)
    bpy.ops.object.mode_set(mode="OBJECT")
    _wrap(thing.data)
    return thing


def _grid(count: int, material: bpy.types.Material) -> bpy.types.Object:
    """A square that leans towards the camera, with a UV map."""
    steps = np.linspace(-0.6, 0.6, count)
    vertices = [(x, 0.5 * y, 0.8 * y) for y in steps for x in steps]
    faces = [
        (y * count + x, y * count + x + 1, (y + 1) * count + x + 1, (y + 1) * count + x)
        for y in range(count - 1)
        for x in range(count - 1)
    ]
    thing = m.add_mesh("Thing", vertices, faces, material)
    layer = thing.data.uv_layers.new(name="UVMap")
    for loop, uv in zip(thing.data.loops, layer.uv, strict=True):
        index = loop.vertex_index
        uv.vector = ((index % count) / (count - 1), (index // count) / (count - 1))
    return thing


def _wrap(mesh: bpy.types.Mesh) -> None:
    """A UV map like a globe's, with a seam."""
    layer = mesh.uv_layers.new(name="UVMap")
    for face in mesh.polygons:
        longitude = np.arctan2(face.center.y, face.center.x)
        for index in face.loop_indices:
            p = mesh.vertices[mesh.loops[index].vertex_index].co
            turn = np.arctan2(p.y, p.x) if p.xy.length > 1e-4 else longitude
            turn += 2 * pi * round((longitude - turn) / (2 * pi))
            layer.uv[index].vector = (0.5 + turn / (2 * pi), 0.5 + p.z)


def _smooth(mesh: bpy.types.Mesh, smooth: bool) -> None:
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))


def _shade(thing: bpy.types.Object, shading: str) -> None:
    mesh = thing.data
    _smooth(mesh, shading != "flat")
    if shading == "sharp":
        mesh.set_sharp_from_angle(angle=radians(30.0))
        for face in mesh.polygons:
            if face.center.z > 0.3:
                face.use_smooth = False
    if shading == "custom":
        normals = [
            (vertex.co.normalized() + Vector((0.0, -0.5, 0.5))).normalized()
            for vertex in mesh.vertices
        ]
        mesh.normals_split_custom_set_from_vertices(normals)


def _give_second(thing: bpy.types.Object, second: str) -> None:
    other = _material("Second", "plain", "")
    other.node_tree.nodes["Shader"].inputs["Base Color"].default_value = (0.2, 0.6, 0.3, 1.0)
    if second != "plain":
        method = "BOTH" if second == "both" else "DISPLACEMENT"
        _displace(other, method, "object", "OBJECT", 0.3, 0.0)
    thing.data.materials.append(other)
    for face in thing.data.polygons:
        face.material_index = int(face.center.x > 0.05)


def _material(name: str, color: str, normal_map: str) -> bpy.types.Material:
    material, tree, output = m._node_material(name)
    add, link = tree.nodes.new, tree.links.new
    shader = add("ShaderNodeBsdfPrincipled")
    shader.name = "Shader"
    shader.inputs["Base Color"].default_value = (0.75, 0.55, 0.4, 1.0)
    shader.inputs["Specular IOR Level"].default_value = 0.0
    link(shader.outputs[0], output.inputs["Surface"])
    if color == "shining":
        shader.inputs["Emission Color"].default_value = (1.0, 0.8, 0.5, 1.0)
        shader.inputs["Emission Strength"].default_value = 3.0
    if color == "places":
        where, mix = add("ShaderNodeTexCoord"), add("ShaderNodeVectorMath")
        link(where.outputs["Object"], mix.inputs[0])
        link(where.outputs["Generated"], mix.inputs[1])
        size = add("ShaderNodeVectorMath")
        size.operation = "ABSOLUTE"
        link(mix.outputs[0], size.inputs[0])
        link(size.outputs[0], shader.inputs["Base Color"])
    if normal_map:
        node, texture = add("ShaderNodeNormalMap"), add("ShaderNodeTexImage")
        node.base = normal_map
        node.inputs["Strength"].default_value = 0.7
        texture.image = _picture(np.array([0.5, 0.5, 0.9]), 0.35)
        texture.image.colorspace_settings.name = "Non-Color"
        link(texture.outputs["Color"], node.inputs["Color"])
        link(node.outputs["Normal"], shader.inputs["Normal"])
    return material


def _picture(base: np.ndarray, swing: float) -> bpy.types.Image:
    y, x = np.mgrid[0:64, 0:64] / 64.0 * 2 * pi
    waves = np.stack([np.sin(3 * x), np.sin(2 * y + x), np.sin(2 * x) * np.cos(3 * y)], -1)
    return m.packed_image("Waves", np.clip(base + swing * waves * [1, 1, 0.3], 0, 1))


def _displace(
    material: bpy.types.Material,
    method: str,
    height: str,
    space: str,
    amount: float,
    midlevel: float,
) -> None:
    material.displacement_method = method
    tree = material.node_tree
    add, link = tree.nodes.new, tree.links.new
    kind = "ShaderNodeVectorDisplacement" if height == "vector" else "ShaderNodeDisplacement"
    node: Any = add(kind)
    node.space = space
    node.inputs["Midlevel"].default_value = midlevel
    node.inputs["Scale"].default_value = amount
    if height in ("image", "vector"):
        texture = add("ShaderNodeTexImage")
        texture.image = _picture(np.array([0.5, 0.5, 0.5]), 0.4)
        texture.image.colorspace_settings.name = "Non-Color"
        link(texture.outputs["Color"], node.inputs[0])
    else:
        where, noise = add("ShaderNodeTexCoord"), add("ShaderNodeTexNoise")
        noise.inputs["Scale"].default_value = 4.0
        link(where.outputs["Object" if height == "object" else "Generated"], noise.inputs[0])
        link(noise.outputs[0], node.inputs["Height"])
    output = next(one for one in tree.nodes if one.type == "OUTPUT_MATERIAL")
    link(node.outputs[0], output.inputs["Displacement"])
