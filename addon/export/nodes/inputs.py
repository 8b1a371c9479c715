"""Nodes that bring in what the hit, the object, the ray or the camera knows."""

from __future__ import annotations

from typing import Any

import bpy

from .media import grid_value
from .node import Node, Want
from .values import NONE, ONE, ORIGIN, ZERO, Value, number, vector

Outputs = dict[str, Value]
LIGHT_PATH = (
    *(
        "Is Camera Ray",
        "Is Shadow Ray",
        "Is Diffuse Ray",
        "Is Glossy Ray",
        "Is Singular Ray",
        "Is Reflection Ray",
    ),
    *(
        "Is Transmission Ray",
        "Is Volume Scatter Ray",
        "Ray Length",
        "Ray Depth",
        "Diffuse Depth",
        "Glossy Depth",
    ),
    *("Transparent Depth", "Transmission Depth"),
)
OF_VOLUMES = ("Density", "Flame", "Temperature")
DEPTHS = ("Ray Depth", "Diffuse Depth", "Glossy Depth", "Transparent Depth", "Transmission Depth")


def uv(n: Node, name: str) -> Value:
    """Coordinates of a UV map; "": the render-active one."""
    return n.graph.one("UvMap", attribute=uv_id(n, name))


def uv_id(n: Node, name: str) -> int:
    if name:
        n.owner.asked_uv_map = True
    if name not in {"", n.owner.uv_map}:
        return n.around.wants.id("uv", name)
    n.around.wants.active_uv_map = True
    return NONE


def instance_value(n: Node, kind: str, name: str) -> Outputs:
    """Of a light, which has a tree of its own wherever it is: a constant."""
    if n.owner.read is None:
        return n.graph.add("InstanceAttribute", attribute=n.around.wants.id(kind, name))
    value = n.owner.read(Want(kind, name))
    numbers = value if isinstance(value, tuple) else (value,) * 3
    first = numbers[0] if len(numbers) == 1 else sum(numbers[:3]) / 3.0
    return {
        "vector": vector(numbers[:3]),
        "factor": number(first),
        "alpha": number(numbers[3] if len(numbers) == 4 else 1.0),
    }


def texture_coordinate(n: Node) -> Outputs:
    node = n.node
    found = {
        name: n.graph.one("TextureCoordinate", what=name.upper())
        for name in ("Normal", "Camera", "Window", "Reflection")
    }
    if node.from_instancer:
        found["Generated"] = instance_value(n, "info", "generated")["vector"]
        found["UV"] = instance_value(n, "info", "uv")["vector"]
    else:
        found["Generated"] = n.generated()
        found["UV"] = uv(n, "")
    if node.object is None:
        found["Object"] = n.graph.one("TextureCoordinate", what="OBJECT")
    else:
        found["Object"] = into_object(n, node.object)
    return found


def into_object(n: Node, ob: Any) -> Value:
    """The position in the coordinates of another object."""
    if n.around.depsgraph is not None:
        ob = ob.evaluated_get(n.around.depsgraph)
    rows = ob.matrix_world.inverted_safe()
    matrix = tuple(float(rows[i][k]) for i in range(3) for k in range(4))
    return n.graph.one(
        "TransformPoint", point=n.graph.one("Geometry", what="POSITION"), matrix=matrix
    )


def uv_map(n: Node) -> Outputs:
    if n.node.from_instancer:
        return {"UV": instance_value(n, "info", "uv")["vector"]}
    return {"UV": uv(n, n.node.uv_map)}


def geometry(n: Node) -> Outputs:
    names = ("Position", "Tangent", "True Normal", "Incoming", "Parametric")
    found = {name: n.graph.one("Geometry", what=name.upper().replace(" ", "_")) for name in names}
    found["Normal"] = n.shading_normal()
    side = n.owner.backfacing
    found["Backfacing"] = n.graph.one("Backfacing") if side is None else (ONE if side else ZERO)
    if n.wanted("Pointiness"):
        found["Pointiness"] = n.graph.add("Attribute", attribute=n.around.wants.id("pointiness"))[
            "factor"
        ]
    if n.wanted("Random Per Island"):
        found["Random Per Island"] = n.graph.add(
            "Attribute", attribute=n.around.wants.id("island")
        )["factor"]
    return found


def object_info(n: Node) -> Outputs:
    color = instance_value(n, "info", "color")
    return {
        "Location": n.graph.one("ObjectLocation"),
        "Color": color["vector"],
        "Alpha": color["alpha"],
        "Object Index": instance_value(n, "info", "index")["factor"],
        "Material Index": number(getattr(n.owner.id, "pass_index", 0)),
        "Random": instance_value(n, "info", "random")["factor"],
    }


def particle_info(n: Node) -> Outputs:
    numbers = ("Index", "Random", "Age", "Lifetime", "Size")
    vectors = ("Location", "Velocity", "Angular Velocity")
    found = {name: instance_value(n, "particle", name)["factor"] for name in numbers}
    return found | {name: instance_value(n, "particle", name)["vector"] for name in vectors}


OF_SURFACES = {
    "uv": "uv",
    "generated": "generated",
    "tangent": "tangent",
    "pointiness": "pointiness",
    "random_per_island": "island",
}
"""What Cycles knows of surfaces by names of its own, which precede attributes of the mesh: what
programs want."""


def attribute(n: Node) -> Outputs:
    node = n.node
    name, kind = node.attribute_name, node.attribute_type
    if kind == "VIEW_LAYER":
        return _from_view_layer(n, name)
    if kind == "GEOMETRY" and n.owner.grids:
        found = grid_value(n, name)
    elif kind == "GEOMETRY" and name in OF_SURFACES:
        found = _of_surface(n, name)
    elif kind == "GEOMETRY":
        found = n.graph.add(
            "Attribute", attribute=n.around.wants.id("attribute", name) if name else NONE
        )
    else:
        found = instance_value(n, kind.lower(), name)
    return {
        "Color": found["vector"],
        "Vector": found["vector"],
        "Fac": found["factor"],
        "Alpha": found["alpha"],
    }


def _of_surface(n: Node, name: str) -> Outputs:
    if name == "uv":
        place = uv(n, "")
        first = n.graph.add("SeparateColor", color=place, mode="RGB")["a"]
        return {"vector": place, "factor": first, "alpha": ONE}
    if name == "generated":
        place = n.generated()
        return {"vector": place, "factor": n.graph.one("Average", value=place), "alpha": ONE}
    number_of = n.tangent_id("") if name == "tangent" else n.around.wants.id(OF_SURFACES[name])
    return n.graph.add("Attribute", attribute=number_of) | {"alpha": ONE}


def _from_view_layer(n: Node, name: str) -> Outputs:
    depsgraph = n.around.depsgraph
    owners = (
        [] if depsgraph is None else [depsgraph.view_layer, depsgraph.scene, depsgraph.scene.world]
    )
    value = property_value(owners, name)
    if value is None:
        return {"Color": ORIGIN, "Vector": ORIGIN, "Fac": ZERO, "Alpha": ZERO}
    color = vector(value[:3])
    return {
        "Color": color,
        "Vector": color,
        "Fac": number(sum(value[:3]) / 3.0),
        "Alpha": number(value[3]),
    }


def property_value(owners: list[Any], path: str) -> tuple[float, float, float, float] | None:
    """RGBA of a custom property or of a property of Blender's own by its path, of the first of
    `owners` that has it.

    A number is grey; what has no alpha is opaque.
    """
    for owner in owners:
        if owner is None:
            continue
        value = None
        try:
            value = owner[path] if path in owner else owner.path_resolve(path)
        except (KeyError, TypeError, ValueError, AttributeError):
            continue
        try:
            numbers = (
                [float(v) for v in value]
                if hasattr(value, "__len__") and not isinstance(value, str)
                else [float(value)] * 3
            )
        except (TypeError, ValueError):
            continue
        if 1 <= len(numbers) <= 4:
            numbers += [0.0] * (3 - len(numbers))
            return tuple([*numbers, 1.0][:4])  # type: ignore[return-value]
    return None


def color_attribute(n: Node) -> Outputs:
    found = n.graph.add("Attribute", attribute=n.around.wants.id("color", n.node.layer_name))
    return {"Color": found["vector"], "Alpha": found["alpha"]}


def scene_time(n: Node) -> Outputs:
    """The same at every time of the exposure, as in Cycles."""
    depsgraph = n.around.depsgraph
    if depsgraph is None:
        return {"Seconds": ZERO, "Frame": ZERO}
    scene = depsgraph.scene
    frame = float(scene.frame_current_final)
    a_second = scene.render.fps / scene.render.fps_base
    return {"Seconds": number(frame / a_second), "Frame": number(frame)}


def camera_data(n: Node) -> Outputs:
    found = n.graph.add("CameraData")
    return {
        "View Vector": found["view_vector"],
        "View Z Depth": found["view_z_depth"],
        "View Distance": found["view_distance"],
    }


def light_path(n: Node) -> Outputs:
    # as in Cycles it knows no kinds of rays; how far away it is looked at, and that it is one step
    # away
    if n.owner.read is not None:
        if any(n.wanted(name) for name in DEPTHS):
            n.warn("the depths of rays that see a light are those of its direct light")
        found = {socket.identifier: ZERO for socket in n.node.outputs}
        return found | {"Ray Length": n.graph.one("LightPath", what="RAY_LENGTH"), "Ray Depth": ONE}
    return {
        name: n.graph.one("LightPath", what=name.upper().replace(" ", "_")) for name in LIGHT_PATH
    } | {"Portal Depth": ZERO}


def light_falloff(n: Node) -> Outputs:
    strength, smooth = n.number("Strength"), n.number("Smooth")
    kinds = ("Quadratic", "Linear", "Constant")
    return {
        kind: n.graph.one("LightFalloff", strength=strength, smooth=smooth, type=kind.upper())
        for kind in kinds
    }


def fresnel(n: Node) -> Outputs:
    return {"Fac": n.graph.one("Fresnel", ior=n.number("IOR"), normal=n.normal())}


def layer_weight(n: Node) -> Outputs:
    found = n.graph.add("LayerWeight", blend=n.number("Blend"), normal=n.normal())
    return {"Fresnel": found["fresnel"], "Facing": found["facing"]}


def wireframe(n: Node) -> Outputs:
    return {
        "Fac": n.graph.one(
            "Wireframe", size=n.number("Size"), use_pixel_size=bool(n.node.use_pixel_size)
        )
    }


def ambient_occlusion(n: Node) -> Outputs:
    open_share = n.graph.one(
        "AmbientOcclusion",
        distance=n.number("Distance", 1.0),
        normal=n.normal(),
        samples=int(n.node.samples),
        inside=bool(n.node.inside),
        only_local=bool(n.node.only_local),
    )
    color = n.color("Color", (1.0, 1.0, 1.0))
    return {"AO": open_share, "Color": n.graph.scale(color, open_share)}


def bevel(n: Node) -> Outputs:
    return {
        "Normal": n.graph.one(
            "Bevel",
            radius=n.number("Radius", 0.05),
            normal_in=n.normal(),
            samples=int(n.node.samples),
        )
    }


def raycast(n: Node) -> Outputs:
    position = (
        n.vector("Position") if n.linked("Position") else n.graph.one("Geometry", what="POSITION")
    )
    direction = n.vector("Direction") if n.linked("Direction") else n.shading_normal()
    found = n.graph.add(
        "Raycast",
        position_in=position,
        direction=direction,
        length=n.number("Length", 1.0),
        only_local=bool(n.node.only_local),
    )
    if len(n.node.sample_attribute_items):
        n.unsupported("its attributes of what is hit are not supported; taken as 0")
    return {
        "Is Hit": found["is_hit"],
        "Self Hit": found["self_hit"],
        "Hit Distance": found["distance"],
        "Hit Position": found["position"],
        "Hit Normal": found["hit_normal"],
    }


def tangent(n: Node) -> Outputs:
    node = n.node
    if node.direction_type == "RADIAL":
        return {"Tangent": n.graph.one("TangentRadial", axis=node.axis)}
    return {
        "Tangent": n.graph.one(
            "TangentUv", tangent=n.tangent_id(node.uv_map), uv=uv_id(n, node.uv_map)
        )
    }


def normal_map(n: Node) -> Outputs:
    node = n.node
    color = n.color("Color", (0.5, 0.5, 1.0))
    if getattr(node, "convention", "OPENGL") == "DIRECTX":
        flipped = n.graph.one("OneMinus", a=color.component(1))
        color = n.graph.one(
            "CombineColor", a=color.component(0), b=flipped, c=color.component(2), mode="RGB"
        )
    tangent_id = n.tangent_id(node.uv_map) if node.space == "TANGENT" else NONE
    uv_of = uv_id(n, node.uv_map) if node.space == "TANGENT" else NONE
    strength = n.number("Strength", 1.0)
    unit = bpy.app.version >= (5, 0, 0)
    original = node.space == "TANGENT" and getattr(node, "base", "ORIGINAL") == "ORIGINAL"
    found = n.graph.one(
        "NormalMap",
        strength=strength,
        color=color,
        space=node.space,
        tangent=tangent_id,
        uv=uv_of,
        unit_normal=unit,
        normals=n.around.wants.id("undisplaced normals") if original else NONE,
    )
    return {"Normal": found}


def bump(n: Node) -> Outputs:
    if not n.linked("Height"):
        return {"Normal": n.normal()}
    numbers = {name.lower(): n.number(name) for name in ("Strength", "Distance")}
    heights = {
        "height": n.number("Height"),
        "height_dx": n.values["Height.DX"],
        "height_dy": n.values["Height.DY"],
    }
    width = bump_width(n)
    return {
        "Normal": n.graph.one(
            "Bump",
            width=width,
            normal_in=n.normal(),
            invert=bool(n.node.invert),
            **numbers,
            **heights,
        )
    }


def bump_width(n: Node) -> Value:
    """How far apart a Bump looks at its height, in pixels."""
    return n.number("Filter Width", 1.0)


def displacement(n: Node) -> Outputs:
    """The way that the surface would move, in world space."""
    graph = n.graph
    amount = graph.multiply(
        graph.one("Subtract", a=n.number("Height"), b=n.number("Midlevel", 0.5)),
        n.number("Scale", 1.0),
    )
    along = n.values.get("Normal") or graph.one("Geometry", what="NORMAL")
    if n.node.space == "OBJECT":
        own = graph.one(
            "VectorTransform",
            vector=along,
            vector_type="NORMAL",
            convert_from="WORLD",
            convert_to="OBJECT",
        )
        moved = graph.scale(own, amount)
        return {
            "Displacement": graph.one(
                "VectorTransform",
                vector=moved,
                vector_type="VECTOR",
                convert_from="OBJECT",
                convert_to="WORLD",
            )
        }
    return {"Displacement": graph.scale(along, amount)}


def vector_displacement(n: Node) -> Outputs:
    """The way that the surface would move, in world space; in tangent space Y is along the
    normal.
    """
    node = n.node
    tangent_id = n.tangent_id("") if node.space == "TANGENT" else NONE
    return {
        "Displacement": n.graph.one(
            "VectorDisplacement",
            vector=n.color("Vector"),
            midlevel=n.number("Midlevel"),
            scale=n.number("Scale", 1.0),
            space=node.space,
            tangent=tangent_id,
            uv=NONE,
        )
    }


def curves_info(n: Node) -> Outputs:
    found = n.graph.add("CurvesInfo")
    return {
        "Is Strand": found["is_strand"],
        "Intercept": found["intercept"],
        "Length": found["length"],
        "Thickness": found["thickness"],
        "Tangent Normal": found["tangent_normal"],
        "Random": found["random"],
    }


def point_info(n: Node) -> Outputs:
    found = n.graph.add("PointInfo")
    return {name: found[name.lower()] for name in ("Position", "Radius", "Random")}


def volume_info(n: Node) -> Outputs:
    """Of the grids that go by these names; elsewhere nothing."""
    if n.owner.grids:
        found = {name: grid_value(n, name.lower())["factor"] for name in OF_VOLUMES}
        return found | {"Color": grid_value(n, "color")["vector"]}
    return {
        socket.identifier: ORIGIN if socket.type in {"VECTOR", "RGBA"} else ZERO
        for socket in n.node.outputs
    }
