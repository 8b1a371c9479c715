"""Tools with which the scripts here model: an empty file, Lambertian materials, boxes, lathes,
lights and a camera.

Metres, Z up. Every material is exactly Lambertian (Diffuse BSDF of roughness 0, or a Principled
BSDF without specular), clear smooth glass or smooth metal, so that any engine that solves the
rendering equation must arrive at the same picture.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import cos, pi, sin
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

Point = Sequence[float]
Face = Sequence[int]
HERE = Path(__file__).resolve().parents[1]


class _Placeholder(bpy.types.RenderEngine):
    """Blender refuses to store the name of an engine it does not know; this makes the name known
    while a scene is written.
    """

    bl_idname = "PHOTON_SPLAT"
    bl_label = "Photon Splat"


def new_scene(width: int, height: int, view_transform: str = "Standard") -> bpy.types.Scene:
    """An empty file whose scene is set to Photon Splat."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if not any(
        getattr(engine, "bl_idname", "") == _Placeholder.bl_idname and engine.is_registered
        for engine in bpy.types.RenderEngine.__subclasses__()
    ):
        bpy.utils.register_class(_Placeholder)
    scene = bpy.context.scene
    scene.render.engine = "PHOTON_SPLAT"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = (
        width,
        height,
        100,
    )
    scene.view_settings.view_transform = view_transform
    scene.render.image_settings.file_format = "PNG"
    return scene


def save(name: str) -> Path:
    """Write `name`.blend beside this file, compressed."""
    path = HERE / f"{name}.blend"
    bpy.ops.outliner.orphans_purge(do_recursive=True)
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)
    print(f"{path.name}: {path.stat().st_size / 1024:.0f} KiB", file=sys.stderr)
    return path


# Materials ----------------------------------------------------------------------------------------


def _node_material(name: str) -> tuple[bpy.types.Material, bpy.types.NodeTree, bpy.types.Node]:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    return material, tree, tree.nodes.new("ShaderNodeOutputMaterial")


def diffuse(name: str, color: Point) -> bpy.types.Material:
    """A Diffuse BSDF of roughness 0; `color` is the linear albedo."""
    material, tree, output = _node_material(name)
    node = tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (*color, 1.0)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def principled(
    name: str, color: Point = (0.8, 0.8, 0.8), image: bpy.types.Image | None = None
) -> bpy.types.Material:
    """A Principled BSDF with its specular level at 0, which leaves a Lambertian surface; `image`
    replaces the base colour.
    """
    material, tree, output = _node_material(name)
    node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    node.inputs["Base Color"].default_value = (*color, 1.0)
    node.inputs["Specular IOR Level"].default_value = 0.0
    if image:
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def emission(name: str, color: Point, strength: float) -> bpy.types.Material:
    """An Emission node: both sides shine with radiance color * strength."""
    material, tree, output = _node_material(name)
    node = tree.nodes.new("ShaderNodeEmission")
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Strength"].default_value = strength
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def front_emission(name: str, color: Point, strength: float) -> bpy.types.Material:
    """Emission from the front, a black surface behind."""
    material, tree, output = _node_material(name)
    light, black = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    mix, geometry = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeNewGeometry")
    light.inputs["Color"].default_value = (*color, 1.0)
    light.inputs["Strength"].default_value = strength
    black.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    tree.links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    tree.links.new(light.outputs[0], mix.inputs[1])
    tree.links.new(black.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return material


def glass(name: str, ior: float) -> bpy.types.Material:
    """A clear, smooth Glass BSDF."""
    material, tree, output = _node_material(name)
    node = tree.nodes.new("ShaderNodeBsdfGlass")
    node.inputs["Roughness"].default_value = 0.0
    node.inputs["IOR"].default_value = ior
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def in_medium(
    material: bpy.types.Material, density: float, color: Point, anisotropy: float = 0.0
) -> bpy.types.Material:
    """Fill what it encloses with a medium that scatters and, in other colours, absorbs."""
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeVolumePrincipled")
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Density"].default_value = density
    node.inputs["Anisotropy"].default_value = anisotropy
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(node.outputs[0], output.inputs["Volume"])
    return material


def medium(
    name: str, density: float, color: Point = (1.0, 1.0, 1.0), anisotropy: float = 0.0
) -> bpy.types.Material:
    """A medium without a surface."""
    return in_medium(_node_material(name)[0], density, color, anisotropy)


def polished_metal(name: str, color: Point) -> bpy.types.Material:
    """A smooth Glossy BSDF: reflects `color` at every angle."""
    material, tree, output = _node_material(name)
    node = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Roughness"].default_value = 0.0
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def packed_image(name: str, pixels: np.ndarray) -> bpy.types.Image:
    """An image packed into the file. pixels: (height, width, 3) in 0..1, sRGB-encoded, row 0 at the
    bottom.
    """
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height)
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = pixels
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    image.pack()
    return image


# Shapes -------------------------------------------------------------------------------------------


def add_mesh(
    name: str,
    vertices: Iterable[Point],
    faces: Iterable[Face],
    materials: bpy.types.Material | Sequence[bpy.types.Material],
    slots: Sequence[int] | None = None,
    *,
    smooth: bool = False,
    location: Point = (0.0, 0.0, 0.0),
    turn: float = 0.0,
) -> bpy.types.Object:
    """A mesh object; `slots` are material slots per face, `turn` is radians about Z."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in vertices], [], [tuple(f) for f in faces])
    for material in [materials] if isinstance(materials, bpy.types.Material) else materials:
        mesh.materials.append(material)
    if slots is not None:
        mesh.polygons.foreach_set("material_index", list(slots))
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    mesh.validate()
    return add_object(name, mesh, location, turn)


def add_object(
    name: str, data: bpy.types.ID | None, location: Point = (0.0, 0.0, 0.0), turn: float = 0.0
) -> bpy.types.Object:
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    thing.rotation_euler[2] = turn
    bpy.context.scene.collection.objects.link(thing)
    return thing


CUBE_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def box_data(low: Point, high: Point) -> tuple[list[Point], list[Face]]:
    """Corners and outward faces (bottom, top, front, back, left, right) of an axis-aligned box."""
    corners = [
        (x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])
    ]
    return corners, list(CUBE_FACES)


def boxes_data(boxes: Iterable[tuple[Point, Point]]) -> tuple[list[Point], list[Face]]:
    vertices: list[Point] = []
    faces: list[Face] = []
    for low, high in boxes:
        corners, sides = box_data(low, high)
        faces += [[index + len(vertices) for index in side] for side in sides]
        vertices += corners
    return vertices, faces


def add_boxes(
    name: str,
    boxes: Iterable[tuple[Point, Point]],
    material: bpy.types.Material,
    location: Point = (0.0, 0.0, 0.0),
    turn: float = 0.0,
) -> bpy.types.Object:
    """One object of several axis-aligned boxes given by their opposite corners."""
    return add_mesh(name, *boxes_data(boxes), material, location=location, turn=turn)


def add_lathe(
    name: str,
    profile: Sequence[tuple[float, float]],
    material: bpy.types.Material,
    location: Point,
    segments: int = 32,
) -> bpy.types.Object:
    """A smooth surface of revolution about Z. profile: (radius, height) from bottom to top; a
    radius of 0 closes an end.
    """
    vertices: list[Point] = []
    rings: list[list[int]] = []
    for radius, height in profile:
        count = segments if radius > 0.0 else 1
        rings.append([len(vertices) + k % count for k in range(segments)])
        vertices += [
            (radius * cos(2 * pi * k / segments), radius * sin(2 * pi * k / segments), height)
            for k in range(count)
        ]
    faces = []
    for lower, upper in pairwise(rings):
        for k in range(segments):
            face = [lower[k], lower[(k + 1) % segments], upper[(k + 1) % segments], upper[k]]
            faces.append(list(dict.fromkeys(face)))
    return add_mesh(name, vertices, faces, material, smooth=True, location=location)


def add_turned(
    name: str,
    profile: Sequence[tuple[float, float]],
    material: bpy.types.Material,
    location: Point,
    segments: int,
) -> bpy.types.Object:
    """Like add_lathe, but every strip of the profile is smooth by itself, with hard edges between
    strips.

    profile: (radius, height), so ordered that the outside is on the right of the way along it in
    the (radius, height) plane.
    """
    vertices: list[Point] = []
    faces: list[Face] = []
    turns = [2 * pi * k / segments for k in range(segments)]
    for pair in pairwise(profile):
        rings = []
        for radius, height in pair:
            count = segments if radius > 0.0 else 1
            rings.append([len(vertices) + k % count for k in range(segments)])
            vertices += [(radius * cos(turn), radius * sin(turn), height) for turn in turns[:count]]
        lower, upper = rings
        for k in range(segments):
            face = [lower[k], lower[(k + 1) % segments], upper[(k + 1) % segments], upper[k]]
            faces.append(list(dict.fromkeys(face)))
    return add_mesh(name, vertices, faces, material, smooth=True, location=location)


def add_sphere(
    name: str, radius: float, material: bpy.types.Material, location: Point, segments: int = 32
) -> bpy.types.Object:
    """A smooth-shaded globe of `segments` x `segments`/2 faces."""
    rings = segments // 2
    profile = [
        (radius * sin(pi * k / rings) if 0 < k < rings else 0.0, -radius * cos(pi * k / rings))
        for k in range(rings + 1)
    ]
    return add_lathe(name, profile, material, location, segments)


def add_picture(
    name: str,
    corners: Sequence[Point],
    material: bpy.types.Material,
    repeat: tuple[float, float] = (1.0, 1.0),
) -> bpy.types.Object:
    """A textured quad. corners: counter-clockwise seen from the front, the first at the texture's
    bottom left.
    """
    thing = add_mesh(name, corners, [(0, 1, 2, 3)], material)
    u, v = repeat
    thing.data.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, u, 0, u, v, 0, v])
    return thing


def subdivide_flat(thing: bpy.types.Object, levels: int) -> None:
    """A modifier that splits every quad into 4**levels of the same plane."""
    if levels > 0:
        modifier = thing.modifiers.new("Subdivide", "SUBSURF")
        modifier.subdivision_type = "SIMPLE"
        modifier.levels = modifier.render_levels = levels


# Light and view -----------------------------------------------------------------------------------


def add_light(
    name: str,
    kind: str,
    energy: float,
    location: Point,
    aim: Point | None = None,
    **settings: object,
) -> bpy.types.Object:
    """A lamp at `location` that shines towards the point `aim` (straight down without one)."""
    light = bpy.data.lights.new(name, kind)
    light.energy = energy
    for key, value in settings.items():
        setattr(light, key, value)
    thing = add_object(name, light, location)
    if aim is not None:
        thing.rotation_euler = (Vector(aim) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    return thing


def set_world(color: Point, strength: float = 1.0) -> None:
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength
    bpy.context.scene.world = world


def add_camera(
    location: Point, aim: Point, lens: float = 35.0, ortho_scale: float | None = None
) -> bpy.types.Object:
    """The scene's camera at `location`, looking at the point `aim`."""
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    if ortho_scale is not None:
        data.type, data.ortho_scale = "ORTHO", ortho_scale
    thing = add_object("Camera", data, location)
    direction = Vector(aim) - Vector(location)
    thing.matrix_world = (
        Matrix.Translation(location) @ direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()
    )
    bpy.context.scene.camera = thing
    return thing
