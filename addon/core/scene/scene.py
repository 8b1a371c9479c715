"""The scene as a whole, and whether two scenes are the same."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .camera import Camera, Frame
from .labels import Labels
from .lights import Light, SunDisc, WorldMap
from .material import NO_PROGRAM, Material, Rgb, Texture
from .mesh import Instances, Mesh
from .motion import Shutter
from .shading import Program
from .visibility import ALL_RAYS, NO_LIGHT_GROUP


@dataclass(slots=True)
class Scene:
    """Everything a render needs.

    `world` is the radiance (W/m^2/sr) seen where a ray leaves the scene: constant, or the factor of
    `world_map`; `sun_discs` come on top. `world_program`, an index into `programs`, stands in the
    place of both where it is given. `world_volume` is the program of a medium
    that is everywhere. `light_groups` are the names of those whose light gets passes
    of their own. `world_seen_by`: the rays that bring the world's light, as of a lamp. `shutter`:
    None where nothing moves. `labels`: None where no pass asks for them. `shadow_pass`: the shadow
    on catchers is to be a pass of its own instead of a part of the picture. `missing`: those of the
    warnings that are of files which are not there.
    """

    camera: Camera
    frame: Frame
    meshes: list[Mesh] = field(default_factory=list)
    instances: Instances = field(default_factory=Instances.empty)
    material_sets: list[NDArray[np.int32]] = field(default_factory=list)
    materials: list[Material] = field(default_factory=list)
    textures: list[Texture] = field(default_factory=list)
    lights: list[Light] = field(default_factory=list)
    programs: list[Program] = field(default_factory=list)
    world: Rgb = (0.0, 0.0, 0.0)
    world_map: WorldMap | None = None
    sun_discs: list[SunDisc] = field(default_factory=list)
    world_program: int = NO_PROGRAM
    world_volume: int = NO_PROGRAM
    light_groups: list[str] = field(default_factory=list)
    world_light_group: int = NO_LIGHT_GROUP
    world_seen_by: int = ALL_RAYS
    shutter: Shutter | None = None
    labels: Labels | None = None
    shadow_pass: bool = False
    warnings: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)


GEOMETRY = ("meshes", "instances", "material_sets", "shutter")
VIEW = ("camera", "frame", "labels", "shadow_pass", "warnings", "missing")
SHADING = tuple(entry.name for entry in fields(Scene) if entry.name not in GEOMETRY + VIEW)


def same_geometry(a: Scene, b: Scene) -> bool:
    """Whether two scenes differ in materials, textures, lights and view at most."""
    return all(same(getattr(a, name), getattr(b, name)) for name in GEOMETRY)


def same_shading(a: Scene, b: Scene) -> bool:
    """Whether two scenes differ in geometry and view at most."""
    return all(same(getattr(a, name), getattr(b, name)) for name in SHADING)


def same(a: Any, b: Any) -> bool:
    """Whether two values of this module are equal, arrays included."""
    if a is b:
        return True
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return (
            isinstance(a, np.ndarray)
            and isinstance(b, np.ndarray)
            and a.dtype == b.dtype
            and np.array_equal(a, b)
        )
    if type(a) is not type(b):
        return False
    if is_dataclass(a):
        return all(same(getattr(a, entry.name), getattr(b, entry.name)) for entry in fields(a))
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    return bool(a == b)
