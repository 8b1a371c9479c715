"""The gallery: one small case per BSDF and parameter step. Cases like those of cases.py, built by
gallery_stage.py.

A material is written as a tree of `node(...)`: plain dicts, so that a case travels as JSON. Every
case shows it on a smooth ball and on a second thing (`second`) that stands slanted on a diffuse
floor before a diffuse wall, under a large area lamp and a dim constant world.
"""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.adaptive import ADAPTIVE
from tests.reference.cycles.cases import CASES, Case
from tests.reference.cycles.catchers import CATCHERS
from tests.reference.cycles.displacement import DISPLACEMENT
from tests.reference.cycles.film import FILM
from tests.reference.cycles.lamp_trees import LAMP_TREES
from tests.reference.cycles.motion import MOTION
from tests.reference.cycles.passes import PASSES
from tests.reference.cycles.specs import Spec, node
from tests.reference.cycles.strands import STRANDS
from tests.reference.cycles.subsurface import SUBSURFACE
from tests.reference.cycles.terminator import TERMINATOR
from tests.reference.cycles.views import VIEWS
from tests.reference.cycles.visibility import VISIBILITY

ORANGE, STEEL, GREENISH = (0.75, 0.42, 0.18), (0.8, 0.82, 0.85), (0.55, 0.9, 0.6)
CLEAR, GLASS = (1.0, 1.0, 1.0), {"Transmission_Weight": 1.0}
DISTRIBUTIONS = {"ggx": "GGX", "multi": "MULTI_GGX", "beckmann": "BECKMANN"}


def mix(factor: Any, first: Spec, second: Spec) -> Spec:
    return node("MixShader", i0=factor, i1=first, i2=second)


def add(first: Spec, second: Spec) -> Spec:
    return node("AddShader", i0=first, i1=second)


def diffuse(color: Any = ORANGE, **more: Any) -> Spec:
    return node("BsdfDiffuse", Color=color, **more)


def glossy(distribution: str, roughness: float, color: Any = STEEL, **more: Any) -> Spec:
    return node(
        "BsdfAnisotropic",
        modes={"distribution": distribution},
        Color=color,
        Roughness=roughness,
        **more,
    )


def glass(
    distribution: str, roughness: float, ior: float = 1.5, color: Any = (1.0, 1.0, 1.0)
) -> Spec:
    return node(
        "BsdfGlass", modes={"distribution": distribution}, Color=color, Roughness=roughness, IOR=ior
    )


def refraction(distribution: str, roughness: float, ior: float) -> Spec:
    return node(
        "BsdfRefraction", modes={"distribution": distribution}, Roughness=roughness, IOR=ior
    )


def metallic(kind: str, roughness: float, **more: Any) -> Spec:
    return node(
        "BsdfMetallic",
        modes={"fresnel_type": kind, "distribution": "MULTI_GGX"},
        Roughness=roughness,
        **more,
    )


def sheen(distribution: str, roughness: float) -> Spec:
    return node(
        "BsdfSheen",
        modes={"distribution": distribution},
        Color=(0.8, 0.5, 0.6),
        Roughness=roughness,
    )


def toon(component: str) -> Spec:
    return node("BsdfToon", modes={"component": component}, Color=ORANGE, Size=0.6, Smooth=0.2)


def transparent(color: Any = (1.0, 1.0, 1.0)) -> Spec:
    return node("BsdfTransparent", Color=color)


def principled(color: Any = ORANGE, distribution: str = "MULTI_GGX", **inputs: Any) -> Spec:
    return node(
        "BsdfPrincipled", modes={"distribution": distribution}, **({"Base_Color": color} | inputs)
    )


def light_path(output: str) -> Spec:
    return node("LightPath", output)


def painted(output: str = "Color") -> Spec:
    """The stage's test image, by UV; its alpha is a pattern of holes."""
    return node("TexImage", output)


BACKFACING = node("NewGeometry", "Backfacing")
GOLD = {"IOR": (0.17, 0.42, 1.37), "Extinction": (3.1, 2.35, 1.77)}
_HILLS = node("TexNoise", "Factor", Vector=node("TexCoord", "Object"), Scale=4.0, Detail=0.0)
WAVES = node("Bump", Strength=0.7, Distance=0.1, Height=_HILLS)
_GRAIN = node("TexNoise", "Factor", Vector=node("TexCoord", "Object"), Scale=400.0, Detail=0.0)
# finer than a pixel: what it finds depends on how far apart it looks
GRAINY = node("Bump", Strength=0.7, Distance=0.005, Height=_GRAIN)
CARVED = node("NormalMap", Strength=1.0, Color=node("TexImage", "Color", {"image": "normals"}))
UV_TANGENT = node("Tangent", modes={"direction_type": "UV_MAP"})


def _bsdfs() -> dict[str, Spec]:
    cases = {f"diffuse_{r:g}": diffuse(Roughness=r) for r in (0.0, 0.5, 1.0)}
    cases["glossy_sharp"] = glossy("GGX", 0.0)
    for name, distribution in DISTRIBUTIONS.items():
        cases |= {f"glossy_{name}_{r:g}": glossy(distribution, r) for r in (0.1, 0.3, 0.6, 1.0)}
        cases |= {f"glass_{name}_{r:g}": glass(distribution, r) for r in (0.1, 0.4, 1.0)}
        cases[f"anisotropic_{name}"] = glossy(distribution, 0.4, Anisotropy=0.7)
    cases |= {
        "glossy_ashikhmin_0.3": glossy("ASHIKHMIN_SHIRLEY", 0.3),
        "anisotropic_turned": glossy("GGX", 0.4, Anisotropy=0.7, Rotation=0.25),
        "anisotropic_turned_30": glossy("GGX", 0.3, Anisotropy=0.9, Rotation=30.0 / 360.0),
        "anisotropic_negative": glossy("GGX", 0.4, Anisotropy=-0.6),
        "anisotropic_uv": glossy("GGX", 0.4, Anisotropy=0.8, Tangent=UV_TANGENT),
    }
    cases |= {
        f"glass_sharp_ior_{ior:g}": glass("GGX", 0.0, ior) for ior in (1.0, 1.1, 1.33, 1.5, 2.4)
    }
    cases |= {f"glass_rough_ior_{ior:g}": glass("GGX", 0.3, ior) for ior in (1.0, 1.1, 1.33, 2.4)}
    cases |= {
        "glass_sharp_coloured": glass("GGX", 0.0, 1.5, GREENISH),
        "glass_multi_coloured": glass("MULTI_GGX", 0.5, 1.5, GREENISH),
        "refraction_sharp": refraction("GGX", 0.0, 1.45),
        "refraction_ggx_0.3": refraction("GGX", 0.3, 1.45),
        "refraction_beckmann_0.3": refraction("BECKMANN", 0.3, 1.45),
        "refraction_0.6_ior_1.1": refraction("GGX", 0.6, 1.1),
        "metallic_f82_0.1": metallic("F82", 0.1),
        "metallic_f82_0.5": metallic("F82", 0.5),
        "metallic_edge_tint": metallic(
            "F82", 0.3, Base_Color=(0.9, 0.6, 0.3), Edge_Tint=(0.2, 0.4, 0.9)
        ),
        "metallic_gold_0.2": metallic("PHYSICAL_CONDUCTOR", 0.2, **GOLD),
        "metallic_gold_0.6": metallic("PHYSICAL_CONDUCTOR", 0.6, **GOLD),
        "metallic_anisotropic": metallic("F82", 0.4, Anisotropy=0.8),
        "transparent_closed": transparent((0.7, 0.85, 0.6)),
        "translucent_closed": node("BsdfTranslucent", Color=ORANGE),
        "sheen_microfiber_0.3": sheen("MICROFIBER", 0.3),
        "sheen_microfiber_0.8": sheen("MICROFIBER", 0.8),
        "sheen_ashikhmin_0.3": sheen("ASHIKHMIN", 0.3),
        "sheen_ashikhmin_0.7": sheen("ASHIKHMIN", 0.7),
        "toon_diffuse": toon("DIFFUSE"),
        "toon_glossy": toon("GLOSSY"),
        "emission": node("Emission", Color=ORANGE, Strength=0.8),
        "mix_diffuse_glossy": mix(0.4, diffuse(), glossy("GGX", 0.2)),
        "mix_fresnel": mix(
            node("Fresnel", "Factor", IOR=1.6), diffuse(), glossy("GGX", 0.1, (1.0, 1.0, 1.0))
        ),
        "mix_facing": mix(
            node("LayerWeight", "Facing", Blend=0.3), diffuse(), glossy("GGX", 0.3, (1.0, 1.0, 1.0))
        ),
        "mix_glass_diffuse": mix(0.5, glass("GGX", 0.0), diffuse()),
        "mix_nested": mix(
            0.3,
            mix(0.5, diffuse(), glossy("BECKMANN", 0.2)),
            mix(0.6, transparent(), diffuse((0.2, 0.4, 0.7))),
        ),
        "add_diffuse_glossy": add(diffuse((0.4, 0.3, 0.2)), glossy("GGX", 0.2, (0.4, 0.4, 0.4))),
        "add_emission": add(diffuse(), node("Emission", Color=(0.2, 0.4, 1.0), Strength=0.3)),
    }
    return cases


def _light_paths() -> dict[str, Spec]:
    red, blue = diffuse((0.8, 0.1, 0.1)), diffuse((0.1, 0.2, 0.8))
    return {
        "path_shadow": mix(
            light_path("Is Shadow Ray"), glass("GGX", 0.0), transparent((0.9, 0.9, 0.9))
        ),
        "path_camera": mix(light_path("Is Camera Ray"), blue, red),
        "path_diffuse": mix(light_path("Is Diffuse Ray"), red, diffuse((0.8, 0.8, 0.8))),
        "path_glossy": mix(light_path("Is Glossy Ray"), glossy("GGX", 0.1), blue),
        "path_transmission": mix(light_path("Is Transmission Ray"), glass("GGX", 0.0), blue),
        "path_reflection": mix(
            light_path("Is Reflection Ray"), glossy("GGX", 0.1), transparent((0.8, 0.6, 0.4))
        ),
        "path_depth": mix(light_path("Ray Depth"), red, transparent((0.7, 0.9, 0.8))),
        "path_depth_emission": mix(
            light_path("Ray Depth"), node("Emission", Strength=2.0), diffuse((0.2, 0.6, 0.3))
        ),
        "path_diffuse_depth": mix(light_path("Diffuse Depth"), red, diffuse((0.8, 0.8, 0.8))),
        "path_emission": mix(
            light_path("Is Camera Ray"),
            node("Emission", Strength=2.0),
            node("Emission", Color=ORANGE, Strength=0.3),
        ),
    }


def _principled() -> dict[str, Spec]:
    cases = {
        f"principled_metallic_{x:g}": principled(Metallic=x, Roughness=0.3) for x in (0.0, 0.5, 1.0)
    }
    cases |= {
        f"principled_roughness_{r:g}": principled(Roughness=r) for r in (0.0, 0.25, 0.5, 0.75, 1.0)
    }
    cases |= {
        f"principled_metal_roughness_{r:g}": principled(Metallic=1.0, Roughness=r)
        for r in (0.0, 0.25, 0.5, 0.75, 1.0)
    }
    cases |= {
        f"principled_ior_{ior:g}": principled(IOR=ior, Roughness=0.2) for ior in (1.0, 1.2, 2.0)
    }
    cases |= {
        f"principled_specular_{level:g}": principled(Specular_IOR_Level=level, Roughness=0.2)
        for level in (0.0, 1.0)
    }
    for name, roughness in (("smooth", 0.0), ("rough", 0.4)):
        cases |= {
            f"principled_transmission_{x:g}_{name}": principled(
                (1.0, 1.0, 1.0), Transmission_Weight=x, Roughness=roughness
            )
            for x in (0.5, 1.0)
        }
    cases |= {
        "principled_transmission_coloured": principled(
            GREENISH, Transmission_Weight=1.0, Roughness=0.0, IOR=1.33
        ),
        "principled_specular_tint": principled(
            Specular_Tint=(0.2, 0.5, 1.0), Roughness=0.1, IOR=2.0
        ),
        "principled_metal_tint": principled(
            Metallic=1.0, Specular_Tint=(0.2, 0.5, 1.0), Roughness=0.2
        ),
        "principled_anisotropic": principled(Metallic=1.0, Roughness=0.4, Anisotropic=0.8),
        "principled_anisotropic_turned": principled(
            Metallic=1.0, Roughness=0.4, Anisotropic=0.8, Anisotropic_Rotation=0.25
        ),
        "principled_diffuse_roughness": principled(Diffuse_Roughness=1.0, Roughness=0.6),
        "principled_coat_0.5": principled(Coat_Weight=0.5, Roughness=0.6),
        "principled_coat_rough": principled(Coat_Weight=1.0, Coat_Roughness=0.4, Roughness=0.8),
        "principled_coat_tint": principled(
            (0.8, 0.8, 0.8), Coat_Weight=1.0, Coat_Tint=(0.9, 0.4, 0.2), Roughness=0.5
        ),
        "principled_coat_ior_2": principled(Coat_Weight=1.0, Coat_IOR=2.0, Roughness=0.5),
        "principled_coat_metal": principled(
            Coat_Weight=1.0, Coat_Roughness=0.0, Metallic=1.0, Roughness=0.5
        ),
        "principled_sheen": principled(Sheen_Weight=1.0, Roughness=0.8),
        "principled_sheen_tint": principled(
            Sheen_Weight=1.0, Sheen_Roughness=0.2, Sheen_Tint=(0.3, 0.6, 1.0), Roughness=0.8
        ),
        "principled_emission": principled(Emission_Color=(0.2, 0.5, 1.0), Emission_Strength=0.5),
        "principled_film": principled(Thin_Film_Thickness=400.0, Thin_Film_IOR=1.6, Roughness=0.15),
        "principled_film_metal": principled(
            Metallic=1.0, Thin_Film_Thickness=350.0, Thin_Film_IOR=1.4, Roughness=0.2
        ),
        "principled_film_glass": principled(
            (1.0, 1.0, 1.0), Transmission_Weight=1.0, Thin_Film_Thickness=500.0, Roughness=0.1
        ),
        "principled_alpha_0.5": principled(Alpha=0.5),
        "principled_alpha_image": principled(Alpha=painted("Alpha"), Base_Color=painted()),
        "principled_everything": principled(
            Metallic=0.3,
            Transmission_Weight=0.3,
            Coat_Weight=0.5,
            Sheen_Weight=0.5,
            Alpha=0.8,
            Emission_Strength=0.1,
            Roughness=0.3,
        ),
        "principled_normal_map": principled(Normal=CARVED, Roughness=0.3),
        "principled_bump": principled(Normal=WAVES, Roughness=0.3),
        "principled_coat_normal": principled(Coat_Weight=1.0, Coat_Normal=WAVES, Roughness=0.7),
    }
    return cases


def _normals() -> dict[str, Spec]:
    return {
        "normal_map_diffuse": diffuse(Normal=CARVED),
        "bump_diffuse": diffuse(Normal=WAVES),
        "bump_grain": diffuse(Normal=GRAINY),
        "bump_glossy": glossy("GGX", 0.2, Normal=WAVES),
        "bump_metal": principled(Metallic=1.0, Roughness=0.1, Normal=WAVES),
    }


HALF = (0.5, 0.5, 0.5)


def occlusion(output: str = "Color", **modes: Any) -> Spec:
    return node("AmbientOcclusion", output, modes, Color=ORANGE, Distance=0.6)


def bevel(radius: float, **inputs: Any) -> Spec:
    return node("Bevel", "Normal", {"samples": 8}, Radius=radius, **inputs)


def raycast(output: str, **modes: Any) -> Spec:
    up = node("CombineXYZ", X=0.4, Z=0.7)
    return node("Raycast", output, modes, Direction=up, Length=0.8)


def shining(vector: Spec) -> Spec:
    """A vector of components from -2.5 to 2.5, as a colour that shines."""
    factor = (0.2, 0.2, 0.2)
    moved = node("VectorMath", modes={"operation": "MULTIPLY_ADD"}, i0=vector, i1=factor, i2=HALF)
    return node("Emission", Color=moved)


def _traced() -> dict[str, Spec]:
    """Nodes that trace rays of their own."""
    squared = node("Math", modes={"operation": "POWER"}, i0=occlusion("AO", samples=4), i1=3.0)
    return {
        "occlusion": diffuse(occlusion()),
        "occlusion_cubed": mix(squared, diffuse((0.1, 0.2, 0.8)), diffuse((0.8, 0.6, 0.3))),
        "occlusion_inside": diffuse(occlusion(inside=True, samples=8)),
        "occlusion_own": diffuse(occlusion(only_local=True)),
        "occlusion_bent": diffuse(node("AmbientOcclusion", Distance=0.6, Normal=WAVES)),
        "occlusion_shines": node("Emission", Color=occlusion(), Strength=0.4),
        "bevel": diffuse(Normal=bevel(0.08)),
        "bevel_wide": diffuse(Normal=bevel(0.3)),
        "bevel_glossy": glossy("GGX", 0.3, Normal=bevel(0.08)),
        "bevel_bumped": principled(Roughness=0.4, Normal=bevel(0.08, Normal=WAVES)),
        "raycast_hit": diffuse(raycast("Is Hit")),
        "raycast_self": diffuse(raycast("Self Hit")),
        "raycast_own": diffuse(raycast("Is Hit", only_local=True)),
        "raycast_distance": diffuse(raycast("Hit Distance")),
        "raycast_position": shining(raycast("Hit Position")),
        "raycast_normal": shining(raycast("Hit Normal")),
    }


WIDTH, HEIGHT = 40, 32
COARSEST_GLASS = ("glass_multi_1", "glass_coarse_ior_1.05")
"""Photons bring up to 3 % less of all light than Cycles' light samples find behind such glass:
docs/limitations.md, Rough glass."""


def _case(
    name: str, material: Spec, *, second: str = "slab", segments: int = 96, **more: Any
) -> Case:
    options = {"material": material, "second": second, "segments": segments}
    clear = any(
        word in name
        for word in (
            "glass",
            "transmission",
            "dielectric",
            "bubble",
            "refraction",
            "metal",
            "glossy",
        )
    )
    usual = {
        "width": WIDTH,
        "height": HEIGHT,
        "block_bias": 0.04,
        "samples": 1024 if clear else 384,
        "photons_per_pass": 10_000,
    }
    if name in COARSEST_GLASS:
        usual |= {"photons_less": 0.02}
    return Case(name, "material_case", options, **(usual | more))


def _cases() -> tuple[Case, ...]:
    cases = [
        _case(name, material)
        for part in (_bsdfs(), _light_paths(), _principled(), _normals(), _traced())
        for name, material in part.items()
    ]
    alpha_mix = mix(painted("Alpha"), transparent(), diffuse(painted()))
    sided = mix(BACKFACING, diffuse((0.8, 0.1, 0.1)), diffuse((0.1, 0.2, 0.8)))
    sided_gloss = mix(BACKFACING, diffuse(), glossy("GGX", 0.2))
    cases += [
        _case("sheet_transparent", transparent(), second="sheet"),
        _case("sheet_transparent_coloured", transparent((0.3, 0.6, 0.9)), second="sheet"),
        _case("sheet_translucent", node("BsdfTranslucent", Color=(0.7, 0.8, 0.5)), second="sheet"),
        _case("sheet_alpha_image", alpha_mix, second="sheet"),
        _case("sheet_backfacing", sided, second="turned_sheet"),
        _case("sheet_backfacing_glossy", sided_gloss, second="turned_sheet"),
        _case("sheet_diffuse", diffuse(), second="sheet"),
        _case("sheet_principled", principled(Roughness=0.2), second="sheet"),
        _case(
            "sheet_principled_back",
            principled(Roughness=0.2, Coat_Weight=0.5),
            second="turned_sheet",
        ),
        _case("sheet_glossy_back", glossy("GGX", 0.2), second="turned_sheet"),
        _case(
            "sheet_mix_translucent",
            mix(0.5, diffuse(), node("BsdfTranslucent", Color=(0.7, 0.8, 0.5))),
            second="sheet",
        ),
        *(
            _case(f"thin_glass_{name}", principled(color, Thin_Wall=True, **more), second="sheet")
            for name, color, more in (
                ("smooth", CLEAR, GLASS | {"Roughness": 0.0}),
                ("rough", CLEAR, GLASS | {"Roughness": 0.5}),
                ("coloured", GREENISH, GLASS | {"Roughness": 0.2, "IOR": 2.0}),
                ("film", CLEAR, GLASS | {"Roughness": 0.3, "Thin_Film_Thickness": 400.0}),
                ("tint", CLEAR, GLASS | {"Roughness": 0.1, "Specular_Tint": (0.9, 0.5, 0.3)}),
                ("low_ior", CLEAR, GLASS | {"Roughness": 0.5, "IOR": 0.8}),
                ("half", ORANGE, {"Transmission_Weight": 0.5, "Roughness": 0.3}),
                ("coarse", GREENISH, GLASS | {"Roughness": 0.9, "Specular_Tint": (0.9, 0.5, 0.2)}),
            )
        ),
        _case(
            "thin_glass_coarse_ggx",
            principled(GREENISH, Thin_Wall=True, Roughness=0.9, distribution="GGX", **GLASS),
            second="sheet",
        ),
        # Light samples find light where no ray does, most of all where glass bends little
        _case("glass_coarse_ior_1.05", glass("GGX", 0.9, 1.05)),
        _case("glass_coarse_ior_2", glass("MULTI_GGX", 0.8, 2.0)),
        _case("coarse_diffuse", diffuse(), segments=12),
        _case("coarse_glossy", glossy("GGX", 0.2), segments=12),
        _case("coarse_metal_sharp", principled(Metallic=1.0, Roughness=0.0), segments=12),
        _case("coarse_glass", glass("GGX", 0.0), segments=12),
        _case("coarse_principled", principled(Roughness=0.3), segments=12),
        _case("nested_dielectrics", glass("GGX", 0.0, 1.33), second="glass_in_water"),
        _case("air_bubble", glass("GGX", 0.0, 1.5), second="bubble"),
        _case("dielectric_on_diffuse", glass("GGX", 0.0, 1.5), second="filled"),
        _case("occlusion_of_floor", diffuse(occlusion()), second="floor"),
        _case("holdout", node("Holdout"), alpha=True),
        _case("holdout_mix", mix(0.5, node("Holdout"), diffuse()), alpha=True),
        _case("subsurface_thin", principled(Subsurface_Weight=1.0, Subsurface_Scale=0.01)),
        _case("subsurface_half", principled(Subsurface_Weight=0.5, Subsurface_Scale=0.05)),
    ]
    return tuple(cases)


GALLERY: tuple[Case, ...] = _cases()
ALL: tuple[Case, ...] = (
    CASES
    + LAMP_TREES
    + VISIBILITY
    + CATCHERS
    + FILM
    + DISPLACEMENT
    + ADAPTIVE
    + TERMINATOR
    + MOTION
    + PASSES
    + VIEWS
    + SUBSURFACE
    + STRANDS
    + GALLERY
)
BY_NAME = {case.name: case for case in ALL}

# The roughness sweep: these materials in 21 steps; only the pictures' means are kept.
STEPS = tuple(k / 20 for k in range(21))


def sweep_case(kind: str, roughness: float) -> Case:
    """kind: floor (a dielectric one), glass or metal."""
    material = {
        "floor": principled(Roughness=roughness),
        "glass": glass("MULTI_GGX", roughness),
        "metal": principled(STEEL, Metallic=1.0, Roughness=roughness),
    }[kind]
    samples = 1024 if kind == "glass" else 512
    case = _case(f"sweep_{kind}_{roughness:.2f}", material, samples=samples)
    if kind == "floor":
        case.options["second"] = "floor"
    return case


SWEEPS = ("floor", "glass", "metal")
