"""Random Blender scenes: objects of all kinds, modifiers, instances, materials in slots of meshes
and objects, lamps, cameras, visibility and collections. Runs inside Blender.

Left out is what docs/limitations.md says is otherwise in Cycles: lights of meshes that shadow rays
do not see, shadow catchers, holdouts that are partly transparent; and the Mirror modifier, whose
doubled faces no warning names where they are partly transparent.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

from tests.support import stage

MODIFIERS: dict[str, dict[str, Any]] = {
    "ARRAY": {"count": 2},
    "BEVEL": {"width": 0.1, "segments": 2},
    "BUILD": {},
    "CAST": {},
    "DECIMATE": {},
    "DISPLACE": {"strength": 0.2},
    "EDGE_SPLIT": {},
    "MASK": {},
    "REMESH": {"mode": "VOXEL", "voxel_size": 0.25},
    "SIMPLE_DEFORM": {"deform_method": "TWIST"},
    "SMOOTH": {},
    "SOLIDIFY": {"thickness": 0.1, "offset": 0.3},
    "SUBSURF": {"levels": 1, "render_levels": 2},
    "TRIANGULATE": {},
    "WEIGHTED_NORMAL": {},
    "WIREFRAME": {"thickness": 0.1},
}
RAYS = ("camera", "diffuse", "glossy", "transmission")


def build(chance: random.Random) -> Any:
    """A scene of its own on an emptied file; returns it."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    made = stage.scene()
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.context.object.data.materials.append(material(chance))
    for _ in range(chance.randint(2, 6)):
        thing(chance)
    for _ in range(chance.randint(1, 3)):
        lamp(chance)
    _world(chance, made)
    _camera(chance)
    if chance.random() < 0.1:
        made.view_layers[0].material_override = material(chance)
    if chance.random() < 0.2:
        _collection(chance, made)
    made.unit_settings.scale_length = chance.choice([1, 1, 0.01])
    return made


def material(chance: random.Random) -> Any:

    made, tree = stage.empty_material("Random")
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    stage.surface(tree, shader)
    shader.inputs["Base Color"].default_value = (*_color(chance), 1)
    shader.inputs["Roughness"].default_value = chance.choice([0.3, 0.5, 1])
    shader.inputs["Metallic"].default_value = chance.choice([0, 0, 0, 1])
    made.use_backface_culling = chance.random() < 0.1
    draw = chance.randrange(6)
    if draw == 0:
        shader.inputs["Emission Strength"].default_value = chance.uniform(0, 2)
    elif draw == 1:
        shader.inputs["Alpha"].default_value = chance.random()
    elif draw == 2:
        source, checks = (
            tree.nodes.new(kind) for kind in ("ShaderNodeTexCoord", "ShaderNodeTexChecker")
        )
        checks.inputs["Scale"].default_value = 4
        tree.links.new(
            source.outputs[chance.choice(["Generated", "Object", "UV", "Camera", "Window"])],
            checks.inputs[0],
        )
        tree.links.new(checks.outputs[0], shader.inputs["Base Color"])
    elif draw == 3:
        info = tree.nodes.new("ShaderNodeObjectInfo")
        output = info.outputs[chance.choice(["Location", "Color", "Random"])]
        tree.links.new(output, shader.inputs["Base Color"])
    return made


def _color(chance: random.Random) -> tuple[float, float, float]:
    return chance.random(), chance.random(), chance.random()


def thing(chance: random.Random) -> None:
    """One object, or what places others."""
    import bpy

    mesh, curve = bpy.ops.mesh, bpy.ops.curve
    kinds: list[Callable[[], Any]] = [
        lambda: mesh.primitive_cube_add(size=1),
        lambda: mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=0.6),
        lambda: mesh.primitive_torus_add(major_radius=0.5, minor_radius=0.2),
        lambda: mesh.primitive_monkey_add(size=1),
        lambda: mesh.primitive_cone_add(vertices=8, radius1=0.5),
        lambda: mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=1.2),
        lambda: bpy.ops.object.text_add(),
        lambda: curve.primitive_bezier_circle_add(radius=0.5),
        lambda: bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=0.5),
        lambda: bpy.ops.object.metaball_add(type="BALL", radius=0.6),
        lambda: _hair(chance),
        lambda: _collection_instance(chance),
        lambda: _on_faces(chance),
    ]
    chance.choice(kinds)()
    ob = bpy.context.object
    ob.location = (chance.uniform(-1.3, 1.3), chance.uniform(-1.3, 1.3), chance.uniform(0.1, 1.6))
    ob.rotation_euler = [chance.uniform(-3, 3) for _ in range(3)]
    ob.scale = [chance.choice([1, 1, 1, -1, 0.5, 1.4]) for _ in range(3)]
    ob.color = (*_color(chance), 1)
    if ob.type == "CURVE":
        ob.data.bevel_depth = chance.choice([0, 0.1])
    if hasattr(ob.data, "materials"):
        _slots(chance, ob)
    if ob.type == "MESH":
        for face in ob.data.polygons:
            face.use_smooth = bool(chance.randrange(2))
        for _ in range(chance.choice([0, 0, 1, 2])):
            _modifier(chance, ob)
    for kind in RAYS:
        if chance.random() < 0.06:
            setattr(ob, f"visible_{kind}", False)
    ob.hide_render, ob.hide_viewport = chance.random() < 0.06, chance.random() < 0.05


def _slots(chance: random.Random, ob: Any) -> None:
    for _ in range(chance.choice([0, 1, 1, 1, 2])):
        ob.data.materials.append(material(chance))
    if len(ob.data.materials) == 2 and ob.type == "MESH":
        for face in ob.data.polygons:
            face.material_index = chance.randrange(2)
    if ob.data.materials and chance.random() < 0.2:
        ob.material_slots[0].link = "OBJECT"
        ob.material_slots[0].material = material(chance) if chance.random() < 0.7 else None


def _modifier(chance: random.Random, ob: Any) -> None:
    kind = chance.choice([*MODIFIERS, "NODES"])
    made = ob.modifiers.new(kind, kind)
    made.show_render, made.show_viewport = chance.random() < 0.85, chance.random() < 0.85
    for name, value in MODIFIERS.get(kind, {}).items():
        setattr(made, name, value)
    if kind == "NODES":
        made.node_group = _geometry(chance)


def _geometry(chance: random.Random) -> Any:
    """Instances on points, or tubes along edges."""
    import bpy

    tree = bpy.data.node_groups.new("Random", "GeometryNodeTree")
    for side in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=side, socket_type="NodeSocketGeometry")

    def add(kind: str, **inputs: Any) -> Any:
        node = tree.nodes.new(kind)
        for name, value in inputs.items():
            node.inputs[name].default_value = value
        return node

    given, out = add("NodeGroupInput"), add("NodeGroupOutput")
    if chance.random() < 0.5:
        small = add("GeometryNodeMeshIcoSphere", Radius=0.2)
        last = add("GeometryNodeInstanceOnPoints")
        tree.links.new(given.outputs[0], last.inputs["Points"])
        tree.links.new(small.outputs[0], last.inputs["Instance"])
    else:
        wires, round_ = (
            add("GeometryNodeMeshToCurve"),
            add("GeometryNodeCurvePrimitiveCircle", Radius=0.05),
        )
        last = add("GeometryNodeCurveToMesh")
        tree.links.new(given.outputs[0], wires.inputs[0])
        tree.links.new(wires.outputs[0], last.inputs["Curve"])
        tree.links.new(round_.outputs[0], last.inputs["Profile Curve"])
    tree.links.new(last.outputs[0], out.inputs[0])
    return tree


def _small(chance: random.Random) -> Any:
    import bpy

    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=1, radius=0.1, location=(5, 5, 5))
    ob = bpy.context.object
    ob.data.materials.append(material(chance))
    return ob


def _hair(chance: random.Random) -> None:
    """Objects in place of hair."""
    import bpy

    small = _small(chance)
    bpy.ops.mesh.primitive_plane_add(size=1)
    ob = bpy.context.object
    ob.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = ob.particle_systems[0].settings
    settings.type, settings.count = "HAIR", 20
    settings.render_type, settings.instance_object = "OBJECT", small
    ob.show_instancer_for_render = chance.random() < 0.7


def _collection_instance(chance: random.Random) -> None:
    import bpy

    small = _small(chance)
    kept = bpy.data.collections.new("Kept")
    small.users_collection[0].objects.unlink(small)
    kept.objects.link(small)
    small.scale, small.location = (4, 4, 4), (0, 0, 0)
    kept.instance_offset = (chance.uniform(-0.3, 0.3), 0, 0)
    bpy.ops.object.collection_instance_add(collection=kept.name)


def _on_faces(chance: random.Random) -> None:
    import bpy

    small = _small(chance)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=2, y_subdivisions=2, size=1)
    ob = bpy.context.object
    small.parent, small.scale = ob, (2, 2, 2)
    ob.instance_type = chance.choice(["VERTS", "FACES"])
    ob.show_instancer_for_render = chance.random() < 0.5
    ob.use_instance_faces_scale = chance.random() < 0.5


def lamp(chance: random.Random) -> None:
    kind = chance.choice(["POINT", "SUN", "SPOT", "AREA"])
    energy = chance.uniform(0.5, 1.5) * (2 if kind == "SUN" else 80)
    place = (chance.uniform(-2, 2), chance.uniform(-3, 0), chance.uniform(2, 4))
    ob = stage.lamp(kind, energy, place)
    ob.rotation_euler = (chance.uniform(0, 1.2), chance.uniform(-0.5, 0.5), 0)
    data = ob.data
    data.color = [chance.uniform(0.4, 1) for _ in range(3)]
    if kind in {"POINT", "SPOT"}:
        data.shadow_soft_size = chance.choice([0, 0.1, 0.4])
    if kind == "SPOT":
        data.spot_size, data.spot_blend = chance.uniform(0.5, 2), chance.random()
    if kind == "AREA":
        data.shape = chance.choice(["SQUARE", "RECTANGLE", "DISK", "ELLIPSE"])
        data.size, data.size_y = chance.uniform(0.2, 1.5), chance.uniform(0.2, 1.5)
        data.spread = chance.choice([math.pi, 1.5])
    if chance.random() < 0.3:
        ob.scale = [chance.uniform(0.5, 2)] * 3
    data.cycles.max_bounces = chance.choice([1024, 1024, 1024, 1])
    for ray in RAYS[1:]:
        if chance.random() < 0.08:
            setattr(ob, f"visible_{ray}", False)
    ob.hide_render = chance.random() < 0.06


def _world(chance: random.Random, made: Any) -> None:
    stage.world(chance.choice([0, 0.3, 1]))
    for ray in RAYS:
        if chance.random() < 0.05:
            setattr(made.world.cycles_visibility, ray, False)


def _camera(chance: random.Random) -> None:
    ob = stage.camera((chance.uniform(-1, 1), -6, 3))
    ob.rotation_euler = (1.15, 0, chance.uniform(-0.1, 0.1))
    data = ob.data
    data.angle, data.shift_x = 0.8, chance.choice([0, 0, 0.1])
    data.sensor_fit = chance.choice(["AUTO", "VERTICAL", "HORIZONTAL"])
    if chance.random() < 0.2:
        data.type, data.ortho_scale = "ORTHO", 5
    if chance.random() < 0.1:
        data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 6, 1
    if chance.random() < 0.15:
        ob.scale = (2, 2, 2)
    if chance.random() < 0.1:
        data.clip_start, data.clip_end = 4.5, 6.5
    render = stage.scene().render
    render.film_transparent = chance.random() < 0.15
    render.pixel_aspect_x = chance.choice([1, 1, 1, 1.5])


def _collection(chance: random.Random, made: Any) -> None:
    """Some objects go into a collection that is not like others in the view layer."""
    import bpy

    kept = bpy.data.collections.new("Apart")
    made.collection.children.link(kept)
    for ob in list(made.collection.objects)[1:3]:
        made.collection.objects.unlink(ob)
        kept.objects.link(ob)
    found = made.view_layers[0].layer_collection.children[kept.name]
    setattr(found, chance.choice(["indirect_only", "exclude", "hide_viewport"]), True)
