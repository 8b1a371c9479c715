"""Builds the scenes of cases.py in Blender's current file. Needs bpy; every function here is a
`build` of the table.

The stage: a floor, a wall behind it, a block and a wedge between them, all flat and Lambertian;
world black.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, radians
from typing import Any

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.cases import Case
from tests.support.paths import ROOT

SCENES = ROOT / "blend_scenes"
HIGH = (0.3, -0.3, 1.9)
_SLANT_SUN = (0.9, -0.5, 2.0)


def build(case: Case) -> bpy.types.Scene:
    """Make the case's scene the current one, at the case's resolution."""
    from tests.reference.caustics import pictures
    from tests.reference.cycles.stages import (
        adaptive_stage,
        catchers_stage,
        displacement_stage,
        film_stage,
        gallery_stage,
        grids_stage,
        media_stage,
        motion_stage,
        passes_stage,
        strands_stage,
        subsurface_stage,
        terminator_stage,
        views_stage,
        visibility_stage,
    )

    builders = (
        globals()
        | vars(visibility_stage)
        | vars(catchers_stage)
        | vars(film_stage)
        | vars(media_stage)
        | vars(passes_stage)
        | vars(grids_stage)
        | vars(displacement_stage)
        | vars(adaptive_stage)
        | vars(terminator_stage)
        | vars(views_stage)
        | vars(motion_stage)
        | vars(strands_stage)
        | vars(subsurface_stage)
        | {"material_case": gallery_stage.material_case, "caustic_view": pictures.open_view}
    )
    builders[case.build](**case.options)
    if case.render_pass:
        passes_stage.switch_on(case.render_pass)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = case.width, case.height
    bpy.context.view_layer.update()
    return scene


def open_scene(name: str) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(SCENES / f"{name}.blend"))
    bpy.context.scene.render.resolution_percentage = 100


def open_file(path: str) -> None:
    bpy.ops.wm.open_mainfile(filepath=path)


# The stage ----------------------------------------------------------------------------------------


def _floor_and_wall() -> None:
    m.add_mesh(
        "Floor",
        [(-1.6, -1.6, 0), (1.6, -1.6, 0), (1.6, 1.5, 0), (-1.6, 1.5, 0)],
        [(0, 1, 2, 3)],
        m.diffuse("Floor", (0.7, 0.62, 0.5)),
    )
    m.add_mesh(
        "Wall",
        [(-1.6, 1.5, 0), (1.6, 1.5, 0), (1.6, 1.5, 2.2), (-1.6, 1.5, 2.2)],
        [(0, 1, 2, 3)],
        m.principled("Wall", (0.5, 0.6, 0.7)),
    )


def _stage(*, things: bool = True) -> None:
    m.new_scene(48, 48)
    _floor_and_wall()
    if things:
        red = m.diffuse("Red", (0.7, 0.2, 0.15))
        m.add_boxes("Block", [((-0.25, -0.25, 0.0), (0.25, 0.25, 0.7))], red, (-0.6, 0.3, 0.0), 0.5)
        corners = [
            (-0.3, -0.3, 0),
            (0.3, -0.3, 0),
            (0.3, 0.3, 0),
            (-0.3, 0.3, 0),
            (-0.3, 0.3, 0.5),
            (0.3, 0.3, 0.5),
        ]
        sides = [(0, 3, 2, 1), (0, 1, 5, 4), (2, 3, 4, 5), (1, 2, 5), (3, 0, 4)]
        m.add_mesh(
            "Wedge",
            corners,
            sides,
            m.diffuse("Green", (0.25, 0.6, 0.3)),
            location=(0.7, -0.2, 0.0),
            turn=-0.3,
        )
    m.set_world((0.0, 0.0, 0.0))
    m.add_camera((0.0, -4.3, 2.7), (0.0, 0.15, 0.55), lens=42.0)


def _lamp(
    kind: str,
    energy: float,
    location: Sequence[float] = HIGH,
    aim: Sequence[float] | None = None,
    scale: Sequence[float] = (1.0, 1.0, 1.0),
    visible_camera: bool = False,
    emission: tuple[Sequence[float], float] | None = None,
    **settings: Any,
) -> bpy.types.Object:
    """A lamp; a sun's `aim` is the direction it comes from. emission: colour and strength of the
    light's Emission node.
    """
    if kind == "SUN" and aim is not None:
        location, aim = aim, (0.0, 0.0, 0.0)
    lamp = m.add_light("Lamp", kind, energy, location, aim, **settings)
    lamp.scale = scale
    lamp.visible_camera = visible_camera
    if emission:
        lamp.data.use_nodes = True
        node = next(node for node in lamp.data.node_tree.nodes if node.type == "EMISSION")
        node.inputs["Color"].default_value = (*emission[0], 1.0)
        node.inputs["Strength"].default_value = emission[1]
    return lamp


def lamp_on_stage(kind: str, energy: float, **options: Any) -> None:
    _stage()
    _lamp(kind, energy, **options)


def shaded_lamp(
    kind: str,
    energy: float,
    tree: dict[str, Any],
    tint: Sequence[float] | None = None,
    **options: Any,
) -> None:
    """A lamp with a node tree, see lamp_trees.py. tint: the object's colour."""
    from tests.reference.cycles.stages import gallery_stage

    _stage()
    lamp = _lamp(kind, energy, **options)
    if tint is not None:
        lamp.color = (*tint, 1.0)
    lamp.data.use_nodes = True
    nodes = lamp.data.node_tree
    nodes.nodes.clear()
    output = nodes.nodes.new("ShaderNodeOutputLight")
    nodes.links.new(gallery_stage.add_nodes(nodes, tree), output.inputs["Surface"])


def many_lamps() -> None:
    """Lamps of very different power, two of them with colours that exclude each other."""
    _stage()
    _lamp("POINT", 20.0, (-0.9, -0.7, 0.8), color=(1.0, 0.1, 0.0), shadow_soft_size=0.05)
    _lamp(
        "SPOT",
        60.0,
        (1.1, -0.8, 1.6),
        (0.2, 0.6, 0.0),
        color=(0.0, 0.2, 1.0),
        spot_size=radians(40.0),
        shadow_soft_size=0.0,
    )
    _lamp("AREA", 10.0, (0.0, 0.9, 1.8), size=0.5)
    _lamp("SUN", 0.5, aim=(-0.4, -0.8, 1.0), angle=0.02)
    for k in range(8):
        _lamp("POINT", 0.15, (-1.4 + 0.4 * k, -1.2, 0.1), shadow_soft_size=0.02)


def instanced_lamp() -> None:
    """Collection instances of a collection that holds a lamp and the plate above it."""
    _stage()
    group = bpy.data.collections.new("Fixture")
    lamp = _lamp("SPOT", 40.0, (0.0, 0.0, 0.0), spot_size=radians(80.0), shadow_soft_size=0.05)
    plate = m.add_boxes(
        "Plate", [((-0.15, -0.15, 0.08), (0.15, 0.15, 0.12))], m.diffuse("Plate", (0.5, 0.5, 0.5))
    )
    for thing in (lamp, plate):
        bpy.context.scene.collection.objects.unlink(thing)
        group.objects.link(thing)
    for place, tilt in (((-0.8, -0.3, 1.5), 0.3), ((0.7, 0.2, 1.2), -0.2)):
        stand = m.add_object("Fixture", None)
        stand.instance_type, stand.instance_collection = "COLLECTION", group
        stand.matrix_world = Matrix.LocRotScale(
            Vector(place), Euler((tilt, 0.0, 0.5)), Vector((1.0, 1.0, 1.0))
        )


def far_thing(kind: str, light: str = "lamp", distance: float = 1e6) -> None:
    """The stage with something far away that hardly matters: a box, a ground, a loose vertex, a
    dark dome, or a shining one.
    """
    _stage()
    if light == "lamp":
        _lamp("POINT", 30.0, shadow_soft_size=0.1)
        _lamp("AREA", 10.0, (-0.5, -0.9, 1.6), (0.0, 0.0, 0.3), size=0.4)
    elif light == "sun":
        _lamp("SUN", 2.0, aim=_SLANT_SUN, angle=radians(4.0))
    elif light == "world":
        m.set_world((0.8, 0.9, 1.0), 1.0)
    d = distance
    bpy.context.scene.camera.data.clip_end = 100 * d
    grey = m.diffuse("Far", (0.5, 0.5, 0.5))
    if kind == "box":
        m.add_boxes("Far", [((d, d, 0.0), (d + 5.0, d + 5.0, 5.0))], grey)
    elif kind == "ground":
        m.add_mesh(
            "Far",
            [(-d, -d, -0.5), (d, -d, -0.5), (d, d, -0.5), (-d, d, -0.5)],
            [(0, 1, 2, 3)],
            grey,
        )
    elif kind == "vertex":
        m.add_mesh(
            "Far",
            [(0.0, 0.0, 0.1), (0.1, 0.0, 0.1), (0.0, 0.1, 0.1), (d, -d, d)],
            [(0, 1, 2)],
            grey,
            location=(0.9, -0.9, 0.0),
        )
    elif kind in ("dome", "bright_dome"):
        bright = kind == "bright_dome"
        bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=d)
        bpy.context.object.data.materials.append(
            m.emission("Dome", (0.8, 0.9, 1.0), 1.0)
            if bright
            else m.diffuse("Dome", (0.0, 0.0, 0.0))
        )
    elif kind:
        raise ValueError(f"no far thing is called {kind!r}")


def lamp_in_plane(offset: float = 0.0, kind: str = "lamp", behind: float = 0.0) -> None:
    """A closed room with a lamp `offset` m below its ceiling, and if wanted another one `behind` m
    above that, which lights nothing.

    kind: lamp, an area lamp; quad, an emissive mesh; both, a lamp on its own emissive mesh;
    quad_front, one that shines downwards only.
    """
    m.new_scene(48, 48)
    walls = m.diffuse("Walls", (0.7, 0.65, 0.6))
    m.add_mesh("Room", *m.box_data((-1.5, -1.5, 0.0), (1.5, 1.5, 2.5)), walls)
    m.add_boxes("Block", [((-0.4, -0.2, 0.0), (0.3, 0.5, 0.8))], m.diffuse("Red", (0.7, 0.2, 0.15)))
    m.set_world((0.0, 0.0, 0.0))
    z, h = 2.5 - offset, 0.35
    if kind in ("lamp", "both"):
        _lamp("AREA", 30.0, (0.2, -0.1, z), shape="SQUARE", size=2 * h)
    if behind:
        _lamp("AREA", 60.0, (-0.8, 0.3, 2.5 + behind), shape="SQUARE", size=h)
    if kind in ("quad", "both", "quad_front"):
        corners = [
            (0.2 - h, -0.1 - h, z),
            (0.2 + h, -0.1 - h, z),
            (0.2 + h, -0.1 + h, z),
            (0.2 - h, -0.1 + h, z),
        ]
        shine = (m.front_emission if kind == "quad_front" else m.emission)(
            "Shine", (1.0, 0.9, 0.8), 12.0
        )
        m.add_mesh("Quad", corners, [(3, 2, 1, 0)], shine)
    m.add_camera((0.0, -1.4, 1.3), (0.0, 0.3, 1.3), lens=22.0)


def twice(second: Sequence[float] = (0.2, 0.3, 0.7)) -> None:
    """Stage whose block and floor are there twice, in other colours."""
    _stage()
    _lamp("AREA", 30.0, size=0.5)
    blue = m.diffuse("Blue", second)
    for name in ("Block", "Floor"):
        thing = bpy.data.objects[name]
        copy = m.add_object(name + " again", thing.data.copy())
        copy.matrix_world = thing.matrix_world
        copy.location, copy.rotation_euler = thing.location, thing.rotation_euler
        copy.data.materials.clear()
        copy.data.materials.append(blue)


def clear_glass(
    ior: float = 1.0,
    roughness: float = 0.0,
    kind: str = "pane",
    node: str = "glass",
    color: Sequence[float] = (0.9, 0.95, 1.0),
) -> None:
    """Glass that bends light little or not at all: a pane or a sphere before the lamp, or a room
    seen through one.
    """
    _stage()
    glass = bpy.data.materials.new("Glass")
    glass.use_nodes = True
    nodes = glass.node_tree
    principled = next(n for n in nodes.nodes if n.type == "BSDF_PRINCIPLED")
    if node == "principled":
        principled.inputs["Base Color"].default_value = (*color, 1.0)
        principled.inputs["Transmission Weight"].default_value = 1.0
        principled.inputs["Roughness"].default_value = roughness
        principled.inputs["IOR"].default_value = ior
        principled.inputs["Specular IOR Level"].default_value = 0.0 if ior == 1.45 else 0.5
    else:
        bsdf = nodes.nodes.new(
            "ShaderNodeBsdfGlass" if node == "glass" else "ShaderNodeBsdfRefraction"
        )
        bsdf.inputs["Color"].default_value = (*color, 1.0)
        bsdf.inputs["Roughness"].default_value = roughness
        bsdf.inputs["IOR"].default_value = ior
        output = next(n for n in nodes.nodes if n.type == "OUTPUT_MATERIAL")
        nodes.links.new(bsdf.outputs[0], output.inputs["Surface"])
    _lamp("POINT", 30.0, (0.2, -0.4, 1.7), shadow_soft_size=0.35, use_soft_falloff=False)
    if kind == "pane":
        m.add_mesh(
            "Pane",
            [(-1.5, -1.0, 1.0), (1.5, -1.0, 1.0), (1.5, 1.0, 1.1), (-1.5, 1.0, 1.1)],
            [(0, 1, 2, 3)],
            glass,
        )
    elif kind == "sphere":
        m.add_sphere("Ball", 0.5, glass, (0.1, -0.6, 0.7))
    elif kind == "room":
        m.add_boxes("Hull", [((-1.5, -1.4, -0.1), (1.5, 1.4, 2.1))], glass)


def lamp_in_ball() -> None:
    """A lamp that faces its receiver, more than half of it within an opaque ball, over a glossy
    floor that finds it by reflected rays as well: the ball hides what of the disc lies in it.
    """
    _stage()
    gloss = m.principled("Gloss")
    principled = next(n for n in gloss.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    principled.inputs["Metallic"].default_value = 1.0
    principled.inputs["Roughness"].default_value = 0.2
    m.add_mesh(
        "Sheet",
        [(-1.5, -1.5, 0.02), (1.5, -1.5, 0.02), (1.5, 1.5, 0.02), (-1.5, 1.5, 0.02)],
        [(0, 1, 2, 3)],
        gloss,
    )
    m.add_sphere("Cover", 0.4, m.diffuse("Cover", (0.7, 0.7, 0.7)), (0.0, 0.0, 0.6), 64)
    _lamp("POINT", 40.0, (0.05, -0.17, 0.5), shadow_soft_size=0.33)


def linked_lamps() -> None:
    """Light linking: lamps for some things only or for all but some, a shining plate too; a mirror
    that sees what it is linked to.
    """
    _stage()
    mirror = m.add_sphere(
        "Mirror", 0.28, m.polished_metal("Mirror", (0.9, 0.9, 0.9)), (0.1, -0.7, 0.28), 64
    )
    things = bpy.data.objects
    warm = _lamp("AREA", 30.0, (0.3, -0.9, 1.7), (0.0, 0.0, 0.0), size=0.6, color=(1.0, 0.6, 0.3))
    _link(warm, "receiver_collection", include=[things["Block"], things["Floor"], mirror])
    blue = _lamp("POINT", 30.0, (0.9, 0.2, 1.5), color=(0.3, 0.5, 1.0), shadow_soft_size=0.05)
    _link(blue, "receiver_collection", exclude=[things["Wedge"], things["Wall"]])
    sun = _lamp("SUN", 0.4, aim=(-0.3, -0.6, 1.0), angle=0.1, color=(0.4, 1.0, 0.4))
    _link(sun, "receiver_collection", include=[things["Wedge"]], exclude=[things["Floor"]])
    corners = [(-1.0, 1.3, 1.2), (-0.4, 1.3, 1.2), (-0.4, 1.3, 1.8), (-1.0, 1.3, 1.8)]
    plate = m.add_mesh("Plate", corners, [(0, 1, 2, 3)], m.emission("Glow", (1.0, 0.9, 0.8), 4.0))
    _link(plate, "receiver_collection", exclude=[mirror, things["Wall"]])


def linked_shadows() -> None:
    """Shadow linking: what does not block a light's way is lit and lets it pass: lamps, a shining
    plate behind glass, in a mirror.
    """
    _stage()
    things = bpy.data.objects
    mirror = m.add_sphere(
        "Mirror", 0.28, m.polished_metal("Mirror", (0.9, 0.9, 0.9)), (0.1, -0.7, 0.28), 64
    )
    glass = m.add_sphere("Glass", 0.25, m.glass("Glass", 1.45), (-0.9, -0.4, 0.25), 64)
    warm = _lamp("AREA", 30.0, (0.3, -0.9, 1.7), (0.0, 0.0, 0.0), size=0.6, color=(1.0, 0.6, 0.3))
    _link(warm, "blocker_collection", exclude=[things["Block"], glass])
    blue = _lamp("POINT", 20.0, (0.9, 0.2, 1.5), color=(0.3, 0.5, 1.0), shadow_soft_size=0.15)
    _link(blue, "blocker_collection", include=[things["Block"]])
    sun = _lamp("SUN", 0.4, aim=(-0.3, -0.6, 1.0), angle=0.1, color=(0.4, 1.0, 0.4))
    _link(sun, "blocker_collection", include=[things["Wedge"], mirror])
    _link(sun, "receiver_collection", exclude=[things["Wall"]])
    corners = [(-1.0, -0.2, 0.9), (-0.4, -0.2, 0.9), (-0.4, 0.3, 1.3), (-1.0, 0.3, 1.3)]
    _link(
        m.add_mesh("Plate", corners, [(0, 1, 2, 3)], m.emission("Glow", (1.0, 0.9, 0.8), 4.0)),
        "blocker_collection",
        exclude=[mirror],
    )


def light_groups() -> None:
    """Lamps of a group, one of them linked; a shining plate and the world, each of a group; a lamp
    of none; caustics of a glass ball.
    """
    _stage()
    groups = bpy.context.view_layer.lightgroups
    for name in ("key", "glow", "sky"):
        groups.add().name = name
    m.set_world((0.10, 0.13, 0.2))
    bpy.context.scene.world.lightgroup = "sky"
    m.add_sphere("Glass", 0.3, m.glass("Glass", 1.45), (-0.2, -0.7, 0.35), 64)
    _lamp(
        "AREA", 30.0, (0.3, -0.9, 1.7), (0.0, 0.0, 0.0), size=0.6, color=(1.0, 0.6, 0.3)
    ).lightgroup = "key"
    linked = _lamp("POINT", 15.0, (0.9, 0.2, 1.5), color=(0.3, 0.5, 1.0), shadow_soft_size=0.15)
    _link(linked, "blocker_collection", exclude=[bpy.data.objects["Wedge"]])
    linked.lightgroup = "key"
    _lamp(
        "SUN", 0.4, aim=(-0.3, -0.6, 1.0), angle=0.1, color=(0.4, 1.0, 0.4)
    ).lightgroup = "none that the view layer has"
    corners = [(-1.0, -0.2, 0.9), (-0.4, -0.2, 0.9), (-0.4, 0.3, 1.3), (-1.0, 0.3, 1.3)]
    m.add_mesh(
        "Plate", corners, [(0, 1, 2, 3)], m.emission("Glow", (1.0, 0.9, 0.8), 4.0)
    ).lightgroup = "glow"


def _link(
    light: bpy.types.Object,
    role: str,
    include: Sequence[bpy.types.Object] = (),
    exclude: Sequence[bpy.types.Object] = (),
) -> None:
    linked = bpy.data.collections.new(f"{role} of {light.name}")
    for thing in (*include, *exclude):
        linked.objects.link(thing)
    for link, thing in zip(linked.collection_objects, linked.objects, strict=True):
        link.light_linking.link_state = "EXCLUDE" if thing in exclude else "INCLUDE"
    setattr(light.light_linking, role, linked)


# World and emissive meshes ------------------------------------------------------------------------


def world(color: Sequence[float], strength: float) -> None:
    _stage()
    m.set_world(color, strength)


def emissive_mesh() -> None:
    """A sheet that shines on both sides, and a globe."""
    _stage()
    sheet = [(-0.4, -0.2, 0.0), (0.4, -0.2, 0.0), (0.4, 0.2, 0.0), (-0.4, 0.2, 0.0)]
    m.add_mesh(
        "Sheet",
        sheet,
        [(0, 1, 2, 3)],
        m.emission("Sheet", (1.0, 0.8, 0.6), 6.0),
        location=(0.2, 0.5, 1.4),
    )
    globe = m.add_sphere(
        "Globe", 0.12, m.principled("Globe", (0.4, 0.4, 0.4)), (0.1, -0.8, 0.3), 16
    )
    node = globe.data.materials[0].node_tree.nodes["Principled BSDF"]
    node.inputs["Emission Color"].default_value = (0.3, 0.6, 1.0, 1.0)
    node.inputs["Emission Strength"].default_value = 4.0
    globe.data.polygons.foreach_set("use_smooth", [False] * len(globe.data.polygons))


def emissive_front_only() -> None:
    _stage()
    sheet = [(-0.4, -0.2, 0.0), (-0.4, 0.2, 0.0), (0.4, 0.2, 0.0), (0.4, -0.2, 0.0)]
    m.add_mesh(
        "Sheet",
        sheet,
        [(0, 1, 2, 3)],
        m.front_emission("Sheet", (1.0, 0.8, 0.6), 8.0),
        location=(0.2, 0.5, 1.2),
    )


def emissive_texture() -> None:
    _stage()
    image = m.packed_image("signs", _test_pixels())
    material, tree, output = m._node_material("Screen")
    node, texture = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    node.inputs["Strength"].default_value = 5.0
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    m.add_picture(
        "Screen", [(-0.9, 0.9, 0.6), (0.7, 0.9, 0.6), (0.7, 0.6, 1.5), (-0.9, 0.6, 1.5)], material
    )


def _background() -> tuple[bpy.types.NodeTree, bpy.types.Node]:
    """The tree of the world and its Background node, nothing but this and the output in it."""
    m.set_world((0.0, 0.0, 0.0))
    shown = bpy.context.scene.world
    shown.use_nodes = True
    return shown.node_tree, next(
        node for node in shown.node_tree.nodes if node.type == "BACKGROUND"
    )


def _sky_pixels(spot: float) -> np.ndarray:
    """A gradient with a dark band and a bright spot of 2x2 texels, (32, 64, 4), not symmetric in
    any way.
    """
    row, column = np.mgrid[:32, :64]
    pixels = np.ones((32, 64, 4), np.float32)
    pixels[..., 0], pixels[..., 1] = 0.2 + 0.6 * row / 32, 0.1 + 0.5 * (column / 64)
    pixels[..., 2] = 0.9 - 0.5 * row / 32
    pixels[14:17, :, :3] *= 0.1
    pixels[24:26, 10:12, :3] = spot * np.array((1.0, 0.8, 0.5), np.float32)
    return pixels


def environment(
    spot: float = 60.0,
    rotation: Sequence[float] | None = None,
    mapping: str = "POINT",
    scale: Sequence[float] = (1.0, 1.0, 1.0),
    location: Sequence[float] = (0.0, 0.0, 0.0),
    projection: str = "EQUIRECTANGULAR",
    strength: float = 0.7,
    coordinates: str = "Generated",
    lamp: bool = False,
) -> None:
    _stage()
    tree, background = _background()
    image = bpy.data.images.new("sky", 64, 32, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(_sky_pixels(spot).ravel())
    image.update()
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image, texture.projection = image, projection
    background.inputs["Strength"].default_value = strength
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    if rotation is not None:
        turn, place = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
        turn.vector_type = mapping
        turn.inputs["Rotation"].default_value = rotation
        turn.inputs["Scale"].default_value = scale
        if mapping in {"POINT", "TEXTURE"}:
            turn.inputs["Location"].default_value = location
        tree.links.new(place.outputs[coordinates], turn.inputs["Vector"])
        tree.links.new(turn.outputs["Vector"], texture.inputs["Vector"])
    if lamp:
        _lamp("AREA", 20.0, HIGH, size=0.6)


def world_by_ray(output: str, above: float | None = None, lamp: bool = False) -> None:
    """Rays that a Light Path node's output is 1 for, or more than `above`, see a blue world, all
    others an uneven warm one; balls of metal and glass.
    """
    _stage()
    m.add_sphere("Mirror", 0.28, m.polished_metal("Mirror", (0.9, 0.9, 0.9)), (-0.1, -0.9, 0.3), 24)
    m.add_sphere("Glass", 0.25, m.glass("Glass", 1.45), (0.75, -1.0, 0.27), 24)
    lacquer = m.principled("Lacquer", (0.5, 0.1, 0.1))
    lacquer.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.25
    m.add_sphere("Lacquer", 0.25, lacquer, (-0.75, -1.0, 0.27), 24)
    tree, blue = _background()
    warm, mix, path, gradient = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("Background", "MixShader", "LightPath", "TexGradient")
    )
    gradient.gradient_type = "EASING"
    blue.inputs["Color"].default_value = (0.1, 0.3, 1.0, 1.0)
    warm.inputs["Color"].default_value = (1.0, 0.6, 0.3, 1.0)
    tree.links.new(
        gradient.outputs["Factor" if "Factor" in gradient.outputs else "Fac"],
        warm.inputs["Strength"],
    )
    ending = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    which = path.outputs[output]
    if above is not None:
        compare = tree.nodes.new("ShaderNodeMath")
        compare.operation = "GREATER_THAN"
        compare.inputs[1].default_value = above
        tree.links.new(which, compare.inputs[0])
        which = compare.outputs[0]
    tree.links.new(which, mix.inputs[0])
    tree.links.new(warm.outputs[0], mix.inputs[1])
    tree.links.new(blue.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], ending.inputs["Surface"])
    _look((0.0, -4.3, 1.6), (0.0, 0.15, 0.9))
    if lamp:
        place, aim = (-0.4, -0.5, 1.9), (0.0, 0.2, 0.0)
        _lamp("AREA", 40.0, place, aim, shape="RECTANGLE", size=1.2, size_y=1.2)


def volume_without_surface() -> None:
    """A box around things and lamp, of a volume that is as good as empty and of no surface."""
    _stage()
    m.set_world((0.2, 0.3, 0.5))
    _lamp("AREA", 20.0, HIGH, size=0.6)
    air = bpy.data.materials.new("Air")
    air.use_nodes = True
    tree = air.node_tree
    tree.nodes.clear()
    ending, volume = (
        tree.nodes.new("ShaderNodeOutputMaterial"),
        tree.nodes.new("ShaderNodeVolumeAbsorption"),
    )
    volume.inputs["Density"].default_value = 1e-6
    tree.links.new(volume.outputs[0], ending.inputs["Volume"])
    m.add_boxes("Air", [((-1.1, -1.1, 0.05), (1.1, 0.9, 1.5))], air)


def outputs_for_both() -> None:
    """An output for each renderer, in a material, the world and a lamp."""
    _stage()
    _lamp("AREA", 20.0, HIGH, size=0.6)
    lamp = next(thing for thing in bpy.context.scene.objects if thing.type == "LIGHT").data
    lamp.use_nodes = True
    red = bpy.data.materials["Red"]
    world, _ = _background()
    for tree, output, shader, color in (
        (red.node_tree, "ShaderNodeOutputMaterial", "ShaderNodeBsdfDiffuse", (0.1, 0.2, 0.8, 1.0)),
        (world, "ShaderNodeOutputWorld", "ShaderNodeBackground", (0.1, 0.3, 0.1, 1.0)),
        (lamp.node_tree, "ShaderNodeOutputLight", "ShaderNodeEmission", (1.0, 0.5, 0.3, 1.0)),
    ):
        theirs = next(node for node in tree.nodes if node.bl_idname == output)
        theirs.target = "EEVEE"
        ours, node = tree.nodes.new(output), tree.nodes.new(shader)
        ours.target = "CYCLES"
        node.inputs["Color"].default_value = color
        tree.links.new(node.outputs[0], ours.inputs["Surface"])
        theirs.is_active_output = True


def sky(kind: str, strength: float = 0.1, seen: float = 0.0, **settings: Any) -> None:
    """seen: height that the camera looks at, so that the sky is in the picture. Names are those of
    Blender 5.
    """
    _stage()
    tree, background = _background()
    texture = tree.nodes.new("ShaderNodeTexSky")
    texture.sky_type = kind
    for name, value in settings.items():
        setattr(texture, name, value)
    background.inputs["Strength"].default_value = strength
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    if seen:
        _look((0.0, -4.3, 0.9), (0.0, 0.15, seen))
        bpy.context.scene.camera.data.lens = 24.0


# Surfaces -----------------------------------------------------------------------------------------


def smooth_sphere() -> None:
    """Few faces, smooth normals: shading and geometric normals differ by up to 15 degrees."""
    _stage(things=False)
    m.add_sphere("Ball", 0.6, m.diffuse("Ball", (0.7, 0.5, 0.3)), (0.0, 0.1, 0.62), 12)
    _lamp("AREA", 40.0, (-1.0, -1.0, 2.0), (0.0, 0.1, 0.6), size=0.8)


def _test_pixels() -> np.ndarray:
    """Coloured fields with a dark cross, (16, 24, 3), not symmetric in any way."""
    row, column = np.mgrid[:16, :24]
    pixels = np.stack(
        [(column + 2) / 26, (row + 1) / 17, ((row // 4 + column // 4) % 2) * 0.8 + 0.1], -1
    )
    pixels[6:8, :] *= 0.3
    pixels[:, 5] *= 0.2
    return pixels.astype(np.float32)


def textured_plane(interpolation: str, extension: str, float_pixels: bool = False) -> None:
    """The wall shows an image one and a half times across, shifted; `float_pixels`: a linear float
    image above 1 in places.
    """
    _stage()
    if float_pixels:
        pixels = _test_pixels()
        image = bpy.data.images.new("float", pixels.shape[1], pixels.shape[0], float_buffer=True)
        image.colorspace_settings.name = "Non-Color"
        rgba = np.ones((*pixels.shape[:2], 4), np.float32)
        rgba[..., :3] = pixels * 0.9
        image.pixels.foreach_set(rgba.ravel())
        image.update()
    else:
        image = m.packed_image("signs", _test_pixels())
    material = m.principled("Painted", image=image)
    texture = next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE")
    texture.interpolation, texture.extension = interpolation, extension
    wall = bpy.data.objects["Wall"]
    wall.data.materials[0] = material
    wall.data.uv_layers.new(name="UVMap").data.foreach_set(
        "uv", [-0.25, -0.3, 1.25, -0.3, 1.25, 1.2, -0.25, 1.2]
    )
    _lamp("AREA", 30.0, (0.0, -1.0, 1.9), (0.0, 0.6, 0.6), size=0.8)


def mirrored_object() -> None:
    """One smooth mesh twice, the second mirrored by a negative scale; a flat one with negative
    scale on all axes.
    """
    _stage(things=False)
    profile = [
        (0.0, 0.0),
        (0.32, 0.0),
        (0.35, 0.1),
        (0.2, 0.35),
        (0.12, 0.6),
        (0.2, 0.8),
        (0.0, 0.85),
    ]
    vase = m.add_lathe("Vase", profile, m.diffuse("Vase", (0.6, 0.5, 0.7)), (-0.7, 0.4, 0.0), 48)
    twin = m.add_object("Twin", vase.data, (0.2, 0.5, 0.0), 0.4)
    twin.scale = (-1.0, 0.7, 1.2)
    block = m.add_boxes(
        "Block",
        [((-0.2, -0.2, -0.6), (0.2, 0.2, 0.0))],
        m.diffuse("Block", (0.3, 0.6, 0.6)),
        (0.9, -0.3, 0.0),
        0.7,
    )
    block.scale = (-1.0, -1.0, -1.0)
    _lamp("AREA", 40.0, (-1.0, -1.0, 2.0), (0.0, 0.1, 0.4), size=0.6)


def several_materials() -> None:
    """A material per face, an object-level material, an empty slot, and one mesh under two sets of
    materials.
    """
    _stage(things=False)
    colors = (
        (0.8, 0.1, 0.1),
        (0.1, 0.7, 0.1),
        (0.1, 0.2, 0.8),
        (0.8, 0.7, 0.1),
        (0.7, 0.2, 0.7),
        (0.2, 0.7, 0.7),
    )
    materials = [m.diffuse(f"Side {k}", color) for k, color in enumerate(colors)]
    corners, faces = m.box_data((-0.3, -0.3, 0.0), (0.3, 0.3, 0.6))
    dice = m.add_mesh(
        "Dice", corners, faces, materials, range(6), location=(-0.7, 0.2, 0.0), turn=0.6
    )
    twin = m.add_object("Twin", dice.data, (0.6, 0.3, 0.0), -0.5)
    for slot, color in ((1, (0.9, 0.9, 0.9)), (2, (0.05, 0.05, 0.05))):
        twin.material_slots[slot].link = "OBJECT"
        twin.material_slots[slot].material = m.diffuse("Own", color)
    bare = m.add_boxes(
        "Bare", [((-0.2, -0.2, 0.0), (0.2, 0.2, 0.3))], materials[0], (0.1, -0.7, 0.0), 0.2
    )
    bare.data.materials.clear()
    _lamp("AREA", 30.0, HIGH, size=0.6)


def curve_and_text() -> None:
    _stage(things=False)
    path = bpy.data.curves.new("Ring", "CURVE")
    path.dimensions, path.bevel_depth, path.bevel_resolution, path.resolution_u = "3D", 0.12, 5, 12
    spline = path.splines.new("BEZIER")
    spline.bezier_points.add(3)
    spline.use_cyclic_u = True
    for k, point in enumerate(spline.bezier_points):
        angle = k * pi / 2
        point.co = (0.5 * np.cos(angle), 0.5 * np.sin(angle), 0.15)
        point.handle_left_type = point.handle_right_type = "AUTO"
    path.materials.append(m.diffuse("Ring", (0.7, 0.4, 0.2)))
    m.add_object("Ring", path, (-0.6, 0.0, 0.0))
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.size, text.extrude = "PS", 0.9, 0.08
    text.materials.append(m.diffuse("Text", (0.2, 0.4, 0.7)))
    m.add_object("Text", text, (0.15, 0.1, 0.1)).rotation_euler = (radians(80.0), 0.0, 0.0)
    _lamp("AREA", 30.0, HIGH, size=0.6)


# Camera and frame ---------------------------------------------------------------------------------


def camera_variant(
    kind: str = "PERSP",
    shift: tuple[float, float] = (0.0, 0.0),
    sensor_fit: str = "AUTO",
    aspect: tuple[float, float] = (1.0, 1.0),
    scale: Sequence[float] = (1.0, 1.0, 1.0),
    clip: tuple[float, float] = (0.1, 100.0),
    border: tuple[float, float, float, float] | None = None,
    crop: bool = False,
    percentage: int = 100,
    transparent: bool = False,
    filter_width: float = 1.5,
) -> None:
    """border: min x, max x, min y, max y as fractions of the frame."""
    _stage()
    _lamp("AREA", 40.0, HIGH, size=0.6)
    scene, camera = bpy.context.scene, bpy.context.scene.camera
    data, render = camera.data, scene.render
    data.type, data.ortho_scale, data.sensor_fit = kind, 3.2, sensor_fit
    data.shift_x, data.shift_y = shift
    data.clip_start, data.clip_end = clip
    camera.scale = scale
    render.pixel_aspect_x, render.pixel_aspect_y = aspect
    render.resolution_percentage = percentage
    render.film_transparent = transparent
    if transparent or clip[1] < 100.0:
        m.set_world((0.1, 0.2, 0.4), 0.5)
    if border:
        render.use_border, render.use_crop_to_border = True, crop
        render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = border
    bpy.context.scene.cycles.filter_width = filter_width


def _look(location: Sequence[float], aim: Sequence[float]) -> None:
    camera = bpy.context.scene.camera
    camera.location = location
    camera.rotation_euler = (Vector(aim) - Vector(location)).to_track_quat("-Z", "Y").to_euler()


def depth_of_field(
    kind: str = "PERSP",
    fstop: float = 0.1,
    blades: int = 0,
    rotation: float = 0.0,
    ratio: float = 1.0,
    distance: float = 3.6,
    target: Sequence[float] | None = None,
    clip_start: float = 0.1,
    clip_end: float = 1000.0,
) -> None:
    """A near globe that shines and the stage behind it, in and out of focus. target: where an
    object in focus stands.
    """
    _stage()
    _lamp("AREA", 40.0, HIGH, size=0.6)
    m.add_sphere("Spark", 0.05, m.emission("Spark", (1.0, 0.8, 0.5), 20.0), (0.45, -1.6, 0.75), 16)
    data = bpy.context.scene.camera.data
    data.type, data.ortho_scale = kind, 3.2
    data.clip_start, data.clip_end = clip_start, clip_end
    data.dof.use_dof = True
    data.dof.aperture_fstop, data.dof.aperture_blades = fstop, blades
    data.dof.aperture_rotation, data.dof.aperture_ratio = rotation, ratio
    data.dof.focus_distance = distance
    if target is not None:
        data.dof.focus_object = m.add_object("Target", None, target)


def panorama(
    kind: str,
    shift: tuple[float, float] = (0.0, 0.0),
    aspect: tuple[float, float] = (1.0, 1.0),
    dof: dict[str, Any] | None = None,
    scale: Sequence[float] = (1.0, 1.0, 1.0),
    **settings: Any,
) -> None:
    """From among the things of the stage, tilted; a world lights what the lamp does not."""
    _stage()
    _lamp("AREA", 40.0, HIGH, size=0.6)
    m.set_world((0.2, 0.4, 0.9), 0.5)
    _look((0.1, -1.1, 0.8), (-0.1, 0.3, 0.5))
    scene = bpy.context.scene
    scene.camera.scale = scale
    scene.render.film_transparent = True
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = aspect
    data = scene.camera.data
    data.type, data.panorama_type = "PANO", kind
    data.shift_x, data.shift_y = shift
    for name, value in settings.items():
        setattr(data, name, value)
    if dof:
        data.dof.use_dof = True
        for name, value in dof.items():
            setattr(data.dof, name, value)
