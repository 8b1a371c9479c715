"""Small scenes as files. Runs inside Blender."""

from __future__ import annotations

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
    for frame, x in ((1, 0.0), (3, 0.5)):
        scene.camera.location.x = x
        scene.camera.keyframe_insert("location", frame=frame)
    write("moving")
    scene.render.use_persistent_data = True
    write("persistent")
