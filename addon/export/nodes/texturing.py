"""Texture nodes."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np

from ...core.scene import SunDisc
from ..directions import direction_map
from ..image_pixels import is_associated
from ..sky import ExportedSky, export_sky, sun_disc
from .inputs import uv
from .links import Source
from .node import Node, label
from .values import ONE, ORIGIN, ZERO, Value, number, vector

Outputs = dict[str, Value]


def _grey(n: Node, fac: Value) -> Outputs:
    return {"Color": n.graph.one("Spread", value=fac), "Fac": fac}


def coordinates(n: Node, default: Value | None = None) -> Value:
    """What the Vector input brings (or else `default`, or Generated coordinates), moved by the
    node's own texture mapping.
    """
    point = n.values.get("Vector") or default or n.generated()
    matrix = texture_matrix(n.node.texture_mapping)
    if matrix is None:
        return point
    moved = n.graph.one("TransformPoint", point=point, matrix=matrix)
    if n.node.texture_mapping.vector_type != "NORMAL":
        return moved
    return n.graph.add("VectorMath", a=moved, b=moved, c=moved, scale=ONE, operation="NORMALIZE")[
        "vector"
    ]


def texture_matrix(mapping: Any) -> tuple[float, ...] | None:
    """3x4 matrix, in rows, of a texture node's own mapping (set by scripts and old files only);
    None: it changes nothing.
    """
    from mathutils import Euler, Matrix

    axes = (mapping.mapping_x, mapping.mapping_y, mapping.mapping_z)
    location, scale = mapping.translation, mapping.scale
    rotation = Euler(mapping.rotation)
    if (
        axes == ("X", "Y", "Z")
        and not any(location)
        and not any(rotation)
        and all(s == 1.0 for s in scale)
    ):
        return None
    moved = Matrix.Translation(location)
    turned = rotation.to_matrix().to_4x4()
    kind = mapping.vector_type
    sizes = (
        [max(abs(s), 1e-5) * (-1.0 if s < 0 else 1.0) for s in scale]
        if kind in {"TEXTURE", "NORMAL"}
        else list(scale)
    )
    scaled = Matrix.Diagonal((*sizes, 1.0))
    chosen = Matrix(
        [[1.0 if axis == "XYZ"[k] else 0.0 for k in range(3)] + [0.0] for axis in axes]
        + [[0.0, 0.0, 0.0, 1.0]]
    )
    if kind == "POINT":
        whole = moved @ turned @ scaled
    elif kind == "TEXTURE":
        whole = (moved @ turned @ scaled).inverted_safe()
    elif kind == "VECTOR":
        whole = turned @ scaled
    else:
        whole = turned @ scaled.inverted_safe()
    whole = whole @ chosen
    return tuple(float(whole[row][column]) for row in range(3) for column in range(4))


def _tiles(n: Node) -> Outputs:
    """A UDIM image: each tile where it lies, pink where there is none, as in Cycles. Every tile
    costs a look-up.
    """
    node, graph = n.node, n.graph
    where = coordinates(n, uv(n, ""))
    parts = [
        graph.one("Math", a=where.component(k), b=ZERO, c=ZERO, operation="TRUNC", use_clamp=False)
        for k in range(2)
    ]
    whole = graph.one("CombineColor", a=parts[0], b=parts[1], c=ZERO, mode="RGB")
    rest = graph.add("VectorMath", a=where, b=whole, c=ORIGIN, scale=ONE, operation="SUBTRACT")[
        "vector"
    ]
    unassociate = n.wanted("Alpha") and is_associated(node.image)
    color, alpha = vector((1.0, 0.0, 1.0)), ONE
    for tile in node.image.tiles:
        at = divmod(tile.number - 1001, 10)
        inside = ONE
        for axis, coordinate in enumerate(reversed(at)):
            same = graph.one(
                "Math",
                a=whole.component(axis),
                b=number(float(coordinate)),
                c=number(0.5),
                operation="COMPARE",
                use_clamp=False,
            )
            inside = graph.multiply(inside, same)
        found = graph.add(
            "ImageTexture",
            vector=rest,
            image=n.around.textures.of_node(
                node, f"{n.owner.name}, node '{label(node)}'", tile.number
            ),
            projection="FLAT",
            projection_blend=ZERO,
            unassociate=unassociate,
        )
        color = graph.one("MixVector", factor=inside, a=color, b=found["color"], clamp_factor=False)
        alpha = graph.one("MixFloat", factor=inside, a=alpha, b=found["alpha"], clamp_factor=False)
    return {"Color": color, "Alpha": alpha}


def image(n: Node) -> Outputs:
    node = n.node
    if node.image is not None and node.image.source == "TILED" and node.projection == "FLAT":
        return _tiles(n)
    unassociate = n.wanted("Alpha") and is_associated(node.image)
    index = n.around.textures.of_node(node, f"{n.owner.name}, node '{label(node)}'")
    found = n.graph.add(
        "ImageTexture",
        vector=coordinates(n, uv(n, "")),
        image=index,
        projection=node.projection,
        projection_blend=number(node.projection_blend),
        unassociate=unassociate,
    )
    return {"Color": found["color"], "Alpha": found["alpha"]}


def environment(n: Node) -> Outputs:
    node = n.node
    named = f"{n.owner.name}, node '{label(node)}'"
    index = n.around.textures.of_node(node, named)
    if n.owner.of_world:
        n.around.textures.report_below_zero(index, named)
    where = coordinates(n, n.graph.one("Geometry", what="POSITION"))
    return {
        "Color": n.graph.add(
            "EnvironmentTexture",
            vector=where,
            image=index,
            projection=node.projection,
            unassociate=False,
        )["color"]
    }


def noise(n: Node) -> Outputs:
    node = n.node
    numbers = _numbers(
        n,
        w="W",
        scale="Scale",
        detail="Detail",
        roughness="Roughness",
        lacunarity="Lacunarity",
        offset="Offset",
        gain="Gain",
    )
    modes = {name: getattr(node, name) for name in ("noise_dimensions", "noise_type", "normalize")}
    found = n.graph.add(
        "NoiseTexture",
        vector=coordinates(n),
        distortion=n.number("Distortion"),
        **numbers,
        **_dimensional(modes),
    )
    return {"Fac": found["fac"], "Color": found["color"]}


def _numbers(n: Node, **names: str) -> dict[str, Value]:
    return {ours: n.number(theirs) for ours, theirs in names.items()}


def _dimensional(modes: dict[str, Any]) -> dict[str, Any]:
    return {name: bool(value) if name == "normalize" else value for name, value in modes.items()}


def voronoi(n: Node) -> Outputs:
    node = n.node
    numbers = _numbers(
        n,
        w="W",
        scale="Scale",
        detail="Detail",
        roughness="Roughness",
        lacunarity="Lacunarity",
        smoothness="Smoothness",
    )
    numbers |= _numbers(n, exponent="Exponent", randomness="Randomness")
    found = n.graph.add(
        "VoronoiTexture",
        vector=coordinates(n),
        voronoi_dimensions=node.voronoi_dimensions,
        feature=node.feature,
        distance_metric=node.distance,
        normalize=bool(node.normalize),
        hash="PCG" if bpy.app.version >= (5, 0, 0) else "LOOKUP3",
        **numbers,
    )
    names = {
        "Distance": "distance",
        "Color": "color",
        "Position": "position",
        "W": "out_w",
        "Radius": "radius",
    }
    return {theirs: found[ours] for theirs, ours in names.items()}


def wave(n: Node) -> Outputs:
    names = {
        "scale": "Scale",
        "distortion": "Distortion",
        "detail": "Detail",
        "detail_scale": "Detail Scale",
    }
    numbers = _numbers(n, **names, detail_roughness="Detail Roughness", phase_offset="Phase Offset")
    modes = {
        name: getattr(n.node, name)
        for name in ("wave_type", "bands_direction", "rings_direction", "wave_profile")
    }
    return _grey(n, n.graph.one("WaveTexture", vector=coordinates(n), **numbers, **modes))


def magic(n: Node) -> Outputs:
    numbers = _numbers(n, scale="Scale", distortion="Distortion")
    wrap = bpy.app.version >= (5, 0, 0)
    depth = n.node.turbulence_depth
    found = n.graph.add(
        "MagicTexture", vector=coordinates(n), turbulence_depth=depth, wrap_scaled=wrap, **numbers
    )
    return {"Color": found["color"], "Fac": found["fac"]}


def checker(n: Node) -> Outputs:
    colors = {"color1": n.color("Color1"), "color2": n.color("Color2")}
    found = n.graph.add("CheckerTexture", vector=coordinates(n), scale=n.number("Scale"), **colors)
    return {"Color": found["color"], "Fac": found["fac"]}


def brick(n: Node) -> Outputs:
    node = n.node
    colors = {name.lower(): n.color(name) for name in ("Color1", "Color2", "Mortar")}
    numbers = _numbers(
        n,
        scale="Scale",
        mortar_size="Mortar Size",
        mortar_smooth="Mortar Smooth",
        bias="Bias",
        brick_width="Brick Width",
    )
    numbers |= {
        "row_height": n.number("Row Height"),
        "offset": number(node.offset),
        "squash": number(node.squash),
    }
    counts = {"offset_frequency": node.offset_frequency, "squash_frequency": node.squash_frequency}
    found = n.graph.add("BrickTexture", vector=coordinates(n), **colors, **numbers, **counts)
    return {"Color": found["color"], "Fac": found["fac"]}


def gradient(n: Node) -> Outputs:
    return _grey(
        n, n.graph.one("GradientTexture", vector=coordinates(n), gradient_type=n.node.gradient_type)
    )


def white_noise(n: Node) -> Outputs:
    # Unlike other textures this one has no coordinates of its own.
    found = n.graph.add(
        "WhiteNoiseTexture",
        vector=n.vector("Vector"),
        w=n.number("W"),
        noise_dimensions=n.node.noise_dimensions,
    )
    return {"Value": found["value"], "Color": found["color"]}


def gabor(n: Node) -> Outputs:
    numbers = _numbers(
        n,
        scale="Scale",
        frequency="Frequency",
        anisotropy="Anisotropy",
        orientation_2d="Orientation 2D",
    )
    space = n.vector("Orientation 3D", (math.sqrt(2.0), math.sqrt(2.0), 0.0))
    found = n.graph.add(
        "GaborTexture",
        vector=coordinates(n),
        orientation_3d=space,
        gabor_type=n.node.gabor_type,
        **numbers,
    )
    return {"Value": found["value"], "Phase": found["phase"], "Intensity": found["intensity"]}


def sky(n: Node) -> Outputs:
    found = export_sky(n.node, n.around.textures, n.owner.name, n.around.report)
    disc = _disc_of_world(n, found)
    if found.has_disc and disc is None:
        n.warn(
            "the sun's disc is left out here; it is there in a world that turns directions at most"
        )
    matrix = tuple(float(v) for v in found.turn[:3].ravel())
    where = n.graph.one("TransformPoint", point=coordinates(n), matrix=matrix)
    looked_up = n.graph.add(
        "EnvironmentTexture",
        vector=where,
        image=found.texture,
        projection="EQUIRECTANGULAR",
        unassociate=False,
    )
    if disc is None:
        return {"Color": looked_up["color"]}
    n.graph.sun_discs.append(disc)
    color = n.graph.one(
        "SunDisc",
        sky=looked_up["color"],
        vector=where,
        bottom=vector(disc.bottom),
        top=vector(disc.top),
        elevation=number(found.settings.sun_elevation),
        half_angle=number(disc.half_angle),
        horizon=number(disc.horizon),
    )
    return {"Color": color}


def _disc_of_world(n: Node, found: ExportedSky) -> SunDisc | None:
    """Of a world whose sky is turned, and no more than that."""
    if not n.owner.of_world:
        return None
    to_lookup = direction_map(Source(n.node, n.node.outputs[0], n.groups))
    if to_lookup is None or not np.allclose(to_lookup[:3, 3], 0.0, atol=1e-5):
        return None
    turn = to_lookup[:3, :3]
    if not np.allclose(turn @ turn.T, np.eye(3), atol=1e-4) or np.linalg.det(turn) < 0.0:
        return None
    return sun_disc(found, to_lookup, (1.0, 1.0, 1.0))


WITHOUT_PROFILE = 100.0
"""What an IES Texture gives in all directions where Cycles finds no profile."""


def ies(n: Node) -> Outputs:
    from .ies import read_profile

    node = n.node
    strength = n.number("Strength", 1.0)
    try:
        profile = read_profile(node)
    except (OSError, ValueError) as error:
        n.unsupported(f"has no profile that can be read ({error}); shines evenly, as in Cycles")
        return {"Fac": n.graph.multiply(strength, number(WITHOUT_PROFILE))}
    # Unlike other textures: where nothing is linked, the direction it is seen from, in the light's
    # own coordinates.
    seen_from = n.graph.one("Geometry", what="INCOMING")
    where = n.values.get("Vector") or n.graph.one(
        "VectorTransform",
        vector=seen_from,
        vector_type="NORMAL",
        convert_from="WORLD",
        convert_to="OBJECT",
    )
    return {"Fac": n.graph.one("IesTexture", vector=where, strength=strength, profile=profile)}


def no_density(n: Node) -> Outputs:
    n.unsupported("is not supported; taken as empty")
    return {"Color": ORIGIN, "Density": ZERO}
