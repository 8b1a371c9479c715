"""Rendered viewport shading inside Blender: what an edit exports, what a viewport shows, and that
nothing is left behind.
"""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np
import pytest

from tests.support import stage
from tests.support.blender import in_blender
from tests.support.window import Viewport, refresh, viewport


def _room() -> Any:
    """A floor, two cubes of their own, a lamp, a camera, and few photons."""

    scene = stage.room()
    for k, x in enumerate((-0.5, 0.5)):
        cube = stage.mesh(f"Cube{k}", *_cube(0.3))
        cube.materials.append(stage.material(f"Paint{k}", (0.2, 0.5 + 0.2 * k, 0.7)))
        stage.add(f"Cube{k}", cube, (x, 0, 0.3))
    stage.world(0.1)
    scene.photon_splat.viewport_passes, scene.photon_splat.viewport_photons_per_pass = 2, 5000
    return scene


def _cube(half: float) -> tuple[list[tuple[float, ...]], list[tuple[int, ...]]]:
    corners = [(x, y, z) for z in (-half, half) for y in (-half, half) for x in (-half, half)]
    return corners, [
        (0, 2, 3, 1),
        (4, 5, 7, 6),
        (0, 1, 5, 4),
        (2, 6, 7, 3),
        (0, 4, 6, 2),
        (1, 3, 7, 5),
    ]


def _threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if "viewport" in thread.name]


def _done(v: Viewport) -> tuple[int, int, int]:
    """Meshes exported, geometry built, light and materials replaced so far."""
    v.settle()
    return v.live.kept.made, v.live.controller.counts.builds, v.live.controller.counts.relights


@pytest.mark.smoke
@in_blender
def test_the_viewport_shows_what_a_render_of_it_shows() -> None:
    """The camera's frame fills the region: the refined picture is the rendered one."""
    import bpy

    from tests.support.window import projection_matrix

    scene = _room()
    scene.photon_splat.viewport_passes = scene.photon_splat.passes = 4
    scene.photon_splat.photons_per_pass, scene.photon_splat.seed = 5000, 0
    scene.photon_splat.denoise = scene.photon_splat.viewport_denoise = False
    scene.render.film_transparent = True
    with stage.watched() as results:
        bpy.ops.render.render()
    passes = results[0].passes["Combined"]
    camera = scene.camera.data
    x = camera.sensor_width / camera.lens / 2 * camera.clip_start
    window = projection_matrix(-x, x, -x, x, camera.clip_start, camera.clip_end)
    with viewport(
        width=scene.render.resolution_x, height=scene.render.resolution_y, window=window
    ) as v:
        v.context.region_data.view_perspective = "CAMERA"
        picture = v.settle()
    assert picture.samples == 4
    assert picture.pixels.shape == passes.shape
    assert np.abs(picture.pixels - passes).max() < 1e-3 * passes.max()


@in_blender
def test_fog_is_in_the_refined_picture() -> None:
    import bpy

    _room()
    with viewport() as v:
        clear = v.settle().pixels
        ob = bpy.data.objects["Cube0"]
        fog, tree = stage.empty_material("Fog")
        volume = tree.nodes.new("ShaderNodeVolumeAbsorption")
        volume.inputs["Density"].default_value = 1e3
        tree.links.new(volume.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
        refresh(lambda: ob.data.materials.__setitem__(0, fog))
        dark = v.settle().pixels
    assert np.abs(dark - clear).max() > 0.01
    assert dark[..., :3].min() < 1e-3


@in_blender
def test_each_edit_exports_and_builds_what_it_changes() -> None:
    import bpy

    scene = _room()
    cube, lamp = bpy.data.objects["Cube0"], bpy.data.objects["POINT"]
    with viewport() as v:
        assert _done(v) == (3, 1, 0)

        refresh(lambda: setattr(lamp.data, "energy", 200.0))
        assert _done(v) == (3, 1, 1), "light"
        refresh(lambda: setattr(lamp, "location", (0.5, 0, 2)))
        assert _done(v) == (3, 1, 2), "light moved"
        node = next(
            node for node in cube.data.materials[0].node_tree.nodes if node.type == "BSDF_DIFFUSE"
        )
        refresh(lambda: setattr(node.inputs["Color"], "default_value", (1, 0, 0, 1)))
        made, builds, relights = _done(v)
        assert (builds, relights) == (1, 3), "material"
        background = scene.world.node_tree.nodes["Background"]
        refresh(lambda: setattr(background.inputs["Color"], "default_value", (0.1, 0.2, 0.3, 1)))
        assert _done(v)[1:] == (1, 4), "world"

        refresh(lambda: setattr(cube, "location", (-0.6, 0, 0.3)))
        assert _done(v) == (made, 2, 4), "object moved"
        refresh(
            lambda: (setattr(cube.data.vertices[0], "co", (-0.4, -0.4, -0.3)), cube.data.update())
        )
        assert _done(v) == (made + 1, 3, 4), "mesh"
        refresh(lambda: setattr(cube, "hide_viewport", True))
        assert _done(v)[1:] == (4, 4), "hidden"
        refresh(lambda: setattr(cube, "hide_viewport", False))
        assert _done(v)[1:] == (5, 4), "shown again"
        refresh(lambda: cube.modifiers.new("Mirror", "MIRROR"))
        assert _done(v)[1] == 6, "modifier"

        before = _done(v), v.canvas.drawn[-1].number
        refresh(lambda: cube.select_set(True))
        refresh(lambda: setattr(scene.render, "resolution_x", 77))
        assert (_done(v), v.canvas.drawn[-1].number) == before, "nothing that is seen"


@in_blender
def test_moving_the_camera_exports_and_traces_nothing() -> None:
    _room()
    with viewport() as v:
        v.settle()
        counts = v.live.controller.counts
        exported, traced, updates = v.live.kept.made, counts.photon_paths, v.updates
        numbers = []
        for k in range(10):
            eye = np.eye(4)
            eye[:3, 3] = 0.1 * k, 0.0, 5.0
            v.context.region_data.view_matrix = np.linalg.inv(eye).astype(np.float32)
            numbers.append(v.draw().number)
            time.sleep(0.03)
        assert (v.live.kept.made, counts.photon_paths, v.updates) == (exported, traced, updates)
        assert numbers[-1] > numbers[0] + 3


@in_blender
def test_two_viewports_and_two_views() -> None:
    _room()
    with viewport() as one, viewport(width=48, height=48) as two:
        assert len(_threads()) == 2
        assert one.settle().pixels.shape == (36, 64, 4)
        assert two.settle().pixels.shape == (48, 48, 4)
    assert _threads() == []


@in_blender
def test_a_viewport_whose_engine_is_gone_is_closed() -> None:
    """Blender drops the engine when shading, engine, editor, window or file change, and does not
    always say so.
    """
    import gc

    from photon_splat.blender.viewport import live

    _room()
    with viewport() as freed, viewport() as dropped:
        assert len(_threads()) == 2
        assert live._poll() is not None
        assert len(live.lives) == 2
        freed.engine.gone = True
        live._poll()
        assert live.lives == [dropped.live]
        dropped.engine = None  # type: ignore[assignment]
        gc.collect()
        assert live._poll() is None
        assert live.lives == []
        assert _threads() == []


@in_blender
def test_loading_a_file_closes_all(tmp_path: str) -> None:
    import bpy

    _room()
    bpy.ops.wm.save_as_mainfile(filepath=f"{tmp_path}/room.blend")
    with viewport() as v:
        v.draw()
        bpy.ops.wm.open_mainfile(filepath=f"{tmp_path}/room.blend")
        assert _threads() == []
        assert v.engine.live is None  # type: ignore[attr-defined]


@in_blender
def test_unregistering_closes_all() -> None:
    import bpy
    import photon_splat

    _room()
    with viewport() as v:
        v.draw()
        photon_splat.unregister()
        try:
            assert _threads() == []
            assert not [
                h
                for name in ("load_pre", "undo_post")
                for h in getattr(bpy.app.handlers, name)
                if "photon_splat" in h.__module__
            ]
        finally:
            photon_splat.register()


@in_blender
def test_local_view_shows_what_it_shows() -> None:
    """As `local_view` needs a window, the object's own answer stands for it."""
    from photon_splat.blender.viewport import live

    _room()
    with viewport() as v:
        everything = len(v.live._scene.meshes)  # type: ignore[union-attr]
        space = v.context.space_data
        space.local_view = object()
        test = live.visible_in(space)
        assert test is not None
        space.local_view = None
        assert live.visible_in(space) is None
        import bpy

        graph = bpy.context.evaluated_depsgraph_get()
        from photon_splat.core.scene import Frame
        from photon_splat.export import export_contents
        from photon_splat.export.report import Report

        def only_cube(instance: Any) -> bool:
            return bool(instance.object.name == "Cube0")

        some = export_contents(graph, live.NOWHERE, Frame(1, 1), Report(), None, only_cube)
        assert (everything, [mesh.name for mesh in some.meshes], some.lights) == (3, ["Cube0"], [])


@in_blender
def test_edit_mode_and_undo() -> None:
    import bpy

    _room()
    cube = bpy.data.objects["Cube0"]
    bpy.context.view_layer.objects.active = cube
    with viewport() as v:
        v.settle()
        triangles = sum(len(mesh.triangles) for mesh in v.live._scene.meshes)  # type: ignore[union-attr]
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.subdivide()
        bpy.context.view_layer.update()
        v.settle()
        assert sum(len(mesh.triangles) for mesh in v.live._scene.meshes) == triangles + 3 * 12  # type: ignore[union-attr]
        bpy.ops.object.mode_set(mode="OBJECT")
        v.settle()


@in_blender
def test_a_scene_that_cannot_be_exported_says_so() -> None:
    from photon_splat.blender.viewport import live

    _room()
    plain = live.export_contents

    def fail(*_: object) -> None:
        raise ValueError("on\n purpose")

    with viewport() as v:
        live.export_contents = fail  # type: ignore[assignment]
        try:
            refresh(lambda: stage.lamp(energy=3.0))
        finally:
            live.export_contents = plain
        v.draw()
        assert v.engine.stats == ("Photon Splat", "Error: on purpose")
        refresh(lambda: stage.lamp(energy=4.0))
        v.settle()


@pytest.mark.parametrize("seed", [1])
@in_blender
def test_random_edits_end_where_a_fresh_export_ends(seed: int) -> None:
    """What is kept from one export to the next never shows: after each edit the scene is that of an
    export without it.
    """
    from tests.integration.viewport.hunt import hunt

    _room()
    counts = hunt(seed, 60)
    assert sum(counts.values()) == 60
    assert _threads() == []


@pytest.mark.slow
@in_blender
def test_five_hundred_edits_leave_no_memory() -> None:
    """With hair, motion, displacement and adaptive subdivision among them: what is resident at the
    end of the second half is what it was at its beginning, but for a few scenes' worth.
    """
    from photon_splat.core.render.memory import current_memory_bytes

    from tests.integration.viewport.hunt import hunt

    _room()
    memory: dict[int, int] = {}

    def note(number: int) -> None:
        memory[number] = current_memory_bytes()

    counts = hunt(7, 500, note)
    assert sum(counts.values()) == 500
    assert min(counts[kind] for kind in ("hair", "displace", "dice", "moving")) > 5
    assert _threads() == []
    halfway, end = (max(memory[k] for k in range(a, a + 50)) for a in (225, 450))
    print("MiB", halfway >> 20, end >> 20)
    assert end - halfway < 64 << 20
