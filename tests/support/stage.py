"""Small Blender scenes, and what the engine makes of them. Runs inside Blender."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from photon_splat.core.render.result import RenderResult, black_passes
from photon_splat.core.scene import Scene

Point = Sequence[float]


def scene() -> Any:
    import bpy

    return bpy.context.scene


def add(name: str, data: Any = None, location: Point = (0, 0, 0), collection: Any = None) -> Any:
    """A new object, linked to `collection` (default: the scene's own)."""
    import bpy

    ob = bpy.data.objects.new(name, data)
    ob.location = location
    (collection or scene().collection).objects.link(ob)
    return ob


def mesh(name: str, vertices: Sequence[Point], faces: Sequence[Sequence[int]]) -> Any:
    import bpy

    made = bpy.data.meshes.new(name)
    made.from_pydata([tuple(v) for v in vertices], [], [tuple(f) for f in faces])
    made.update()
    return made


def plane(name: str = "Plane", half: float = 1.0, **where: Any) -> Any:
    """A grey square in z = 0 that faces +Z."""
    corners = [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)]
    made = add(name, mesh(name, corners, [(0, 1, 2, 3)]), **where)
    made.data.materials.append(material("Grey"))
    return made


def camera(location: Point = (0, 0, 4)) -> Any:
    """The scene's camera, which looks straight down."""
    import bpy

    ob = add("Camera", bpy.data.cameras.new("Camera"), location)
    scene().camera = ob
    return ob


def lamp(kind: str = "POINT", energy: float = 100.0, location: Point = (0, 0, 2)) -> Any:
    import bpy

    data = bpy.data.lights.new(kind, kind)
    data.energy = energy
    return add(kind, data, location)


def portal() -> Any:
    """A light portal, which the engine leaves out and names."""
    ob = lamp("AREA")
    ob.name = "Portal"
    ob.data.cycles.is_portal = True
    return ob


def material(name: str, color: Point = (0.5, 0.5, 0.5), kind: str = "ShaderNodeBsdfDiffuse") -> Any:
    """A material with a single shader."""
    made, tree = empty_material(name)
    shader = tree.nodes.new(kind)
    shader.inputs["Color"].default_value = (*color, 1)
    surface(tree, shader)
    return made


def empty_material(name: str) -> tuple[Any, Any]:
    """A material with nothing but an output node, and its tree."""
    import bpy

    made = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    made.node_tree.nodes.clear()
    made.node_tree.nodes.new("ShaderNodeOutputMaterial")
    return made, made.node_tree


def surface(tree: Any, shader: Any) -> None:
    output(tree, shader, "Surface")


def output(tree: Any, shader: Any, socket: str) -> None:
    """Links the shader to that socket of a material's or a world's output."""
    node = next(node for node in tree.nodes if node.type in {"OUTPUT_MATERIAL", "OUTPUT_WORLD"})
    tree.links.new(shader.outputs[0], node.inputs[socket])


def add_bumps(material: Any, height: float) -> None:
    """A displacement by noise, as bumps alone; height: m."""
    tree = material.node_tree
    material.displacement_method = "BUMP"
    place, noise, bump = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise", "Displacement")
    )
    noise.inputs["Scale"].default_value = 3.0
    bump.inputs["Scale"].default_value = height
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    output(tree, bump, "Displacement")


def world(radiance: float) -> None:
    import bpy

    made = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    made.node_tree.nodes["Background"].inputs["Color"].default_value = (
        radiance,
        radiance,
        radiance,
        1,
    )
    scene().world = made


def room(pixels: int = 16, passes: int = 2, photons: int = 2000) -> Any:
    """A lit grey floor under a camera, to be rendered quickly. Returns the scene."""
    made = scene()
    camera()
    lamp()
    plane(half=2.0)
    resize(pixels)
    made.photon_splat.passes, made.photon_splat.photons_per_pass = passes, photons
    made.photon_splat.error_threshold, made.photon_splat.denoise = 0.0, False
    return made


def resize(width: int, height: int | None = None) -> None:
    render = scene().render
    render.resolution_x, render.resolution_y, render.resolution_percentage = (
        width,
        height or width,
        100,
    )


def compositor(made: Any) -> tuple[Any, Any]:
    """A new compositor of a scene: its nodes, and the one whose input is the picture."""
    import bpy

    made.render.use_compositing = True
    if not hasattr(made, "compositing_node_group"):  # before Blender 5
        made.use_nodes = True
        made.node_tree.nodes.clear()
        return made.node_tree, made.node_tree.nodes.new("CompositorNodeComposite")
    tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
    made.compositing_node_group = tree
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    return tree, tree.nodes.new("NodeGroupOutput")


def exported() -> Scene:
    """The scene as a final render exports it: through Blender's render operator, with a session
    that renders nothing.
    """
    return exports()[0]


def exports(**operator: Any) -> list[Scene]:
    """The scenes that are exported, one per view layer and frame that is rendered."""
    import bpy

    seen: list[Scene] = []

    def keep(what: Scene, *_: Any, **__: Any) -> RenderResult:
        seen.append(what)
        return RenderResult(
            black_passes(*what.frame.region[2:]), False, {"warnings": list(what.warnings)}
        )

    if scene().camera is None:
        camera()
    with replaced("render", keep):
        bpy.ops.render.render(**operator)
    return seen


def rendered_layers(folder: str) -> list[Any]:
    """The specifications (OpenImageIO.ImageSpec) of all parts of the multi-layer EXR that Blender
    writes of a render; it writes a part for each pass.
    """
    import bpy
    import OpenImageIO as oiio

    image = scene().render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format = "OPEN_EXR_MULTILAYER"
    scene().render.filepath = f"{folder}/out.exr"
    bpy.ops.render.render(write_still=True)
    file, specs = oiio.ImageInput.open(scene().render.filepath), []
    while file.seek_subimage(len(specs), 0):
        specs.append(file.spec())
    return specs


@contextmanager
def replaced(name: str, value: Any) -> Iterator[None]:
    """`value` in the place of `name` of photon_splat.blender.job."""
    from photon_splat.blender import job

    kept = getattr(job, name)
    setattr(job, name, value)
    try:
        yield
    finally:
        setattr(job, name, kept)


@contextmanager
def watched() -> Iterator[list[RenderResult]]:
    """The results of the renders inside."""
    from photon_splat.blender import job

    results: list[RenderResult] = []
    job.observer.on_result = lambda result, frame: results.append(result)
    yield results


def triangle_count(what: Scene) -> int:
    return sum(len(what.meshes[m].triangles) for m in what.instances.mesh)


def world_positions(what: Scene, instance: int = 0) -> np.ndarray:
    """(T, 3, 3) corners of the triangles of an instance in the world."""
    found = what.meshes[what.instances.mesh[instance]]
    matrix = what.instances.matrix[instance]
    return (found.positions.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3])[found.triangles]


def the_one_warning(what: Scene, matches: Callable[[str], bool] | None = None) -> str:
    """The only warning, or the only one that `matches`."""
    found = [warning for warning in what.warnings if matches is None or matches(warning)]
    assert len(found) == 1, what.warnings
    return found[0]
