"""Light that single surfaces scatter, as Cycles has it: the fixture of
native/tests/bsdf/test_bsdf_albedo.cpp.

`python -m tests.reference.cycles.tables.bsdf_albedo` writes native/tests/bsdf/bsdf_albedo.inc anew
(some minutes; Blender 5.x). Each case is a plane under a world of radiance (1, lobe about +Z, lobe
about LEAN): an orthographic camera that sees nothing else measures the integral of f |cos| times
the world for one direction, in three shapes at once. Coloured cases have a white world."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Vector

from tests.reference.cycles.references import cycles_settings
from tests.support.paths import ROOT

TARGET = ROOT / "native" / "tests" / "bsdf" / "bsdf_albedo.inc"
LEAN, POWER = (1.0, 0.0, 0.5), 8.0  # the world's third channel: ((1 + w.d) / 2)^POWER about d
SIZE = 16  # pixels a side; all see the same
SPOT = (0.5, 0.0, 0.0)  # what the camera looks at: here the default tangent (radial about Z) is +Y

DISTRIBUTIONS = {"GGX": "kGgx", "MULTI_GGX": "kMultiGgx", "BECKMANN": "kBeckmann"}
PRINCIPLED = {  # socket: field of PrincipledInputs
    "Base Color": "base_color", "Metallic": "metallic", "Roughness": "roughness", "IOR": "ior",
    "Alpha": "alpha", "Diffuse Roughness": "diffuse_roughness",
    "Specular IOR Level": "specular_level", "Specular Tint": "specular_tint",
    "Anisotropic": "anisotropic", "Anisotropic Rotation": "anisotropic_rotation",
    "Transmission Weight": "transmission_weight", "Coat Weight": "coat_weight",
    "Coat Roughness": "coat_roughness", "Coat IOR": "coat_ior", "Coat Tint": "coat_tint",
    "Sheen Weight": "sheen_weight", "Sheen Roughness": "sheen_roughness",
    "Sheen Tint": "sheen_tint", "Emission Color": "emission_color",
    "Emission Strength": "emission_strength", "Thin Film Thickness": "thin_film_thickness",
    "Thin Film IOR": "thin_film_ior",
}  # fmt: skip
GREY, GOLD = (0.8, 0.8, 0.8), (0.9, 0.5, 0.2)

PRINCIPLED_CHANGES: list[dict[str, Any]] = [
    {},
    {"IOR": 2.5},
    {"IOR": 0.8},
    {"Specular IOR Level": 1.0},
    {"Specular Tint": GOLD},
    {"Metallic": 1.0, "Base Color": GOLD, "Specular Tint": (0.2, 0.8, 0.5)},
    {"Transmission Weight": 1.0, "Base Color": GOLD},
    {"Coat Weight": 1.0, "Coat Roughness": 0.4, "Coat Tint": GOLD},
    {"Sheen Weight": 0.7, "Sheen Roughness": 0.6},
    {"Diffuse Roughness": 0.8},
    {"Anisotropic": 0.8, "Anisotropic Rotation": 0.1, "Metallic": 0.5},
    {"Emission Strength": 0.5, "Coat Weight": 0.5, "Alpha": 0.7},
    {"Thin Film Thickness": 400.0, "Thin Film IOR": 1.8},
    {"Thin Film Thickness": 400.0, "Metallic": 1.0, "Base Color": GOLD},
]

# node type without "ShaderNode", its properties (lower case) and sockets
Case = tuple[str, dict[str, Any]]


def cases() -> Iterator[Case]:
    for roughness in (0.0, 0.6, 1.0):
        yield "BsdfDiffuse", {"Color": GREY, "Roughness": roughness}
    yield "BsdfDiffuse", {"Color": GOLD, "Roughness": 1.0}
    yield "BsdfTranslucent", {"Color": GREY}
    for roughness in (0.3, 0.7, 1.0):
        for distribution in DISTRIBUTIONS:
            yield (
                "BsdfAnisotropic",
                {"distribution": distribution, "Color": GREY, "Roughness": roughness},
            )
            yield (
                "BsdfGlass",
                {"distribution": distribution, "Color": GREY, "Roughness": roughness, "IOR": 1.5},
            )
        yield (
            "BsdfAnisotropic",
            {
                "distribution": "MULTI_GGX",
                "Color": GREY,
                "Roughness": roughness,
                "Anisotropy": 0.6,
                "Rotation": 0.15,
            },
        )
        yield (
            "BsdfGlass",
            {"distribution": "MULTI_GGX", "Color": GOLD, "Roughness": roughness, "IOR": 0.7},
        )
        yield (
            "BsdfRefraction",
            {"distribution": "GGX", "Color": GREY, "Roughness": roughness, "IOR": 1.3},
        )
        yield "BsdfSheen", {"distribution": "MICROFIBER", "Color": GREY, "Roughness": roughness}
        yield (
            "BsdfMetallic",
            {
                "distribution": "MULTI_GGX",
                "fresnel_type": "F82",
                "Base Color": GOLD,
                "Edge Tint": (0.4, 0.9, 1.0),
                "Roughness": roughness,
            },
        )
        yield (
            "BsdfMetallic",
            {
                "distribution": "GGX",
                "fresnel_type": "PHYSICAL_CONDUCTOR",
                "IOR": (0.24, 0.92, 1.1),
                "Extinction": (3.6, 2.6, 2.6),
                "Roughness": roughness,
            },
        )
        for change in PRINCIPLED_CHANGES:
            yield (
                "BsdfPrincipled",
                {
                    "Base Color": GREY,
                    "Roughness": roughness,
                    "IOR": 1.5,
                    "Emission Strength": 0.0,
                    **change,
                },
            )
    yield "BsdfSheen", {"distribution": "ASHIKHMIN", "Color": GREY, "Roughness": 0.6}
    yield "BsdfToon", {"component": "DIFFUSE", "Color": GREY, "Size": 0.3, "Smooth": 0.3}
    yield "BsdfToon", {"component": "GLOSSY", "Color": GREY, "Size": 0.5, "Smooth": 0.1}


def views(case: Case) -> list[tuple[float, float, float]]:
    """Unit directions towards the camera; through glass also from behind."""
    angles = [15.0, 55.0, 78.0]
    if "Glass" in case[0] or case[1].get("Transmission Weight"):
        angles += [150.0, 110.0]
    return [
        (
            math.sin(math.radians(a)) * math.cos(0.5),
            math.sin(math.radians(a)) * math.sin(0.5),
            math.cos(math.radians(a)),
        )
        for a in angles
    ]


def is_grey(case: Case) -> bool:
    return (
        all(len(set(v)) == 1 for v in case[1].values() if isinstance(v, tuple))
        and "Thin Film Thickness" not in case[1]
    )


def cpp(value: Any) -> str:
    return (
        "{" + ", ".join(f"{v:g}f" if "." in f"{v:g}" else f"{v:g}" for v in value) + "}"
        if isinstance(value, tuple)
        else f"{value:g}" + ("f" if "." in f"{value:g}" else "")
    )


def cpp_call(case: Case) -> str:
    """The case as a call of native/src/bsdf/bsdf.h on `b`; the normal is kUp, the tangent
    kTangent.
    """
    kind, p = case
    d = "Distribution::" + DISTRIBUTIONS.get(p.get("distribution", ""), "kGgx")
    get = lambda name, default=0.0: cpp(p.get(name, default))  # noqa: E731
    match kind.removeprefix("Bsdf"):
        case "Diffuse":
            return f"b.add_diffuse({get('Color')}, kUp, {get('Roughness')})"
        case "Translucent":
            return f"b.add_translucent({get('Color')}, kUp)"
        case "Anisotropic":
            return (
                f"b.add_glossy({get('Color')}, kUp, {d}, {get('Roughness')}, "
                f"{get('Anisotropy')}, {get('Rotation')}, kTangent)"
            )
        case "Glass":
            return (
                f"b.add_glass({get('Color')}, kUp, {d}, {get('Roughness')}, {get('IOR')}, 0, 1.33f)"
            )
        case "Refraction":
            return f"b.add_refraction({get('Color')}, kUp, {d}, {get('Roughness')}, {get('IOR')})"
        case "Sheen":
            return (
                f"b.add_sheen({get('Color')}, kUp, {get('Roughness')}, "
                f"{str(p['distribution'] == 'ASHIKHMIN').lower()})"
            )
        case "Toon":
            return (
                f"b.add_toon({get('Color')}, kUp, {str(p['component'] == 'GLOSSY').lower()}, "
                f"{get('Size')}, {get('Smooth')})"
            )
        case "Metallic":
            colors = (
                "true, " + get("IOR") + ", " + get("Extinction")
                if p["fresnel_type"] == "PHYSICAL_CONDUCTOR"
                else "false, " + get("Base Color") + ", " + get("Edge Tint")
            )
            return (
                f"b.add_metallic(kWhite, kUp, {d}, {get('Roughness')}, 0, 0, kTangent, "
                f"{colors}, 0, 1.33f)"
            )
        case "Principled":
            fields = " ".join(f"in.{PRINCIPLED[name]} = {cpp(value)};" for name, value in p.items())
            return (
                "b.add_principled(kWhite, principled_inputs([](auto& in) { in.tangent = kTangent; "
                + fields
                + " }))"
            )
    raise ValueError(kind)


class Lab:
    """Blender's scene for one surface at a time."""

    def __init__(self, samples: int = 1024) -> None:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = scene = bpy.context.scene
        cycles_settings(samples, seed=1)
        scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
        scene.render.resolution_x = scene.render.resolution_y = SIZE
        scene.render.use_persistent_data = True
        settings = scene.render.image_settings
        if hasattr(settings, "media_type"):
            settings.media_type = "IMAGE"
        settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
        mesh = bpy.data.meshes.new("Plane")
        mesh.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
        scene.collection.objects.link(bpy.data.objects.new("Plane", mesh))
        self.material = bpy.data.materials.new("Surface")
        self.world = bpy.data.worlds.new("World")
        self.material.use_nodes = self.world.use_nodes = True
        mesh.materials.append(self.material)
        scene.world = self.world
        self.world.cycles.sampling_method = "NONE"
        camera = bpy.data.cameras.new("Camera")
        camera.type, camera.ortho_scale = "ORTHO", 0.002
        self.camera = bpy.data.objects.new("Camera", camera)
        scene.collection.objects.link(self.camera)
        scene.camera = self.camera

    def set_world(self, *, lobes: bool) -> None:
        tree = self.world.node_tree
        tree.nodes.clear()
        new, link = tree.nodes.new, tree.links.new
        background, output = new("ShaderNodeBackground"), new("ShaderNodeOutputWorld")
        link(background.outputs[0], output.inputs[0])
        background.inputs["Color"].default_value = (1, 1, 1, 1)
        if not lobes:
            return
        direction, combined = new("ShaderNodeTexCoord"), new("ShaderNodeCombineXYZ")
        combined.inputs[0].default_value = 1
        for channel, axis in ((1, (0.0, 0.0, 1.0)), (2, LEAN)):
            dot, half, power = (
                new("ShaderNodeVectorMath"),
                new("ShaderNodeMath"),
                new("ShaderNodeMath"),
            )
            dot.operation, half.operation, power.operation = "DOT_PRODUCT", "MULTIPLY_ADD", "POWER"
            dot.inputs[1].default_value = Vector(axis).normalized()
            half.inputs[1].default_value = half.inputs[2].default_value = 0.5
            half.use_clamp = True
            power.inputs[1].default_value = POWER
            link(direction.outputs["Generated"], dot.inputs[0])
            link(dot.outputs["Value"], half.inputs[0])
            link(half.outputs[0], power.inputs[0])
            link(power.outputs[0], combined.inputs[channel])
        link(combined.outputs[0], background.inputs["Color"])

    def set_surface(self, case: Case) -> None:
        tree = self.material.node_tree
        tree.nodes.clear()
        node, output = (
            tree.nodes.new("ShaderNode" + case[0]),
            tree.nodes.new("ShaderNodeOutputMaterial"),
        )
        for name, value in case[1].items():
            if name.islower():
                setattr(node, name, value)
            else:
                socket = node.inputs[name]
                socket.default_value = (*value, 1) if socket.type == "RGBA" else value
        tree.links.new(node.outputs[0], output.inputs[0])

    def measure(self, wo: tuple[float, float, float]) -> np.ndarray:
        """Mean radiance (RGB, float64) of the surface towards the unit vector `wo`."""
        self.camera.location = Vector(SPOT) + Vector(wo) * 5
        self.camera.rotation_euler = Vector(wo).to_track_quat("Z", "Y").to_euler()
        with tempfile.TemporaryDirectory() as folder:
            self.scene.render.filepath = str(Path(folder, "plane.exr"))
            bpy.ops.render.render(write_still=True)
            image = bpy.data.images.load(self.scene.render.filepath)
            image.colorspace_settings.name = "Non-Color"
            pixels = np.empty(SIZE * SIZE * image.channels, np.float32)
            image.pixels.foreach_get(pixels)
            bpy.data.images.remove(image)
        return pixels.reshape(SIZE * SIZE, -1)[:, :3].mean(axis=0, dtype=np.float64)


def main() -> None:
    lab = Lab()
    lines = [
        "// Generated by tests/reference/cycles/tables/bsdf_albedo.py with Cycles of Blender "
        f"{bpy.app.version_string}."
    ]
    for case in cases():
        lab.set_surface(case)
        lab.set_world(lobes=is_grey(case))
        rows = [(wo, lab.measure(wo)) for wo in views(case)]
        lines += ["{[](Bsdf& b) { " + cpp_call(case) + f"; }}, {str(is_grey(case)).lower()}, {{"]
        lines += [
            "   {{"
            + ", ".join(f"{x:.7f}f" for x in wo)
            + "}, {"
            + ", ".join(f"{x:.5f}f" for x in light)
            + "}},"
            for wo, light in rows
        ]
        lines += [" }},"]
    TARGET.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
