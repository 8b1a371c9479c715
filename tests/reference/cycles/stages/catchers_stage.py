"""Scenes for cases.py: shadow catchers, and objects that Simplify culls."""

from __future__ import annotations

import bpy

from blend_scenes.scripts import modelling as m
from tests.reference.cycles.stages import stage


def shadow_catcher(
    floor: str = "matte",
    light: str = "lamp",
    things: str = "solid",
    on: str = "object",
    transparent: bool = False,
    focus: bool = False,
    shadow_pass: bool = False,
) -> None:
    """The stage, whose floor and wall catch shadows.

    floor: matte, glossy, or leaf: a catcher that is half transparent before them. light: lamp,
    sky, emitter (a thing that shines), shining (the wall does). things: solid, glass, fog, unseen
    (by the camera). on: what the flag is set on, the object or an instance of its collection.
    """
    stage._stage(things=things != "fog")
    scene = bpy.context.scene
    catchers = [scene.objects["Floor"], scene.objects["Wall"]]
    m.set_world((0.25, 0.3, 0.4), 1.0 if light == "sky" else 0.3)
    if light == "lamp":
        stage._lamp("AREA", 40.0, (0.9, -0.9, 1.5), (0.0, 0.0, 0.0), size=0.4)
    elif light == "emitter":
        glow = m.emission("Glow", (1.0, 0.6, 0.3), 3.0)
        m.add_boxes("Glow", [((-0.3, -1.0, 0.05), (0.1, -0.8, 0.25))], glow)
    elif light == "shining":
        glow = m.emission("Glow", (1.0, 0.6, 0.3), 2.0)
        catchers.append(m.add_boxes("Glow", [((-1.2, 0.9, 0.05), (-1.0, 1.1, 1.4))], glow))
    if floor == "glossy":
        gloss = m.principled("Gloss", (0.4, 0.4, 0.4))
        gloss.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.25
        catchers[0].data.materials[0] = gloss
    elif floor == "leaf":
        leaf = m.principled("Leaf", (0.3, 0.6, 0.3))
        leaf.node_tree.nodes["Principled BSDF"].inputs["Alpha"].default_value = 0.5
        corners = [(-0.9, -1.1, 0.1), (0.9, -1.1, 0.1), (0.9, -1.0, 0.7), (-0.9, -1.0, 0.7)]
        catchers.append(m.add_mesh("Leaf", corners, [(0, 1, 2, 3)], leaf))
    if things == "glass":
        m.add_sphere("Ball", 0.35, m.glass("Ball", 1.45), (0.05, -0.9, 0.4), 48)
    elif things == "fog":
        cloud = m.medium("Cloud", 2.0, (0.8, 0.6, 0.4))
        m.add_boxes("Cloud", [((-0.6, -0.7, 0.1), (0.5, 0.2, 0.8))], cloud)
    elif things == "unseen":
        for name in ("Block", "Wedge"):
            scene.objects[name].visible_camera = False
    if on == "instance":
        group = bpy.data.collections.new("Group")
        for catcher in catchers:
            scene.collection.objects.unlink(catcher)
            group.objects.link(catcher)
        stand = m.add_object("Stand", None)
        stand.instance_type, stand.instance_collection = "COLLECTION", group
        catchers = [stand]
    for catcher in catchers:
        catcher.is_shadow_catcher = True
    scene.render.film_transparent = transparent
    bpy.context.view_layer.cycles.use_pass_shadow_catcher = shadow_pass
    if focus:
        lens = scene.camera.data.dof
        lens.use_dof, lens.focus_distance, lens.aperture_fstop = True, 4.0, 0.8


def culled(margin: float = -1.0, distance: float = 0.0, orthographic: bool = False) -> None:
    """Posts in the view and left of it, whose long shadows fall on the stage; the last one is not
    to be culled. margin: of the view (negative: nothing beside it is culled); distance: from the
    camera, beyond which posts are culled (0: none are).
    """
    stage._stage(things=False)
    stage._lamp("SUN", 2.0, aim=(-0.9, -0.2, 0.4), angle=0.02)
    scene = bpy.context.scene
    places = ((-1.7, -0.9, 0.8), (-2.3, -0.3, 1.0), (-4.0, 0.3, 1.9), (0.5, 0.9, 0.7))
    for i, (x, y, height) in enumerate((*places, (-2.9, 1.0, 1.3))):
        color = m.diffuse(f"Post {i}", (0.3 + 0.1 * i, 0.5, 0.8 - 0.1 * i))
        post = m.add_boxes(f"Post {i}", [((-0.1, -0.1, 0.0), (0.1, 0.1, height))], color)
        post.location = (x, y, 0.0)
        post.cycles.use_camera_cull = post.cycles.use_distance_cull = i < len(places)
    if orthographic:
        scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 3.0
    cycles = scene.cycles
    scene.render.use_simplify = True
    cycles.use_camera_cull, cycles.camera_cull_margin = margin >= 0.0, max(margin, 0.0)
    cycles.use_distance_cull, cycles.distance_cull_margin = distance > 0.0, distance
