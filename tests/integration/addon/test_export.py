"""Blender's data as the engine sees it: geometry, instances, visibility."""

from __future__ import annotations

import numpy as np
import pytest
from photon_splat.core.scene import ALL_GROUPS, ALL_RAYS, Ray, Scene

from tests.support import stage
from tests.support.blender import in_blender


@pytest.mark.smoke
@in_blender
def test_modifiers_at_the_level_of_a_render() -> None:
    ob = stage.plane()
    subdivision = ob.modifiers.new("Subdivision", "SUBSURF")
    subdivision.subdivision_type, subdivision.levels, subdivision.render_levels = "SIMPLE", 0, 2
    off = ob.modifiers.new("Array", "ARRAY")
    off.show_render = False
    assert stage.triangle_count(stage.exported()) == 2 * 4**2


@pytest.mark.smoke
@in_blender
def test_curves_text_surfaces_and_metaballs_become_meshes() -> None:
    import bpy

    curve = bpy.data.curves.new("Wire", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.1
    curve.splines.new("POLY").points.add(2)
    for k, point in enumerate(curve.splines[0].points):
        point.co = (k, 0, 0, 1)
    text = bpy.data.curves.new("Text", "FONT")
    text.body = "ab"
    metaball = bpy.data.metaballs.new("Meta")
    metaball.elements.new()
    made = {
        name: stage.add(name, data)
        for name, data in (("Wire", curve), ("Text", text), ("Meta", metaball))
    }
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    whole = stage.exported()
    assert len(whole.instances.mesh) == 4
    assert not [warning for warning in whole.warnings if "supported" in warning]
    for ob in made.values():
        before = stage.triangle_count(stage.exported())
        ob.hide_render = True
        assert stage.triangle_count(stage.exported()) < before - 10, ob.name


@in_blender
def test_an_object_without_faces_is_nothing() -> None:
    import bpy

    stage.add("Edges", stage.mesh("Edges", [(0, 0, 0), (1, 0, 0)], []))
    stage.add("Nothing", bpy.data.meshes.new("Nothing"))
    bare = bpy.data.curves.new("Bare", "CURVE")
    bare.splines.new("POLY").points.add(2)
    stage.add("Bare", bare)
    stage.add("Empty")
    what = stage.exported()
    assert what.meshes == []
    assert len(what.instances.mesh) == 0
    assert what.warnings == []


@pytest.mark.smoke
@in_blender
def test_geometry_nodes_instances_share_one_mesh() -> None:
    import bpy

    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    given, made = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    scatter, cube = (
        tree.nodes.new("GeometryNodeInstanceOnPoints"),
        tree.nodes.new("GeometryNodeMeshCube"),
    )
    tree.links.new(given.outputs[0], scatter.inputs["Points"])
    tree.links.new(cube.outputs["Mesh"], scatter.inputs["Instance"])
    tree.links.new(scatter.outputs["Instances"], made.inputs[0])
    ob = stage.plane()
    ob.modifiers.new("Scatter", "NODES").node_group = tree
    what = stage.exported()
    assert len(what.instances.mesh) == 4
    assert len(what.meshes) == 1
    assert stage.triangle_count(what) == 4 * 12
    assert sorted(tuple(m[:2, 3]) for m in what.instances.matrix) == [
        (-1, -1),
        (-1, 1),
        (1, -1),
        (1, 1),
    ]


@pytest.mark.smoke
@in_blender
def test_collection_instances_and_linked_meshes_share_one_mesh() -> None:
    import bpy

    parts = bpy.data.collections.new("Parts")
    stage.plane("Part", location=(0, 0, 1), collection=parts)
    data = bpy.data.objects["Part"].data
    for k in range(3):
        empty = stage.add(f"Empty {k}", location=(k, 0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", parts
    for k in range(2):
        stage.add(f"Twin {k}", data, (0, k + 5, 0))
    what = stage.exported()
    assert len(what.meshes) == 1
    places = sorted(tuple(m[:3, 3]) for m in what.instances.matrix)
    assert places == [(0, 0, 1), (0, 5, 0), (0, 6, 0), (1, 0, 1), (2, 0, 1)]
    # warnings name objects, not the mesh that they share
    assert sorted(what.instances.owners) == ["Part", "Part", "Part", "Twin 0", "Twin 1"]


@in_blender
def test_twins_with_a_modifier_on_one() -> None:
    data = stage.plane("One").data
    two = stage.add("Two", data, (3, 0, 0))
    two.modifiers.new("Solid", "SOLIDIFY")
    what = stage.exported()
    assert sorted(len(what.meshes[m].triangles) for m in what.instances.mesh) == [2, 12]


@in_blender
def test_smooth_flat_and_custom_normals() -> None:
    import bpy

    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=2)
    ball = bpy.context.object
    assert stage.exported().meshes[0].normals() is None

    ball.data.shade_smooth()
    mesh = stage.exported().meshes[0]
    normals = mesh.normals()
    assert normals is not None
    assert mesh.corner_normals is None
    assert np.allclose(normals, mesh.positions[mesh.triangles] / 2, atol=1e-3)

    ball.hide_render = True
    tilted = (0.6, 0.0, 0.8)
    flat = stage.plane()
    flat.data.normals_split_custom_set([tilted] * 4)
    normals = stage.exported().meshes[0].normals()
    assert normals is not None
    assert np.allclose(normals, tilted, atol=1e-3)


@in_blender
def test_smooth_and_flat_faces_in_one_mesh() -> None:
    import bpy

    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.data.polygons.foreach_set("use_smooth", [True, False] * 3)
    mesh = stage.exported().meshes[0]
    p = mesh.positions[mesh.triangles].astype(np.float64)
    faces = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    normals = mesh.normals()
    assert normals is not None
    alike = np.isclose(normals, faces[:, None], atol=1e-3).all(axis=(1, 2))
    assert alike.sum() == 6


@pytest.mark.smoke
@in_blender
def test_several_materials() -> None:
    corners = [(x, y, 0) for y in (0, 1) for x in range(4)]
    ob = stage.add(
        "Strip", stage.mesh("Strip", corners, [(k, k + 1, k + 5, k + 4) for k in range(3)])
    )
    for name, red in (("A", 0.125), ("B", 0.25)):
        ob.data.materials.append(stage.material(name, (red, 0, 0)))
    ob.data.polygons.foreach_set("material_index", [1, 0, 5])
    twin = stage.add("Twin", ob.data, (0, 3, 0))
    twin.material_slots[0].link = "OBJECT"
    twin.material_slots[0].material = stage.material("C", (0.5, 0, 0))
    what = stage.exported()
    assert len(what.meshes) == 1
    reds = {}
    for instance, name in ((0, "Strip"), (1, "Twin")):
        mesh = what.meshes[what.instances.mesh[instance]]
        materials = what.material_sets[what.instances.material_set[instance]][mesh.slots]
        order = np.argsort(mesh.positions[mesh.triangles][..., 0].mean(axis=1))
        reds[name] = [what.materials[m].front.base_color[0] for m in materials[order]][::2]
    # A slot that does not exist shows the last material.
    assert reds == {"Strip": [0.25, 0.125, 0.25], "Twin": [0.25, 0.5, 0.25]}


@pytest.mark.smoke
@in_blender
def test_visibility_in_renders_decides() -> None:
    import bpy

    shown = stage.plane("Shown", 1)
    shown.hide_viewport = True
    stage.plane("Hidden", 2).hide_render = True
    for name, half in (("Hidden collection", 3), ("Excluded", 4), ("Not in the viewport", 5)):
        collection = bpy.data.collections.new(name)
        stage.scene().collection.children.link(collection)
        stage.plane(name, half, collection=collection)
        layer = bpy.context.view_layer.layer_collection.children[name]
        if name == "Excluded":
            layer.exclude = True
        collection.hide_render = name == "Hidden collection"
        collection.hide_viewport = name == "Not in the viewport"
    lamp = stage.lamp()
    lamp.hide_render = True
    what = stage.exported()
    assert sorted(mesh.positions.max() for mesh in what.meshes) == [1, 5]
    assert what.lights == []
    assert what.warnings == []


@in_blender
def test_an_instancer_is_hidden_but_not_what_it_places() -> None:
    parent = stage.plane("Parent", 2)
    parent.instance_type = "VERTS"
    parent.show_instancer_for_render = False
    child = stage.plane("Child", 0.1)
    child.parent = parent
    what = stage.exported()
    assert len(what.instances.mesh) == 4
    assert {what.meshes[m].name for m in what.instances.mesh} == {"Child"}


@in_blender
def test_an_instance_that_comes_first_stays_in_its_place() -> None:
    """Blender 5.2 tells of it what comes next, here a curve with a mesh of its own."""
    import bpy

    parent = stage.plane("Parent", 2, location=(1, 2, 3))
    parent.instance_type = "FACES"
    parent.show_instancer_for_render = False
    stage.plane("Child", 0.1).parent = parent
    bpy.ops.curve.primitive_bezier_circle_add(location=(7, 7, 7))
    bpy.context.object.data.bevel_depth = 0.1
    what = stage.exported()
    places = {
        what.meshes[m].name: tuple(matrix[:3, 3])
        for m, matrix in zip(what.instances.mesh, what.instances.matrix, strict=True)
    }
    assert places["Child"] == pytest.approx((1, 2, 3))


@in_blender
def test_objects_in_place_of_hair_stand_on_the_emitter() -> None:
    emitter, thing = stage.plane("Emitter"), stage.plane("Thing", 0.1, location=(5, 5, 5))
    emitter.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.type, settings.count = "HAIR", 20
    settings.render_type, settings.instance_object = "OBJECT", thing
    what = stage.exported()
    places = np.array(
        [
            matrix[:3, 3]
            for m, matrix in zip(what.instances.mesh, what.instances.matrix, strict=True)
            if what.meshes[m].name == "Thing"
        ]
    )
    on_it = (np.abs(places) < 1.2).all(1)
    assert on_it.sum() == 20
    assert len(np.unique(places[on_it].round(4), axis=0)) == 20


@in_blender
def test_a_mesh_that_nodes_have_made_anew_has_its_own_materials_alone() -> None:
    """A slot of the object counts where the evaluated mesh has that slot, as in Cycles since 5.1,
    and is then empty if it is empty.
    """
    import bpy

    strict = bpy.app.version >= (5, 1, 0)
    red, grey = pytest.approx((0.9, 0.1, 0.1)), pytest.approx((0.8, 0.8, 0.8))
    tree = bpy.data.node_groups.new("Anew", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    given, made, wires, tubes, round_ = (
        tree.nodes.new(kind)
        for kind in (
            "NodeGroupInput",
            "NodeGroupOutput",
            "GeometryNodeMeshToCurve",
            "GeometryNodeCurveToMesh",
            "GeometryNodeCurvePrimitiveCircle",
        )
    )
    tree.links.new(given.outputs[0], wires.inputs[0])
    tree.links.new(wires.outputs[0], tubes.inputs[0])
    tree.links.new(round_.outputs[0], tubes.inputs[1])
    tree.links.new(tubes.outputs[0], made.inputs[0])
    ob = stage.plane()
    ob.data.materials.append(stage.material("Of the mesh"))
    ob.material_slots[0].link = "OBJECT"
    ob.material_slots[0].material = stage.material("Of the object", (0.9, 0.1, 0.1))

    def color() -> tuple[float, ...]:
        what = stage.exported()
        [materials] = what.material_sets
        return what.materials[materials[0]].front.base_color

    assert color() == red
    ob.modifiers.new("Anew", "NODES").node_group = tree
    assert color() == (grey if strict else red)
    ob.modifiers.clear()
    ob.material_slots[0].material = None
    assert color() == (grey if strict else pytest.approx((0.5, 0.5, 0.5)))


@in_blender
def test_negative_scale_keeps_the_front() -> None:
    ob = stage.plane(location=(0, 0, 1))
    ob.scale = (-2, 1, 1)
    what = stage.exported()
    assert np.linalg.det(what.instances.matrix[0][:3, :3]) == pytest.approx(-2)
    corners = stage.world_positions(what)
    assert corners[..., 0].min() == -2
    assert what.warnings == []


@pytest.mark.smoke
@in_blender
def test_degenerate_and_broken_triangles_are_dropped_with_one_warning() -> None:
    nan = float("nan")
    vertices = [
        (0, 0, 0),
        (1, 0, 0),
        (1, 1, 0),
        (2, 0, 0),
        (nan, 0, 0),
        (0, float("inf"), 0),
        (0, 1, 1),
    ]
    faces = [(0, 1, 2), (0, 1, 3), (1, 2, 4), (0, 2, 5), (0, 2, 6)]
    stage.add("Bad apple", stage.mesh("Data", vertices, faces))
    what = stage.exported()
    mesh = what.meshes[0]
    assert np.isfinite(mesh.positions).all()
    assert len(mesh.triangles) == 2
    said = stage.the_one_warning(
        what, lambda warning: "Bad apple" in warning and "material" not in warning.lower()
    )
    assert (
        said
        == "Object 'Bad apple': triangles left out: 2 with a vertex that is not a finite number, "
        "1 without area"
    )


@in_blender
def test_uv_maps_that_nobody_reads_stay_behind() -> None:
    """One on its own, one that a scale flattens, one that is subdivided adaptively."""
    import bpy

    picture = bpy.data.images.new("Picture", 2, 2)
    made, tree = stage.empty_material("Painted")
    shader, image = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "TexImage"))
    image.image = picture
    stage.surface(tree, shader)
    for name, depth in (("Plain", 1.0), ("Flat", 0.0), ("Fine", 1.0)):
        ob = stage.plane(name)
        ob.scale = (1.0, 1.0, depth)
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], np.float32)
        ob.data.uv_layers.new(name="UV").uv.foreach_set("vector", corners.ravel())
        ob.data.materials[0] = made
    modifier = stage.scene().objects["Fine"].modifiers.new("Adaptive", "SUBSURF")
    modifier.subdivision_type, modifier.levels, modifier.render_levels = "SIMPLE", 0, 0
    modifier.use_adaptive_subdivision, modifier.adaptive_space = True, "OBJECT"
    modifier.adaptive_object_edge_length = 0.1
    assert [mesh.uv is None for mesh in stage.exported().meshes] == [True] * 3
    tree.links.new(image.outputs["Color"], shader.inputs["Color"])
    read = stage.exported().meshes
    for mesh in read:
        assert mesh.uv is not None
        assert np.allclose(mesh.uv, mesh.positions[mesh.triangles][..., :2], atol=1e-6)
    assert max(len(mesh.triangles) for mesh in read) > 500


@in_blender
def test_slots_uv_and_normals_follow_what_is_dropped() -> None:
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (2, 0, 0), (0, 1, 0)]
    data = stage.mesh("Data", corners, [(0, 1, 3), (0, 1, 2), (0, 2, 4)])
    data.uv_layers.new(name="UV").uv.foreach_set(
        "vector",
        np.array([corners[v][:2] for v in (0, 1, 3, 0, 1, 2, 0, 2, 4)], np.float32).ravel(),
    )
    data.shade_smooth()
    for name in "ABC":
        data.materials.append(stage.material(name))
    data.polygons.foreach_set("material_index", [0, 1, 2])
    stage.add("Ob", data)
    stage.scene().view_layers[0].use_pass_uv = True
    mesh = stage.exported().meshes[0]
    assert mesh.slots is not None
    assert mesh.slots.tolist() == [1, 2]
    assert mesh.uv is not None
    assert np.array_equal(mesh.uv, mesh.positions[mesh.triangles][..., :2])
    normals = mesh.normals()
    assert normals is not None
    assert np.allclose(normals, (0, 0, 1), atol=1e-3)


@in_blender
def test_an_object_with_nothing_left() -> None:
    stage.add("Line", stage.mesh("Line", [(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]))
    what = stage.exported()
    assert what.meshes == []
    assert stage.the_one_warning(what) == "Object 'Line': triangles left out: 1 without area"


@in_blender
def test_scales_of_zero() -> None:
    flat, point = stage.plane("Flat"), stage.plane("Point")
    flat.scale, point.scale = (1, 1, 0), (0, 0, 0)
    what = stage.exported()
    assert len(what.instances.mesh) == 1
    assert np.ptp(stage.world_positions(what), axis=(0, 1)).tolist() == [2, 2, 0]
    assert (
        stage.the_one_warning(what, lambda warning: "scale" in warning)
        == "Objects left out, as their scale is zero: 'Point'"
    )


@in_blender
def test_what_is_not_a_surface_is_named() -> None:
    import bpy

    pencils = getattr(bpy.data, "grease_pencils_v3", None) or bpy.data.grease_pencils
    stage.add("Sketch", pencils.new("Sketch"))
    assert "'Sketch'" in stage.the_one_warning(stage.exported())


@in_blender
def test_views_of_blenders_memory_outlive_the_render() -> None:
    """What is exported must not change with the scene afterwards."""
    ob = stage.plane()
    what = stage.exported()
    before = what.meshes[0].positions.copy()
    ob.data.vertices.foreach_set("co", np.full(12, 7.0, np.float32))
    ob.data.update()
    stage.exported()
    assert np.array_equal(what.meshes[0].positions, before)


@in_blender
def test_frames_of_an_animation() -> None:
    ob = stage.plane()
    for frame in (1, 2):
        ob.location.x = frame * 10
        ob.keyframe_insert("location", frame=frame)
    made = stage.scene()
    made.frame_start, made.frame_end = 1, 2
    made.render.filepath = "//unused"
    places = []
    for frame in (1, 2):
        made.frame_set(frame)
        places.append(stage.exported().instances.matrix[0][0, 3])
    assert places == [10, 20]


@in_blender
def test_light_linking() -> None:
    """Groups of objects that lights treat alike and that block alike."""
    import bpy

    floor, box, _ = stage.plane("Floor"), stage.plane("Box"), stage.plane("Wall")
    only, all_but, plain = stage.lamp("POINT"), stage.lamp("SPOT"), stage.lamp("SUN")
    for lamp, thing, state in ((only, floor, "INCLUDE"), (all_but, box, "EXCLUDE")):
        receivers = lamp.light_linking.receiver_collection = bpy.data.collections.new(lamp.name)
        receivers.objects.link(thing)
        receivers.collection_objects[0].light_linking.link_state = state
    blockers = plain.light_linking.blocker_collection = bpy.data.collections.new("Blockers")
    blockers.objects.link(floor)
    only.light_linking.blocker_collection = bpy.data.collections.new("Nothing in it")
    what = stage.exported()
    groups = {
        what.meshes[mesh].name: int(group)
        for mesh, group in zip(what.instances.mesh, what.instances.group, strict=True)
    }
    assert groups["Wall"] == 0
    assert len(set(groups.values())) == 3
    lit = {
        light.kind: {name for name, group in groups.items() if light.lit_groups >> group & 1}
        for light in what.lights
    }
    assert lit == {"point": {"Floor"}, "spot": {"Floor", "Wall"}, "sun": {"Floor", "Box", "Wall"}}
    blocked = {
        light.kind: {name for name, group in groups.items() if light.blockers >> group & 1}
        for light in what.lights
    }
    assert blocked == {
        "point": {"Floor", "Box", "Wall"},
        "spot": {"Floor", "Box", "Wall"},
        "sun": {"Floor"},
    }
    assert [light.blockers == ALL_GROUPS for light in what.lights] == [True, True, False]
    assert what.instances.lit_groups is None
    assert what.instances.blockers is None
    assert not what.warnings


@pytest.mark.smoke
@in_blender
def test_ray_visibility() -> None:
    import bpy

    stage.plane("Seen")
    assert stage.exported().instances.seen_by is None
    hidden = stage.plane("Hidden from the camera and shadow rays")
    hidden.visible_camera = hidden.visible_shadow = False
    unseen = stage.plane("Seen by no ray")
    for flag in ("camera", "diffuse", "glossy", "transmission", "shadow", "volume_scatter"):
        setattr(unseen, f"visible_{flag}", False)
    group = bpy.data.collections.new("Group")
    stage.scene().collection.children.link(group)
    stage.plane("Indirect", collection=group)
    bpy.context.view_layer.layer_collection.children["Group"].indirect_only = True
    within = bpy.data.collections.new("Within")
    instanced = stage.plane("Instanced", collection=within)
    instanced.visible_glossy = False
    instanced.is_holdout = True  # of itself alone, as in Cycles
    stand = stage.add("Stand")
    stand.instance_type, stand.instance_collection = "COLLECTION", within
    stand.visible_diffuse = False
    stage.plane("Hole").is_holdout = True
    what = stage.exported()
    left = {ALL_RAYS & ~mask for mask in what.instances.seen_by.tolist()}
    assert left >= {0, Ray.CAMERA | Ray.SHADOW, Ray.CAMERA, Ray.GLOSSY | Ray.DIFFUSE}
    assert Ray.CAMERA | Ray.SHADOW | Ray.DIFFUSE | Ray.GLOSSY | Ray.TRANSMISSION not in left
    assert what.instances.holdout.tolist().count(True) == 1
    assert not [warning for warning in what.warnings if "isib" in warning or "oldout" in warning]


@in_blender
def test_shadow_catchers() -> None:
    import bpy

    stage.plane("Thing")
    what = stage.exported()
    assert what.instances.catcher is None
    assert not what.shadow_pass
    stage.plane("Floor").is_shadow_catcher = True
    within = bpy.data.collections.new("Within")
    stage.plane("Instanced", collection=within)
    for name in ("One", "Other"):
        stand = stage.add(name)
        stand.instance_type, stand.instance_collection = "COLLECTION", within
        stand.is_shadow_catcher = name == "One"
    bpy.context.view_layer.cycles.use_pass_shadow_catcher = True
    what = stage.exported()
    assert sorted(what.instances.catcher.tolist()) == [False, False, True, True]
    assert what.shadow_pass
    assert what.warnings == []


def _standing(what: Scene) -> set[int]:
    """Where the planes of the next test stand."""
    return {round(float(x)) for x in what.instances.matrix[:, 0, 3]}


@in_blender
def test_simplify_culls_objects_beside_the_view_and_far_from_the_camera() -> None:
    made = stage.room()  # from 4 m above, sees 1.44 m to each side
    render, cycles = made.render, made.cycles
    for x in (0, 2, 4, 8):
        ob = stage.plane(f"At {x}", half=0.3, location=(x, 0, 0))
        ob.cycles.use_camera_cull = ob.cycles.use_distance_cull = True
    stage.plane("Not to be culled", half=0.3, location=(9, 0, 0))
    sun = stage.lamp("SUN", location=(50.0, 0.0, 0.0))
    sun.cycles.use_camera_cull = sun.cycles.use_distance_cull = True
    everything = {0, 2, 4, 8, 9}
    cycles.use_camera_cull = True
    assert _standing(stage.exported()) == everything
    render.use_simplify, cycles.camera_cull_margin = True, 0.02
    what = stage.exported()
    assert _standing(what) == {0, 9}
    assert len(what.lights) == 2
    assert what.warnings == []
    cycles.camera_cull_margin = 0.3  # of 2.88 m
    assert _standing(stage.exported()) == {0, 2, 9}
    cycles.use_distance_cull, cycles.distance_cull_margin = True, 5.0
    assert _standing(stage.exported()) == {0, 2, 9}
    cycles.distance_cull_margin = 6.0  # culled is what both cull
    assert _standing(stage.exported()) == {0, 2, 4, 9}
    cycles.use_camera_cull = False
    assert _standing(stage.exported()) == {0, 2, 4, 9}
    cycles.distance_cull_margin = 0.0
    assert _standing(stage.exported()) == everything
    cycles.use_camera_cull, made.camera.data.type = True, "PANO"
    assert _standing(stage.exported()) == everything


@in_blender
def test_what_stands_behind_the_camera_is_culled() -> None:
    made = stage.room()
    made.render.use_simplify = made.cycles.use_camera_cull = True
    for x in (1, 2):
        stage.plane("Behind", half=0.3, location=(x, 0, 5)).cycles.use_camera_cull = True
    assert _standing(stage.exported()) == {0}
    made.cycles.camera_cull_margin = 5.0
    assert _standing(stage.exported()) == {0, 1, 2}


@pytest.mark.smoke
@in_blender
def test_what_is_said_of_lamps() -> None:
    import bpy

    plain = stage.lamp()
    exported = stage.exported().lights[0]
    assert (
        exported.seen_by,
        exported.max_bounces,
        exported.met_by_rays,
        exported.casts_shadows,
    ) == (ALL_RAYS, None, True, True)
    plain.visible_glossy = plain.visible_shadow = False
    plain.data.use_shadow = False
    plain.data.cycles.max_bounces = 3
    plain.data.cycles.use_multiple_importance_sampling = False
    exported = stage.exported().lights[0]
    assert (exported.seen_by, exported.max_bounces) == (ALL_RAYS - Ray.GLOSSY, 3)
    assert (exported.met_by_rays, exported.casts_shadows) == (False, False)
    flat = stage.lamp("SPOT")
    flat.scale = (1.0, 1.0, 0.0)
    what = stage.exported()
    assert len(what.lights) == 1
    assert any("flattened" in warning for warning in what.warnings)
    world = bpy.data.worlds.new("World")
    stage.scene().world = world
    world.cycles_visibility.camera = False
    assert stage.exported().world_seen_by == ALL_RAYS - Ray.CAMERA


@in_blender
def test_lamps_that_add_light_to_catchers_are_named_where_there_are_some() -> None:
    floor, sun = stage.plane("Floor"), stage.lamp("SUN")
    sun.is_shadow_catcher = False
    assert stage.exported().warnings == []
    floor.is_shadow_catcher = True
    assert stage.the_one_warning(stage.exported()).endswith("add light to them: 'SUN'")
    sun.is_shadow_catcher = True
    assert stage.exported().warnings == []


@in_blender
def test_what_makes_a_lamp_an_instance_has_a_say_in_who_sees_it() -> None:
    import bpy

    def lamp() -> tuple[int, bool]:
        (light,) = stage.exported().lights
        return light.seen_by, light.camera_visible

    bulb, source = stage.lamp(), bpy.data.collections.new("Source")
    bulb.visible_camera = True
    source.objects.link(bulb)
    stage.scene().collection.objects.unlink(bulb)
    maker = stage.add("Maker")
    maker.instance_type, maker.instance_collection = "COLLECTION", source
    assert lamp() == (ALL_RAYS, True)
    maker.visible_diffuse = False
    assert lamp() == (ALL_RAYS - Ray.DIFFUSE, True)
    maker.visible_diffuse, bulb.visible_glossy = True, False
    maker.visible_camera = False
    assert lamp() == (ALL_RAYS - Ray.GLOSSY, False)
    maker.visible_camera = True
    child = bpy.data.collections.new("Indirect")
    stage.scene().collection.children.link(child)
    child.objects.link(maker)
    stage.scene().collection.objects.unlink(maker)
    bpy.context.view_layer.layer_collection.children["Indirect"].indirect_only = True
    assert lamp() == (ALL_RAYS - Ray.GLOSSY, False)


@in_blender
def test_light_groups() -> None:
    """What names a group that the view layer has is of it."""
    layer = stage.scene().view_layers[0]
    stage.plane("Dark"), stage.lamp("SUN")
    plain = stage.exported()
    assert (plain.light_groups, plain.instances.light_group, plain.world_light_group) == (
        [],
        None,
        -1,
    )
    for name in ("key", "rim"):
        layer.lightgroups.add(name=name)
    stage.plane("Glow").lightgroup = "rim"
    stage.lamp("POINT").lightgroup = "key"
    stage.lamp("SPOT").lightgroup = "gone"
    stage.world(0.5)
    stage.scene().world.lightgroup = "rim"
    what = stage.exported()
    assert what.light_groups == ["key", "rim"]
    assert {
        what.meshes[mesh].name: int(g)
        for mesh, g in zip(what.instances.mesh, what.instances.light_group, strict=True)
    } == {
        "Dark": -1,
        "Glow": 1,
    }
    assert {light.kind: light.light_group for light in what.lights} == {
        "sun": -1,
        "point": 0,
        "spot": -1,
    }
    assert what.world_light_group == 1
    assert not what.warnings


@in_blender
def test_what_cycles_does_with_some_caustics_only_is_told() -> None:
    stage.camera()
    lamp = stage.lamp("SPOT")
    assert not any("Caustics" in warning for warning in stage.exported().warnings)
    lamp.data.cycles.is_caustics_light = True
    assert any("Caustics" in w and lamp.name in w for w in stage.exported().warnings)


@in_blender
def test_fast_gi_is_named() -> None:
    import bpy

    stage.plane()
    assert not stage.exported().warnings
    bpy.context.scene.cycles.use_fast_gi = True
    assert stage.exported().warnings == [
        "Fast GI Approximation is not used: all indirect light is traced"
    ]
