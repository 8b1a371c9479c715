"""Nodes that turn values into values: mathematics, mixing, ramps and curves, colours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .node import Node
from .values import ONE, ORIGIN, ZERO, Value, vector

Outputs = dict[str, Value]
TABLE_SIZE = 256  # entries of ramps and curves, as in Cycles


def math(n: Node) -> Outputs:
    a, b, c = (n.number(name) for name in ("Value", "Value_001", "Value_002"))
    return {
        "Value": n.graph.one(
            "Math", a=a, b=b, c=c, operation=n.node.operation, use_clamp=n.node.use_clamp
        )
    }


def vector_math(n: Node) -> Outputs:
    a, b, c = (n.vector(name) for name in ("Vector", "Vector_001", "Vector_002"))
    results = n.graph.add(
        "VectorMath", a=a, b=b, c=c, scale=n.number("Scale", 1.0), operation=n.node.operation
    )
    return {"Vector": results["vector"], "Value": results["value"]}


def mix(n: Node) -> Outputs:
    node, kind = n.node, n.node.data_type
    clamp = bool(node.clamp_factor)
    if kind == "FLOAT":
        factor, a, b = n.number("Factor_Float"), n.number("A_Float"), n.number("B_Float")
        return {
            "Result_Float": n.graph.one("MixFloat", factor=factor, a=a, b=b, clamp_factor=clamp)
        }
    if kind == "VECTOR":
        a, b = n.vector("A_Vector"), n.vector("B_Vector")
        if node.factor_mode == "UNIFORM":
            return {
                "Result_Vector": n.graph.one(
                    "MixVector", factor=n.number("Factor_Float"), a=a, b=b, clamp_factor=clamp
                )
            }
        factor = n.vector("Factor_Vector")
        return {
            "Result_Vector": n.graph.one(
                "MixVectorNonUniform", factor=factor, a=a, b=b, clamp_factor=clamp
            )
        }
    if kind == "RGBA":
        a, b = n.color("A_Color"), n.color("B_Color")
        return {
            "Result_Color": _mix_color(
                n, n.number("Factor_Float"), a, b, clamp, bool(node.clamp_result)
            )
        }
    n.unsupported(f"of {kind.lower()}s is not supported; A is taken")
    return {"Result_Rotation": n.vector("A_Rotation")}


def mix_rgb(n: Node) -> Outputs:
    return {
        "Color": _mix_color(
            n, n.number("Fac"), n.color("Color1"), n.color("Color2"), True, bool(n.node.use_clamp)
        )
    }


def _mix_color(
    n: Node, factor: Value, a: Value, b: Value, clamp_factor: bool, clamp_result: bool
) -> Value:
    return n.graph.one(
        "MixColor",
        factor=factor,
        a=a,
        b=b,
        blend_type=n.node.blend_type,
        clamp_factor=clamp_factor,
        clamp_result=clamp_result,
    )


def map_range(n: Node) -> Outputs:
    node = n.node
    modes = {"interpolation_type": node.interpolation_type, "clamp": bool(node.clamp)}
    ends: dict[str, Value] = {}
    if node.data_type == "FLOAT":
        for end in ("From", "To"):
            for limit in ("Min", "Max"):
                ends[f"{end}_{limit}".lower()] = n.number(f"{end} {limit}")
        return {
            "Result": n.graph.one(
                "MapRange", value=n.number("Value"), steps=n.number("Steps", 4.0), **ends, **modes
            )
        }
    ends = {
        f"{end}_{m}": n.vector(f"{end.title()}_{m.title()}_FLOAT3")
        for end in ("from", "to")
        for m in ("min", "max")
    }
    steps = n.vector("Steps_FLOAT3", (4.0, 4.0, 4.0))
    return {
        "Vector": n.graph.one(
            "MapRangeVector", value=n.vector("Vector"), steps=steps, **ends, **modes
        )
    }


def clamp(n: Node) -> Outputs:
    limits = {"min": n.number("Min"), "max": n.number("Max", 1.0)}
    return {
        "Result": n.graph.one(
            "Clamp", value=n.number("Value"), clamp_type=n.node.clamp_type, **limits
        )
    }


def color_ramp(n: Node) -> Outputs:
    ramp = n.node.color_ramp
    table = [float(TABLE_SIZE)]
    for k in range(TABLE_SIZE):
        table.extend(ramp.evaluate(k / (TABLE_SIZE - 1)))
    results = n.graph.add(
        "ColorRamp",
        factor=n.number("Fac"),
        table=tuple(table),
        interpolate=ramp.interpolation != "CONSTANT",
    )
    return {"Color": results["color"], "Alpha": results["alpha"]}


def float_curve(n: Node) -> Outputs:
    mapping = n.node.mapping
    sample, low, high = _curves(mapping, 1)
    table = _table(lambda t: [sample(0, t)], low, high)
    limits = {
        "min_x": _number(low),
        "max_x": _number(high),
        "extrapolate": mapping.extend == "EXTRAPOLATED",
    }
    return {
        "Value": n.graph.one(
            "FloatCurve", factor=n.number("Factor"), value=n.number("Value"), table=table, **limits
        )
    }


def rgb_curves(n: Node) -> Outputs:
    mapping = n.node.mapping
    sample, low, high = _curves(mapping, 4)
    table = _table(lambda t: [sample(k, sample(3, t)) for k in range(3)], low, high)
    return {"Color": _three_curves(n, "Color", table, low, high)}


def vector_curves(n: Node) -> Outputs:
    mapping = n.node.mapping
    sample, low, high = _curves(mapping, 3)
    return {
        "Vector": _three_curves(
            n, "Vector", _table(lambda t: [sample(k, t) for k in range(3)], low, high), low, high
        )
    }


def _three_curves(n: Node, name: str, table: tuple[float, ...], low: float, high: float) -> Value:
    extrapolate = n.node.mapping.extend == "EXTRAPOLATED"
    value, factor = n.vector(name), n.number("Fac", 1.0)
    return n.graph.one(
        "Curves",
        factor=factor,
        value=value,
        table=table,
        min_x=_number(low),
        max_x=_number(high),
        extrapolate=extrapolate,
    )


def _curves(mapping: Any, count: int) -> tuple[Callable[[int, float], float], float, float]:
    """A function of the curve and the position, and the range in which curves have points."""
    mapping.initialize()
    curves = [mapping.curves[k] for k in range(count)]
    low = min(curve.points[0].location.x for curve in curves)
    high = max(curve.points[-1].location.x for curve in curves)
    return lambda k, x: mapping.evaluate(curves[k], x), low, high


def _table(sample: Callable[[float], list[float]], low: float, high: float) -> tuple[float, ...]:
    table = [float(TABLE_SIZE)]
    for k in range(TABLE_SIZE):
        table.extend(sample(low + (high - low) * k / (TABLE_SIZE - 1)))
    return tuple(table)


def _number(value: float) -> Value:
    return Value(1, -1, (float(value),))


def hue_saturation(n: Node) -> Outputs:
    inputs = {
        "hue": n.number("Hue"),
        "saturation": n.number("Saturation"),
        "value": n.number("Value"),
        "factor": n.number("Fac"),
    }
    return {"Color": n.graph.one("HueSaturation", color=n.color("Color"), **inputs)}


def bright_contrast(n: Node) -> Outputs:
    return {
        "Color": n.graph.one(
            "BrightContrast",
            color=n.color("Color"),
            bright=n.number("Bright"),
            contrast=n.number("Contrast"),
        )
    }


def gamma(n: Node) -> Outputs:
    return {"Color": n.graph.one("Gamma", color=n.color("Color"), gamma=n.number("Gamma"))}


def invert(n: Node) -> Outputs:
    return {"Color": n.graph.one("Invert", factor=n.number("Fac"), color=n.color("Color"))}


def rgb_to_bw(n: Node) -> Outputs:
    return {"Val": n.graph.one("Luminance", color=n.color("Color"))}


def separate_xyz(n: Node) -> Outputs:
    v = n.vector("Vector")
    return {name: v.component(k) for k, name in enumerate("XYZ")}


def combine_xyz(n: Node) -> Outputs:
    return {"Vector": _combined(n, "RGB", [n.number(name) for name in "XYZ"])}


def _combined(n: Node, mode: str, parts: list[Value]) -> Value:
    a, b, c = parts
    return n.graph.one("CombineColor", a=a, b=b, c=c, mode=mode)


def separate_color(n: Node) -> Outputs:
    return _separated(n, n.color("Color"), n.node.mode, ("Red", "Green", "Blue"))


def separate_rgb(n: Node) -> Outputs:
    return _separated(n, n.color("Image"), "RGB", ("R", "G", "B"))


def separate_hsv(n: Node) -> Outputs:
    return _separated(n, n.color("Color"), "HSV", ("H", "S", "V"))


def _separated(n: Node, color: Value, mode: str, names: tuple[str, str, str]) -> Outputs:
    if mode == "RGB":
        return {name: color.component(k) for k, name in enumerate(names)}
    results = n.graph.add("SeparateColor", color=color, mode=mode)
    return dict(zip(names, (results["a"], results["b"], results["c"]), strict=True))


def combine_color(n: Node) -> Outputs:
    return {
        "Color": _combined(n, n.node.mode, [n.number(name) for name in ("Red", "Green", "Blue")])
    }


def combine_rgb(n: Node) -> Outputs:
    return {"Image": _combined(n, "RGB", [n.number(name) for name in "RGB"])}


def combine_hsv(n: Node) -> Outputs:
    return {"Color": _combined(n, "HSV", [n.number(name) for name in "HSV"])}


def blackbody(n: Node) -> Outputs:
    return {"Color": n.graph.one("Blackbody", temperature=n.number("Temperature"))}


def wavelength(n: Node) -> Outputs:
    return {"Color": n.graph.one("Wavelength", wavelength=n.number("Wavelength"))}


def vector_transform(n: Node) -> Outputs:
    node = n.node
    modes = {
        "vector_type": node.vector_type,
        "convert_from": node.convert_from,
        "convert_to": node.convert_to,
    }
    return {"Vector": n.graph.one("VectorTransform", vector=n.vector("Vector"), **modes)}


def vector_rotate(n: Node) -> Outputs:
    inputs = {name.lower(): n.vector(name) for name in ("Vector", "Center", "Axis", "Rotation")}
    modes = {"rotation_type": n.node.rotation_type, "invert": bool(n.node.invert)}
    return {"Vector": n.graph.one("VectorRotate", angle=n.number("Angle"), **inputs, **modes)}


def mapping(n: Node) -> Outputs:
    inputs = {name.lower(): n.vector(name) for name in ("Vector", "Location", "Rotation")}
    scale = n.vector("Scale", (1.0, 1.0, 1.0))
    kind = n.node.vector_type
    if all(v.is_constant for v in (inputs["location"], inputs["rotation"], scale)):
        matrix = mapping_matrix(kind, inputs["location"].data, inputs["rotation"].data, scale.data)
        if matrix is not None:
            return {"Vector": n.graph.one("TransformPoint", point=inputs["vector"], matrix=matrix)}
    return {"Vector": n.graph.one("Mapping", scale=scale, vector_type=kind, **inputs)}


def mapping_matrix(
    kind: str, location: Sequence[float], rotation: Sequence[float], scale: Sequence[float]
) -> tuple[float, ...] | None:
    """3x4 matrix, in rows, of a Mapping node (radians); None where it is no affine map: normals,
    and textures of scale 0.
    """
    if kind == "NORMAL" or (kind == "TEXTURE" and not all(scale)):
        return None
    (cx, cy, cz), (sx, sy, sz) = np.cos(rotation), np.sin(rotation)
    turned = np.array(
        [
            [cy * cz, sy * sx * cz - cx * sz, sy * cx * cz + sx * sz],
            [cy * sz, sy * sx * sz + cx * cz, sy * cx * sz - sx * cz],
            [-sy, cy * sx, cy * cx],
        ]
    )
    if kind == "TEXTURE":
        linear = turned.T / np.array(scale)[:, None]
        moved = -linear @ np.array(location)
    else:
        linear = turned * np.array(scale)
        moved = np.array(location if kind == "POINT" else (0.0, 0.0, 0.0))
    return tuple(float(v) for v in np.column_stack([linear, moved]).ravel())


def normal(n: Node) -> Outputs:
    def unit(v: Value) -> Value:
        return n.graph.add("VectorMath", a=v, b=ORIGIN, c=ORIGIN, scale=ONE, operation="NORMALIZE")[
            "vector"
        ]

    own = unit(vector(n.node.outputs["Normal"].default_value))
    product = n.graph.add(
        "VectorMath",
        a=own,
        b=unit(n.vector("Normal")),
        c=ORIGIN,
        scale=ONE,
        operation="DOT_PRODUCT",
    )
    return {"Normal": own, "Dot": product["value"]}


def value(n: Node) -> Outputs:
    return {"Value": n.own_value(n.node.outputs[0]) or ZERO}


def rgb(n: Node) -> Outputs:
    return {"Color": n.own_value(n.node.outputs[0]) or ORIGIN}
