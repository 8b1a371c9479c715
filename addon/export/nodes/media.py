"""Volume nodes -> closures of media."""

from __future__ import annotations

import math
from typing import Any

from ...core.scene.shading import Feature
from .assemble import statement
from .node import Node
from .shaders import Made, emitted
from .values import ONE, ZERO, Value, number

OF_VOLUMES = {
    "VOLUME_ABSORPTION",
    "VOLUME_SCATTER",
    "VOLUME_COEFFICIENTS",
    "PRINCIPLED_VOLUME",
}
"""Shaders that mean something in a volume alone."""
NO_FOURNIER = "the phase function of Fournier and Forand is taken as Henyey-Greenstein's of 0.9"
FOURNIER_FORWARD = 0.9
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
    made = statement(
        "PrincipledVolume",
        weight=weight,
        color=n.color("Color", (0.5, 0.5, 0.5)),
        density=n.number("Density", 1.0),
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
    hot = _math(graph, "POWER", temperature, number(4.0))
    share = graph.one("ClampUnit", a=glow)
    mixed = graph.one("MixFloat", factor=share, a=ONE, b=hot, clamp_factor=False)
    intensity = graph.multiply(mixed, number(STEFAN_BOLTZMANN * 1e-6 / math.pi))
    color = graph.one("Blackbody", temperature=temperature)
    tinted = graph.one("MultiplyVector", a=color, b=n.color("Blackbody Tint", (1.0, 1.0, 1.0)))
    return emitted(n, graph.multiply(weight, intensity), tinted)


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
        n.warn(NO_FOURNIER)
        found["anisotropy"], phase = number(FOURNIER_FORWARD), "HENYEY_GREENSTEIN"
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
