"""Blender materials -> core.scene.Material."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..core.scene import Material, Side
from ..report import Report
from .images import Textures
from .nodes import Source, output_node, source, uses_nodes
from .shading import Closure, Reducer

DEFAULT_NAME = "(default)"


class Materials:
    """The materials of one scene, each once. Indices point into `list`."""

    def __init__(self, textures: Textures, report: Report) -> None:
        self.list: list[Material] = []
        self._textures, self._report = textures, report
        self._known: dict[tuple[int, str | None], int] = {}

    def index(self, material: Any, user: str, uv_map: str | None = None) -> int:
        """Index of a bpy.types.Material (None: Blender's default grey) on object `user` whose render-active UV map is `uv_map`."""
        if material is None:
            if bpy.app.version >= (5, 0, 0):  # its default became a Principled BSDF
                self._report.warn(
                    "No material: Blender's default is approximated by its base colour; specular reflection left out: {}", user
                )
            return self._remember((0, None), lambda: Material(DEFAULT_NAME))
        key = (material.as_pointer(), uv_map)
        return self._remember(key, lambda: export_material(material, self._textures, self._report, uv_map))

    def _remember(self, key: tuple[int, str | None], make: Any) -> int:
        if key not in self._known:
            self.list.append(make())
            self._known[key] = len(self.list) - 1
        return self._known[key]


def export_material(material: Any, textures: Textures, report: Report, uv_map: str | None = None) -> Material:
    """Reduce a material's node tree; without nodes its viewport colour is what Cycles takes, with an empty tree it is black."""
    owner = f"Material '{material.name}'"
    if not uses_nodes(material):
        r, g, b, _ = material.diffuse_color
        side = Side(base_color=(r, g, b))
        return Material(material.name, side, side)
    output = output_node(material.node_tree)
    if output is None:
        return Material(material.name, Side((0.0, 0.0, 0.0)), Side((0.0, 0.0, 0.0)))
    root = Source(output, None)
    for name in ("Volume", "Displacement"):
        found = root.input(name)
        if found is not None and found.node is not None:
            report.warn(f"{owner}, node '{found.node.name}': {name} not supported; left out")
    surface = source(output.inputs["Surface"])
    front, back = (
        _side(Reducer(owner, textures, report, backfacing, uv_map).shader(surface), owner, textures, report) for backfacing in (False, True)
    )
    return Material(material.name, front, front if front == back else back)


def _side(closure: Closure, owner: str, textures: Textures, report: Report) -> Side:
    base, base_texture, exact = closure.diffuse.as_texture(textures)
    emission, emission_texture, also_exact = closure.emission.as_texture(textures)
    if not (exact and also_exact):
        report.warn(f"{owner}: a sum of images of different sizes is approximated by its mean colour")
    for name, value in (("base colour", base), ("emission", emission)):
        if not np.isfinite(value).all():
            report.warn(f"{owner}: its {name} is not a finite number; taken as black")
    base = base if np.isfinite(base).all() else (0.0, 0.0, 0.0)
    emission = emission if np.isfinite(emission).all() else (0.0, 0.0, 0.0)
    if min(base) < 0.0 or min(emission) < 0.0:
        report.warn(f"{owner}: negative colours are taken as 0")
        base, emission = ((max(r, 0.0), max(g, 0.0), max(b, 0.0)) for r, g, b in (base, emission))
    return Side(base, base_texture, emission, emission_texture)
