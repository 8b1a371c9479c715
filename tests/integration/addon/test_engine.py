"""The engine inside Blender: pictures, passes, errors, cancelling."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support import stage
from tests.support.blender import in_blender
from tests.support.clock import Stopwatch
from tests.support.paths import ROOT, environment

SCRIPT = """
import sys, bpy, photon_splat
from tests.support import stage
photon_splat.register()
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
scene = stage.room()
scene.render.engine = "PHOTON_SPLAT"
scene.render.filepath = sys.argv[1]
print(bpy.ops.render.render(write_still=True))
"""


def _load(path: str | Path) -> np.ndarray:
    """(height, width, 4) linear, row 0 at the bottom."""
    import bpy

    image = bpy.data.images.load(str(path))
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    width, height = image.size
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, -1)


def _exr(path: str) -> None:
    """Renders are saved to `path` as plain OpenEXR."""
    render = stage.scene().render
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.filepath = path


@pytest.mark.smoke
def test_render_operator_in_a_plain_script(tmp_path: Path) -> None:
    command = [sys.executable, "-c", SCRIPT, str(tmp_path / "out.png")]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env=environment(tmp_path / "blender"),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "{'FINISHED'}" in done.stdout
    import OpenImageIO as oiio

    pixels = oiio.ImageBuf(str(tmp_path / "out.png")).get_pixels(oiio.FLOAT)
    assert pixels.shape[:2] == (16, 16)
    assert pixels[..., :3].min() > 0.01


def _broken(error: BaseException) -> Any:
    def fail(*_: object, **__: object) -> None:
        raise error

    return fail


ERRORS = {
    "ValueError": ("on purpose", "on purpose"),
    "RuntimeError": ("on\n  purpose", "on purpose"),
    "MemoryError": ("", "not enough memory"),
    "ZeroDivisionError": ("on purpose", "internal error (ZeroDivisionError): on purpose"),
    "KeyboardInterrupt": ("", "interrupted"),
    "SystemExit": ("7", "internal error (SystemExit): 7"),
}


@pytest.mark.smoke
@pytest.mark.parametrize("kind", ERRORS)
@in_blender
def test_errors_of_every_kind_reach_the_caller(kind: str, tmp_path: str) -> None:
    import builtins

    text, sentence = ERRORS[kind]
    _fails("render", getattr(builtins, kind)(text), sentence, tmp_path)


@pytest.mark.parametrize(
    "where",
    [
        "export_frame",
        "export_scene",
        "render_settings",
        "fill_passes",
        "current_memory_bytes",
        "_finish",
    ],
)
@in_blender
def test_errors_anywhere_reach_the_caller(where: str, tmp_path: str) -> None:
    _fails(where, RuntimeError("on purpose"), "on purpose", tmp_path)


def _fails(where: str, error: BaseException, sentence: str, folder: str) -> None:
    import bpy
    from photon_splat.blender import job

    stage.room()
    stage.scene().render.filepath = f"{folder}/out.png"
    seen: list[BaseException] = []
    job.observer.on_error = seen.append
    with stage.replaced(where, _broken(error)), pytest.raises(RuntimeError) as caught:
        bpy.ops.render.render(write_still=True)
    assert f"Photon Splat: {sentence}" in str(caught.value), str(caught.value)
    assert seen == [error]
    assert os.listdir(folder) == []
    # And the next render is as if nothing had happened.
    bpy.ops.render.render(write_still=True)
    assert _load(f"{folder}/out.png").shape == (16, 16, 4)


@in_blender
def test_an_error_in_the_second_view_layer_saves_nothing(tmp_path: str) -> None:
    import bpy
    from photon_splat.blender import job

    stage.room().view_layers.new("Second")
    stage.scene().render.filepath = f"{tmp_path}/out.png"
    plain, calls = job.render, []

    def fail_later(*given: Any, **more: Any) -> Any:
        calls.append(1)
        if len(calls) == 2:
            raise ValueError("too late")
        return plain(*given, **more)

    with stage.replaced("render", fail_later), pytest.raises(RuntimeError, match="too late"):
        bpy.ops.render.render(write_still=True)
    assert len(calls) == 2
    assert os.listdir(tmp_path) == []


@in_blender
def test_an_animation_stops_at_the_frame_that_fails(tmp_path: str) -> None:
    import bpy
    from photon_splat.blender import job

    scene = stage.room()
    scene.frame_start, scene.frame_end = 1, 4
    scene.render.filepath = f"{tmp_path}/frame_"
    plain = job.export_scene

    def fail_at_two(depsgraph: Any, *given: Any) -> Any:
        if depsgraph.scene.frame_current == 2:
            raise ValueError("frame 2 on purpose")
        return plain(depsgraph, *given)

    with (
        stage.replaced("export_scene", fail_at_two),
        pytest.raises(RuntimeError, match="frame 2 on purpose"),
    ):
        bpy.ops.render.render(animation=True)
    assert os.listdir(tmp_path) == ["frame_0001.png"]


@in_blender
def test_cancelling_keeps_what_is_there(tmp_path: str) -> None:
    import bpy
    from photon_splat.blender import job

    scene = stage.room(pixels=64, passes=1_000_000, photons=20_000)
    _exr(f"{tmp_path}/out.exr")
    done: list[int] = []
    asked: list[Stopwatch] = []

    def cancel() -> bool:
        if done and done[-1] >= 3:
            asked.append(Stopwatch())
        return bool(asked)

    job.observer.on_progress = lambda progress: done.append(progress.passes_done)
    job.observer.should_cancel = cancel
    with stage.watched() as results:
        bpy.ops.render.render(write_still=True)
    assert asked[0].seconds() < 1.0
    assert results[0].cancelled
    assert 3 <= results[0].statistics["passes"] < 1_000_000
    saved = _load(scene.render.filepath)
    assert np.array_equal(saved, results[0].passes["Combined"])
    assert saved[..., :3].mean() > 0.01


@in_blender
def test_cancelling_is_heard_during_export() -> None:
    """Of a hundred objects with materials of their own most are not even looked at."""
    import bpy
    from photon_splat.blender import job
    from photon_splat.export import materials

    stage.room()
    for k in range(100):
        stage.plane(f"Plane {k}")
    asked: list[None] = []

    def cancel() -> bool:
        asked.append(None)
        return len(asked) > 20

    job.observer.should_cancel = cancel
    seen: list[None] = []
    plain = materials.export_material
    materials.export_material = lambda *given: (seen.append(None), plain(*given))[1]  # type: ignore[assignment]
    try:
        with stage.watched() as results:
            bpy.ops.render.render()
    finally:
        materials.export_material = plain
    assert results[0].cancelled
    assert len(seen) < 20
    assert not results[0].passes["Combined"][..., :3].any()


@in_blender
def test_cancelling_at_once_is_a_black_picture() -> None:
    import bpy
    from photon_splat.blender import job

    stage.room(pixels=64, passes=1_000_000, photons=20_000)
    job.observer.should_cancel = lambda: True
    with stage.watched() as results:
        bpy.ops.render.render()
    assert results[0].cancelled
    assert np.isfinite(results[0].passes["Combined"]).all()


@pytest.mark.smoke
@in_blender
def test_passes_of_view_layers(tmp_path: str) -> None:
    import bpy
    from photon_splat.blender import job
    from photon_splat.blender.passes import blender_name, own_name

    scene = stage.room()
    first, second = scene.view_layers[0], scene.view_layers.new("Second")
    first.name = "First"
    for name in (
        "use_pass_z",
        "use_pass_normal",
        "use_pass_diffuse_direct",
        "use_pass_diffuse_indirect",
        "use_pass_diffuse_color",
    ):
        setattr(first, name, True)
    first.use_pass_emit = True
    first.photon_splat.use_pass_photon_density = first.photon_splat.use_pass_surface_id = True
    off = scene.view_layers.new("Off")
    off.use = False
    extra = bpy.data.collections.new("Extra")
    scene.collection.children.link(extra)
    stage.plane("Only in the second", 5, location=(0, 0, 0.5), collection=extra)
    first.layer_collection.children["Extra"].exclude = True
    second.use_pass_z = True
    if hasattr(scene.render.image_settings, "media_type"):
        scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = f"{tmp_path}/out.exr"
    with stage.watched() as results:
        bpy.ops.render.render(write_still=True)
    assert len(results) == 2
    saved = _channels(scene.render.filepath)
    wanted = {
        "Combined": "RGBA",
        "Depth": "Z",
        "Normal": "XYZ",
        "Photon Density": "X",
        "Surface ID": "X",
    }
    light = ("Diffuse Direct", "Diffuse Indirect", "Diffuse Color", "Emission")
    wanted |= {blender_name(name): "RGB" for name in light}
    names = {f"First.{name}.{letter}" for name, letters in wanted.items() for letter in letters}
    names |= {f"Second.Combined.{letter}" for letter in "RGBA"} | {"Second.Depth.Z"}
    assert {name for name in saved if not name.startswith("Composite.")} == names
    for name, letters in wanted.items():
        for k, letter in enumerate(letters):
            assert np.array_equal(
                saved[f"First.{name}.{letter}"][::-1], results[0].passes[own_name(name)][..., k]
            ), name
    job.observer.on_result = None  # then only what Blender asks for is made
    bpy.ops.render.render(write_still=True)
    alone = _channels(scene.render.filepath)
    assert all(np.array_equal(alone[name], saved[name]) for name in names)
    assert saved["First.Depth.Z"].mean() == pytest.approx(4.0, abs=0.1)
    assert saved["Second.Depth.Z"].mean() == pytest.approx(3.5, abs=0.1)


@in_blender
def test_normal_pass_has_the_bumps_that_cycles_has(tmp_path: str) -> None:
    import bpy

    scene = stage.room(pixels=32, passes=32, photons=0)
    scene.view_layers[0].use_pass_normal = True
    shade, tree = stage.empty_material("Bumpy")
    wave, bump, shader = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexWave", "Bump", "BsdfDiffuse")
    )
    wave.inputs["Scale"].default_value = 0.5
    bump.inputs["Distance"].default_value = 0.3
    tree.links.new(wave.outputs["Color"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    stage.surface(tree, shader)
    bpy.data.objects["Plane"].data.materials[0] = shade
    if hasattr(scene.render.image_settings, "media_type"):
        scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    seen = []
    for engine in ("PHOTON_SPLAT", "CYCLES"):
        scene.render.engine = engine
        if engine == "CYCLES":
            scene.cycles.samples, scene.cycles.use_denoising = 32, False
        scene.render.filepath = f"{tmp_path}/{engine}.exr"
        bpy.ops.render.render(write_still=True)
        saved = _channels(scene.render.filepath)
        seen.append(
            np.stack([saved[f"{scene.view_layers[0].name}.Normal.{axis}"] for axis in "XYZ"], -1)
        )
    assert np.abs(seen[1][..., 0]).max() > 0.2
    assert np.abs(seen[0] - seen[1]).mean() < 0.02
    assert np.abs(seen[0] - seen[1]).max() < 0.2


@in_blender
def test_light_groups_add_up_to_the_picture(tmp_path: str) -> None:
    """Passes by Cycles' names; kept photons, a mirror's caustics and the reference integrator among
    what is told apart.
    """
    import bpy

    scene = stage.room(photons=20_000)
    layer = scene.view_layers[0]
    rest = stage.lamp("SPOT", 50.0, (-1, 0, 2))
    box = stage.plane("Wall", location=(-1.5, 0, 1))
    box.rotation_euler = (0, 1.2, 0)
    box.data.materials[0] = stage.material("Mirror", (0.9, 0.7, 0.5), "ShaderNodeBsdfAnisotropic")
    box.data.materials[0].node_tree.nodes[-1].inputs["Roughness"].default_value = 0.1
    stage.world(0.1)
    plain = _combined()
    for name in ("key", "sky"):
        layer.lightgroups.add(name=name)
    bpy.data.objects["POINT"].lightgroup, scene.world.lightgroup = "key", "sky"
    scene.render.use_persistent_data = True
    for again in (False, True):
        with stage.watched() as results:
            bpy.ops.render.render()
        passes = results[0].passes
        left = passes["Combined"][..., :3] - passes["Combined_key"] - passes["Combined_sky"]
        assert (
            min(passes["Combined_key"].mean(), passes["Combined_sky"].mean(), left.mean()) > 0.001
        )
        assert (results[0].statistics["reused"]["photons"] > 0) == again
    rest.lightgroup = "sky"  # of which a graph that Blender keeps is not told
    with stage.watched() as results:
        bpy.ops.render.render()
    passes = results[0].passes
    assert np.allclose(
        passes["Combined_key"] + passes["Combined_sky"],
        passes["Combined"][..., :3],
        rtol=1e-4,
        atol=1e-6,
    )
    scene.render.use_persistent_data = False
    if hasattr(scene.render.image_settings, "media_type"):
        scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = f"{tmp_path}/out.exr"
    with stage.watched() as results:
        bpy.ops.render.render(write_still=True)
    passes = results[0].passes
    assert results[0].statistics["warnings"] == []
    assert np.allclose(
        passes["Combined_key"] + passes["Combined_sky"],
        passes["Combined"][..., :3],
        rtol=1e-4,
        atol=1e-6,
    )
    assert np.allclose(passes["Combined"], plain, rtol=1e-4, atol=1e-6)
    saved = _channels(scene.render.filepath)
    for name in ("key", "sky"):
        for k, letter in enumerate("RGB"):
            assert np.array_equal(
                saved[f"{layer.name}.Combined_{name}.{letter}"][::-1],
                passes[f"Combined_{name}"][..., k],
            )


def _combined() -> np.ndarray:
    import bpy

    with stage.watched() as results:
        bpy.ops.render.render()
    return results[0].passes["Combined"]


def _channels(path: str) -> dict[str, np.ndarray]:
    """Every channel of an OpenEXR file, top row first; Blender 5 writes layers as parts."""
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(path)
    found: dict[str, np.ndarray] = {}
    part = 0
    while file.seek_subimage(part, 0):
        spec = file.spec(part, 0)
        pixels = file.read_image(part, 0, 0, spec.nchannels, oiio.FLOAT)
        found |= {name: pixels[..., k] for k, name in enumerate(spec.channelnames)}
        part += 1
    file.close()
    return found


@in_blender
def test_two_scenes_have_settings_of_their_own() -> None:
    import bpy

    stage.room(pixels=8, passes=2)
    other = bpy.data.scenes.new("Other")
    other.render.engine = "PHOTON_SPLAT"
    other.collection.objects.link(bpy.data.objects["Camera"])
    other.camera = bpy.data.objects["Camera"]
    other.render.resolution_x, other.render.resolution_y, other.render.resolution_percentage = (
        12,
        6,
        100,
    )
    other.photon_splat.passes = 5
    with stage.watched() as results:
        bpy.ops.render.render()
        bpy.ops.render.render(scene="Other")
    assert [(r.passes["Combined"].shape, r.statistics["passes"]) for r in results] == [
        ((8, 8, 4), 2),
        ((6, 12, 4), 5),
    ]
    assert results[0].passes["Combined"][..., :3].mean() > 0
    assert results[1].passes["Combined"][..., :3].max() == 0


@in_blender
def test_animation(tmp_path: str) -> None:
    import bpy

    scene = stage.room()
    lamp = bpy.data.objects["POINT"].data
    for frame in (1, 2):
        lamp.energy = 100 * frame
        lamp.keyframe_insert("energy", frame=frame)
    scene.frame_start, scene.frame_end = 1, 2
    _exr(f"{tmp_path}/frame_")
    bpy.ops.render.render(animation=True)
    assert sorted(os.listdir(tmp_path)) == ["frame_0001.exr", "frame_0002.exr"]
    one, two = (_load(f"{tmp_path}/frame_000{k}.exr") for k in (1, 2))
    assert two[..., :3].mean() == pytest.approx(2 * one[..., :3].mean(), rel=1e-3)


def _signs() -> None:
    """Shining squares that tell where a pixel is: red at the lower left, green at the upper right
    of a frame of 4 x 4 units.
    """
    camera = stage.camera()
    camera.data.type, camera.data.ortho_scale = "ORTHO", 4
    for name, color, place in (("Red", (1, 0, 0), -1), ("Green", (0, 1, 0), 1)):
        stage.plane(name, 1, location=(place, place, 0)).data.materials[0] = stage.material(
            name, color, "ShaderNodeEmission"
        )
    stage.resize(16)
    stage.scene().photon_splat.passes = 2
    stage.scene().photon_splat.denoise = False


@pytest.mark.smoke
@pytest.mark.parametrize("crop", [False, True])
@in_blender
def test_border(crop: bool, tmp_path: str) -> None:
    import bpy

    _signs()
    render = stage.scene().render
    render.use_border, render.use_crop_to_border = True, crop
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = (
        0.0,
        0.5,
        0.25,
        0.5,
    )
    _exr(f"{tmp_path}/out.exr")
    bpy.ops.render.render(write_still=True)
    saved = _load(render.filepath)
    inner = saved if crop else saved[4:8, :8]
    assert saved.shape == ((4, 8, 4) if crop else (16, 16, 4))
    assert np.allclose(inner[1:-2, 1:-2], (1, 0, 0, 1), atol=1e-3)
    if not crop:
        assert saved[8:].max() == 0
        assert saved[:4].max() == 0
        assert saved[:, 8:].max() == 0


@in_blender
def test_orientation(tmp_path: str) -> None:
    import bpy

    _signs()
    stage.scene().render.film_transparent = True
    _exr(f"{tmp_path}/out.exr")
    bpy.ops.render.render(write_still=True)
    saved = _load(f"{tmp_path}/out.exr")
    assert np.allclose(saved[3, 3], (1, 0, 0, 1), atol=1e-3)
    assert np.allclose(saved[12, 12], (0, 1, 0, 1), atol=1e-3)
    assert np.allclose(saved[12, 3], 0, atol=1e-3)


@pytest.mark.smoke
@in_blender
def test_no_camera(tmp_path: str) -> None:
    import bpy

    stage.room()
    stage.scene().camera = None
    stage.scene().render.filepath = f"{tmp_path}/out.png"
    with pytest.raises(RuntimeError, match="camera"):
        bpy.ops.render.render(write_still=True)
    assert os.listdir(tmp_path) == []


@in_blender
def test_no_light_is_black_and_nothing_is_empty() -> None:
    import bpy

    stage.room()
    bpy.data.objects.remove(bpy.data.objects["POINT"])
    with stage.watched() as results:
        bpy.ops.render.render()
        bpy.data.objects.remove(bpy.data.objects["Plane"])
        stage.scene().render.film_transparent = True
        bpy.ops.render.render()
    assert results[0].passes["Combined"][..., :3].max() == 0
    assert results[0].passes["Combined"][..., 3].max() == pytest.approx(1, abs=1e-6)
    assert results[1].passes["Combined"].max() == 0


@pytest.mark.parametrize(
    ("size", "percentage"), [((4, 4), 100), ((4, 4), 25), ((400, 4), 25), ((4, 400), 25)]
)
@in_blender
def test_smallest_images(size: tuple[int, int], percentage: int) -> None:
    import bpy

    stage.room()
    stage.resize(*size)
    stage.scene().render.resolution_percentage = percentage
    with stage.watched() as results:
        bpy.ops.render.render()
    combined = results[0].passes["Combined"]
    assert combined.shape == (
        max(size[1] * percentage // 100, 1),
        max(size[0] * percentage // 100, 1),
        4,
    )
    assert np.isfinite(combined).all()
    assert combined[..., :3].mean() > 0


@in_blender
def test_settings_of_the_scene_reach_the_session() -> None:
    from photon_splat.blender.properties import render_settings
    from photon_splat.core.render.settings import Backend, RenderSettings

    scene = stage.scene()
    click = RenderSettings(passes=4096, error_threshold=0.045, denoise=True)
    assert render_settings(scene) == click
    assert scene.photon_splat.passes == 4096
    values = {
        "time_limit": 2.5,
        "passes": 7,
        "photons_per_pass": 11,
        "max_bounces": 3,
        "radius_scale": 0.5,
        "seed": 9,
        "point_spacing": 0.25,
    }
    for name, value in values.items():
        setattr(scene.photon_splat, name, value)
    scene.photon_splat.boundary_correction = False
    scene.photon_splat.backend = "CPU"
    scene.render.threads_mode, scene.render.threads = "FIXED", 3
    assert render_settings(scene) == RenderSettings(
        **values, denoise=True, boundary_correction=False, backend=Backend.CPU, threads=3
    )


@in_blender
def test_a_view_layer_overrides_the_number_of_passes() -> None:
    import bpy
    from photon_splat.blender.properties import render_settings

    made = stage.room(passes=6)
    del made.photon_splat["error_threshold"]
    layer, use = made.view_layers[0], {"IGNORE": 6, "BOUNDED": 6, "USE": 9}
    assert render_settings(made, layer).passes == 6
    layer.samples = 9
    for how, passes in use.items():
        made.cycles.use_layer_samples = how
        assert render_settings(made, layer).passes == passes
    layer.samples = 3
    other = made.view_layers.new("Other")
    with stage.watched() as results:
        bpy.ops.render.render()
    assert [result.statistics["passes"] for result in results] == [3, 6]
    made.photon_splat.property_unset("passes")
    assert render_settings(made, layer).error_threshold == 0.0
    assert render_settings(made, other).error_threshold > 0.0


@in_blender
def test_an_error_threshold_that_nobody_has_set_ends_no_render_with_another_limit() -> None:
    from photon_splat.blender.properties import render_settings

    group = stage.scene().photon_splat
    assert render_settings(stage.scene()).error_threshold == pytest.approx(0.045)
    group.time_limit = 3.0
    assert render_settings(stage.scene()).error_threshold == 0.0
    group.time_limit = 0.0
    group.passes = 4096
    assert render_settings(stage.scene()).error_threshold == 0.0
    group.error_threshold = 0.045
    assert render_settings(stage.scene()).error_threshold == pytest.approx(0.045)


@in_blender
def test_the_time_that_remains() -> None:
    from photon_splat.blender.job import remaining
    from photon_splat.core.render.result import Progress

    assert remaining(Progress(0.0, "", 0), 3.0) == "--:--"
    assert remaining(Progress(0.25, "", 4), 30.0) == "01:30"
    assert remaining(Progress(1.0, "", 4), 30.0) == "00:00"
    assert remaining(Progress(0.001, "", 1), 10.0) == "2:46:30"


@in_blender
def test_the_last_render_is_told_in_the_panel() -> None:
    import bpy
    from photon_splat.blender import job
    from photon_splat.blender.panels import report

    stage.room()
    stage.portal()
    # passes have as many photons
    job.observer.settings = lambda own: replace(
        own, adaptive_samples=False, adaptive_indirect=False
    )
    bpy.ops.render.render()
    last = job.last_renders["Scene"]
    assert "Light portals" in last.warnings[0]
    lines = list(report.statistics_lines(last.statistics))
    assert lines[0].startswith("2 passes in ")
    assert any(line.startswith("4,000 photons traced, ") for line in lines)
    with stage.replaced("render", _broken(ValueError("on purpose"))), pytest.raises(RuntimeError):
        bpy.ops.render.render()
    assert job.last_renders["Scene"].error == "on purpose"


@pytest.mark.parametrize(
    "kind", ["material", "object", "collection", "light", "world", "empty object"]
)
@in_blender
def test_previews(kind: str) -> None:
    """Blender renders the picture of an asset by the engine, too, on a scene of its own."""
    import bpy
    from photon_splat.blender import engine

    previews: list[bool] = []
    plain = engine.render_view_layer

    def keep(made: Any, depsgraph: Any) -> None:
        previews.append(made.is_preview)
        plain(made, depsgraph)

    stage.room()
    stage.world(1.0)
    red = stage.material("Red", (1, 0, 0))
    asset = {
        "material": red,
        "object": bpy.data.objects["Plane"],
        "collection": stage.scene().collection,
        "light": bpy.data.objects["POINT"].data,
        "world": stage.scene().world,
        "empty object": stage.add("Empty"),
    }[kind]
    engine.render_view_layer = keep
    try:
        asset.asset_generate_preview()
    finally:
        engine.render_view_layer = plain
    assert all(previews)
    if kind == "material":
        assert previews
        pixels = np.array(asset.preview.image_pixels_float[:]).reshape(-1, 4)
        assert pixels[:, 0].max() > 0.1
        assert pixels[:, 0].max() > pixels[:, 1].max()


@pytest.mark.smoke
@in_blender
def test_registering_twice_leaves_nothing() -> None:
    import bpy
    import photon_splat

    def traces() -> list[str]:
        kinds = (bpy.types.Panel, bpy.types.PropertyGroup, bpy.types.RenderEngine)
        classes = [cls for kind in kinds for cls in kind.__subclasses__() if cls.is_registered]
        found = [
            cls.__name__
            for cls in classes
            if "photon" in cls.__name__.lower()
            or "PHOTON_SPLAT" in getattr(cls, "COMPAT_ENGINES", ())
        ]
        found += [
            f"{kind.__name__}.photon_splat"
            for kind in (bpy.types.Scene, bpy.types.ViewLayer)
            if hasattr(kind, "photon_splat")
        ]
        return sorted(set(found))

    registered = traces()
    assert "PhotonSplatEngine" in registered
    assert "Scene.photon_splat" in registered
    try:
        for _ in range(2):
            photon_splat.unregister()
            assert traces() == []
            photon_splat.register()
            assert traces() == registered
    finally:
        if not hasattr(bpy.types.Scene, "photon_splat"):
            photon_splat.register()
    stage.room()
    bpy.ops.render.render()
