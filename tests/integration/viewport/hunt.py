"""Random edits, seeded, against a viewport that renders all the while."""

from __future__ import annotations

import random
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

from tests.support import stage
from tests.support.window import viewport


def hunt(seed: int, edits: int, told: Callable[[int], None] | None = None) -> Counter[str]:
    """How often each kind of edit was done; `told` gets the number of each. AssertionError
    where the viewport's scene is not the one there is.
    """
    import bpy
    from photon_splat.blender.viewport.live import NOWHERE
    from photon_splat.core.scene import Frame, same_geometry, same_shading
    from photon_splat.export import export_contents
    from photon_splat.export.report import Report

    chance = random.Random(seed)
    done: Counter[str] = Counter()
    with viewport(width=48, height=27) as v:
        for number in range(edits):
            name = chance.choice(list(EDITS))
            EDITS[name](chance)
            bpy.context.view_layer.update()
            done[name] += 1
            if told is not None:
                told(number)
            eye = np.eye(4)
            eye[:3, 3] = chance.uniform(-1, 1), chance.uniform(-1, 1), chance.uniform(3, 6)
            if chance.random() < 0.5:
                v.context.region_data.view_matrix = np.linalg.inv(eye).astype(np.float32)
            v.draw()
            time.sleep(chance.choice((0.0, 0.0, 0.005, 0.05)))
            graph = bpy.context.evaluated_depsgraph_get()
            fresh = export_contents(graph, NOWHERE, Frame(1, 1), Report())
            shown = v.live._scene
            assert shown is not None, v.live.error
            assert same_geometry(shown, fresh), f"geometry differs after edit {number}, {name}"
            assert same_shading(shown, fresh), f"shading differs after edit {number}, {name}"
            assert shown.warnings == fresh.warnings, f"warnings differ after edit {number}, {name}"
        picture = v.settle()
        assert np.isfinite(picture.pixels).all()
    return done


def _meshes() -> list[Any]:
    import bpy

    return [ob for ob in bpy.context.scene.objects if ob.type == "MESH"]


def _pick(chance: random.Random) -> Any:
    meshes = _meshes()
    return chance.choice(meshes) if meshes else stage.plane("Another", 0.5)


def _move(chance: random.Random) -> None:
    _pick(chance).location = [chance.uniform(-1, 1) for _ in range(3)]


def _scale(chance: random.Random) -> None:
    _pick(chance).scale = [chance.choice((1.0, 0.5, -1.0, 0.0, 2.0)) for _ in range(3)]


def _vertex(chance: random.Random) -> None:
    mesh = _pick(chance).data
    if len(mesh.vertices):
        mesh.vertices[chance.randrange(len(mesh.vertices))].co = [
            chance.uniform(-1, 1) for _ in range(3)
        ]
        mesh.update()


def _add(chance: random.Random) -> None:
    if len(_meshes()) < 8:
        stage.plane(
            f"Added{chance.randrange(100)}",
            chance.uniform(0.1, 1),
            location=[chance.uniform(-1, 1) for _ in range(3)],
        )


def _remove(chance: random.Random) -> None:
    import bpy

    if len(_meshes()) > 1:
        bpy.data.objects.remove(_pick(chance))


def _remove_data(chance: random.Random) -> None:
    import bpy

    mesh = _pick(chance).data
    bpy.data.meshes.remove(mesh)


def _duplicate(chance: random.Random) -> None:
    ob = _pick(chance)
    if len(_meshes()) < 8:
        stage.add("Linked", ob.data, [chance.uniform(-1, 1) for _ in range(3)])


def _hide(chance: random.Random) -> None:
    ob = _pick(chance)
    ob.hide_viewport = not ob.hide_viewport


def _modifier(chance: random.Random) -> None:
    ob = _pick(chance)
    if ob.modifiers:
        ob.modifiers.clear()
    else:
        kind = chance.choice(("MIRROR", "ARRAY", "SUBSURF", "SOLIDIFY", "TRIANGULATE"))
        ob.modifiers.new(kind, kind)


def _color(chance: random.Random) -> None:
    import bpy

    for material in chance.sample(list(bpy.data.materials), min(1, len(bpy.data.materials))):
        for node in material.node_tree.nodes:
            if node.type == "BSDF_DIFFUSE":
                node.inputs["Color"].default_value = (*(chance.random() for _ in range(3)), 1.0)


def _assign(chance: random.Random) -> None:
    mesh = _pick(chance).data
    mesh.materials.append(
        stage.material(f"New{chance.randrange(100)}", [chance.random() for _ in range(3)])
    )


def _shine(chance: random.Random) -> None:
    mesh = _pick(chance).data
    mesh.materials.clear()
    mesh.materials.append(stage.material("Shine", (1, 1, 1), "ShaderNodeEmission"))


def _energy(chance: random.Random) -> None:
    import bpy

    for light in bpy.data.lights:
        light.energy = chance.uniform(0, 200)


def _lamp(chance: random.Random) -> None:
    import bpy

    lamps = [ob for ob in bpy.context.scene.objects if ob.type == "LIGHT"]
    if len(lamps) > 3:
        bpy.data.objects.remove(lamps[0])
    else:
        stage.lamp(
            chance.choice(("POINT", "SUN", "SPOT", "AREA")),
            chance.uniform(1, 50),
            [chance.uniform(-1, 2) for _ in range(3)],
        )


def _world(chance: random.Random) -> None:
    import bpy

    if bpy.context.scene.world is None or chance.random() < 0.3:
        stage.world(chance.random())
    else:
        background = bpy.context.scene.world.node_tree.nodes["Background"]
        background.inputs["Color"].default_value = (*(chance.random() for _ in range(3)), 1.0)


def _settings(chance: random.Random) -> None:
    import bpy

    group = bpy.context.scene.photon_splat
    group.max_bounces = chance.choice((0, 1, 8, 32))
    group.viewport_photons_per_pass = chance.choice((0, 1, 1000, 5000))


def _frame(chance: random.Random) -> None:
    import bpy

    bpy.context.scene.frame_set(chance.randrange(1, 50))


def _mode(chance: random.Random) -> None:
    import bpy

    ob = _pick(chance)
    if ob.hide_viewport:
        return
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    if len(ob.data.polygons) < 200:
        bpy.ops.mesh.subdivide()
    bpy.context.view_layer.update()
    bpy.ops.object.mode_set(mode="OBJECT")


def _hair(chance: random.Random) -> None:
    """Particles that are shown as hair, or none."""
    import bpy

    ob = _pick(chance)
    if ob.particle_systems:
        ob.modifiers.clear()
        return
    bpy.context.view_layer.objects.active = ob
    ob.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = ob.particle_systems[-1].settings
    settings.type, settings.count, settings.hair_length = "HAIR", 20, 0.3


def _displace(chance: random.Random) -> None:
    """A material that moves its surface by noise."""
    mesh = _pick(chance).data
    material = stage.material(f"Moved{chance.randrange(100)}")
    tree = material.node_tree
    node, noise = tree.nodes.new("ShaderNodeDisplacement"), tree.nodes.new("ShaderNodeTexNoise")
    node.inputs["Scale"].default_value = chance.uniform(-0.5, 0.5)
    tree.links.new(noise.outputs[0], node.inputs["Height"])
    output = next(one for one in tree.nodes if one.type == "OUTPUT_MATERIAL")
    tree.links.new(node.outputs[0], output.inputs["Displacement"])
    material.displacement_method = chance.choice(("DISPLACEMENT", "BOTH"))
    mesh.materials.clear()
    mesh.materials.append(material)


def _dice(chance: random.Random) -> None:
    """Adaptive subdivision, in a Blender that has it in its modifier."""
    modifier = _pick(chance).modifiers.new("Adaptive", "SUBSURF")
    if hasattr(modifier, "use_adaptive_subdivision"):
        modifier.use_adaptive_subdivision = True
        modifier.subdivision_type = chance.choice(("SIMPLE", "CATMULL_CLARK"))
        modifier.levels = chance.randrange(3)


def _moving(chance: random.Random) -> None:
    """An animation, and motion blur, which viewports do not show."""
    import bpy

    ob = _pick(chance)
    for frame in (1, 50):
        ob.location = [chance.uniform(-1, 1) for _ in range(3)]
        ob.keyframe_insert("location", frame=frame)
    bpy.context.scene.render.use_motion_blur = chance.random() < 0.5


EDITS: dict[str, Callable[[random.Random], None]] = {
    "move": _move,
    "scale": _scale,
    "vertex": _vertex,
    "add": _add,
    "remove": _remove,
    "remove data": _remove_data,
    "duplicate": _duplicate,
    "hide": _hide,
    "modifier": _modifier,
    "color": _color,
    "assign": _assign,
    "shine": _shine,
    "energy": _energy,
    "lamp": _lamp,
    "world": _world,
    "settings": _settings,
    "frame": _frame,
    "edit mode": _mode,
    "hair": _hair,
    "displace": _displace,
    "dice": _dice,
    "moving": _moving,
}
