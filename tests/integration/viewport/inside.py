"""Runs inside a Blender with a window: works in Rendered shading as a user does, and writes down
what happened.

blender --python inside.py -- ARCHIVE_MODULE SCENE OTHER_SCENE OUTPUT_FOLDER EDITS HUNT
Writes OUTPUT_FOLDER/result.json and pictures; ends Blender. No test framework is here.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import math
import os
import random
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

MODULE, SCENE, OTHER, FOLDER = sys.argv[sys.argv.index("--") + 1 :][:4]
EDITS, HUNT = (int(text) for text in sys.argv[sys.argv.index("--") + 5 :][:2])
LONGEST_WAIT = 60.0
TICK = 0.004

result: dict[str, Any] = {"version": bpy.app.version_string, "steps": []}


def lives() -> list[Any]:
    return importlib.import_module(f"{MODULE}.blender.viewport.live").lives  # type: ignore[no-any-return]


def live() -> Any:
    return lives()[-1]


def area() -> Any:
    return next(
        area
        for area in bpy.context.window_manager.windows[0].screen.areas
        if area.type == "VIEW_3D"
    )


def space() -> Any:
    return area().spaces.active


def in_window(call: Callable[..., Any], *given: Any, **named: Any) -> Any:
    """Calls an operator as if the mouse were over the viewport."""
    window = bpy.context.window_manager.windows[0]
    region = next(region for region in area().regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, screen=window.screen, area=area(), region=region):
        return call(*given, **named)


def screenshot(name: str) -> None:
    subprocess.run(["import", "-window", "root", f"{FOLDER}/{name}.png"], check=True)


def resident() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def photon_threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if "viewport" in thread.name]


def until(condition: Callable[[], bool], what: str) -> Iterator[float]:
    """Waits for something."""
    deadline = time.monotonic() + LONGEST_WAIT
    while not condition():
        if time.monotonic() > deadline:
            state = [
                (each.controller.status(), each.error, each.controller.counts) for each in lives()
            ]
            raise AssertionError(f"not within {LONGEST_WAIT} s: {what}; {state}")
        yield TICK


def settled() -> bool:
    """The last picture of what there is has been drawn."""
    return (
        bool(lives())
        and live().controller.idle
        and number() > 0
        and live().canvas.number == number()
    )


def number() -> int:
    picture = live().controller.picture() if lives() else None
    return picture.number if picture else 0


def quiet() -> None:
    """No overlays, few passes: what is seen is the picture alone."""
    scene = bpy.context.scene
    scene.render.engine = "PHOTON_SPLAT"
    scene.photon_splat.viewport_passes = 4
    scene.photon_splat.backend = "CPU"
    space().overlay.show_overlays = space().show_gizmo = False
    space().show_region_header = space().show_region_toolbar = space().show_region_ui = False


def steps() -> Iterator[float]:
    for step in (
        same_as_a_render,
        orbit,
        others_orbit,
        edits,
        undo,
        other_states,
        render_and_cancel,
        two_viewports,
        extension,
        hunt,
        other_file,
    ):
        began = time.monotonic()
        yield from step()
        result["steps"].append([step.__name__, round(time.monotonic() - began, 2)])


def same_as_a_render() -> Iterator[float]:
    """The refined camera view, as the window shows it, and the F12 picture of the same view."""
    quiet()
    space().shading.type = "RENDERED"
    space().region_3d.view_perspective = "CAMERA"
    scene = bpy.context.scene
    scene.photon_splat.viewport_passes = 32
    scene.camera.data.passepartout_alpha = 0.0
    yield from until(
        lambda: bool(lives()) and live().controller.picture() is not None, "the first picture"
    )
    yield 0.3
    yield from until(settled, "the refined picture")
    yield 0.5
    screenshot("camera")
    region = next(region for region in area().regions if region.type == "WINDOW")
    view = live().controller.picture().view
    left, right = view.camera.screen[:2]
    render = scene.render
    # The same view as a render: the camera's frame is made the region's.
    result["region"] = [region.x, region.y, region.width, region.height]
    kept = (
        render.resolution_x,
        render.resolution_y,
        scene.camera.data.lens,
        scene.camera.data.sensor_fit,
    )
    render.resolution_x, render.resolution_y, render.resolution_percentage = (
        region.width,
        region.height,
        100,
    )
    scene.camera.data.sensor_fit = "HORIZONTAL"
    scene.camera.data.lens = scene.camera.data.sensor_width / (right - left)
    (
        scene.photon_splat.passes,
        scene.photon_splat.photons_per_pass,
        scene.photon_splat.time_limit,
    ) = 32, 100_000, 0.0
    render.filepath = f"{FOLDER}/render.png"
    bpy.ops.render.render(write_still=True)
    (
        render.resolution_x,
        render.resolution_y,
        scene.camera.data.lens,
        scene.camera.data.sensor_fit,
    ) = kept
    scene.photon_splat.viewport_passes = 4
    space().region_3d.view_perspective = "PERSP"
    yield 0.1


def orbit() -> Iterator[float]:
    """Turns the view; counts pictures and photons."""
    view = space().region_3d
    view.view_distance, view.view_location = (
        3.2,
        (0.0, 0.0, 1.0) if "cornell" in SCENE else (0.0, 0.0, 0.0),
    )
    yield 1.0
    yield from until(settled, "the refined picture")
    yield 0.2
    from mathutils import Euler

    def turn(angle: float) -> None:
        view.view_rotation = Euler((math.radians(80), 0.0, 0.3 * math.sin(angle))).to_quaternion()

    traced, first = live().controller.counts.photon_paths, number()
    began, angle, draws = time.monotonic(), 0.0, []
    while time.monotonic() - began < 4.0:
        angle += 0.02
        turn(angle)
        draws.append(live().seconds["draw"])
        yield 0.01
    seconds, moving = time.monotonic() - began, live().controller.picture()
    result["orbit"] = {
        "updates per second": (number() - first) / seconds,
        "step": moving.step,
        "photons traced": live().controller.counts.photon_paths - traced,
        "draw": {"median": sorted(draws)[len(draws) // 2], "most": max(draws)},
        "picture": live().controller.counts.seconds["moving"],
    }
    screenshot("orbit")
    before = live().controller.picture().view
    turn(angle + 0.02)
    while (picture := live().controller.picture()).moving or picture.view == before:
        if picture.moving:
            moving = picture
        yield TICK
    bpy.context.scene.photon_splat.viewport_passes = 64
    yield 0.3
    yield from until(settled, "the refined picture of the last view")
    finished = live().controller.picture()
    assert finished.view == moving.view
    result["orbit"]["difference"] = difference(moving, finished)
    screenshot("orbit_finished")
    bpy.context.scene.photon_splat.viewport_passes = 4
    yield 0.1


def difference(moving: Any, finished: Any) -> float:
    """Mean absolute difference of a coarse picture to the finished one, as 8-bit values."""
    step, (height, width) = moving.step, moving.pixels.shape[:2]
    rows, columns = height * step - len(finished.pixels), width * step - finished.pixels.shape[1]
    whole = np.pad(finished.pixels[..., :3], ((0, rows), (0, columns), (0, 0)), mode="edge")
    means = whole.reshape(height, step, width, step, 3).mean((1, 3))
    shown, wanted = (
        255 * np.clip(pixels, 0, 1) ** (1 / 2.2) for pixels in (moving.pixels[..., :3], means)
    )
    return float(np.abs(shown - wanted).mean())


def others_orbit() -> Iterator[float]:
    """The same turns without this engine: what the window itself costs on this machine, and with
    Cycles.
    """
    from mathutils import Euler

    view, scene = space().region_3d, bpy.context.scene
    result["others"] = {}
    for name in ("SOLID", "CYCLES"):
        if name == "SOLID":
            space().shading.type = "SOLID"
        else:
            scene.render.engine, space().shading.type = name, "RENDERED"
        yield 1.0
        drawn: list[float] = []
        handler = bpy.types.SpaceView3D.draw_handler_add(
            lambda times: times.append(time.monotonic()), (drawn,), "WINDOW", "POST_PIXEL"
        )
        stalls, began, angle = [], time.monotonic(), 0.0
        last = began
        while time.monotonic() - began < 3.0:
            angle += 0.02
            view.view_rotation = Euler(
                (math.radians(80), 0.0, 0.3 * math.sin(angle))
            ).to_quaternion()
            yield TICK
            now = time.monotonic()
            stalls.append(now - last - TICK)
            last = now
        bpy.types.SpaceView3D.draw_handler_remove(handler, "WINDOW")
        result["others"][name] = {
            "redraws per second": len(drawn) / 3.0,
            "stall": sorted(stalls)[len(stalls) // 2],
        }
    scene.render.engine, space().shading.type = "PHOTON_SPLAT", "RENDERED"
    yield from until(settled, "the picture after other engines")


def edits() -> Iterator[float]:
    """Edits of each kind: time to the first picture, and what Blender's thread was held up by."""
    yield from until(settled, "the refined picture")
    chance = random.Random(0)
    meshes = [ob for ob in bpy.context.scene.objects if ob.type == "MESH"]
    light = bpy.data.lights.new("Edited", "POINT")
    bpy.context.collection.objects.link(bpy.data.objects.new("Edited", light))
    times: dict[str, list[float]] = {"light": [], "material": [], "move": [], "mesh": []}
    seen: list[float] = []
    exports: list[float] = []
    stalls: list[float] = []
    memory = []
    for k in range(EDITS):
        kind = list(times)[k % len(times)]
        before, began = number(), time.monotonic()
        if kind == "light":
            light.energy = chance.uniform(1, 20)
        elif kind == "material":
            material = chance.choice([m for m in bpy.data.materials if m.node_tree])
            for node in material.node_tree.nodes:
                for socket in node.inputs:
                    if socket.name in {"Base Color", "Color"}:
                        socket.default_value = (*(chance.random() for _ in range(3)), 1.0)
        elif kind == "move":
            meshes[k % len(meshes)].location.x += chance.uniform(-0.01, 0.01)
        else:
            mesh = meshes[k % len(meshes)].data
            mesh.vertices[0].co.x += chance.uniform(-0.01, 0.01)
            mesh.update()
        last = time.monotonic()
        while number() == before and time.monotonic() - began < 10.0:
            yield TICK
            now = time.monotonic()
            stalls.append(now - last - TICK)
            last = now
        times[kind].append(live().controller.picture().made - began)
        seen.append(time.monotonic() - began)
        exports.append(live().seconds["export"])
        if k % 10 == 0:
            memory.append(resident())
        yield chance.choice((TICK, 0.05, 0.2))
    if EDITS:
        result["edits"] = {
            kind: sorted(values)[len(values) // 2] for kind, values in times.items() if values
        }
        result["seen by Blender's thread"] = sorted(seen)[len(seen) // 2]
        result["export"] = sorted(exports)[len(exports) // 2]
        result["stall"] = {
            "median": sorted(stalls)[len(stalls) // 2],
            "95 %": sorted(stalls)[int(0.95 * len(stalls))],
            "most": max(stalls),
        }
        result["memory"] = [memory[len(memory) // 4], memory[-1]]
    screenshot("edited")
    yield 0.1


def undo() -> Iterator[float]:
    ob = next(ob for ob in bpy.context.scene.objects if ob.type == "MESH")
    name, place = ob.name, ob.location.x
    in_window(bpy.ops.ed.undo_push, message="before")
    for k in range(5):
        bpy.data.objects[name].location.x += 0.1
        in_window(bpy.ops.ed.undo_push, message="move")
        yield 0.05 * k
    for _ in range(5):
        in_window(bpy.ops.ed.undo)
        yield 0.05
    assert abs(bpy.data.objects[name].location.x - place) < 1e-5
    yield from until(settled, "the picture after undo")
    in_window(bpy.ops.ed.redo)
    yield 0.05
    in_window(bpy.ops.ed.undo)
    yield from until(settled, "the picture after redo")


def other_states() -> Iterator[float]:
    """Modes, shadings, engines, local view, border, orthographic and axis views, while it
    renders.
    """
    ob = next(ob for ob in bpy.context.scene.objects if ob.type == "MESH")
    bpy.context.view_layer.objects.active = ob
    ob.select_set(True)
    for mode in ("EDIT", "OBJECT", "SCULPT", "OBJECT", "WEIGHT_PAINT", "OBJECT"):
        in_window(bpy.ops.object.mode_set, mode=mode)
        yield 0.05
    for _ in range(4):
        for shading in ("SOLID", "RENDERED", "MATERIAL", "RENDERED", "WIREFRAME", "RENDERED"):
            space().shading.type = shading
            yield random.Random(1).choice((TICK, 0.03))
    space().shading.type = "SOLID"
    yield from until(
        lambda: not lives() and not photon_threads(), "the end of the threads after Solid shading"
    )
    space().shading.type = "RENDERED"
    yield from until(settled, "the picture after Solid shading")
    for engine in ("BLENDER_WORKBENCH", "PHOTON_SPLAT", "CYCLES", "PHOTON_SPLAT"):
        bpy.context.scene.render.engine = engine
        yield 0.2
    yield from until(
        lambda: len(lives()) == 1 and settled(), "the picture after the engine was changed"
    )
    in_window(bpy.ops.view3d.localview)
    yield from until(settled, "the picture of a local view")
    screenshot("local_view")
    in_window(bpy.ops.view3d.localview)
    space().use_render_border = True
    space().render_border_min_x, space().render_border_max_x = 0.3, 0.7
    space().render_border_min_y, space().render_border_max_y = 0.2, 0.6
    yield 0.3
    yield from until(settled, "the picture of a border")
    screenshot("border")
    space().use_render_border = False
    for axis in ("TOP", "FRONT"):
        in_window(bpy.ops.view3d.view_axis, type=axis)
        yield 0.5
        yield from until(settled, "the picture of an axis")
        screenshot(f"axis_{axis.lower()}")
    bpy.context.scene.render.film_transparent = True
    yield 0.5
    yield from until(settled, "the transparent picture")
    screenshot("transparent")
    bpy.context.scene.render.film_transparent = False


def render_and_cancel() -> Iterator[float]:
    """F12 in a window of its own; Escape ends it and keeps what is there."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 320, 200
    scene.photon_splat.passes = 100_000
    scene.render.filepath = f"{FOLDER}/cancelled.png"
    yield from until(settled, "the picture before F12")
    in_window(bpy.ops.render.render, "INVOKE_DEFAULT")
    yield 2.5
    screenshot("rendering")
    result["rendering"] = bool(bpy.app.is_job_running("RENDER"))
    for _ in range(10):
        if not bpy.app.is_job_running("RENDER"):
            break
        found = subprocess.run(
            ["xdotool", "search", "--class", "blender"], capture_output=True, text=True, check=False
        ).stdout.split()
        for window in found:
            subprocess.run(["xdotool", "key", "--window", window, "Escape"], check=False)
        yield 0.5
    result["cancelled"] = not bpy.app.is_job_running("RENDER")
    yield 0.5
    screenshot("cancelled")
    image = bpy.data.images.get("Render Result")
    image.save_render(f"{FOLDER}/cancelled.png")
    scene.photon_splat.passes = 4
    for window in list(bpy.context.window_manager.windows)[1:]:
        with bpy.context.temp_override(window=window):
            bpy.ops.wm.window_close()
    yield 0.5
    yield from until(settled, "the picture after F12")


def two_viewports() -> Iterator[float]:
    in_window(bpy.ops.screen.area_split, direction="VERTICAL", factor=0.5)
    yield 0.3
    areas = [
        area
        for area in bpy.context.window_manager.windows[0].screen.areas
        if area.type == "VIEW_3D"
    ]
    for each in areas:
        each.spaces.active.shading.type = "RENDERED"
    yield 0.3
    yield from until(
        lambda: len(lives()) == len(areas) and all(each.controller.idle for each in lives()),
        "two viewports",
    )
    screenshot("two_viewports")
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, screen=window.screen, area=areas[-1]):
        bpy.ops.screen.area_close()
    yield from until(
        lambda: len(lives()) == 1 and len(photon_threads()) == 1,
        "the end of the closed viewport's thread",
    )


def extension() -> Iterator[float]:
    """Disabled while it renders, and enabled again."""
    bpy.ops.preferences.addon_disable(module=MODULE)
    yield 0.2
    assert not photon_threads(), photon_threads()
    assert not hasattr(bpy.context.scene, "photon_splat")
    bpy.ops.preferences.addon_enable(module=MODULE)
    bpy.context.scene.render.engine = "PHOTON_SPLAT"
    quiet()
    space().shading.type = "RENDERED"
    yield 0.2
    yield from until(settled, "the picture after the extension was enabled")


def hunt() -> Iterator[float]:
    """Random edits, faster than they are rendered."""
    chance = random.Random(7)
    bpy.context.scene.photon_splat.viewport_passes = 4
    before, counts = resident(), {}
    for _ in range(HUNT):
        meshes = [ob for ob in bpy.context.scene.objects if ob.type == "MESH"]
        name = chance.choice(
            (
                "move",
                "vertex",
                "add",
                "remove",
                "color",
                "light",
                "view",
                "shading",
                "undo",
                "mode",
                "hide",
                "modifier",
                "frame",
            )
        )
        counts[name] = counts.get(name, 0) + 1
        ob = chance.choice(meshes) if meshes else None
        if name == "move" and ob:
            ob.location = [chance.uniform(-1, 1) for _ in range(3)]
        elif name == "vertex" and ob and len(ob.data.vertices):
            ob.data.vertices[0].co = [chance.uniform(-1, 1) for _ in range(3)]
            ob.data.update()
        elif name == "add" and len(meshes) < 12:
            in_window(
                bpy.ops.mesh.primitive_cube_add,
                size=0.3,
                location=[chance.uniform(-1, 1) for _ in range(3)],
            )
        elif name == "remove" and len(meshes) > 3:
            bpy.data.objects.remove(ob)
        elif name == "color":
            for material in bpy.data.materials:
                material.diffuse_color = [chance.random() for _ in range(4)]
                for node in material.node_tree.nodes if material.node_tree else ():
                    if node.type == "BSDF_DIFFUSE":
                        node.inputs["Color"].default_value = (
                            *(chance.random() for _ in range(3)),
                            1.0,
                        )
        elif name == "light":
            for light in bpy.data.lights:
                light.energy = chance.uniform(0, 30)
        elif name == "view":
            space().region_3d.view_rotation = [chance.uniform(-1, 1) for _ in range(4)]
        elif name == "shading":
            space().shading.type = chance.choice(("SOLID", "RENDERED", "RENDERED"))
        elif name == "undo":
            operator = chance.choice((bpy.ops.ed.undo_push, bpy.ops.ed.undo))
            if in_window(operator.poll):
                in_window(operator)
        elif name == "mode" and ob and not ob.hide_viewport and not ob.hide_get():
            bpy.context.view_layer.objects.active = ob
            in_window(bpy.ops.object.mode_set, mode="EDIT")
            yield TICK
            in_window(bpy.ops.object.mode_set, mode="OBJECT")
        elif name == "hide" and ob:
            ob.hide_viewport = not ob.hide_viewport
        elif name == "modifier" and ob:
            if len(ob.modifiers):
                ob.modifiers.clear()
            else:
                ob.modifiers.new("M", chance.choice(("MIRROR", "SOLIDIFY", "BEVEL")))
        elif name == "frame":
            bpy.context.scene.frame_set(chance.randrange(1, 20))
        yield chance.choice((TICK, TICK, 0.03, 0.1))
    space().shading.type = "RENDERED"
    yield 0.2
    yield from until(settled, "the picture after the hunt")
    result["hunt"] = {
        "edits": HUNT,
        "threads": len(photon_threads()),
        "memory": [before, resident()],
    } | {"kinds": counts}
    screenshot("hunted")


def other_file() -> Iterator[float]:
    bpy.ops.wm.open_mainfile(filepath=OTHER, load_ui=False)
    yield 0.3
    quiet()
    space().shading.type = "RENDERED"
    space().region_3d.view_perspective = "CAMERA"
    yield 0.3
    yield from until(settled, "the picture of another file")
    assert len(photon_threads()) == 1
    screenshot("other_file")


def finish(error: str = "") -> None:
    result["error"] = error
    if error:
        with contextlib.suppress(OSError):
            screenshot("failed")
    Path(FOLDER, "result.json").write_text(json.dumps(result, indent=1))
    bpy.ops.wm.quit_blender()


walk = None


def tick() -> float | None:
    global walk
    try:
        walk = walk or steps()
        return next(walk)
    except StopIteration:
        finish()
    except BaseException:
        finish(traceback.format_exc())
    return None


bpy.context.preferences.view.show_splash = False
bpy.ops.wm.open_mainfile(filepath=SCENE, load_ui=False)
bpy.app.timers.register(tick, first_interval=1.0, persistent=True)
