"""Lamps whose node trees make their light differ by place, direction and distance: cases like those
of cases.py.
"""

from __future__ import annotations

from math import radians
from typing import Any

from tests.reference.cycles.cases import Case
from tests.reference.cycles.specs import Spec, node


def _emission(color: Spec | None = None, strength: Spec | float = 1.0) -> Spec:
    return node("Emission", Strength=strength, **({} if color is None else {"Color": color}))


def _checker(scale: float, where: Spec) -> Spec:
    return node(
        "TexChecker", Vector=where, Scale=scale, Color1=(1.0, 0.3, 0.1), Color2=(0.1, 0.4, 1.0)
    )


def _falloff(kind: str, smooth: float = 0.0) -> Spec:
    return node("LightFalloff", kind, Strength=0.5, Smooth=smooth)


def _ies(strength: float = 0.02) -> Spec:
    return node("TexIES", modes={"ies": "beam"}, Strength=strength)


def _case(name: str, kind: str, energy: float, tree: Spec, **options: Any) -> Case:
    return Case(name, "shaded_lamp", {"kind": kind, "energy": energy, "tree": tree, **options})


_UV, _OBJECT, _NORMAL = (node("TexCoord", name) for name in ("UV", "Object", "Normal"))
_TILTED = {"aim": (0.6, 0.5, 0.0)}
_SPOT = {"spot_size": radians(80.0), "spot_blend": 0.3}
_BROAD = {"shape": "RECTANGLE", "size": 1.2, "size_y": 0.6}
_SPOTTED = node("TexNoise", "Color", Vector=_NORMAL, Scale=4.0, Detail=1.0)
_RAMPED = node("TexGradient", "Fac", modes={"gradient_type": "QUADRATIC"}, Vector=_UV)
_WARM = node(
    "Blackbody",
    Temperature=node(
        "MapRange", 0, Value=node("SeparateXYZ", "Y", Vector=_UV), i3=2000.0, i4=9000.0
    ),
)
_FACING = node(
    "Math",
    0,
    {"operation": "POWER"},
    i0=node("Math", 0, {"operation": "SUBTRACT"}, i0=1.0, i1=node("LayerWeight", "Facing")),
    i1=4.0,
)
_SLIDE = node("TexImage", "Color", {"image": "holes"}, Vector=_UV)

LAMP_TREES: tuple[Case, ...] = (
    _case("lamp_area_checker", "AREA", 40.0, _emission(_checker(3.0, _UV)), **_BROAD, **_TILTED),
    _case(
        "lamp_area_slide_narrow", "AREA", 20.0, _emission(_SLIDE), **_BROAD, spread=radians(40.0)
    ),
    _case(
        "lamp_area_gradient",
        "AREA",
        40.0,
        _emission(strength=_RAMPED),
        shape="ELLIPSE",
        size=1.2,
        size_y=0.6,
    ),
    _case("lamp_area_blackbody", "AREA", 30.0, _emission(_WARM), **_BROAD, scale=(0.8, 1.5, 1.0)),
    _case(
        "lamp_area_facing",
        "AREA",
        60.0,
        _emission(strength=_FACING),
        shape="SQUARE",
        size=0.4,
        **_TILTED,
    ),
    _case("lamp_area_ies", "AREA", 30.0, _emission(strength=_ies()), **_BROAD, **_TILTED),
    _case(
        "lamp_area_seen",
        "AREA",
        30.0,
        _emission(_checker(4.0, _OBJECT)),
        **_BROAD,
        visible_camera=True,
        location=(0.3, 0.6, 1.2),
        aim=(0.0, -4.0, 2.0),
    ),
    _case(
        "lamp_point_linear",
        "POINT",
        40.0,
        _emission(strength=_falloff("Linear")),
        shadow_soft_size=0.2,
    ),
    _case(
        "lamp_point_constant",
        "POINT",
        40.0,
        _emission(strength=_falloff("Constant")),
        shadow_soft_size=0.0,
    ),
    _case(
        "lamp_point_smooth",
        "POINT",
        60.0,
        _emission(strength=_falloff("Quadratic", 2.0)),
        shadow_soft_size=0.2,
        use_soft_falloff=False,
    ),
    _case("lamp_point_noise", "POINT", 60.0, _emission(_SPOTTED), shadow_soft_size=0.0),
    _case("lamp_point_noise_soft", "POINT", 60.0, _emission(_SPOTTED), shadow_soft_size=0.3),
    _case(
        "lamp_point_globe",
        "POINT",
        60.0,
        _emission(_checker(6.0, _UV)),
        shadow_soft_size=0.25,
        use_soft_falloff=False,
    ),
    _case(
        "lamp_point_ies",
        "POINT",
        40.0,
        _emission(strength=_ies()),
        shadow_soft_size=0.05,
        scale=(1.0, 1.5, 1.0),
    ),
    _case(
        "lamp_spot_slide",
        "SPOT",
        150.0,
        _emission(_SLIDE),
        shadow_soft_size=0.05,
        **_SPOT,
        **_TILTED,
    ),
    _case(
        "lamp_spot_ies", "SPOT", 150.0, _emission(strength=_ies()), shadow_soft_size=0.1, **_SPOT
    ),
    _case(
        "lamp_spot_object",
        "SPOT",
        150.0,
        _emission(_checker(9.0, _OBJECT)),
        shadow_soft_size=0.3,
        use_soft_falloff=False,
        **_SPOT,
    ),
    _case(
        "lamp_sun_checker",
        "SUN",
        3.0,
        _emission(_checker(5.0, _UV)),
        angle=radians(60.0),
        aim=(0.9, -0.5, 2.0),
    ),
    _case(
        "lamp_sun_normal",
        "SUN",
        3.0,
        _emission(_SPOTTED),
        angle=radians(90.0),
        aim=(0.9, -0.5, 2.0),
    ),
    _case(
        "lamp_info",
        "AREA",
        30.0,
        _emission(node("ObjectInfo", "Color"), node("ObjectInfo", "Random")),
        shape="SQUARE",
        size=0.5,
        tint=(0.9, 0.5, 0.2),
    ),
)
