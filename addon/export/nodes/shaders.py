"""Shader nodes -> closures, with what they may produce."""

from __future__ import annotations

from ...core.scene.shading import Feature
from .assemble import Statement, statement
from .node import LEAST_IOR, Node
from .values import ONE, ORIGIN, ZERO, Value

Made = tuple[list[Statement], Feature]
# A lobe below this roughness focuses light: photons of its own kind (see the integrator).
SHARP_BELOW = 0.5
BENDS_NOTHING = 1.0021
"""bends_nothing() of native/src/bsdf/fresnel.h, and a little for rounding."""
OF_HAIR = Feature.REST | Feature.TRANSMITS


def _roughness_features(*roughnesses: Value) -> Feature:
    """Features of a closure with these roughnesses: REST, and SHARP if one may be below the
    limit.
    """
    sharp = any(not r.is_constant or r.data[0] < SHARP_BELOW for r in roughnesses)
    return Feature.REST | (Feature.SHARP if sharp else Feature(0))


MEDIA = ("VolumeAbsorption", "VolumeScatter", "VolumeCoefficients", "PrincipledVolume")
MOST_LOBES = 48
"""LobeList::kMax of native/src/bsdf/lobe.h."""
DEFAULT_RADIUS = (1.0, 0.2, 0.1)
SMOOTH_PANE, STRAIGHT_PANE = 0.05, 1.01
"""Roughness and index up to which light may go straight through a pane."""


def lobe_count(made: Statement) -> int:
    """How many lobes a closure has at most."""
    name = made.operation.name
    if name != "Principled":
        return 0 if name in {"BentNormal", "Emission", "Transparent", "Holdout", *MEDIA} else 1
    metallic, transmission = made.get("metallic"), made.get("transmission_weight")
    lobes = sum(
        value != ZERO
        for value in (metallic, transmission, made.get("coat_weight"), made.get("sheen_weight"))
    )
    thin = made.get("thin_wall") != ZERO
    lobes += thin and transmission != ZERO
    if ONE in (metallic, transmission):
        return lobes
    specular = made.get("specular_level") != ZERO or made.get("thin_film_thickness") != ZERO
    both_diffuse = made.get("diffuse_roughness") != ZERO and made.get("subsurface_weight") != ZERO
    return lobes + specular + (2 if both_diffuse else 1) + 2 * thin


def emission(n: Node, weight: Value) -> Made:
    color, strength = n.color("Color"), n.number("Strength", 1.0)
    return emitted(n, n.graph.multiply(weight, strength), color)


def emitted(n: Node, weight: Value, color: Value) -> Made:
    """An emission of `color`, or nothing where that is known to be black."""
    if weight == ZERO or (color.is_constant and not any(color.data)):
        return [], Feature(0)
    constant = weight.is_constant and color.is_constant
    return [statement("Emission", weight=weight, color=color)], Feature.EMITS | (
        Feature.CONSTANT_EMISSION if constant else Feature(0)
    )


def transparent(n: Node, weight: Value) -> Made:
    return [
        statement(
            "Transparent", weight=n.graph.multiply(weight, seen_through(n)), color=n.color("Color")
        )
    ], Feature.TRANSPARENT


def seen_through(n: Node) -> Value:
    """1, or 0 for shadow rays where the material's transparency does not count for them."""
    if not n.owner.opaque_shadow:
        return ONE
    return n.graph.one("OneMinus", a=n.graph.one("LightPath", what="IS_SHADOW_RAY"))


def holdout(n: Node, weight: Value) -> Made:
    return [statement("Holdout", weight=weight)], Feature(0)


def diffuse(n: Node, weight: Value) -> Made:
    roughness = n.share("Roughness")
    made = statement(
        "Diffuse",
        weight=weight,
        color=n.color("Color"),
        normal=n.closure_normal(),
        roughness=roughness,
    )
    return [made], Feature.GATHERS if roughness == ZERO else Feature.GATHERS | Feature.REST


def translucent(n: Node, weight: Value) -> Made:
    return [
        statement("Translucent", weight=weight, color=n.color("Color"), normal=n.closure_normal())
    ], Feature.GATHERS | Feature.TRANSMITS


def subsurface(n: Node, weight: Value) -> Made:
    method, anisotropy = _walk(n, "falloff", "Anisotropy")
    made = statement(
        "Subsurface",
        weight=weight,
        color=n.color("Color"),
        normal=n.closure_normal(),
        radius=n.vector("Radius", DEFAULT_RADIUS),
        scale=n.number("Scale", 0.05),
        ior=n.number("IOR", 1.4),
        roughness=n.share("Roughness", 1.0),
        anisotropy=anisotropy,
        method=method,
    )
    return [made], Feature.GATHERS | Feature.SUBSURFACE


def _walk(n: Node, method: str, anisotropy: str) -> tuple[str, Value]:
    """The method of a subsurface node, and the mean cosine of its phase function. Blender before
    5.2 has only the older random walk, which does not scatter backwards.
    """
    older = "RANDOM_WALK_LEGACY" not in n.node.bl_rna.properties[method].enum_items
    name, cosine = getattr(n.node, method), n.number(anisotropy)
    if not older:
        return name, cosine
    bounded = n.graph.one("Math", operation="MAXIMUM", a=cosine, b=ZERO, c=ZERO, use_clamp="OFF")
    return "RANDOM_WALK_LEGACY" if name == "RANDOM_WALK" else name, bounded


def _distribution(n: Node) -> str:
    name = n.node.distribution
    if name in {"GGX", "MULTI_GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY"}:
        return name
    n.unsupported(
        f"with distribution {name.replace('_', '-').title()} is not supported; taken as GGX"
    )
    return "GGX"


def glossy(n: Node, weight: Value) -> Made:
    roughness, anisotropy = n.share("Roughness"), n.number("Anisotropy")
    made = statement(
        "Glossy",
        weight=weight,
        color=n.color("Color"),
        normal=n.closure_normal(),
        roughness=roughness,
        anisotropy=anisotropy,
        rotation=n.number("Rotation"),
        tangent=n.tangent(anisotropy),
        distribution=_distribution(n),
    )
    return [made], _roughness_features(roughness)


def _bent(ior: Value, roughness: Value) -> Feature:
    """What glass does to light: where its index is 1, or may be, some goes straight on."""
    if ior.is_constant:
        index = max(ior.data[0], LEAST_IOR)
        if max(index, 1 / index) < BENDS_NOTHING:
            return Feature.TRANSPARENT
    straight = Feature(0) if ior.is_constant else Feature.TRANSPARENT
    return straight | _roughness_features(roughness) | Feature.TRANSMITS


def glass(n: Node, weight: Value) -> Made:
    roughness, ior = n.share("Roughness"), n.ior("IOR", 1.5)
    made = statement(
        "Glass",
        weight=weight,
        color=n.color("Color"),
        normal=n.closure_normal(),
        roughness=roughness,
        ior=ior,
        thin_film_thickness=n.number("Thin Film Thickness"),
        thin_film_ior=n.number("Thin Film IOR", 1.33),
        distribution=_distribution(n),
    )
    return [made], _bent(ior, roughness)


def refraction(n: Node, weight: Value) -> Made:
    roughness = n.share("Roughness")
    inputs = {
        "color": n.color("Color"),
        "normal": n.closure_normal(),
        "roughness": roughness,
        "ior": n.ior("IOR", 1.45),
    }
    made = statement("Refraction", weight=weight, distribution=_distribution(n), **inputs)
    return [made], _bent(inputs["ior"], roughness)


def metallic(n: Node, weight: Value) -> Made:
    roughness, anisotropy = n.share("Roughness"), n.number("Anisotropy")
    physical = n.node.fresnel_type == "PHYSICAL_CONDUCTOR"
    made = statement(
        "Metallic",
        weight=weight,
        normal=n.closure_normal(),
        roughness=roughness,
        anisotropy=anisotropy,
        rotation=n.number("Rotation"),
        tangent=n.tangent(anisotropy),
        base_or_ior=n.vector("IOR") if physical else n.color("Base Color"),
        edge_or_extinction=n.vector("Extinction") if physical else n.color("Edge Tint"),
        thin_film_thickness=n.number("Thin Film Thickness"),
        thin_film_ior=n.number("Thin Film IOR", 1.33),
        fresnel_type=n.node.fresnel_type,
        distribution=_distribution(n),
    )
    return [made], _roughness_features(roughness)


def sheen(n: Node, weight: Value) -> Made:
    inputs = {
        "color": n.color("Color"),
        "normal": n.closure_normal(),
        "roughness": n.share("Roughness"),
    }
    return [
        statement("Sheen", weight=weight, distribution=n.node.distribution, **inputs)
    ], Feature.GATHERS | Feature.REST


def toon(n: Node, weight: Value) -> Made:
    inputs = {
        "color": n.color("Color"),
        "normal": n.closure_normal(),
        "size": n.number("Size"),
        "smooth": n.number("Smooth"),
    }
    made = statement("Toon", weight=weight, component=n.node.component, **inputs)
    return [made], Feature.GATHERS | Feature.REST | (
        Feature.SHARP if n.node.component == "GLOSSY" else Feature(0)
    )


def _scatters_all(roughness: Value, ior: Value) -> bool:
    """Whether no light goes straight through a pane."""
    return (
        roughness.is_constant
        and roughness.data[0] > SMOOTH_PANE
        and ior.is_constant
        and ior.data[0] > STRAIGHT_PANE
    )


def principled(n: Node, weight: Value) -> Made:
    weights = {
        name: n.share(name) for name in ("Subsurface Weight", "Transmission Weight", "Coat Weight")
    } | {"Sheen Weight": n.number("Sheen Weight")}
    scatters_below = weights["Subsurface Weight"] != ZERO
    thin = n.number("Thin Wall")
    transmits = weights["Transmission Weight"] != ZERO
    metal, roughness, coat_roughness = (
        n.share("Metallic"),
        n.share("Roughness", 0.5),
        n.share("Coat Roughness", 0.03),
    )
    alpha, specular, anisotropic = (
        n.share("Alpha", 1.0),
        n.number("Specular IOR Level", 0.5),
        n.number("Anisotropic"),
    )
    if n.owner.opaque_shadow and alpha != ONE:
        clear = n.graph.multiply(n.graph.one("OneMinus", a=alpha), seen_through(n))
        alpha = n.graph.one("OneMinus", a=clear)
    ior, film = n.ior("IOR", 1.5), n.number("Thin Film Thickness")
    emission_color, emission_strength = n.color("Emission Color"), n.number("Emission Strength")
    layers = ("Subsurface Weight", "Transmission Weight", "Coat Weight", "Sheen Weight")
    if (
        alpha == ONE
        and specular == ZERO
        and film == ZERO
        and metal == ZERO
        and all(weights[name] == ZERO for name in layers)
    ):
        return _matte(n, weight, emission_color, emission_strength)
    method, cosine = (
        _walk(n, "subsurface_method", "Subsurface Anisotropy")
        if scatters_below
        else ("RANDOM_WALK", ZERO)
    )
    made = statement(
        "Principled",
        weight=weight,
        base_color=n.color("Base Color"),
        metallic=metal,
        roughness=roughness,
        ior=ior,
        alpha=alpha,
        normal=n.closure_normal(),
        diffuse_roughness=n.share("Diffuse Roughness"),
        subsurface_weight=weights["Subsurface Weight"],
        specular_level=specular,
        specular_tint=n.color("Specular Tint", (1.0, 1.0, 1.0)),
        anisotropic=anisotropic,
        anisotropic_rotation=n.number("Anisotropic Rotation"),
        tangent=n.tangent(anisotropic),
        transmission_weight=weights["Transmission Weight"],
        coat_weight=weights["Coat Weight"],
        coat_roughness=coat_roughness,
        coat_ior=n.ior("Coat IOR", 1.5),
        coat_tint=n.color("Coat Tint", (1.0, 1.0, 1.0)),
        coat_normal=n.closure_normal("Coat Normal"),
        sheen_weight=weights["Sheen Weight"],
        sheen_roughness=n.share("Sheen Roughness", 0.5),
        sheen_tint=n.color("Sheen Tint", (1.0, 1.0, 1.0)),
        emission_color=emission_color,
        emission_strength=emission_strength,
        thin_film_thickness=film,
        thin_film_ior=n.number("Thin Film IOR", 1.33),
        distribution=n.node.distribution,
        subsurface_radius=n.vector("Subsurface Radius", DEFAULT_RADIUS)
        if scatters_below
        else ORIGIN,
        subsurface_scale=n.number("Subsurface Scale", 0.05) if scatters_below else ZERO,
        subsurface_ior=n.number("Subsurface IOR", 1.4) if scatters_below else ONE,
        subsurface_anisotropy=cosine,
        subsurface_method=method,
        thin_wall=thin if scatters_below or transmits else ZERO,
    )
    features = Feature.SUBSURFACE if scatters_below else Feature(0)
    if alpha != ONE:
        features |= Feature.TRANSPARENT
    if emission_strength != ZERO and not (
        emission_color.is_constant and not any(emission_color.data)
    ):
        features |= Feature.EMITS
        layered = weights["Coat Weight"] != ZERO or weights["Sheen Weight"] != ZERO or alpha != ONE
        if (
            weight.is_constant
            and emission_color.is_constant
            and emission_strength.is_constant
            and not layered
        ):
            features |= Feature.CONSTANT_EMISSION
    if metal != ONE and weights["Transmission Weight"] != ONE:
        features |= Feature.GATHERS
    if scatters_below and thin != ZERO:
        features |= Feature.TRANSMITS
    if transmits:
        features |= Feature.TRANSMITS | (_bent(ior, roughness) & Feature.TRANSPARENT)
        if thin != ZERO and not _scatters_all(roughness, ior):
            features |= Feature.TRANSPARENT
    if weights["Sheen Weight"] != ZERO:
        features |= Feature.GATHERS | Feature.REST
    smooth = (
        metal == ZERO
        and weights["Transmission Weight"] == ZERO
        and (specular == ZERO or ior == ONE)
    )
    if not smooth:
        features |= _roughness_features(roughness)
    if weights["Coat Weight"] != ZERO:
        features |= _roughness_features(coat_roughness)
    if n.share("Diffuse Roughness") != ZERO:
        features |= Feature.REST
    return [made], features


def hair(n: Node, weight: Value) -> Made:
    made = statement(
        "Hair",
        weight=weight,
        color=n.color("Color"),
        normal=n.closure_normal(),
        tangent=n.values["Tangent"] if n.linked("Tangent") else ORIGIN,
        offset=n.number("Offset"),
        roughness_u=n.number("RoughnessU", 0.1),
        roughness_v=n.number("RoughnessV", 1.0),
        component=n.node.component,
    )
    return [made], OF_HAIR


def hair_principled(n: Node, weight: Value) -> Made:
    of_strand = n.graph.add("CurvesInfo")["random"]
    model = getattr(n.node, "model", "CHIANG")
    aspect = n.number("Aspect Ratio", 0.85) if model == "HUANG" else ONE
    made = statement(
        "PrincipledHair",
        weight=weight,
        color=n.color("Color"),
        melanin=n.number("Melanin", 0.8),
        melanin_redness=n.number("Melanin Redness", 1.0),
        tint=n.color("Tint", (1.0, 1.0, 1.0)),
        absorption=n.vector("Absorption Coefficient"),
        roughness=n.number("Roughness", 0.3),
        radial_roughness=n.number("Radial Roughness", 0.3),
        coat=n.number("Coat"),
        ior=n.number("IOR", 1.55),
        offset=n.number("Offset"),
        random_color=n.number("Random Color"),
        random_roughness=n.number("Random Roughness"),
        random=n.values["Random"] if n.linked("Random") else of_strand,
        aspect_ratio=aspect,
        major_axis=ORIGIN if aspect == ONE else _curve_normal(n),
        reflection=n.number("R lobe", 1.0),
        transmission=n.number("TT lobe", 1.0),
        secondary_reflection=n.number("TRT lobe", 1.0),
        parametrization=n.node.parametrization,
        model=model,
    )
    # Curves are hit as if they were round: light goes straight through what an ellipse lacks
    return [made], OF_HAIR if aspect == ONE else OF_HAIR | Feature.TRANSPARENT


def _curve_normal(n: Node) -> Value:
    """In the object's coordinates; 0 where there is none, as of hair of particles."""
    return n.graph.add("Attribute", attribute=n.around.wants.id("curve normal"))["vector"]


def _matte(n: Node, weight: Value, emission_color: Value, emission_strength: Value) -> Made:
    """A Principled BSDF that has nothing but its diffuse layer and emission."""
    roughness = n.share("Diffuse Roughness")
    made = statement(
        "Diffuse",
        weight=weight,
        color=n.color("Base Color"),
        normal=n.closure_normal(),
        roughness=roughness,
    )
    shining, features = emitted(n, n.graph.multiply(weight, emission_strength), emission_color)
    return [made, *shining], features | Feature.GATHERS | (
        Feature(0) if roughness == ZERO else Feature.REST
    )


def of_eevee(n: Node, weight: Value) -> Made:
    """Cycles knows no such shader and shows black."""
    n.unsupported("is for EEVEE only; left out, which is black, as in Cycles")
    return [], Feature(0)


def ray_portal(n: Node, weight: Value) -> Made:
    n.unsupported("is not supported; taken as transparent with its colour")
    return transparent(n, weight)


def from_value(n: Node, weight: Value, color: Value) -> Made:
    """A colour or number where a shader belongs shines, as in Cycles."""
    return emitted(n, weight, color)


def unknown(n: Node, weight: Value) -> Made:
    n.unsupported("is not a shader that is known; left out, which is black")
    return [], Feature(0)
