"""Volume nodes -> closures of media."""

from __future__ import annotations

import math
from typing import Any

from ...core.scene.shading import Feature
from .assemble import statement
from .node import Node
from .shaders import Made, emitted
from .values import NONE, ONE, ZERO, Value, number, vector

OF_VOLUMES = {
    "VOLUME_ABSORPTION",
    "VOLUME_SCATTER",
    "VOLUME_COEFFICIENTS",
    "PRINCIPLED_VOLUME",
}
"""Shaders that mean something in a volume alone."""
STEFAN_BOLTZMANN = 5.670373e-8
"""W/m^2/K^4"""


def absorption(n: Node, weight: Value) -> Made:
    made = statement(
        "VolumeAbsorption",
        weight=weight,
        color=n.color("Color", (0.8, 0.8, 0.8)),
        density=n.number("Density", 1.0),
    )
    return [made], Feature(0)


def scatter(n: Node, weight: Value) -> Made:
    made = statement(
        "VolumeScatter",
        weight=weight,
        color=n.color("Color", (0.8, 0.8, 0.8)),
        density=n.number("Density", 1.0),
        **_phase(n),
    )
    return [made], Feature(0)


def coefficients(n: Node, weight: Value) -> Made:
    emission = n.vector("Emission Coefficients")
    made = statement(
        "VolumeCoefficients",
        weight=weight,
        absorption=n.vector("Absorption Coefficients", (1.0, 1.0, 1.0)),
        scatter=n.vector("Scatter Coefficients", (1.0, 1.0, 1.0)),
        emission=emission,
        **_phase(n),
    )
    shines = not emission.is_constant or any(emission.data)
    return [made], Feature.EMITS if shines else Feature(0)


def principled(n: Node, weight: Value) -> Made:
    """With emission by colour and by black body, as Cycles adds them: of density's none."""
    color, density = n.color("Color", (0.5, 0.5, 0.5)), n.number("Density", 1.0)
    name = _grid_name(n, "Density Attribute")
    if name:
        held = grid_value(n, name, absent=1.0)["factor"]
        density = n.graph.multiply(_positive(n.graph, density), held)
    name = _grid_name(n, "Color Attribute")
    if name:
        held = grid_value(n, name, absent=1.0)["vector"]
        color = n.graph.one("MultiplyVector", a=color, b=held)
    made = statement(
        "PrincipledVolume",
        weight=weight,
        color=color,
        density=density,
        anisotropy=n.number("Anisotropy"),
        absorption_color=n.color("Absorption Color"),
    )
    strength = n.graph.multiply(weight, n.number("Emission Strength"))
    shining, features = emitted(n, strength, n.color("Emission Color", (1.0, 1.0, 1.0)))
    glow = n.number("Blackbody Intensity")
    if glow != ZERO:
        hot, more = _black_body(n, weight, glow)
        shining, features = [*shining, *hot], features | more
    return [made, *shining], features


def _black_body(n: Node, weight: Value, glow: Value) -> Made:
    """Radiance per metre of a black body at its temperature, in the unit of kW that Cycles takes:
    sigma T^4 / pi, or that of 1 K, mixed by the intensity.
    """
    graph = n.graph
    temperature = n.number("Temperature", 1000.0)
    name = _grid_name(n, "Temperature Attribute")
    if name:  # Cycles asks one voxel: what shines is interpolated, not its temperature
        held = grid_value(n, name, absent=1.0, one_voxel=True)["factor"]
        temperature = graph.multiply(temperature, _positive(graph, held))
    hot = _math(graph, "POWER", temperature, number(4.0))
    mixed = graph.one("MixFloat", factor=_positive(graph, glow), a=ONE, b=hot, clamp_factor=False)
    intensity = graph.multiply(mixed, number(STEFAN_BOLTZMANN * 1e-6 / math.pi))
    color = graph.one("Blackbody", temperature=temperature)
    tinted = graph.one("MultiplyVector", a=color, b=n.color("Blackbody Tint", (1.0, 1.0, 1.0)))
    return emitted(n, graph.multiply(weight, intensity), tinted)


def grid_value(
    n: Node, name: str, absent: float = 0.0, one_voxel: bool = False
) -> dict[str, Value]:
    """vector, factor and alpha of a volume grid; `absent` where an object has none of that name."""
    how = n.owner.grids or "LINEAR"
    return n.graph.add(
        "GridValue",
        absent=vector((absent, absent, absent)),
        attribute=n.around.wants.id("attribute", name) if name else NONE,
        interpolation="VOXEL" if one_voxel and how == "LINEAR" else how,
    )


def _grid_name(n: Node, identifier: str) -> str:
    """Of the grid that an input names, in trees of objects with grids."""
    socket = n.socket(identifier) if n.owner.grids else None
    return "" if socket is None else str(socket.default_value)


def _positive(graph: Any, value: Value) -> Value:
    return _math(graph, "MAXIMUM", value, ZERO)


def _math(graph: Any, operation: str, a: Value, b: Value) -> Value:
    return graph.one("Math", a=a, b=b, c=b, operation=operation, use_clamp=False)


def _phase(n: Node) -> dict[str, Any]:
    found: dict[str, Any] = {
        "anisotropy": n.number("Anisotropy"),
        "alpha": n.number("Alpha", 0.5),
        "diameter": n.number("Diameter", 20.0),
    }
    phase = getattr(n.node, "phase", "HENYEY_GREENSTEIN")
    if phase == "FOURNIER_FORAND":
        found["anisotropy"], found["alpha"] = n.number("IOR", 1.33), n.number("Backscatter", 0.1)
    return found | {"phase": phase}


def belongs(n: Node) -> bool:
    """Whether a shader means something where it is: in a volume, or on a surface."""
    if n.owner.of_volume:
        return n.node.type in OF_VOLUMES or n.node.type == "EMISSION"
    return n.node.type not in OF_VOLUMES


def misplaced(n: Node) -> Made:
    place = "in a volume" if n.owner.of_volume else "on a surface"
    n.unsupported(f"has no effect {place}; left out")
    return [], Feature(0)
