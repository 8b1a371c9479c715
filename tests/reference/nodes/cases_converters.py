"""Cases of mathematics, mixing, ramps, curves and colours."""

from __future__ import annotations

from typing import Any

from tests.reference.nodes.cases import Case, enum, exists


def cases() -> list[Case]:
    return [*_math(), *_vector_math(), *_mixes(), *_ranges(), *_curves(), *_colors(), *_vectors()]


def _math() -> list[Case]:
    found = []
    for operation in enum("ShaderNodeMath", "operation"):
        for clamp in (False, True):
            inputs = {"Value": "x", "Value_001": "y", "Value_002": 0.4}
            properties = {"operation": operation, "use_clamp": clamp}
            found.append(
                Case(f"math {operation} {clamp}", "ShaderNodeMath", "Value", properties, inputs)
            )
    inputs = {"Value": "u", "Value_001": "h", "Value_002": "y"}
    found += [
        Case(
            f"math {operation} positive",
            "ShaderNodeMath",
            "Value",
            {"operation": operation},
            inputs,
        )
        for operation in (
            "POWER",
            "LOGARITHM",
            "SMOOTH_MIN",
            "SMOOTH_MAX",
            "WRAP",
            "COMPARE",
            "PINGPONG",
            "SNAP",
        )
    ]
    for operation in ("DIVIDE", "MODULO", "FLOORED_MODULO", "POWER", "SNAP", "PINGPONG"):
        constant = {"Value": "x", "Value_001": 0.0}
        found.append(
            Case(
                f"math {operation} zero",
                "ShaderNodeMath",
                "Value",
                {"operation": operation},
                constant,
            )
        )
    return found


def _vector_math() -> list[Case]:
    found = []
    for operation in enum("ShaderNodeVectorMath", "operation"):
        output = "Value" if operation in {"DOT_PRODUCT", "DISTANCE", "LENGTH"} else "Vector"
        inputs: dict[str, Any] = {
            "Vector": "p",
            "Vector_001": "q",
            "Vector_002": (0.3, -0.5, 0.7),
            "Scale": 0.8,
        }
        found.append(
            Case(
                f"vector {operation}",
                "ShaderNodeVectorMath",
                output,
                {"operation": operation},
                inputs,
            )
        )
        constant: dict[str, Any] = {"Vector": "p", "Vector_001": (0.7, 0.0, -0.4)}
        found.append(
            Case(
                f"vector {operation} constant",
                "ShaderNodeVectorMath",
                output,
                {"operation": operation},
                constant,
            )
        )
    return found


def _mixes() -> list[Case]:
    found = []
    for kind in enum("ShaderNodeMix", "blend_type"):
        for k, (factor, clamp) in enumerate((("u", False), (0.7, True), ("x", False))):
            properties = {
                "data_type": "RGBA",
                "blend_type": kind,
                "clamp_result": clamp,
                "clamp_factor": factor != "x",
            }
            inputs = {"Factor_Float": factor, "A_Color": "c", "B_Color": "d"}
            found.append(
                Case(f"mix {kind} {k}", "ShaderNodeMix", "Result_Color", properties, inputs)
            )
        inputs = {"Factor_Float": 1.0, "A_Color": "p", "B_Color": "q"}
        found.append(
            Case(
                f"mix {kind} signed",
                "ShaderNodeMix",
                "Result_Color",
                {"data_type": "RGBA", "blend_type": kind},
                inputs,
            )
        )
        old = {"Fac": "x", "Color1": "c", "Color2": "d"}
        found.append(
            Case(
                f"mix rgb {kind}",
                "ShaderNodeMixRGB",
                "Color",
                {"blend_type": kind, "use_clamp": kind == "ADD"},
                old,
            )
        )
    for clamp in (False, True):
        common = {"clamp_factor": clamp}
        inputs = {"Factor_Float": "x", "A_Float": "y", "B_Float": 0.4}
        found.append(Case(f"mix float {clamp}", "ShaderNodeMix", "Result_Float", common, inputs))
        inputs = {"Factor_Float": "x", "A_Vector": "p", "B_Vector": "q"}
        found.append(
            Case(
                f"mix vector {clamp}",
                "ShaderNodeMix",
                "Result_Vector",
                common | {"data_type": "VECTOR"},
                inputs,
            )
        )
        own = {"Factor_Vector": "p", "A_Vector": "q", "B_Vector": (0.1, 0.5, 0.9)}
        properties = common | {"data_type": "VECTOR", "factor_mode": "NON_UNIFORM"}
        found.append(
            Case(f"mix vectors {clamp}", "ShaderNodeMix", "Result_Vector", properties, own)
        )
    return found


def _ranges() -> list[Case]:
    found = []
    for kind in enum("ShaderNodeMapRange", "interpolation_type"):
        for clamp in (False, True):
            properties = {"interpolation_type": kind, "clamp": clamp}
            ends = {"From Min": -1.0, "From Max": 1.5, "To Min": "y", "To Max": -0.5, "Steps": 5.0}
            found.append(
                Case(
                    f"map range {kind} {clamp}",
                    "ShaderNodeMapRange",
                    "Result",
                    properties,
                    {"Value": "x"} | ends,
                )
            )
            own = {
                "Vector": "p",
                "From_Min_FLOAT3": (-1, 0, -2),
                "From_Max_FLOAT3": (1, 1, 2),
                "To_Min_FLOAT3": "q",
            }
            own |= {"To_Max_FLOAT3": (0, 1, 3), "Steps_FLOAT3": (2, 3, 4)}
            properties |= {"data_type": "FLOAT_VECTOR"}
            found.append(
                Case(
                    f"map range vector {kind} {clamp}",
                    "ShaderNodeMapRange",
                    "Vector",
                    properties,
                    own,
                )
            )
        reversed_ends = {
            "Value": "x",
            "From Min": 1.0,
            "From Max": -1.0,
            "To Min": 2.0,
            "To Max": 0.5,
            "Steps": 3.0,
        }
        found.append(
            Case(
                f"map range {kind} reversed",
                "ShaderNodeMapRange",
                "Result",
                {"interpolation_type": kind},
                reversed_ends,
            )
        )
        none = {"Value": "x", "From Min": 0.5, "From Max": 0.5}
        found.append(
            Case(
                f"map range {kind} empty",
                "ShaderNodeMapRange",
                "Result",
                {"interpolation_type": kind},
                none,
            )
        )
    for kind in ("MINMAX", "RANGE"):
        inputs = {"Value": "x", "Min": "y", "Max": 0.5}
        found.append(
            Case(f"clamp {kind}", "ShaderNodeClamp", "Result", {"clamp_type": kind}, inputs)
        )
    return found


def _ramp(mode: str, interpolation: str) -> Any:
    def setup(node: Any) -> None:
        ramp = node.color_ramp
        ramp.color_mode, ramp.interpolation = mode, interpolation
        ramp.elements[0].position, ramp.elements[0].color = 0.1, (0.9, 0.1, 0.2, 0.3)
        ramp.elements[1].position, ramp.elements[1].color = 0.8, (0.1, 0.3, 0.8, 1.0)
        ramp.elements.new(0.45).color = (0.2, 0.9, 0.4, 0.7)

    return setup


def _bend(node: Any) -> None:
    for k, curve in enumerate(node.mapping.curves):
        curve.points.new(0.3, 0.55 + 0.05 * k)
        curve.points.new(0.7, 0.4 + 0.1 * k)
    node.mapping.update()


def _bend_wide(node: Any) -> None:
    node.mapping.use_clip = False
    node.mapping.extend = "HORIZONTAL"
    for k, curve in enumerate(node.mapping.curves):
        curve.points[0].location = (-0.5, 0.2)
        curve.points[-1].location = (1.2, 0.9 - 0.1 * k)
        curve.points.new(0.3, 0.6)
    node.mapping.update()


def _curves() -> list[Case]:
    found = []
    for interpolation in ("EASE", "CARDINAL", "LINEAR", "B_SPLINE", "CONSTANT"):
        for output in ("Color", "Alpha"):
            setup = _ramp("RGB", interpolation)
            found.append(
                Case(
                    f"ramp {interpolation} {output}",
                    "ShaderNodeValToRGB",
                    output,
                    inputs={"Fac": "x"},
                    setup=setup,
                )
            )
    found += [
        Case(
            f"ramp {m}",
            "ShaderNodeValToRGB",
            "Color",
            inputs={"Fac": "u"},
            setup=_ramp(m, "LINEAR"),
        )
        for m in ("HSV", "HSL")
    ]
    for name, bend in (("", _bend), (" wide", _bend_wide)):
        found.append(
            Case(
                f"float curve{name}",
                "ShaderNodeFloatCurve",
                "Value",
                inputs={"Factor": "v", "Value": "x"},
                setup=bend,
            )
        )
        found.append(
            Case(
                f"rgb curves{name}",
                "ShaderNodeRGBCurve",
                "Color",
                inputs={"Fac": "v", "Color": "p"},
                setup=bend,
            )
        )
        found.append(
            Case(
                f"vector curves{name}",
                "ShaderNodeVectorCurve",
                "Vector",
                inputs={"Fac": 0.8, "Vector": "p"},
                setup=bend,
            )
        )
    return found


def _colors() -> list[Case]:
    found = []
    for k, inputs in enumerate(
        (
            {"Hue": "u", "Saturation": 1.3},
            {"Hue": 0.6, "Saturation": "v", "Value": "u"},
            {"Fac": "u", "Value": 1.7},
        )
    ):
        found.append(
            Case(f"hsv {k}", "ShaderNodeHueSaturation", "Color", inputs=inputs | {"Color": "c"})
        )
    found.append(
        Case(
            "bright",
            "ShaderNodeBrightContrast",
            "Color",
            inputs={"Color": "c", "Bright": "x", "Contrast": "y"},
        )
    )
    found.append(Case("gamma", "ShaderNodeGamma", "Color", inputs={"Color": "c", "Gamma": "y"}))
    found.append(
        Case("gamma signed", "ShaderNodeGamma", "Color", inputs={"Color": "p", "Gamma": 2.2})
    )
    found.append(Case("invert", "ShaderNodeInvert", "Color", inputs={"Color": "c", "Fac": "x"}))
    found.append(Case("bw", "ShaderNodeRGBToBW", "Val", inputs={"Color": "p"}))
    for mode in ("RGB", "HSV", "HSL"):
        for output in ("Red", "Green", "Blue"):
            name = f"separate {mode} {output}"
            found.append(
                Case(name, "ShaderNodeSeparateColor", output, {"mode": mode}, {"Color": "c"})
            )
        inputs = {"Red": "u", "Green": "v", "Blue": 0.7}
        found.append(
            Case(f"combine {mode}", "ShaderNodeCombineColor", "Color", {"mode": mode}, inputs)
        )
        signed = {"Red": "x", "Green": "y", "Blue": "u"}
        found.append(
            Case(
                f"combine {mode} signed", "ShaderNodeCombineColor", "Color", {"mode": mode}, signed
            )
        )
    for kind, parts in (("RGB", "RGB"), ("HSV", "HSV")):
        if exists(f"ShaderNodeSeparate{kind}"):
            image = "Image" if kind == "RGB" else "Color"
            inputs = dict(zip(parts, ("u", "v", 0.3), strict=True))
            found.append(
                Case(f"old combine {kind}", f"ShaderNodeCombine{kind}", image, inputs=inputs)
            )
            found += [
                Case(
                    f"old separate {kind} {p}", f"ShaderNodeSeparate{kind}", p, inputs={image: "c"}
                )
                for p in parts
            ]
    found.append(Case("separate xyz", "ShaderNodeSeparateXYZ", "Z", inputs={"Vector": "p"}))
    found.append(
        Case("combine xyz", "ShaderNodeCombineXYZ", "Vector", inputs={"X": "u", "Y": 0.3, "Z": "y"})
    )
    for k, scale in enumerate((3000.0, 14000.0)):
        found.append(
            Case(
                f"blackbody {k}",
                "",
                "",
                build=lambda tree, scale=scale: _scaled(tree, "ShaderNodeBlackbody", 500.0, scale),
            )
        )
    found.append(
        Case(
            "wavelength",
            "",
            "",
            build=lambda tree: _scaled(tree, "ShaderNodeWavelength", 370.0, 420.0),
        )
    )
    return found


def _scaled(tree: Any, node: str, low: float, width: float) -> Any:
    """A node of one number that runs from `low` over `width`."""
    from tests.reference.nodes.cases import Sources

    made, scale = tree.nodes.new(node), tree.nodes.new("ShaderNodeMath")
    scale.operation = "MULTIPLY_ADD"
    tree.links.new(Sources(tree).get("u"), scale.inputs[0])
    scale.inputs[1].default_value, scale.inputs[2].default_value = width, low
    tree.links.new(scale.outputs[0], made.inputs[0])
    return made.outputs[0]


def _vectors() -> list[Case]:
    found = []
    for kind in enum("ShaderNodeMapping", "vector_type"):
        inputs = {
            "Vector": "p",
            "Location": (0.1, -0.2, 0.3),
            "Rotation": (0.3, 0.5, -0.7),
            "Scale": (1.5, 0.7, -2.0),
        }
        found.append(
            Case(f"mapping {kind}", "ShaderNodeMapping", "Vector", {"vector_type": kind}, inputs)
        )
        inputs = {"Vector": (0.3, 0.6, 0.9), "Location": "p", "Rotation": "q", "Scale": "c"}
        found.append(
            Case(
                f"mapping {kind} swept",
                "ShaderNodeMapping",
                "Vector",
                {"vector_type": kind},
                inputs,
            )
        )
    for kind in enum("ShaderNodeVectorRotate", "rotation_type"):
        for invert in (False, True):
            inputs = {
                "Vector": "p",
                "Center": (0.2, 0.1, 0.3),
                "Axis": (0.3, 0.5, 1.0),
                "Rotation": (0.4, -0.3, 1.2),
                "Angle": "x",
            }
            properties = {"rotation_type": kind, "invert": invert}
            found.append(
                Case(
                    f"rotate {kind} {invert}",
                    "ShaderNodeVectorRotate",
                    "Vector",
                    properties,
                    inputs,
                )
            )
    for kind in ("POINT", "VECTOR", "NORMAL"):
        for source in ("WORLD", "OBJECT", "CAMERA"):
            for target in ("WORLD", "OBJECT", "CAMERA"):
                properties = {"vector_type": kind, "convert_from": source, "convert_to": target}
                name = f"transform {kind} {source} {target}"
                found.append(
                    Case(
                        name,
                        "ShaderNodeVectorTransform",
                        "Vector",
                        properties,
                        {"Vector": "p"},
                        thing="sphere",
                    )
                )
    return found
