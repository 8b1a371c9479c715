"""Blender's world -> constant radiance."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..core.scene import Rgb
from ..report import Report
from .images import Textures
from .nodes import output_node, source, uses_nodes
from .shading import Reducer


def export_world(world: Any, textures: Textures, report: Report) -> Rgb:
    """Radiance of a bpy.types.World (W/m^2/sr); None is black. What is not constant is reported and averaged."""
    if world is None:
        return (0.0, 0.0, 0.0)
    owner = f"World '{world.name}'"
    if not uses_nodes(world):
        radiance = np.asarray(world.color, np.float64)
    else:
        output = output_node(world.node_tree)
        if output is None:
            return (0.0, 0.0, 0.0)
        volume = source(output.inputs["Volume"])
        if volume.node is not None:
            report.warn(f"{owner}, node '{volume.node.name}': Volume not supported; left out")
        radiance = Reducer(owner, textures, report).shader(source(output.inputs["Surface"])).emission.mean(textures)
    visibility = getattr(world, "cycles_visibility", None)
    rays = ("camera", "diffuse", "glossy", "transmission", "scatter")
    if visibility is not None and not all(getattr(visibility, ray, True) for ray in rays):
        report.warn(f"{owner}: ray visibility is not supported; it is visible to all rays")
    if not np.isfinite(radiance).all() or (radiance < 0.0).any():
        report.warn(f"{owner}: its radiance is negative or not a finite number; taken as 0")
        radiance = np.where(np.isfinite(radiance), np.maximum(radiance, 0.0), 0.0)
    return (float(radiance[0]), float(radiance[1]), float(radiance[2]))
