"""Blender lamps -> core.scene.Light."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import NO_PROGRAM, NO_TEXTURE, Light, LightKind
from ..report import Report
from .compile.node import Owner
from .compile.reduce import lambertian
from .materials import Shading
from .nodes import output_node, uses_nodes

MOST_STRENGTH = 1e18
"""Beyond it what is bright in the picture, and its square, is no number any more."""
KINDS = {"POINT": LightKind.POINT, "SPOT": LightKind.SPOT, "SUN": LightKind.SUN, "AREA": LightKind.AREA}


def export_light(ob: Any, matrix: NDArray[np.float64], shading: Shading) -> Light | None:
    """A lamp object placed by `matrix`, or None if it sheds no light or cannot be rendered (which is reported)."""
    lamp = ob.data
    report = shading.around.report
    if lamp.type not in KINDS:
        report.warn(f"Light {{}}: lights of type {lamp.type} are not supported; left out", ob.name)
        return None
    if not np.isfinite(matrix).all():
        report.warn("Lights left out, as their transformation is not a finite number: {}", ob.name)
        return None
    cycles = getattr(lamp, "cycles", None)
    if lamp.type == "AREA" and getattr(cycles, "is_portal", False):
        report.warn("Light portals are not supported; left out: {}", ob.name)
        return None
    strength, program = _strength(lamp, ob, shading)
    if not np.isfinite(strength).all() or (strength < 0.0).any():
        report.warn("Lights whose strength is negative or not a finite number are left out: {}", ob.name)
        return None
    if not strength.any():
        return None
    if (strength > MOST_STRENGTH).any():
        report.warn("Lights left out, as they are brighter than numbers of pixels can be: {}", ob.name)
        return None
    _report_unsupported(ob, lamp, cycles, report)
    r, g, b = (float(v) for v in strength)
    light = Light(ob.name, KINDS[lamp.type], matrix, (r, g, b), camera_visible=bool(ob.visible_camera), program=program)
    light.normalize = bool(getattr(lamp, "normalize", True))
    if lamp.type in {"POINT", "SPOT"}:
        light.radius = float(lamp.shadow_soft_size)
        light.soft_falloff = bool(lamp.use_soft_falloff)
    if lamp.type == "SPOT":
        light.spot_size, light.spot_blend = float(lamp.spot_size), float(lamp.spot_blend)
    if lamp.type == "SUN":
        light.angle = float(lamp.angle)
        _normalize_sun(light)
    if lamp.type == "AREA":
        light.size = (float(lamp.size), float(lamp.size_y if lamp.shape in {"RECTANGLE", "ELLIPSE"} else lamp.size))
        light.ellipse = lamp.shape in {"DISK", "ELLIPSE"}
        light.spread = float(lamp.spread)
        axes = np.linalg.norm(np.cross(matrix[:3, 0] * light.size[0], matrix[:3, 1] * light.size[1]))
        if not axes > 0.0:
            report.warn("Area lights without area are left out: {}", ob.name)
            return None
    return light


def _strength(lamp: Any, ob: Any, shading: Shading) -> tuple[NDArray[np.float64], int]:
    """energy * colour * temperature * 2^exposure * what the light's nodes emit; where that is no constant, their program."""
    strength = np.asarray(lamp.color, np.float64) * float(lamp.energy)
    if getattr(lamp, "use_temperature", False):
        strength = strength * np.asarray(lamp.temperature_color, np.float64)
    strength = strength * 2.0 ** float(getattr(lamp, "exposure", 0.0))
    if not uses_nodes(lamp):
        return strength, NO_PROGRAM
    output = output_node(lamp.node_tree)
    if output is None:
        return np.zeros(3), NO_PROGRAM
    owner = Owner(f"Light '{ob.name}'", lamp, lamp=ob)
    compiled = shading.compile(owner, output.inputs["Surface"])
    compiled.statements = [made for made in compiled.statements if made.operation.name == "Emission"]
    constant = lambertian(compiled)
    if constant is not None and constant[1][1] == NO_TEXTURE:
        return strength * constant[1][0], NO_PROGRAM
    return strength, shading.add(compiled.program(ob.name))


def _normalize_sun(light: Light) -> None:
    """A sun that is not normalized has `strength` as radiance: times its projected solid angle it is the irradiance."""
    if not light.normalize and light.angle > 0.0:
        half = min(light.angle / 2.0, math.pi / 2.0)
        r, g, b = (value * math.pi * math.sin(half) ** 2 for value in light.strength)
        light.strength = (r, g, b)
    light.normalize = True


def _report_unsupported(ob: Any, lamp: Any, cycles: Any, report: Report) -> None:
    if not lamp.use_shadow:
        report.warn("Lights without shadow are not supported; these cast shadows: {}", ob.name)
    if getattr(cycles, "max_bounces", 1024) < 32:
        report.warn("A light's own number of bounces is not supported: {}", ob.name)
    if not (ob.visible_diffuse and ob.visible_glossy and ob.visible_transmission and ob.visible_shadow):
        report.warn("Ray visibility of lights other than Camera is not supported; ignored for: {}", ob.name)
