"""A symbolic reducer of shader trees to Lambertian reflectance and emission.

Each side of a surface is reduced by itself, with Geometry > Backfacing as the constant 0 or 1, so that a Mix Shader
driven by it gives each side its own shader. What cannot be expressed is approximated by its base colour and reported
with the names of its owner and node.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..report import Report
from .colors import Color, rgb
from .images import Textures
from .nodes import Source, default_value, label, source

# Inputs that take Principled BSDF away from pure diffuse: names (they differ between versions) and the harmless value.
PRINCIPLED_EXTRAS: tuple[tuple[str, float], ...] = (
    ("Metallic", 0.0),
    ("Alpha", 1.0),
    ("Diffuse Roughness", 0.0),
    ("Subsurface Weight", 0.0),
    ("Transmission Weight", 0.0),
    ("Coat Weight", 0.0),
    ("Sheen Weight", 0.0),
    ("Thin Wall", 0.0),
)
SPECULAR = "Specular IOR Level"
INVISIBLE_SHADERS = {"BSDF_TRANSPARENT", "HOLDOUT"}
MATH: dict[str, Callable[[float, float], float]] = {
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
    "MULTIPLY": lambda a, b: a * b,
    "DIVIDE": lambda a, b: a / b if b else 0.0,
    "POWER": lambda a, b: float(abs(a) ** b) if a or b > 0 else 0.0,
    "MINIMUM": min,
    "MAXIMUM": max,
    "LESS_THAN": lambda a, b: float(a < b),
    "GREATER_THAN": lambda a, b: float(a > b),
    "ABSOLUTE": lambda a, _: abs(a),
}


@dataclass(slots=True)
class Closure:
    """Diffuse albedo and emitted radiance of one side; `visible` is how much of the surface is there (1 = opaque)."""

    diffuse: Color = field(default_factory=Color)
    emission: Color = field(default_factory=Color)
    visible: float = 1.0

    def __mul__(self, factor: float) -> Closure:
        return Closure(self.diffuse * factor, self.emission * factor, self.visible)

    def __add__(self, other: Closure) -> Closure:
        return Closure(self.diffuse + other.diffuse, self.emission + other.emission, max(self.visible, other.visible))


class Reducer:
    """Reduces the shaders of one owner (a material, light or world, named as in "Material 'Wall'")."""

    def __init__(self, owner: str, textures: Textures, report: Report, backfacing: bool = False, uv_map: str | None = None) -> None:
        self.owner, self.textures, self.report = owner, textures, report
        self.backfacing, self.uv_map = backfacing, uv_map

    def approximated(self, node: Any, how: str) -> None:
        self.report.warn(f"{self.owner}, node '{label(node)}': {how}")

    # --- shaders ---

    def shader(self, src: Source | None) -> Closure:
        if src is None or src.node is None:
            return Closure()
        handler = getattr(self, f"_shader_{src.node.type.lower()}", self._shader_other)
        return handler(src)

    def _shader_bsdf_diffuse(self, src: Source) -> Closure:
        left_out = [name for name in ("Roughness",) if self._differs(src, name, 0.0)] + self._linked(src, "Normal")
        if left_out:
            self.approximated(src.node, f"{', '.join(left_out)} left out")
        return Closure(diffuse=self.color(src.input("Color")))

    def _shader_bsdf_principled(self, src: Source) -> Closure:
        extras = [name for name, harmless in PRINCIPLED_EXTRAS if self._differs(src, name, harmless)]
        extras += self._linked(src, "Normal")
        specular = self._differs(src, SPECULAR, 0.0) and self._differs(src, "IOR", 1.0)
        if extras:
            names = [*extras, SPECULAR] if specular else extras
            self.approximated(src.node, f"approximated by its base colour; {', '.join(names)} left out")
        elif specular:
            name = f"{self.owner.replace('Material ', '').strip(chr(39))} / {label(src.node)}"
            self.report.warn(f"Approximated by the base colour; specular reflection ({SPECULAR}) left out: {{}}", name)
        emission = Color()
        strength = self.number(src.input("Emission Strength"))
        if strength:
            emission = self.color(src.input("Emission Color", "Emission")) * strength
        return Closure(self.color(src.input("Base Color")), emission)

    def _shader_emission(self, src: Source) -> Closure:
        return Closure(emission=self.color(src.input("Color")) * self.number(src.input("Strength")))

    _shader_background = _shader_emission

    def _shader_add_shader(self, src: Source) -> Closure:
        first, second = (self.shader(source(socket, src.groups)) for socket in src.node.inputs[:2])
        return first + second

    def _shader_mix_shader(self, src: Source) -> Closure:
        factor = min(max(self.number(source(src.node.inputs[0], src.groups)), 0.0), 1.0)
        if factor in (0.0, 1.0):
            return self.shader(source(src.node.inputs[1 + int(factor)], src.groups))
        first, second = (self.shader(source(socket, src.groups)) for socket in src.node.inputs[1:3])
        if first.visible != second.visible:
            return first if first.visible else second
        return first * (1.0 - factor) + second * factor

    def _shader_other(self, src: Source) -> Closure:
        """By its base colour; shaders that let everything through yield to what they are mixed with."""
        node = src.node
        color = src.input("Color", "Base Color", "Tint", "Main Color")
        invisible = node.type in INVISIBLE_SHADERS
        how = "not supported; what it is mixed with is taken alone, or else its colour" if invisible else "approximated by its base colour"
        self.approximated(node, f"{node.bl_label} {how}")
        return Closure(diffuse=self.color(color) if color else Color(rgb(0.8)), visible=0.0 if invisible else 1.0)

    # --- colours ---

    def color(self, src: Source | None) -> Color:
        if src is None:
            return Color()
        if src.node is None:
            value = default_value(src.socket)
            return Color(rgb(value if value is not None else 0.0))
        handler = getattr(self, f"_color_{src.node.type.lower()}", None)
        if handler is not None:
            return handler(src)
        if src.socket.type == "VALUE":
            return Color(rgb(self.number(src)))
        return self._color_other(src)

    def _color_rgb(self, src: Source) -> Color:
        return Color(rgb(default_value(src.node.outputs[0])))

    def _color_tex_image(self, src: Source) -> Color:
        node = src.node
        self._check_coordinates(src)
        if node.projection != "FLAT":
            self.approximated(node, f"{node.projection.capitalize()} projection not supported; the UV map is used")
        if node.interpolation == "Cubic":
            self.approximated(node, "Cubic interpolation read as Linear")
        index = self.textures.of_node(node, f"{self.owner}, node '{label(node)}'")
        if src.socket.name == "Alpha":
            self.approximated(node, "Alpha not supported; read as 1")
            return Color(np.ones(3))
        return Color(textured={index: np.ones(3)})

    def _color_tex_environment(self, src: Source) -> Color:
        self.approximated(src.node, "environment image approximated by its mean colour")
        index = self.textures.of_node(src.node, f"{self.owner}, node '{label(src.node)}'")
        return Color(self.textures.mean(index))

    def _color_mix_rgb(self, src: Source) -> Color:
        sockets = src.node.inputs
        factor, a, b = (source(socket, src.groups) for socket in sockets[:3])
        return self._blend(src, factor, a, b, src.node.use_clamp)

    def _color_mix(self, src: Source) -> Color:
        node = src.node
        if node.data_type != "RGBA":
            return self._color_other(src)
        factor, a, b = (source(s, src.groups) for s in node.inputs if s.identifier in {"Factor_Float", "A_Color", "B_Color"})
        return self._blend(src, factor, a, b, node.clamp_result)

    def _blend(self, src: Source, factor_source: Source, a_source: Source, b_source: Source, clamp: bool) -> Color:
        factor = self.number(factor_source)
        if getattr(src.node, "clamp_factor", True):
            factor = min(max(factor, 0.0), 1.0)
        a, b = self.color(a_source), self.color(b_source)
        kind = src.node.blend_type
        if kind == "ADD":
            mixed = a + b * factor
        elif kind == "SUBTRACT":
            mixed = a + b * -factor
        elif kind == "MULTIPLY" and (a.is_constant or b.is_constant):
            mixed = a * (1.0 - factor) + (b * a.constant if a.is_constant else a * b.constant) * factor
        else:
            if kind != "MIX":
                self.approximated(src.node, f"{kind.replace('_', ' ').title()} approximated by a plain mix")
            mixed = a * (1.0 - factor) + b * factor
        if clamp and mixed.is_constant:
            mixed = Color(np.clip(mixed.constant, 0.0, 1.0))
        return mixed

    def _color_other(self, src: Source) -> Color:
        """By the first colour that goes into the node (the mean of those of a pattern), or the value the socket has without the link."""
        node = src.node
        colors = [self.color(source(s, src.groups)) for s in node.inputs if s.type == "RGBA" and getattr(s, "enabled", True)]
        self.approximated(node, f"{node.bl_label} not supported; approximated by a colour that goes into it")
        if not colors:
            consumer = next((link.to_socket for link in src.socket.links), None)
            value = default_value(consumer) if consumer is not None else None
            return Color(rgb(value if value is not None else 0.5))
        if node.type in {"TEX_CHECKER", "TEX_BRICK"}:
            return (colors[0] + colors[1]) * 0.5
        return colors[0]

    def _check_coordinates(self, src: Source) -> None:
        """Report coordinates of an image texture that are not the mesh's render-active UV map."""
        vector = src.input("Vector")
        if vector is None or vector.node is None:
            return
        node = vector.node
        if node.type == "TEX_COORD" and vector.socket.name == "UV" and not node.from_instancer:
            return
        if node.type == "UVMAP" and (not node.uv_map or self.uv_map is None or node.uv_map == self.uv_map):
            return
        what = f"UV map '{node.uv_map}'" if node.type == "UVMAP" else f"{node.bl_label} > {vector.socket.name}"
        self.approximated(node, f"{what} not supported; the render-active UV map is used as it is")

    # --- numbers ---

    def number(self, src: Source | None) -> float:
        if src is None:
            return 0.0
        if src.node is None:
            value = default_value(src.socket)
            return _average(value)
        node, name = src.node, src.socket.name
        if node.type == "NEW_GEOMETRY" and name == "Backfacing":
            return float(self.backfacing)
        if node.type == "VALUE":
            return _average(default_value(node.outputs[0]))
        if node.type == "MATH" and node.operation in MATH:
            values = [self.number(source(socket, src.groups)) for socket in node.inputs[:2]]
            result = MATH[node.operation](*values)
            return min(max(result, 0.0), 1.0) if node.use_clamp else result
        if node.type == "LIGHT_FALLOFF" and name == "Quadratic" and not self._differs(src, "Smooth", 0.0):
            return self.number(src.input("Strength"))
        if src.socket.type == "RGBA":
            return float(np.dot(self.color(src).mean(self.textures), (0.2126, 0.7152, 0.0722)))
        consumer = next((link.to_socket for link in src.socket.links), None)
        value = _average(default_value(consumer)) if consumer is not None else 0.5
        self.approximated(node, f"{node.bl_label} > {name} not supported; replaced by the value {value:g}")
        return value

    def _differs(self, src: Source, name: str, harmless: float) -> bool:
        found = src.input(name)
        if found is None:
            return False
        return found.node is not None or abs(_average(default_value(found.socket)) - harmless) > 1e-6

    def _linked(self, src: Source, *names: str) -> list[str]:
        sources = ((name, src.input(name)) for name in names)
        return [name for name, found in sources if found is not None and found.node is not None]


def _average(value: Any) -> float:
    if value is None:
        return 0.0
    return float(np.mean(value[:3])) if isinstance(value, tuple) else float(value)
