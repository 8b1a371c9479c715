"""Cases like those of cases.py: hair, curves and point clouds."""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.cases import Case
from tests.reference.cycles.specs import node


def _case(
    name: str,
    kind: str = "tuft",
    *,
    samples: int = 1024,
    bias: float = 0.005,
    **options: Any,
) -> Case:
    return Case(
        f"strands_{name}",
        "strands",
        {"kind": kind, **options},
        samples=samples,
        block_bias=0.04,
        reference_bias=bias,
    )


def _diffuse(color: Any) -> dict[str, Any]:
    return node("BsdfDiffuse", Color=color)


def _info(output: str, kind: str = "HairInfo") -> dict[str, Any]:
    """A material in whose colour one output of Curves Info or Point Info is seen."""
    value = node(kind, output)
    if output in {"Tangent Normal", "Position"}:
        value = node("VectorMath", modes={"operation": "ABSOLUTE"}, i0=value)
    if output in {"Thickness", "Radius"}:
        value = node("Math", modes={"operation": "MULTIPLY"}, i0=value, i1=6.0)
    return _diffuse(value)


def _principled(
    parametrization: str = "COLOR", random: bool = False, **inputs: Any
) -> dict[str, Any]:
    given = {"i11": 0.6, "i12": 0.6} if random else {}  # of colour and roughness
    spec = node("BsdfHairPrincipled", modes={"parametrization": parametrization}, **inputs)
    spec["inputs"] |= given
    return spec


def _huang(parametrization: str = "COLOR", **inputs: Any) -> dict[str, Any]:
    """Principled Hair BSDF with the model of Huang; round and untilted without other inputs."""
    given: dict[str, Any] = {"Aspect_Ratio": 1.0, "Offset": 0.0}
    if parametrization == "COLOR":
        given["Color"] = (0.6, 0.35, 0.15)
    modes = {"model": "HUANG", "parametrization": parametrization}
    return node("BsdfHairPrincipled", modes=modes, **(given | inputs))


def _melanin(amount: float, redness: float = 1.0, **inputs: Any) -> dict[str, Any]:
    return _principled("MELANIN", Melanin=amount, Melanin_Redness=redness, **inputs)


def _hair(component: str, **inputs: Any) -> dict[str, Any]:
    given = {"Color": (0.8, 0.5, 0.3), "RoughnessU": 0.2, "RoughnessV": 0.8}
    return node("BsdfHair", modes={"component": component}, **(given | inputs))


def _mix(share: Any, a: dict[str, Any], b: dict[str, Any]) -> dict[str, Any]:
    return node("MixShader", i0=share, i1=a, i2=b)


def _attribute(name: str, output: str = "Color") -> dict[str, Any]:
    return node("Attribute", output, modes={"attribute_name": name})


ABSORBING = {"Absorption_Coefficient": (0.3, 0.8, 1.5)}
GLOW = node("Emission", Color=(1.0, 0.5, 0.2), Strength=3.0)
CLEAR = node("BsdfTransparent")
CHECKS = node("TexChecker", Vector=node("TexCoord", "UV"), Scale=6.0)
GENERATED = node("TexCoord", "Generated")
BROWN = _diffuse((0.45, 0.2, 0.08))
FELT = node("BsdfPrincipled", Base_Color=(0.6, 0.2, 0.1), Subsurface_Weight=0.4, Sheen_Weight=0.8)
BLUE = {"skin": _diffuse((0.1, 0.2, 0.8))}

STRANDS = (
    # Shapes and places
    _case("tuft"),
    _case("tuft_sun", lamp="sun"),
    _case("tuft_sky", lamp="world"),
    _case("tuft_subdivisions", subdivisions=4, lamp="point"),
    _case("thick", shape="THICK"),
    _case("thick_back", shape="THICK", lamp="back"),
    _case("linear", shape="THICK_LINEAR", lamp="point"),
    _case("turned", turned=True),
    _case("stretched", stretched=True, lamp="sun"),
    _case("stretched_thick", stretched=True, shape="THICK", lamp="sun"),
    _case("constant_radius", tip=0.022, count=60),
    _case("closed_tip", tip=0.0, root=0.03),
    _case("instances", "instances"),
    _case("lawn", "lawn", material=_diffuse((0.2, 0.6, 0.1))),
    _case("lawn_sky", "lawn", lamp="world", material=_diffuse((0.7, 0.2, 0.1))),
    _case("points", "points"),
    _case("points_sun", "points", lamp="sun", stretched=True),
    _case("generated", "generated"),
    # Hair of particles
    _case("hair", "hair", **BLUE),
    _case("hair_turned", "hair", turned=True, **BLUE),
    _case("hair_children", "hair", children="INTERPOLATED", count=60, **BLUE),
    _case("hair_simple_children", "hair", children="SIMPLE", count=60, lamp="sun", **BLUE),
    _case("hair_shape", "hair", shape_of_radius=0.6, use_close_tip=True, lamp="sun"),
    _case("hair_smooth", "hair", use_hair_bspline=True, render_step=4, lamp="point"),
    _case("hair_spiral", "hair", kink="SPIRAL", lamp="point"),
    _case("hair_alone", "hair", hide_emitter=True, lamp="back"),
    _case("hair_instances", "instances", of="hair"),
    # Motion
    _case("moving", moves="slide", lamp="sun"),
    _case("moving_velocity", moves="velocity", lamp="sun"),
    _case("moving_points", "points", moves="velocity"),
    _case("moving_hair", "hair", moves="slide", **BLUE),
    _case("moving_bent", "hair", moves="bend", lamp="sun", **BLUE),
    # What is known of them
    *(
        _case(f"info_{output.lower().replace(' ', '_')}", material=_info(output), lamp="world")
        for output in ("Is Strand", "Intercept", "Length", "Thickness", "Random")
    ),
    _case("info_tangent_normal", material=_info("Tangent Normal"), lamp="world"),
    _case("info_hair", "hair", material=_info("Intercept"), lamp="world"),
    _case("info_turned", material=_info("Thickness"), lamp="world", turned=True),
    *(
        _case(f"point_{output.lower()}", "points", material=_info(output, "PointInfo"), lamp="sun")
        for output in ("Position", "Radius", "Random")
    ),
    _case("attribute_curve", material=_diffuse(_attribute("tint")), attributes=True),
    _case("attribute_key", material=_diffuse(_attribute("along")), attributes=True),
    _case("attribute_point", "points", material=_diffuse(_attribute("tint")), attributes=True),
    _case("uv", material=_diffuse(CHECKS), attributes=True),
    _case("hair_uv", "hair", material=_diffuse(CHECKS)),
    _case("hair_paint", "hair", material=_diffuse(_attribute("paint"))),
    _case("hair_generated", "hair", material=_diffuse(GENERATED)),
    _case("tangent", material=_diffuse(node("NewGeometry", "Tangent")), lamp="world"),
    # Materials that surfaces have too
    _case("transparent", material=_mix(0.5, BROWN, CLEAR)),
    _case("transparent_hair", "hair", material=_mix(0.6, BROWN, CLEAR), lamp="sun"),
    _case("fading", material=_mix(node("HairInfo", "Intercept"), BROWN, CLEAR), lamp="sun"),
    _case("translucent", material=node("BsdfTranslucent", Color=(0.7, 0.5, 0.2)), lamp="back"),
    _case("glossy", material=node("BsdfGlossy", Roughness=0.4), lamp="world"),
    _case("principled", material=node("BsdfPrincipled", Base_Color=(0.6, 0.2, 0.1))),
    _case("subsurface", material=FELT, lamp="sun"),
    _case("subsurface_hair", "hair", material=FELT, lamp="world"),
    _case("points_glass", "points", material=node("BsdfGlass", Roughness=0.0), lamp="world"),
    _case("points_metal", "points", material=node("BsdfGlossy", Roughness=0.1), lamp="world"),
    _case("points_glossy", "points", material=node("BsdfGlossy", Roughness=0.3)),
    # What shines is found by chance, in Cycles too: far away seldom, which blocks do not show
    _case("shining", material=GLOW, samples=4096, bias=0.015),
    _case("points_shining", "points", material=GLOW, samples=4096, bias=0.015),
    # Hair BSDF
    _case("reflection", material=_hair("Reflection"), lamp="sun"),
    _case("reflection_tight", material=_hair("Reflection", RoughnessV=0.3), lamp="point"),
    _case("reflection_offset", material=_hair("Reflection", Offset=0.3), lamp="sun"),
    _case("transmission", material=_hair("Transmission"), lamp="back"),
    _case("both", material=_mix(0.5, _hair("Reflection"), _hair("Transmission")), lamp="sun"),
    _case("reflection_thick", material=_hair("Reflection"), shape="THICK", lamp="sun"),
    # Principled Hair BSDF
    *(
        _case(
            f"principled_{roughness:g}",
            material=_principled(
                Color=(0.6, 0.35, 0.15), Roughness=roughness, Radial_Roughness=roughness
            ),
            lamp="sun",
        )
        for roughness in (0.1, 0.3, 0.6, 1.0)
    ),
    *(
        _case(f"melanin_{amount:g}", material=_melanin(amount), lamp="sun")
        for amount in (0.0, 0.3, 0.8)
    ),
    _case("melanin_dark", material=_melanin(0.9, 0.2), lamp="back"),
    _case("melanin_tint", material=_melanin(0.2, Tint=(0.9, 0.3, 0.3))),
    _case(
        "absorption",
        material=_principled("ABSORPTION", **ABSORBING),
        lamp="back",
    ),
    _case("coat", material=_principled(Color=(0.6, 0.3, 0.1), Coat=0.8), lamp="point"),
    _case("ior", material=_principled(Color=(0.6, 0.3, 0.1), IOR=1.2, Offset=0.2), lamp="sun"),
    _case("randomised", material=_principled(random=True, Color=(0.5, 0.3, 0.2)), lamp="sun"),
    _case("principled_sky", material=_melanin(0.4), lamp="world"),
    _case("principled_thick", material=_melanin(0.4), shape="THICK", lamp="sun", samples=4096),
    _case("principled_hair", "hair", material=_melanin(0.5), lamp="area"),
    _case("principled_lawn", "lawn", material=_melanin(0.2)),
    # Of Huang
    *(
        _case(f"huang_{roughness:g}", material=_huang(Roughness=roughness), lamp="sun")
        for roughness in (0.1, 0.3, 0.6, 1.0)
    ),
    _case("huang_ior", material=_huang(IOR=1.2), lamp="sun"),
    _case("huang_offset", material=_huang(Offset=0.1), lamp="sun"),
    *(
        _case(f"huang_aspect_{ratio:g}", material=_huang(Aspect_Ratio=ratio), lamp="sun")
        for ratio in (0.5, 2.0)
    ),
    _case("huang_turned", material=_huang(Aspect_Ratio=0.4), lamp="sun", turned=True),
    _case("huang_defaults", material=_huang(Aspect_Ratio=0.85, Offset=0.0349)),
    _case("huang_sky", material=_huang("MELANIN", Melanin=0.4), lamp="world"),
    _case("huang_absorption", material=_huang("ABSORPTION", **ABSORBING), lamp="back"),
    *(
        _case(f"huang_without_{name}", material=_huang(**{f"i{at}": 0.0}), lamp=lamp)
        for name, at, lamp in (
            ("reflection", 15, "sun"),
            ("transmission", 16, "back"),
            ("secondary", 17, "sun"),
        )
    ),
    _case("huang_randomised", material=_huang(i12=0.6), lamp="sun"),
    _case("huang_thick", material=_huang(), shape="THICK", lamp="sun"),
    _case("huang_hair", "hair", material=_huang(Aspect_Ratio=0.6), lamp="area"),
    _case("huang_lawn", "lawn", material=_huang("MELANIN", Melanin=0.2)),
)
