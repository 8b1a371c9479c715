"""Blender's world -> radiance by direction: a constant, an image, or a sky and its sun."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import NO_PROGRAM, NO_TEXTURE, Rgb, Scene, WorldMap
from .directions import direction_map
from .lights import MOST_STRENGTH
from .materials import Shading, export_volume
from .nodes.compiler import Compiler
from .nodes.links import (
    Source,
    label,
    output_node,
    report_foreign_output,
    source,
    uses_nodes,
)
from .nodes.node import Owner
from .nodes.reduce import lambertian
from .report import Report
from .sky import export_sky, sun_disc
from .visibility import world_seen_by

Matrix = NDArray[np.float64]


def export_world(world: Any, shading: Shading, scene: Scene) -> None:
    """Sets `scene`'s world from a bpy.types.World; None is black. What cannot be expressed is
    reported.
    """
    report = shading.around.report
    if world is None:
        scene.world = (0.0, 0.0, 0.0)
        return
    owner = f"World '{world.name}'"
    if uses_nodes(world):
        _World(owner, shading, scene).read(world)
    else:
        scene.world = _radiance(np.asarray(world.color, np.float64), owner, report)
    scene.world_seen_by = world_seen_by(world)
    kept = getattr(world.original, "cycles", None)
    sampled = scene.world_map is not None or scene.world_program != NO_PROGRAM
    if sampled and kept is not None and not _casts_shadows(kept):
        report.warn(f"{owner}: Cast Shadow is off, but all of its light casts shadows")


def _casts_shadows(kept: Any) -> bool:
    """By the settings of Cycles: what it does not sample does in any case."""
    return kept.sampling_method == "NONE" or getattr(kept, "use_shadows", True)


class _World:
    def __init__(self, owner: str, shading: Shading, scene: Scene) -> None:
        self.owner, self.shading, self.scene = owner, shading, scene
        self.textures, self.report = shading.around.textures, shading.around.report

    def read(self, world: Any) -> None:
        tree = self.shading.tree(world)
        output = output_node(tree)
        if output is None:
            report_foreign_output(tree, self.owner, self.report)
            return
        self.scene.world_volume = export_volume(
            Owner(self.owner, world, of_volume=True), world.name, output, self.shading
        )
        surface = source(output.inputs["Surface"])
        if not (
            surface.node is not None
            and surface.node.type in {"BACKGROUND", "EMISSION"}
            and self._image(surface)
        ):
            self._program(world, output.inputs["Surface"])

    def _program(self, world: Any, surface: Any) -> None:
        """Any other tree: a program, or a constant where the tree amounts to one."""
        compiled = self.shading.compile(Owner(self.owner, world, of_world=True), surface)
        constant = lambertian(compiled)
        if constant is not None and constant[1][1] == NO_TEXTURE:
            self.scene.world = _radiance(np.array(constant[1][0]), self.owner, self.report)
        else:
            self.scene.world_program = self.shading.add(compiled.program(world.name))
            self.scene.sun_discs = list(compiled.graph.sun_discs)

    def _image(self, surface: Source) -> bool:
        """Takes an image or a sky that feeds a Background; False if it is something else."""
        color = surface.input("Color")
        if (
            color is None
            or color.node is None
            or color.node.type not in {"TEX_ENVIRONMENT", "TEX_SKY"}
        ):
            return False
        to_lookup = direction_map(color)
        if to_lookup is None:
            return False
        strength = self._strength(surface)
        if strength is None:
            return False
        self.scene.world = _radiance(np.full(3, strength), self.owner, self.report)
        if color.node.type == "TEX_SKY":
            self._sky(color.node, to_lookup)
        else:
            named = f"{self.owner}, node '{label(color.node)}'"
            texture = self.textures.of_node(color.node, named)
            self.textures.report_below_zero(texture, named)
            self.scene.world_map = WorldMap(
                texture, to_lookup[:3], color.node.projection == "MIRROR_BALL"
            )
        return True

    def _strength(self, surface: Source) -> float | None:
        """None where it depends on the direction."""
        compiler = Compiler(
            Owner(self.owner, of_world=True), self.shading.around, self.shading.folding
        )
        value = compiler.value(surface.node.inputs["Strength"], surface.groups)
        return float(value.data[0]) if value.is_constant else None

    def _sky(self, node: Any, to_lookup: Matrix) -> None:
        strength = self.scene.world
        found = export_sky(node, self.textures, self.owner, self.report)
        matrix = found.turn @ to_lookup
        self.scene.world_map = WorldMap(found.texture, matrix[:3])
        disc = sun_disc(found, to_lookup, strength)
        self.scene.sun_discs = [disc] if disc is not None else []


def _radiance(value: NDArray[np.float64], owner: str, report: Report) -> Rgb:
    if not np.isfinite(value).all() or (value < 0.0).any():
        report.warn(f"{owner}: its radiance is negative or not a finite number; taken as 0")
        value = np.where(np.isfinite(value), np.maximum(value, 0.0), 0.0)
    if (value > MOST_STRENGTH).any():
        report.warn(f"{owner}: it is brighter than numbers of pixels can be; left out")
        value = np.zeros(3)
    return (float(value[0]), float(value[1]), float(value[2]))
