"""Random Blender scenes as artists set them up: lamps of all kinds with nodes and flags, worlds,
lenses, ray visibility, Light Path, holdouts, instances, modifiers, parents that shear. Runs inside
Blender.

What docs/limitations.md says to differ from Cycles is left out: lamps and shining meshes without
shadow, emission that asks which ray sees it.
"""

from __future__ import annotations

import math
import random
from typing import Any

from tests.support import random_materials, stage

SIZE = (96, 72)
RAYS = ("camera", "diffuse", "glossy", "transmission")
LENSES = (
    "EQUIRECTANGULAR",
    "FISHEYE_EQUIDISTANT",
    "FISHEYE_EQUISOLID",
    "MIRRORBALL",
    "EQUIANGULAR_CUBEMAP_FACE",
    "CENTRAL_CYLINDRICAL",
)


def build(chance: random.Random) -> Any:
    """A scene of its own on an emptied file; returns it."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    made = stage.scene()
    stage.resize(*SIZE)
    _world(chance, made)
    _ground(chance)
    for _ in range(chance.randint(3, 6)):
        _thing(chance)
    for _ in range(chance.randint(1, 3)):
        _lamp(chance)
    _camera(chance)
    _film(chance, made)
    return made


def _world(chance: random.Random, made: Any) -> None:
    stage.world(1.0)
    tree = made.world.node_tree
    background = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = random_materials.color(chance)
    background.inputs["Strength"].default_value = chance.choice([0.0, 0.2, 0.5, 1.0])
    kind = chance.choice(["", "", "TexGradient", "TexNoise", "TexSky", "LightPath"])
    if kind == "LightPath":
        path, mix, other = (
            tree.nodes.new(f"ShaderNode{name}") for name in (kind, "MixShader", "Background")
        )
        other.inputs["Color"].default_value = random_materials.color(chance)
        tree.links.new(
            path.outputs[f"Is {chance.choice(['Camera', 'Glossy', 'Diffuse'])} Ray"], mix.inputs[0]
        )
        tree.links.new(background.outputs[0], mix.inputs[1])
        tree.links.new(other.outputs[0], mix.inputs[2])
        stage.surface(tree, mix)
    elif kind == "TexSky":
        sky = tree.nodes.new("ShaderNodeTexSky")
        sky.sun_elevation, sky.sun_rotation = chance.uniform(0.1, 1.4), chance.uniform(0, 6)
        sky.sun_disc, sky.sun_size = chance.random() < 0.7, chance.uniform(0.02, 0.2)
        tree.links.new(sky.outputs[0], background.inputs["Color"])
        background.inputs["Strength"].default_value = 0.05
    elif kind:
        place, mapping, texture = (
            tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "Mapping", kind)
        )
        mapping.inputs["Rotation"].default_value = [chance.uniform(-2, 2) for _ in range(3)]
        tree.links.new(place.outputs[chance.choice(["Generated", "Object"])], mapping.inputs[0])
        tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
        tree.links.new(texture.outputs[0], background.inputs["Color"])
    for ray in RAYS:
        if chance.random() < 0.1:
            setattr(made.world.cycles_visibility, ray, False)


def _ground(chance: random.Random) -> None:
    import bpy

    kind = chance.choice(["plane", "room", "hills"])
    if kind == "room":
        bpy.ops.mesh.primitive_cube_add(size=8, location=(0, 0, 4))
    elif kind == "plane":
        bpy.ops.mesh.primitive_plane_add(size=chance.choice([6, 40]))
    else:
        bpy.ops.mesh.primitive_grid_add(size=12, x_subdivisions=20, y_subdivisions=20)
        for vertex in bpy.context.object.data.vertices:
            vertex.co.z = 0.3 * math.sin(vertex.co.x) * math.cos(1.3 * vertex.co.y)
        bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(random_materials.material(chance))


def _thing(chance: random.Random) -> None:
    import bpy

    add = bpy.ops.mesh
    chance.choice(
        [
            lambda: add.primitive_cube_add(size=0.9),
            lambda: add.primitive_uv_sphere_add(segments=24, ring_count=12, radius=0.5),
            lambda: add.primitive_torus_add(major_radius=0.45, minor_radius=0.18),
            lambda: add.primitive_monkey_add(size=1),
            lambda: add.primitive_cylinder_add(vertices=24, radius=0.4, depth=0.8),
            lambda: add.primitive_plane_add(size=1.2),
            lambda: add.primitive_ico_sphere_add(radius=0.5),
        ]
    )()
    ob = bpy.context.object
    ob.location = (chance.uniform(-1.5, 1.5), chance.uniform(-1.5, 1.5), chance.uniform(0.3, 1.5))
    ob.rotation_euler = [chance.uniform(-3, 3) for _ in range(3)]
    ob.scale = [chance.uniform(0.5, 1.4) for _ in range(3)]
    ob.scale.x *= chance.choice([1, 1, 1, -1])
    if chance.random() < 0.6:
        bpy.ops.object.shade_smooth()
    kinds = chance.choice(["FLOAT_COLOR", "BYTE_COLOR"]), chance.choice(["POINT", "CORNER"])
    for value in ob.data.color_attributes.new(random_materials.COLORS, *kinds).data:
        value.color = random_materials.color(chance, 0.0, 1.0)
    for _ in range(chance.choice([1, 1, 2])):
        ob.data.materials.append(random_materials.material(chance))
    for face in ob.data.polygons:
        face.material_index = face.index % len(ob.data.materials)
    modifier = chance.choice(["", "", "", "SUBSURF", "ARRAY", "WIREFRAME", "BEVEL"])
    if modifier:
        made = ob.modifiers.new(modifier, modifier)
        if modifier == "SUBSURF":  # scenes are exported as the viewport has them
            made.levels = made.render_levels
    if chance.random() < 0.15:  # a parent that shears
        ob.parent = stage.add("Parent")
        ob.parent.scale = [chance.uniform(0.5, 1.5) for _ in range(3)]
        ob.parent.rotation_euler = [chance.uniform(-1, 1) for _ in range(3)]
    for ray in RAYS:
        if chance.random() < 0.06:
            setattr(ob, f"visible_{ray}", False)
    ob.is_holdout = chance.random() < 0.05
    if chance.random() < 0.1:
        _instances(chance, ob)


def _instances(chance: random.Random, ob: Any) -> None:
    import bpy

    group = bpy.data.collections.new("Group")
    group.objects.link(ob)
    for _ in range(2):
        place = (chance.uniform(-1, 1), chance.uniform(-1, 1), chance.uniform(0.1, 1))
        stand = stage.add("Stand", location=place)
        stand.instance_type, stand.instance_collection = "COLLECTION", group
        stand.rotation_euler.z, stand.scale = chance.uniform(-3, 3), [chance.uniform(0.5, 1)] * 3


def _lamp(chance: random.Random) -> None:
    kind = chance.choice(["POINT", "SPOT", "AREA", "AREA", "SUN"])
    place = (chance.uniform(-2.5, 2.5), chance.uniform(-3, 1.5), chance.uniform(1.8, 3.8))
    ob = stage.lamp(kind, chance.uniform(0.5, 1.5) * (2 if kind == "SUN" else 120), place)
    ob.rotation_euler = (chance.uniform(-0.4, 1), chance.uniform(-0.6, 0.6), chance.uniform(-3, 3))
    lamp = ob.data
    lamp.color = random_materials.color(chance, 0.4, 1.0)[:3]
    if kind in {"POINT", "SPOT"}:
        lamp.shadow_soft_size = chance.choice([0, 0.05, 0.2, 0.5])
        lamp.use_soft_falloff = chance.random() < 0.5
    if kind == "SPOT":
        lamp.spot_size, lamp.spot_blend = chance.uniform(0.4, 2.5), chance.choice([0, 0.15, 1])
        ob.scale = chance.choice([(1, 1, 1), (1, 0.5, 1), (2, 1, 1)])
    if kind == "AREA":
        lamp.shape = chance.choice(["SQUARE", "RECTANGLE", "DISK", "ELLIPSE"])
        lamp.size, lamp.size_y = chance.uniform(0.2, 2), chance.uniform(0.2, 1)
        lamp.spread = chance.choice([math.pi, math.pi, 1.5, 0.4])
    if kind == "SUN":
        lamp.angle = chance.choice([0, 0.01, 0.3, 1.5])
    if chance.random() < 0.15 and hasattr(lamp, "normalize"):
        lamp.normalize, lamp.energy = False, lamp.energy / 30
    if chance.random() < 0.2 and hasattr(lamp, "use_temperature"):
        lamp.use_temperature, lamp.temperature = True, chance.uniform(2000, 12000)
    if chance.random() < 0.1:
        lamp.cycles.max_bounces = chance.choice([0, 1, 2])
    for ray in RAYS[1:]:
        if chance.random() < 0.08:
            setattr(ob, f"visible_{ray}", False)


def _camera(chance: random.Random) -> None:
    ob = stage.camera((chance.uniform(-1.5, 1.5), -3.7, chance.uniform(0.6, 2.6)))
    down = math.atan2(ob.location.z - 0.7, 3.7)
    ob.rotation_euler = (math.pi / 2 - down, chance.uniform(-0.1, 0.1), chance.uniform(-0.1, 0.1))
    lens = ob.data
    lens.type = chance.choice(["PERSP", "PERSP", "PERSP", "PERSP", "ORTHO", "PANO"])
    lens.ortho_scale = chance.uniform(3, 6)
    lens.angle = chance.uniform(0.6, 1.3)
    if lens.type == "PANO":
        of_lens = lens if hasattr(lens, "panorama_type") else lens.cycles
        of_lens.panorama_type = chance.choice(LENSES)
        of_lens.fisheye_fov = chance.uniform(1.5, 4)
    if chance.random() < 0.3:
        lens.shift_x, lens.shift_y = chance.uniform(-0.3, 0.3), chance.uniform(-0.3, 0.3)
    lens.sensor_fit = chance.choice(["AUTO", "AUTO", "HORIZONTAL", "VERTICAL"])
    if chance.random() < 0.25 and lens.type != "PANO":
        lens.dof.use_dof, lens.dof.focus_distance = True, chance.uniform(2, 4)
        lens.dof.aperture_fstop = chance.choice([0.2, 0.5, 1.4])
        lens.dof.aperture_blades, lens.dof.aperture_ratio = chance.choice([(0, 1), (3, 2), (6, 1)])
    if chance.random() < 0.2:
        lens.clip_start = chance.uniform(2, 3.5)
    if chance.random() < 0.1:
        lens.clip_end = chance.uniform(3.5, 6)


def _film(chance: random.Random, made: Any) -> None:
    made.cycles.film_exposure = chance.choice([1, 1, 1, 0.5, 2])
    made.render.film_transparent = chance.random() < 0.2
    made.cycles.pixel_filter_type = chance.choice(["BLACKMAN_HARRIS"] * 4 + ["BOX", "GAUSSIAN"])
    made.cycles.filter_width = chance.choice([1.5, 1.5, 0.7, 3])
    made.render.pixel_aspect_x = chance.choice([1, 1, 1, 1, 2])
