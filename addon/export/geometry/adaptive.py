"""Meshes whose last modifier subdivides them as finely as the camera sees them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.dicing.catmull_clark import Surface
from ...core.dicing.eye import Eye
from ...core.dicing.values import Faces
from ...core.dicing.wanted import Wanted
from ...core.scene import Camera, Frame, Mesh
from ..arrays import read
from ..camera import export_camera, resolution
from ..report import Report
from .mesh import sound_triangles

SHARPEST = 10.0
"""Levels that an edge of crease 1 stays sharp; and it is then sharp for ever."""


@dataclass(frozen=True, slots=True)
class Adaptive:
    """What the modifier says of one object.

    length  of edges, in `pixels` or else in the mesh's own measure
    level   that Blender has subdivided the mesh to; on the smooth surface, if `at_limit`
    """

    length: float
    pixels: bool
    level: int
    smooth: bool
    at_limit: bool
    creases: bool
    keeps_corners: bool


def adaptive_of(ob: Any, depsgraph: Any) -> Adaptive | None:
    """Of an evaluated object; None where it is not subdivided adaptively, as in viewports of a
    scene without a camera.
    """
    modifiers = ob.modifiers
    last = modifiers[-1] if ob.type == "MESH" and len(modifiers) else None
    if last is None or last.type != "SUBSURF":
        return None
    final = depsgraph.mode == "RENDER"
    if not (last.show_render if final else last.show_viewport):
        return None
    scene = depsgraph.scene_eval
    cycles, pixels = getattr(scene, "cycles", None), True
    if hasattr(last, "use_adaptive_subdivision"):
        wanted = last.use_adaptive_subdivision
        pixels = last.adaptive_space == "PIXEL"
        length = last.adaptive_pixel_size if pixels else last.adaptive_object_edge_length
    else:  # before Blender 5.0, where it belongs to Cycles' experimental features
        own = getattr(ob, "cycles", None)
        if own is None or getattr(cycles, "feature_set", "") != "EXPERIMENTAL":
            return None
        wanted, length = own.use_adaptive_subdivision, own.dicing_rate
    if not wanted or (pixels and not final and _dicing_camera(depsgraph) is None):
        return None
    rate = 1.0 if final else 8.0
    if cycles is not None:
        rate = cycles.dicing_rate if final else cycles.preview_dicing_rate
    level = last.render_levels if final else last.levels
    if scene.render.use_simplify:
        simplify = "simplify_subdivision_render" if final else "simplify_subdivision"
        level = min(level, getattr(scene.render, simplify))
    return Adaptive(
        length=max(0.1, rate * length) if pixels else max(1e-4, rate * length),
        pixels=pixels,
        level=int(level),
        smooth=last.subdivision_type == "CATMULL_CLARK",
        at_limit=bool(last.use_limit_surface),
        creases=bool(last.use_creases),
        keeps_corners=last.boundary_smooth == "PRESERVE_CORNERS",
    )


def wanted_of(adaptive: Adaptive, eye: Eye, levels: int) -> Wanted:
    """`levels`: how often the edges of the mesh without its modifier may be halved."""
    left = max(levels - adaptive.level, 0)
    return Wanted(adaptive.length, left, eye if adaptive.pixels else None)


def levels_of(scene: Any) -> int:
    """How often an edge is halved at most."""
    cycles = getattr(scene, "cycles", None)
    return 12 if cycles is None else int(cycles.max_subdivisions)


def eye_of(depsgraph: Any, camera: Camera, frame: Frame) -> Eye:
    """The dicing camera, or else the one that is rendered."""
    scene = depsgraph.scene_eval
    cycles = getattr(scene, "cycles", None)
    offscreen = 4.0 if cycles is None else float(cycles.offscreen_dicing_scale)
    chosen = _dicing_camera(depsgraph)
    if chosen is None:
        return Eye(camera, frame.width, frame.height, offscreen)
    viewport = depsgraph.mode == "VIEWPORT"
    size = resolution(scene.render) if viewport else (frame.width, frame.height)
    given = export_camera(chosen.evaluated_get(depsgraph), scene, Report(), size=size)
    return Eye(given, *size, offscreen)


def _dicing_camera(depsgraph: Any) -> Any:
    """In viewports the scene's camera decides, so that looking around dices nothing anew."""
    scene = depsgraph.scene_eval
    chosen = getattr(getattr(scene, "cycles", None), "dicing_camera", None)
    if chosen is None and depsgraph.mode == "VIEWPORT":
        chosen = scene.camera
    return chosen if chosen is not None and chosen.type == "CAMERA" else None


def faces_of(mesh: Any, exported: Mesh, adaptive: Adaptive, name: str) -> Faces:
    """What is to be known of a bpy.types.Mesh beyond its triangles."""
    found = sound_triangles(mesh, name, Report())
    assert found is not None
    of_faces = read(mesh.loop_triangle_polygons, "value", np.int32)
    if found.kept is not None:
        of_faces = of_faces[found.kept]
    smooth = None
    sharp = mesh.attributes.get("sharp_face")
    if sharp is not None and sharp.domain == "FACE":
        smooth = ~read(sharp.data, "value", np.bool_)[of_faces]
    surface = _surface(mesh, exported, adaptive) if adaptive.smooth else None
    return Faces(surface, np.array(found.corners, np.int32), smooth)


def _surface(mesh: Any, exported: Mesh, adaptive: Adaptive) -> Surface:
    corners = read(mesh.loops, "vertex_index", np.int32).astype(np.int64)
    starts = read(mesh.polygons, "loop_start", np.int32).astype(np.int64)
    ends = read(mesh.edges, "vertices", np.int32, 2).astype(np.int64)
    positions = exported.positions.astype(np.float64)
    level = adaptive.level
    sharpness, pinned = np.zeros(len(ends)), np.zeros(len(positions))
    if adaptive.creases:
        sharpness = _left(_values(mesh, "crease_edge", "EDGE", sharpness), level)
        found = _values(mesh, "crease_vert", "POINT", pinned)
        # Blender gives new vertices what lies between; only what is fixed for ever is told apart.
        pinned = _left(found, 0) if level == 0 else np.where(found >= 1.0, np.inf, 0.0)
    if adaptive.keeps_corners:
        pinned[np.bincount(corners, minlength=len(pinned)) == 1] = np.inf
    surface = Surface(positions, corners, np.append(starts, len(corners)), ends, sharpness, pinned)
    quads = bool((np.diff(surface.starts) == 4).all())
    return surface.through(positions) if level and adaptive.at_limit and quads else surface


def _values(
    mesh: Any, name: str, domain: str, otherwise: NDArray[np.float64]
) -> NDArray[np.float64]:
    found = mesh.attributes.get(name)
    if found is None or found.domain != domain or found.data_type != "FLOAT":
        return otherwise
    return np.nan_to_num(read(found.data, "value", np.float32).astype(np.float64))


def _left(crease: NDArray[np.float64], level: int) -> NDArray[np.float64]:
    """Levels that what has this crease stays sharp after so many. Blender, which has made these,
    squares creases; Cycles does not, and lets all that is not sharp for ever end after three.
    """
    sharp = SHARPEST * crease**2 - level if level else np.minimum(SHARPEST * crease, 3.0)
    return np.where(crease >= 1.0, np.inf, np.maximum(sharp, 0.0))
