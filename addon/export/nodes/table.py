"""Which node is compiled how. The exporter, its warnings and docs/nodes.md are made from this
table; `make node-list` writes that page.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import converters as c
from . import inputs as i
from . import media as m
from . import shaders as s
from . import texturing as t
from .values import Value

Outputs = dict[str, Value]


@dataclass(frozen=True, slots=True)
class Entry:
    """A type of node (Node.type) as the user calls it.

    `compile`    its outputs by identifier (kind "shader": closures). None: unsupported, and links
                 from it count as not there.
    `instead`    what an unsupported or partly supported node does; empty: it does all that Cycles
                 does.
    """

    kind: str
    label: str
    compile: Callable[..., Any] | None = None
    instead: str = ""


NO_SCRIPT = "links from it count as not there"

NODES: dict[str, Entry] = {
    # --- shaders ---
    "MIX_SHADER": Entry("shader", "Mix Shader"),
    "ADD_SHADER": Entry("shader", "Add Shader"),
    "EMISSION": Entry("shader", "Emission", s.emission),
    "BACKGROUND": Entry("shader", "Background", s.emission),
    "BSDF_DIFFUSE": Entry("shader", "Diffuse BSDF", s.diffuse),
    "BSDF_PRINCIPLED": Entry("shader", "Principled BSDF", s.principled),
    "BSDF_GLOSSY": Entry("shader", "Glossy BSDF", s.glossy),
    "BSDF_GLASS": Entry("shader", "Glass BSDF", s.glass),
    "BSDF_REFRACTION": Entry("shader", "Refraction BSDF", s.refraction),
    "BSDF_METALLIC": Entry("shader", "Metallic BSDF", s.metallic),
    "BSDF_TRANSPARENT": Entry("shader", "Transparent BSDF", s.transparent),
    "BSDF_TRANSLUCENT": Entry("shader", "Translucent BSDF", s.translucent),
    "BSDF_SHEEN": Entry("shader", "Sheen BSDF", s.sheen),
    "BSDF_TOON": Entry("shader", "Toon BSDF", s.toon),
    "HOLDOUT": Entry("shader", "Holdout", s.holdout),
    "SUBSURFACE_SCATTERING": Entry("shader", "Subsurface Scattering", s.subsurface),
    "BSDF_HAIR": Entry("shader", "Hair BSDF", s.hair),
    "BSDF_HAIR_PRINCIPLED": Entry("shader", "Principled Hair BSDF", s.hair_principled),
    "BSDF_RAY_PORTAL": Entry("shader", "Ray Portal BSDF", s.ray_portal, "taken as transparent"),
    "EEVEE_SPECULAR": Entry("shader", "Specular BSDF", s.of_eevee, "black, as in Cycles"),
    "VOLUME_ABSORPTION": Entry("shader", "Volume Absorption", m.absorption),
    "VOLUME_SCATTER": Entry("shader", "Volume Scatter", m.scatter),
    "VOLUME_COEFFICIENTS": Entry("shader", "Volume Coefficients", m.coefficients),
    "PRINCIPLED_VOLUME": Entry("shader", "Principled Volume", m.principled),
    # --- textures ---
    "TEX_IMAGE": Entry("texture", "Image Texture", t.image, "of movies one frame"),
    "TEX_ENVIRONMENT": Entry("texture", "Environment Texture", t.environment),
    "TEX_NOISE": Entry("texture", "Noise Texture", t.noise),
    "TEX_VORONOI": Entry("texture", "Voronoi Texture", t.voronoi),
    "TEX_WAVE": Entry("texture", "Wave Texture", t.wave),
    "TEX_MAGIC": Entry("texture", "Magic Texture", t.magic),
    "TEX_CHECKER": Entry("texture", "Checker Texture", t.checker),
    "TEX_BRICK": Entry("texture", "Brick Texture", t.brick),
    "TEX_GRADIENT": Entry("texture", "Gradient Texture", t.gradient),
    "TEX_WHITE_NOISE": Entry("texture", "White Noise Texture", t.white_noise),
    "TEX_GABOR": Entry("texture", "Gabor Texture", t.gabor),
    "TEX_SKY": Entry(
        "texture",
        "Sky Texture",
        t.sky,
        "without the sun's disc outside of worlds, and where it is scaled or moved",
    ),
    "TEX_IES": Entry("texture", "IES Texture", t.ies),
    "TEX_POINTDENSITY": Entry("texture", "Point Density", t.no_density, "taken as empty"),
    # --- what the hit knows ---
    "TEX_COORD": Entry("input", "Texture Coordinate", i.texture_coordinate),
    "UVMAP": Entry("input", "UV Map", i.uv_map),
    "ATTRIBUTE": Entry("input", "Attribute", i.attribute, "`N` and `P` of the mesh are taken as 0"),
    "VERTEX_COLOR": Entry("input", "Color Attribute", i.color_attribute),
    "NEW_GEOMETRY": Entry("input", "Geometry", i.geometry),
    "OBJECT_INFO": Entry("input", "Object Info", i.object_info),
    "PARTICLE_INFO": Entry("input", "Particle Info", i.particle_info),
    "CAMERA": Entry("input", "Camera Data", i.camera_data),
    "LIGHT_PATH": Entry(
        "input",
        "Light Path",
        i.light_path,
        "depths: in a light those of its direct light",
    ),
    "LIGHT_FALLOFF": Entry("input", "Light Falloff", i.light_falloff),
    "FRESNEL": Entry("input", "Fresnel", i.fresnel),
    "LAYER_WEIGHT": Entry("input", "Layer Weight", i.layer_weight),
    "WIREFRAME": Entry("input", "Wireframe", i.wireframe),
    "TANGENT": Entry("input", "Tangent", i.tangent),
    "INPUT_SCENE_TIME": Entry("input", "Scene Time", i.scene_time),
    "VALUE": Entry("input", "Value", c.value),
    "RGB": Entry("input", "RGB", c.rgb),
    "HAIR_INFO": Entry("input", "Curves Info", i.curves_info),
    "POINT_INFO": Entry("input", "Point Info", i.point_info),
    "VOLUME_INFO": Entry("input", "Volume Info", i.volume_info),
    "AMBIENT_OCCLUSION": Entry("input", "Ambient Occlusion", i.ambient_occlusion),
    "BEVEL": Entry("input", "Bevel", i.bevel),
    "MATERIAL_RAYCAST": Entry(
        "input", "Raycast", i.raycast, "attributes of what is hit are taken as 0"
    ),
    "UVALONGSTROKE": Entry("input", "UV Along Stroke", None, NO_SCRIPT),
    # --- vectors ---
    "MAPPING": Entry("vector", "Mapping", c.mapping),
    "NORMAL_MAP": Entry("vector", "Normal Map", i.normal_map),
    "BUMP": Entry("vector", "Bump", i.bump),
    "NORMAL": Entry("vector", "Normal", c.normal),
    "CURVE_VEC": Entry("vector", "Vector Curves", c.vector_curves),
    "VECT_MATH": Entry("vector", "Vector Math", c.vector_math),
    "VECTOR_ROTATE": Entry("vector", "Vector Rotate", c.vector_rotate),
    "VECT_TRANSFORM": Entry("vector", "Vector Transform", c.vector_transform),
    "DISPLACEMENT": Entry("vector", "Displacement", i.displacement),
    "VECTOR_DISPLACEMENT": Entry("vector", "Vector Displacement", i.vector_displacement),
    "ShaderNodeRadialTiling": Entry("vector", "Radial Tiling", None, NO_SCRIPT),
    # --- colours and numbers ---
    "MIX": Entry("converter", "Mix", c.mix, "of rotations A is taken"),
    "MIX_RGB": Entry("converter", "Mix (Legacy)", c.mix_rgb),
    "MATH": Entry("converter", "Math", c.math),
    "MAP_RANGE": Entry("converter", "Map Range", c.map_range),
    "CLAMP": Entry("converter", "Clamp", c.clamp),
    "VALTORGB": Entry("converter", "Color Ramp", c.color_ramp),
    "CURVE_RGB": Entry("converter", "RGB Curves", c.rgb_curves),
    "CURVE_FLOAT": Entry("converter", "Float Curve", c.float_curve),
    "HUE_SAT": Entry("converter", "Hue/Saturation/Value", c.hue_saturation),
    "BRIGHTCONTRAST": Entry("converter", "Brightness/Contrast", c.bright_contrast),
    "GAMMA": Entry("converter", "Gamma", c.gamma),
    "INVERT": Entry("converter", "Invert Color", c.invert),
    "RGBTOBW": Entry("converter", "RGB to BW", c.rgb_to_bw),
    "SEPARATE_COLOR": Entry("converter", "Separate Color", c.separate_color),
    "COMBINE_COLOR": Entry("converter", "Combine Color", c.combine_color),
    "SEPXYZ": Entry("converter", "Separate XYZ", c.separate_xyz),
    "COMBXYZ": Entry("converter", "Combine XYZ", c.combine_xyz),
    "SEPRGB": Entry("converter", "Separate RGB (Legacy)", c.separate_rgb),
    "COMBRGB": Entry("converter", "Combine RGB (Legacy)", c.combine_rgb),
    "SEPHSV": Entry("converter", "Separate HSV (Legacy)", c.separate_hsv),
    "COMBHSV": Entry("converter", "Combine HSV (Legacy)", c.combine_hsv),
    "BLACKBODY": Entry("converter", "Blackbody", c.blackbody),
    "WAVELENGTH": Entry("converter", "Wavelength", c.wavelength),
    "SHADERTORGB": Entry("converter", "Shader to RGB", None, NO_SCRIPT),
    "SCRIPT": Entry("converter", "Script", None, NO_SCRIPT),
    "SQUEEZE": Entry("converter", "Squeeze Value (Legacy)", None, NO_SCRIPT),
}
INLINED = ("Menu Switch", "Repeat zones", "Closures", "Bundles", "Integer", "Boolean", "Vector")
"""What Blender 5 has taken apart before a tree is compiled (inlined.py)."""
KINDS = {
    "shader": "Shaders",
    "texture": "Textures",
    "input": "Input",
    "vector": "Vector",
    "converter": "Colour and converter",
}


def markdown() -> str:
    """docs/nodes.md: nodes that do what they do in Cycles, then the others."""
    lines = [
        "# Nodes",
        "",
        "`make node-list` writes this page from the exporter's own table. Do not edit it.",
        "",
        "Node trees of materials, lights and worlds are compiled to programs that native code",
        "runs at every hit. `make nodes` compares about 900 cases with Cycles. Where a node does",
        "something else than in Cycles, a warning names the material and the node.",
        "",
        "## As in Cycles",
        "",
        "| kind | nodes |",
        "|---|---|",
    ]
    for kind, title in KINDS.items():
        same = [entry.label for entry in NODES.values() if entry.kind == kind and not entry.instead]
        lines.append(f"| {title} | {', '.join(sorted(same))} |")
    lines.append(f"| Taken apart by Blender 5 | {', '.join(INLINED)} |")
    instead: dict[str, list[str]] = {}
    for entry in NODES.values():
        if entry.instead:
            instead.setdefault(entry.instead, []).append(entry.label)
    lines += ["", "## Different from Cycles", "", "| nodes | what the engine does |", "|---|---|"]
    lines += [f"| {', '.join(labels)} | {what} |" for what, labels in instead.items()]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(markdown())
