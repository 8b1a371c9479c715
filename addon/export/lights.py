"""Blender lamps -> core.scene.Light."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import NO_PROGRAM, NO_TEXTURE, Light, LightKind, Ray
from .materials import Shading
from .nodes.links import output_node, report_foreign_output, uses_nodes
from .nodes.node import Owner, Want
from .nodes.reduce import lambertian
from .visibility import lamp_seen_by

FEW_BOUNCES = 1024  # Blender's default, more than any path has
MOST_STRENGTH = 1e18
"""Brighter lamps are clipped: bright pixels, and their squares, would overflow."""
KINDS = {
    "POINT": LightKind.POINT,
    "SPOT": LightKind.SPOT,
    "SUN": LightKind.SUN,
    "AREA": LightKind.AREA,
}


def export_light(
    ob: Any,
    matrix: NDArray[np.float64],
    rays: int,
    shading: Shading,
    read: Callable[[Want], Any],
) -> Light | None:
    """A lamp object placed by `matrix`, or None if it sheds no light or cannot be rendered (which
    is reported). `rays`: those that meet it, by itself and by what makes it an instance; `read`:
    what its nodes ask of the instance that it is.
    """
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
    strength, program = _strength(lamp, ob, shading, read)
    if not np.isfinite(strength).all() or (strength < 0.0).any():
        report.warn(
            "Lights whose strength is negative or not a finite number are left out: {}", ob.name
        )
        return None
    if not strength.any():
        return None
    if (strength > MOST_STRENGTH).any():
        report.warn(
            "Lights left out, as they are brighter than numbers of pixels can be: {}", ob.name
        )
        return None
    r, g, b = (float(v) for v in strength)
    light = Light(
        ob.name,
        KINDS[lamp.type],
        matrix,
        (r, g, b),
        camera_visible=bool(rays & Ray.CAMERA),
        program=program,
    )
    if getattr(cycles, "is_caustics_light", False):
        report.warn(
            "Lights with Shadow Caustics, of which Cycles finds a part only; here photons bring all"
            " of their caustics: {}",
            ob.name,
        )
    light.seen_by = lamp_seen_by(rays)
    light.casts_shadows = bool(lamp.use_shadow and getattr(cycles, "cast_shadow", True))
    most = int(getattr(cycles, "max_bounces", FEW_BOUNCES))
    light.max_bounces = most if most < FEW_BOUNCES else None
    light.met_by_rays = bool(getattr(cycles, "use_multiple_importance_sampling", True))
    light.camera_visible &= light.met_by_rays
    light.normalize = bool(getattr(lamp, "normalize", True))
    if lamp.type in {"POINT", "SPOT"}:
        light.radius = float(lamp.shadow_soft_size)
        light.soft_falloff = bool(lamp.use_soft_falloff)
    if lamp.type == "SPOT":
        if not np.abs(matrix[:3, 2]).max() > 0.0:
            report.warn(
                "Spot lights flattened along their axis, which have no direction, are left out: {}",
                ob.name,
            )
            return None
        light.spot_size, light.spot_blend = float(lamp.spot_size), float(lamp.spot_blend)
    if lamp.type == "SUN":
        light.angle = float(lamp.angle)
        _normalize_sun(light)
    if lamp.type == "AREA":
        light.size = (
            float(lamp.size),
            float(lamp.size_y if lamp.shape in {"RECTANGLE", "ELLIPSE"} else lamp.size),
        )
        light.ellipse = lamp.shape in {"DISK", "ELLIPSE"}
        light.spread = float(lamp.spread)
        axes = np.linalg.norm(
            np.cross(matrix[:3, 0] * light.size[0], matrix[:3, 1] * light.size[1])
        )
        if not axes > 0.0:
            report.warn("Area lights without area are left out: {}", ob.name)
            return None
    return light


def _strength(
    lamp: Any, ob: Any, shading: Shading, read: Callable[[Want], Any]
) -> tuple[NDArray[np.float64], int]:
    """energy * colour * temperature * 2^exposure * what the light's nodes emit; where that is no
    constant, their program.
    """
    strength = np.asarray(lamp.color, np.float64) * float(lamp.energy)
    if getattr(lamp, "use_temperature", False):
        strength = strength * np.asarray(lamp.temperature_color, np.float64)
    strength = strength * 2.0 ** float(getattr(lamp, "exposure", 0.0))
    if not uses_nodes(lamp):
        return strength, NO_PROGRAM
    tree = shading.tree(lamp)
    output = output_node(tree)
    if output is None:
        report_foreign_output(tree, f"Light '{ob.name}'", shading.around.report)
        return np.zeros(3), NO_PROGRAM
    owner = Owner(f"Light '{ob.name}'", lamp, read=read)
    compiled = shading.compile(owner, output.inputs["Surface"])
    compiled.statements = [
        made for made in compiled.statements if made.operation.name == "Emission"
    ]
    constant = lambertian(compiled)
    if constant is not None and constant[1][1] == NO_TEXTURE:
        return strength * constant[1][0], NO_PROGRAM
    return strength, shading.add(compiled.program(ob.name))


def _normalize_sun(light: Light) -> None:
    """A sun that is not normalized has `strength` as radiance: times its projected solid angle it
    is the irradiance.
    """
    if not light.normalize and light.angle > 0.0:
        half = min(light.angle / 2.0, math.pi / 2.0)
        r, g, b = (value * math.pi * math.sin(half) ** 2 for value in light.strength)
        light.strength = (r, g, b)
    light.normalize = True
