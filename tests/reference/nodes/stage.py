"""A board of small things, each with its own material, seen from above: what many node trees give,
in one picture.

Runs inside Blender. Every case has a cell of the board of 1 m and PIXELS x PIXELS pixels, with a
plane or a sphere on it whose colour is emitted. Cycles renders it with one sample in the middle of
every pixel; our programs run at the same points.
"""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from tests.reference.nodes.cases import Case

PIXELS = 32
SHIFT = 64.0  # is added to what is emitted, so that nothing is negative


def build(cases: list[Case]) -> None:
    """The board, in an empty file."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    side = board(len(cases))
    things = {"plane": _plane(), "sphere": _sphere(), "bumps": _bumps()}
    things |= {"hexagons": _hexagons(), "bare": _bare(), "hollow": _hollow()}
    for k, case in enumerate(cases):
        ob = bpy.data.objects.new(case.name, things[case.thing].copy())
        ob.location = (k % side + 0.5, k // side + 0.5, 0.0)
        if case.thing in {"sphere", "bare", "hollow"}:
            ob.rotation_euler, ob.scale = (0.3, 0.5, 0.7), (1.0, 0.9, 1.1)
        ob.color, ob.pass_index = (0.25, 0.5, 0.75, 0.5), 3
        ob["own"] = 0.375
        ob.data["own_vector"] = (0.25, 0.5, 1.0)
        scene.collection.objects.link(ob)
        ob.data.materials.append(_material(case))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", side
    camera.location = (side / 2, side / 2, 5.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = side * PIXELS
    scene.render.resolution_percentage = 100
    bpy.context.view_layer.update()


def board(count: int) -> int:
    """Cells along an edge of the board."""
    return max(math.ceil(math.sqrt(count)), 1)


def cell(picture: np.ndarray, k: int) -> np.ndarray:
    """(PIXELS, PIXELS, C) of case k of a board's picture (row 0 at the bottom)."""
    side = picture.shape[0] // PIXELS
    x, y = (k % side) * PIXELS, (k // side) * PIXELS
    return picture[y : y + PIXELS, x : x + PIXELS]


def _plane() -> Any:
    import bpy

    # Three by five pieces: no diagonal runs through pixels' centres all along.
    columns, rows = 3, 5
    vertices = [
        (i / columns - 0.5, j / rows - 0.5, 0.0)
        for j in range(rows + 1)
        for i in range(columns + 1)
    ]
    first = [j * (columns + 1) + i for j in range(rows) for i in range(columns)]
    faces = [
        face
        for a in first
        for face in ((a, a + 1, a + columns + 2), (a, a + columns + 2, a + columns + 1))
    ]
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata(vertices, [], faces)
    _layers(mesh, lambda v: (v.co.x + 0.5, v.co.y + 0.5))
    return mesh


def _bumps() -> Any:
    """Ridges and grooves of two sheets that share the places of a row of vertices, without being
    joined there.
    """
    import bpy

    vertices: list[tuple[float, float, float]] = []
    faces = []
    for first in (0, 4):
        start = len(vertices)
        places = [(i, j) for j in range(9) for i in range(first, first + 5)]
        vertices += [
            (i / 8 - 0.5, j / 8 - 0.5, 0.2 * math.sin(2.1 * i) * math.cos(1.3 * j))
            for i, j in places
        ]
        corners = [start + 5 * j + i for j in range(8) for i in range(4)]
        faces += [(a, a + 1, a + 6, a + 5) for a in corners]
    mesh = bpy.data.meshes.new("Bumps")
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    _layers(mesh, lambda v: (v.co.x + 0.5, v.co.y + 0.5))
    return mesh


def _hexagons() -> Any:
    """A smooth sheet of four faces, bent, of six corners each."""
    import bpy

    places = [(i, j) for j in range(5) for i in range(3)]
    vertices = [(i / 2 - 0.5, j / 4 - 0.5, 0.2 * math.sin(2.1 * i + 1.3 * j)) for i, j in places]
    rows = range(0, 12, 3)
    faces = [(a, a + 1, a + 2, a + 5, a + 4, a + 3) for a in rows]
    mesh = bpy.data.meshes.new("Hexagons")
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    _layers(mesh, lambda v: (v.co.x + 0.5 + 0.3 * v.co.y * v.co.y, v.co.y + 0.5))
    return mesh


def _bare() -> Any:
    """The sphere without UV maps, its poles where one hardly looks."""
    import mathutils

    mesh = _sphere()
    mesh.transform(mathutils.Matrix.Rotation(0.4, 4, "Y"))
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    return mesh


def _sphere() -> Any:
    import bmesh
    import bpy

    mesh = bpy.data.meshes.new("Sphere")
    made = bmesh.new()
    bmesh.ops.create_icosphere(made, subdivisions=3, radius=0.45)
    made.to_mesh(mesh)
    made.free()
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    _layers(mesh, lambda v: (v.co.x * 0.8 + 0.5, v.co.y * 0.7 + 0.3 * v.co.z + 0.5))
    return mesh


def _hollow() -> Any:
    """A sphere whose faces look inwards: their backs are seen."""
    mesh = _sphere()
    mesh.flip_normals()
    return mesh


def _layers(mesh: Any, uv: Any) -> None:
    """Two UV maps, two colour attributes and attributes of every domain."""
    for name in ("First", "Second"):
        mesh.uv_layers.new(name=name)
    mesh.color_attributes.new("Bytes", "BYTE_COLOR", "CORNER")
    mesh.color_attributes.new("Floats", "FLOAT_COLOR", "POINT")
    kinds = {
        "Number": ("FLOAT", "POINT"),
        "Where": ("FLOAT_VECTOR", "CORNER"),
        "Whole": ("INT", "FACE"),
        "Edge": ("FLOAT", "EDGE"),
    }
    kinds |= {"Flag": ("BOOLEAN", "FACE"), "Pair": ("FLOAT2", "POINT")}
    for name, (kind, domain) in kinds.items():
        mesh.attributes.new(name, kind, domain)
    # A new layer may move the ones that are there.
    first, second = (mesh.uv_layers[name] for name in ("First", "Second"))
    corners, floats = mesh.attributes["Bytes"], mesh.attributes["Floats"]
    number, where, whole, edge, flag, pair = (mesh.attributes[name] for name in kinds)
    for loop in mesh.loops:
        v = mesh.vertices[loop.vertex_index]
        x, y = uv(v)
        first.uv[loop.index].vector = (x, y)
        second.uv[loop.index].vector = (y * 0.9 + 0.05, 1.0 - x)
        corners.data[loop.index].color = (
            abs(x) % 1.0,
            abs(y) % 1.0,
            0.3,
            0.5 + 0.4 * (loop.index % 2),
        )
        where.data[loop.index].vector = (x, x * y, -y)
    for v in mesh.vertices:
        x, y = uv(v)
        floats.data[v.index].color = (x * 2.0, y, 0.1, 0.7)
        number.data[v.index].value = x - y
        pair.data[v.index].vector = (y, x)
    for polygon in mesh.polygons:
        whole.data[polygon.index].value = polygon.index % 5 - 2
        flag.data[polygon.index].value = polygon.index % 3 == 0
    for line in mesh.edges:
        edge.data[line.index].value = (line.index % 7) / 7.0
    _edge_layers(mesh)
    mesh.color_attributes.render_color_index = 0


def _edge_layers(mesh: Any) -> None:
    """Attributes of edges, which are mixed at vertices, each kind in its own way."""
    rows = np.arange(len(mesh.edges))
    color = np.stack([(rows * k % 11) / 11.0 for k in (1, 3, 5, 7)], axis=1)
    turned = np.stack([np.cos(rows), np.sin(rows) * 0.6, np.sin(rows) * 0.8, 0 * rows], axis=1)
    for kind, field, values in (
        ("BOOLEAN", "value", rows % 5 == 0),
        ("INT", "value", rows % 8 - 3),
        ("INT8", "value", rows % 8 - 3),
        ("BYTE_COLOR", "color", color),
        ("FLOAT_COLOR", "color", color),
        ("QUATERNION", "value", turned),
    ):
        layer = mesh.attributes.new(f"Edge {kind}", kind, "EDGE")
        layer.data.foreach_set(field, values.ravel())


def _material(case: Case) -> Any:
    import bpy

    made = bpy.data.materials.new(case.name)
    made.pass_index = 7
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    output, emission = (
        tree.nodes.new("ShaderNodeOutputMaterial"),
        tree.nodes.new("ShaderNodeEmission"),
    )
    shifted = tree.nodes.new("ShaderNodeVectorMath")
    shifted.inputs[1].default_value = (SHIFT, SHIFT, SHIFT)
    tree.links.new(shifted.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    tree.links.new(case.make(tree), shifted.inputs[0])
    return made


def cycles() -> tuple[np.ndarray, np.ndarray]:
    """The board as Cycles renders it, without the shift, and where its samples hit: (height, width,
    3) each, row 0 at the bottom.
    """
    import bpy

    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    settings = scene.cycles
    settings.device, settings.samples, settings.seed = "CPU", 1, 0
    settings.use_adaptive_sampling = settings.use_denoising = False
    settings.sample_clamp_direct = settings.sample_clamp_indirect = 0.0
    settings.pixel_filter_type, settings.filter_width = "BOX", 0.01
    settings.max_bounces = 0
    picture = _rendered() - SHIFT
    where = bpy.data.materials.new("Where")
    if bpy.app.version < (5, 0, 0):
        where.use_nodes = True
    tree = where.node_tree
    tree.nodes.clear()
    output, emission, geometry = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("OutputMaterial", "Emission", "NewGeometry")
    )
    tree.links.new(geometry.outputs["Position"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    layer = scene.view_layers[0]
    layer.material_override = where
    positions = _rendered()
    layer.material_override = None
    return picture, positions


def _rendered() -> np.ndarray:
    import bpy

    render = bpy.context.scene.render
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth, render.image_settings.color_mode = "32", "RGBA"
    with tempfile.TemporaryDirectory() as folder:
        render.filepath = str(Path(folder, "board.exr"))
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(render.filepath)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        size = tuple(image.size)
        bpy.data.images.remove(image)
    return pixels.reshape(size[1], size[0], -1)[..., :3].astype(np.float64)


def ours(positions: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """What our programs emit at `positions` (black where there is nothing), and the exporter's
    warnings.
    """
    import bpy
    from photon_splat.core.native import library as native
    from photon_splat.core.native.bounds import world_bounds
    from photon_splat.core.native.fill import fill_renderer
    from photon_splat.core.render.settings import RenderSettings
    from photon_splat.export import export_scene, materials

    plain = materials._sides
    materials._sides = lambda *_: None  # everything as a program
    try:
        scene = export_scene(bpy.context.evaluated_depsgraph_get())
    finally:
        materials._sides = plain
    renderer = native.load().Renderer(0)
    fill_renderer(renderer, scene, RenderSettings())
    renderer.build()
    origin = world_bounds(scene).mean(axis=0)
    height, width = positions.shape[:2]
    points = positions.reshape(-1, 3).copy()
    nothing = ~points.any(axis=1)
    points[:, 2] = scene.camera.matrix[2, 3]
    down = np.tile(np.array([[0.0, 0.0, -1.0]], np.float32), (len(points), 1))
    left, right, *_ = scene.camera.screen
    found = renderer.shade_rays(
        (points - origin).astype(np.float32), down, footprint=(right - left) / width
    )
    picture = found["emission"].astype(np.float64) - SHIFT
    picture[nothing | ~found["hit"].astype(bool)] = -SHIFT
    return picture.reshape(height, width, 3), list(scene.warnings)
