"""Small scenes as files. Runs inside Blender."""

from __future__ import annotations

from typing import Any

from tests.support import stage


def save(folder: str) -> None:
    import bpy

    def write(name: str) -> None:
        bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/{name}.blend", compress=False)

    scene = stage.room(pixels=24, passes=4, photons=3000)
    wall = stage.plane("Wall", half=1.0, location=(-1.0, 0.0, 1.0))
    wall.rotation_euler = (0.0, 1.5708, 0.0)
    wall.data.materials[0] = stage.material("Red", (0.8, 0.1, 0.1))
    write("room")
    layers(scene)
    write("layers")
    bpy.data.objects["POINT"].data.energy = 101
    write("layers_brighter")
    bpy.ops.wm.open_mainfile(filepath=f"{folder}/room.blend")
    missing_texture()
    write("missing_texture")
    bpy.ops.wm.open_mainfile(filepath=f"{folder}/room.blend")
    moving_in_fog(bpy.context.scene)
    write("moving_in_fog")
    bpy.ops.wm.open_mainfile(filepath=f"{folder}/room.blend")
    scene = bpy.context.scene
    for frame, x in ((1, 0.0), (3, 0.5)):
        scene.camera.location.x = x
        scene.camera.keyframe_insert("location", frame=frame)
    write("moving")
    scene.render.use_persistent_data = True
    write("persistent")


def layers(scene: Any) -> None:
    """Two view layers, mattes, a light group, a border, and a transparent film."""
    import bpy

    first = scene.view_layers[0]
    first.use_pass_cryptomatte_object = True
    first.lightgroups.add(name="Key")
    bpy.data.objects["POINT"].lightgroup = "Key"
    stage.lamp(energy=50, location=(1, 1, 1.5)).name = "Fill"
    scene.view_layers.new("Second")
    render = scene.render
    render.film_transparent = True
    render.use_border = True
    render.border_min_x, render.border_max_x = 0.0, 0.75
    render.border_min_y, render.border_max_y = 0.25, 1.0
    scene.camera.location.z = 7


def moving_in_fog(scene: Any) -> None:
    """A glass ball that moves while the shutter is open, in a world full of fog: beams of photons,
    light along camera rays, and two passes of volumes.
    """
    import bpy

    glass, tree = stage.empty_material("Glass")
    stage.surface(tree, tree.nodes.new("ShaderNodeBsdfGlass"))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.4, location=(0, 0, 0.6))
    ball = bpy.context.object
    ball.data.materials.append(glass)
    for frame, x in ((0, -0.6), (2, 0.6)):
        ball.location.x = x
        ball.keyframe_insert("location", frame=frame)
    world = bpy.data.worlds.new("Fog")
    world.use_nodes = True
    scatter = world.node_tree.nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Density"].default_value = 0.1
    output = world.node_tree.nodes["World Output"]
    world.node_tree.links.new(scatter.outputs["Volume"], output.inputs["Volume"])
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    scene.world = world
    scene.frame_set(1)
    scene.render.use_motion_blur = True
    layer = scene.view_layers[0]
    layer.cycles.use_pass_volume_direct = layer.cycles.use_pass_volume_indirect = True


def missing_texture() -> None:
    import bpy

    made, tree = stage.empty_material("Photo")
    shader, photo = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "TexImage"))
    photo.image = bpy.data.images.new("photo", 1, 1)
    photo.image.source, photo.image.filepath = "FILE", "//gone.png"
    tree.links.new(photo.outputs["Color"], shader.inputs["Color"])
    stage.surface(tree, shader)
    bpy.data.objects["Plane"].data.materials[0] = made
