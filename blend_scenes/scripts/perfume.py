"""A product shot: a bottle of scent and a jar of cream on stone before an arch, in the evening sun
and soft boxes.

Glass with liquid in it, brushed and polished metal, marble, terrazzo, travertine and glazed
porcelain; an HDRI of a studio made here.
"""

from __future__ import annotations

from math import cos, pi, radians, sin

import bpy
import numpy as np
from mathutils import Euler, Matrix

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import artwork as art
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.trees import Tree, material, plain

# Materials ----------------------------------------------------------------------------------------


def _marble() -> bpy.types.Material:
    t = material("Marble")
    picture = art.packed("Marble", art.marble(512, 5, (0.93, 0.91, 0.88), (0.46, 0.41, 0.38)))
    where = t.coordinates("Object", 3.1, (0.5, 0.3, 0.2), (0.21, 0.4, 0.0))
    stone = t.image(picture, where, projection="BOX", projection_blend=0.3)
    return t.principled(
        Base_Color=stone,
        Roughness=t.map_range(t.add("RGBToBW", Color=stone), 0.4, 0.9, 0.28, 0.14),
        Coat_Weight=0.4,
        Coat_Roughness=0.04,
    )


def _terrazzo() -> bpy.types.Material:
    """Chips of four stones in pink cement."""
    t = material("Terrazzo")
    where = t.coordinates("Object")
    warped = t.add(
        "VectorMath",
        0,
        {"operation": "ADD"},
        i0=where,
        i1=t.add(
            "VectorMath",
            0,
            {"operation": "SCALE"},
            i0=t.noise(where, 30.0, 1.0, "Color"),
            Scale=0.018,
        ),
    )
    chip = t.add("TexVoronoi", "Color", Vector=warped, Scale=26.0)
    edge = t.add(
        "TexVoronoi", "Distance", {"feature": "DISTANCE_TO_EDGE"}, Vector=warped, Scale=26.0
    )
    pick = t.add("SeparateColor", "Red", Color=chip)
    stones = t.ramp(
        pick,
        [
            (0.0, (0.86, 0.82, 0.76)),
            (0.3, (0.42, 0.2, 0.16)),
            (0.5, (0.72, 0.5, 0.38)),
            (0.68, (0.16, 0.14, 0.14)),
            (0.8, (0.9, 0.88, 0.84)),
        ],
        "CONSTANT",
    )
    size = t.add("SeparateColor", "Green", Color=chip)
    inside = t.math("GREATER_THAN", edge, t.map_range(size, 0.0, 1.0, 0.06, 0.4))
    color = t.mix(inside, (0.66, 0.43, 0.36), stones)
    return t.principled(
        Base_Color=color,
        Roughness=t.map_range(inside, 0.0, 1.0, 0.42, 0.16),
        Normal=t.bump(
            t.math("MULTIPLY", t.noise(where, 70.0), t.math("SUBTRACT", 1.0, inside)), 0.001, 0.4
        ),
    )


def _travertine(
    name: str, light: tuple[float, float, float], dark: tuple[float, float, float]
) -> bpy.types.Material:
    """Layers with pits."""
    t = material(name)
    where = t.coordinates("Object")
    layer = t.add(
        "TexWave",
        "Fac",
        {"bands_direction": "Z"},
        Vector=where,
        Scale=5.0,
        Distortion=7.0,
        Detail=4.0,
        Detail_Scale=1.6,
    )
    flat = t.add("Mapping", Vector=where, Scale=(16.0, 16.0, 60.0))
    pits = t.map_range(t.noise(flat, 1.0, 3.0), 0.30, 0.42)
    color = t.mix(pits, tuple(0.55 * c for c in dark), t.ramp(layer, [(0.0, dark), (1.0, light)]))
    height = t.math("ADD", pits, t.math("MULTIPLY", t.noise(where, 90.0, 4.0), 0.25))
    return t.principled(Base_Color=color, Roughness=0.62, Normal=t.bump(height, 0.003, 0.7))


def _wall() -> bpy.types.Material:
    """Trowelled lime plaster."""
    t = material("Lime plaster")
    color, height = art.plaster(512, 21)
    where = t.coordinates("Object", 0.9)
    tone = t.image(art.packed("Plaster", color), where, projection="BOX")
    rise = t.image(art.packed("Plaster height", height, data=True), where, projection="BOX")
    paint = t.mix(1.0, t.mix(0.55, tone, (0.9, 0.9, 0.9)), (0.74, 0.40, 0.29), "MULTIPLY")
    return t.principled(Base_Color=paint, Roughness=0.8, Normal=t.bump(rise, 0.012, 0.6))


def _gold(name: str, brushed: bool) -> bpy.types.Material:
    t = material(name)
    where = t.coordinates("Object")
    if not brushed:
        return t.principled(
            Base_Color=(0.95, 0.68, 0.38),
            Metallic=1.0,
            Roughness=t.map_range(t.noise(where, 25.0, 4.0), 0.3, 0.7, 0.08, 0.16),
        )
    lines = t.noise(t.add("Mapping", Vector=where, Scale=(30.0, 30.0, 2600.0)), 1.0, 2.0)
    return t.principled(
        Base_Color=(0.93, 0.66, 0.37),
        Metallic=1.0,
        Roughness=t.map_range(lines, 0.3, 0.7, 0.18, 0.32),
        Anisotropic=0.5,
        Normal=t.bump(lines, 0.0001, 0.5),
    )


def _porcelain() -> bpy.types.Material:
    t = material("Porcelain")
    where = t.coordinates("Object")
    fade = t.add(
        "TexGradient",
        "Fac",
        Vector=t.add(
            "Mapping", Vector=t.add("SeparateXYZ", "Z", Vector=where), Scale=(14.0, 1.0, 1.0)
        ),
    )
    color = t.mix(
        t.add("ClampValue" if hasattr(bpy.types, "ShaderNodeClampValue") else "Clamp", Value=fade),
        (0.82, 0.58, 0.47),
        (0.93, 0.88, 0.82),
    )
    return t.principled(Base_Color=color, Roughness=0.25, Coat_Weight=1.0, Coat_Roughness=0.02)


def _scent() -> bpy.types.Material:
    """Two sorts of glass by height: the liquid fades from amber to rose."""
    t = material("Scent")
    height = t.add("SeparateXYZ", "Z", Vector=t.coordinates("Generated"))
    return t.surface(
        t.add(
            "BsdfGlass",
            Color=t.ramp(height, [(0.0, (0.98, 0.55, 0.24)), (1.0, (0.98, 0.74, 0.5))]),
            Roughness=0.0,
            IOR=1.36,
        )
    )


def _paper() -> bpy.types.Material:
    """Handmade paper with a gilt edge."""
    t = material("Label paper")
    x = t.add("SeparateXYZ", "X", Vector=t.coordinates("Generated"))
    y = t.add("SeparateXYZ", "Y", Vector=x.node.inputs["Vector"].links[0].from_socket)
    edge = t.math(
        "MINIMUM",
        t.math("MINIMUM", x, t.math("SUBTRACT", 1.0, x)),
        t.math("MULTIPLY", t.math("MINIMUM", y, t.math("SUBTRACT", 1.0, y)), 0.7),
    )
    line = t.math("MULTIPLY", t.math("GREATER_THAN", edge, 0.03), t.math("LESS_THAN", edge, 0.045))
    fibre = t.noise(t.coordinates("Object"), 900.0, 4.0)
    paper = t.add(
        "BsdfPrincipled",
        Base_Color=t.ramp(fibre, [(0.3, (0.83, 0.79, 0.71)), (0.7, (0.9, 0.87, 0.8))]),
        Roughness=0.9,
    )
    gilt = t.add("BsdfPrincipled", Base_Color=(0.93, 0.66, 0.37), Metallic=1.0, Roughness=0.25)
    return t.surface(t.add("MixShader", i0=line, i1=paper, i2=gilt))


def _orange() -> tuple[bpy.types.Material, bpy.types.Material]:
    t = material("Orange peel")
    pores = t.add("TexVoronoi", "Distance", Vector=t.coordinates("Object"), Scale=330.0)
    peel = t.principled(
        Base_Color=t.mix(
            t.noise(t.coordinates("Object"), 30.0), (0.9, 0.32, 0.03), (0.85, 0.42, 0.06)
        ),
        Roughness=0.35,
        Normal=t.bump(pores, 0.0016, 0.7),
    )
    t = material("Orange flesh")
    size = 256
    v, u = (np.mgrid[:size, :size] + 0.5) / size * 2.0 - 1.0
    r, turn = np.hypot(u, v), np.arctan2(v, u) / (2 * pi) * 10.0
    wall = np.abs(turn - np.round(turn)) * r
    drops = art.cloud(size, 0.9, 3, low=9.0)
    flesh = art.blend(drops, (0.93, 0.36, 0.05), (0.98, 0.6, 0.16))
    flesh = art.blend(np.clip(1.0 - wall / 0.05, 0, 1), flesh, (0.97, 0.86, 0.66))
    flesh = art.blend(np.clip((r - 0.84) * 25.0, 0, 1), flesh, (0.97, 0.88, 0.72))
    flesh = art.blend(np.clip((r - 0.94) * 30.0, 0, 1), flesh, (0.93, 0.42, 0.05))
    flesh = art.blend(np.clip(1.0 - r / 0.1, 0, 1), flesh, (0.97, 0.88, 0.7))
    color = t.image(art.packed("Orange slice", np.clip(flesh, 0, 1)), t.coordinates("UV"))
    wet = t.bump(t.add("RGBToBW", Color=color), 0.002, 0.8)
    return peel, t.principled(
        Base_Color=color, Roughness=0.18, Coat_Weight=0.6, Coat_Roughness=0.05, Normal=wet
    )


# Things -------------------------------------------------------------------------------------------


def _backdrop(wall: bpy.types.Material) -> None:
    """A sweep with an arched niche standing before it."""
    profile = [(0.0, -1.4, 0.0), (0.0, 0.75, 0.0)]
    profile += [
        (0.0, 0.75 + 0.3 * sin(k * pi / 16), 0.3 - 0.3 * cos(k * pi / 16)) for k in range(1, 9)
    ]
    profile += [(0.0, 1.05, 2.2)]
    points = [(x, y, z) for x in (-1.9, 1.9) for _, y, z in profile]
    n = len(profile)
    m.add_mesh(
        "Backdrop", points, [(k, n + k, n + k + 1, k + 1) for k in range(n - 1)], wall, smooth=True
    )


def _arch(
    material_: bpy.types.Material,
    x: float,
    y: float,
    width: float,
    height: float,
    thick: float,
    depth: float,
) -> None:
    """A free-standing round arch."""
    inner, outer, count = width / 2, width / 2 + thick, 32
    line = [
        (-1.0, 0.0),
        *[(-cos(k * pi / count), sin(k * pi / count)) for k in range(count + 1)],
        (1.0, 0.0),
    ]
    vertices = []
    for radius in (inner, outer):
        for depth_at in (-depth / 2, depth / 2):
            for k, (c, s) in enumerate(line):
                z = 0.0 if k in {0, len(line) - 1} else height + s * radius
                vertices.append((c * radius, depth_at, z))
    n = len(line)
    faces = []
    for k in range(n - 1):
        # inner front, inner back, outer front, outer back
        a, b, c, d = (s * n + k for s in range(4))
        faces += [
            (a, a + 1, b + 1, b),
            (c, d, d + 1, c + 1),
            (a, c, c + 1, a + 1),
            (b, b + 1, d + 1, d),
        ]
    faces += [(0, n, 3 * n, 2 * n), (n - 1, 3 * n - 1, 4 * n - 1, 2 * n - 1)]
    thing = m.add_mesh("Arch", vertices, faces, material_, location=(x, y, 0.0005))
    p.rounded(thing, 0.004)


def _drum(
    name: str, x: float, y: float, radius: float, low: float, high: float, stone: bpy.types.Material
) -> None:
    thing = m.add_turned(
        name,
        [(0.0, 0.0), (radius, 0.0), (radius, high - low), (0.0, high - low)],
        stone,
        (x, y, low + 0.0005),
        72,
    )
    p.rounded(thing, 0.006, 3)


def _slab(
    name: str,
    width: float,
    depth: float,
    height: float,
    round_by: float,
    inset: float,
    stuff: bpy.types.Material,
) -> bpy.types.Object:
    """A rounded block that stands at the origin, `inset` smaller all round."""
    w, d = width / 2 - inset, depth / 2 - inset
    return p.rounded(
        m.add_boxes(name, [((-w, -d, inset), (w, d, height - inset))], stuff), round_by, 5
    )


def _perfume(x: float, y: float, z: float, turn: float) -> None:
    """A thick block of glass, the scent in it (which wets the glass), a gold collar and cap, a
    label.
    """
    glass = plain("Flint glass", (1.0, 1.0, 1.0), 0.0, Transmission_Weight=1.0, IOR=1.52)
    place = Matrix.Translation((x, y, z + 0.0005)) @ Matrix.Rotation(turn, 4, "Z")
    outer = _slab("Flacon", 0.17, 0.075, 0.2, 0.016, 0.0, glass)
    # The hollow: its faces look inwards. The scent overlaps it by a hair, so that no air is
    # between.
    hollow = p.rounded(
        m.add_boxes("Hollow", [((-0.066, -0.02, 0.024), (0.066, 0.02, 0.182))], glass), 0.01, 4
    )
    hollow.data.flip_normals()
    scent = p.rounded(
        m.add_boxes("Scent", [((-0.0664, -0.0204, 0.0236), (0.0664, 0.0204, 0.14))], _scent()),
        0.01,
        4,
    )
    gold, polished = _gold("Brushed gold", True), _gold("Polished gold", False)
    for thing in (outer, hollow, scent):
        thing.matrix_world = place
    top = z + 0.2015
    p.turned(
        "Collar",
        [(0.0, 0.0), (0.028, 0.0), (0.03, 0.002), (0.03, 0.01), (0.027, 0.013), (0.0, 0.013)],
        polished,
        (x, y, top),
        64,
        0,
    )
    cap = [(0.0, 0.0), (0.031, 0.0), (0.034, 0.003), (0.034, 0.07), (0.031, 0.075), (0.0, 0.0755)]
    made = m.add_turned("Cap", cap, gold, (x, y, top + 0.0135), 72)
    p.rounded(made, 0.002)
    front = (
        place
        @ Matrix.Translation((0.0, -0.0386, 0.0))
        @ Euler((pi / 2, 0.0, 0.0)).to_matrix().to_4x4()
    )
    ink = plain("Ink", (0.03, 0.025, 0.022), 0.5)
    label = p.box("Label", (-0.046, 0.058, -0.0004), (0.046, 0.122, 0.0006), _paper())
    label.matrix_world = front
    p.text("Name", "LUMEN", 0.024, ink, front @ Matrix.Translation((0.0, 0.088, 0.001)), 0.0002)
    p.text("Below", "PARFUM", 0.0115, ink, front @ Matrix.Translation((0.0, 0.0715, 0.001)), 0.0002)
    rule = m.add_boxes("Rule", [((-0.03, 0.0825, 0.0007), (0.03, 0.0831, 0.001))], ink)
    rule.matrix_world = front


def _cream(x: float, y: float, z: float) -> None:
    body = [(0.0, 0.0), (0.052, 0.0), (0.058, 0.006), (0.058, 0.038), (0.054, 0.042), (0.0, 0.042)]
    p.turned("Cream jar", body, _porcelain(), (x, y, z + 0.0005), 64)
    lid = [
        (0.0, 0.0),
        (0.055, 0.0),
        (0.0565, 0.0015),
        (0.0565, 0.0245),
        (0.054, 0.027),
        (0.0, 0.0275),
    ]
    p.turned("Cream lid", lid, bpy.data.materials["Polished gold"], (x, y, z + 0.043), 64, 0)


def _fruit(x: float, y: float, z: float) -> None:
    peel, flesh = _orange()
    m.add_sphere("Orange", 0.042, peel, (x, y, z + 0.0425), 48)
    half = [
        (0.0, -0.041),
        *[(0.041 * sin(k * pi / 20), -0.041 * cos(k * pi / 20)) for k in range(1, 11)],
    ]
    cut = m.add_lathe("Half orange", half, peel, (0.0, 0.0, 0.0), 48)
    ring = [
        (0.0, 0.0, 0.0),
        *[(0.0408 * cos(2 * pi * k / 48), 0.0408 * sin(2 * pi * k / 48), 0.0) for k in range(48)],
    ]
    face = m.add_mesh("Slice", ring, [(0, k + 1, (k + 1) % 48 + 1) for k in range(48)], flesh)
    uv = [
        value
        for loop in face.data.loops
        for value in (
            0.5 + ring[loop.vertex_index][0] / 0.0826,
            0.5 + ring[loop.vertex_index][1] / 0.0826,
        )
    ]
    face.data.uv_layers.new(name="UVMap").data.foreach_set("uv", uv)
    stand = (
        Matrix.Translation((x - 0.085, y - 0.045, z + 0.0415))
        @ Euler((radians(78.0), 0.0, radians(28.0))).to_matrix().to_4x4()
    )
    cut.matrix_world = face.matrix_world = stand


def _sprig(x: float, y: float, z: float) -> None:
    """Eucalyptus in a vase behind."""
    t = material("Eucalyptus")
    picture = art.packed("Eucalyptus", art.leaf(64, (0.45, 0.55, 0.46), (0.25, 0.36, 0.3)))
    color = t.image(picture, t.coordinates("UV"))
    leaf = t.surface(
        t.add(
            "MixShader",
            i0=0.25,
            i1=t.add("BsdfPrincipled", Base_Color=color, Roughness=0.5),
            i2=t.add("BsdfTranslucent", Color=color),
        )
    )
    rng = np.random.default_rng(2)
    places = []
    stem = plain("Stem", (0.22, 0.2, 0.12), 0.6)
    for lean, turn, high in (
        (0.42, 0.3, 0.34),
        (0.3, 2.0, 0.42),
        (0.5, 3.3, 0.3),
        (0.25, 4.6, 0.38),
        (0.55, 5.4, 0.28),
    ):
        path = [
            (lean * high * s**1.6 * cos(turn), lean * high * s**1.6 * sin(turn), high * s)
            for s in (0.0, 0.35, 0.7, 1.0)
        ]
        p.tube("Stem", [(x + a, y + b, z + 0.09 + c) for a, b, c in path], 0.0022, stem)
        for s in np.linspace(0.3, 1.0, 11):
            out = lean * high * s**1.6
            for side in (0.0, pi):
                swing = turn + pi / 2 + side + rng.normal(0.0, 0.3)
                places.append(
                    (
                        (out * cos(turn), out * sin(turn), 0.09 + high * s),
                        (cos(swing), sin(swing), rng.uniform(0.1, 0.7)),
                        rng.uniform(0.04, 0.058),
                    )
                )
    p.leaves("Eucalyptus", places, leaf, 0.8, 0.15, 4, (x, y, z))
    shape = [(0.045, 0.0), (0.05, 0.004), (0.068, 0.04), (0.06, 0.09), (0.03, 0.115), (0.034, 0.13)]
    p.turned(
        "Vase",
        p.vessel(shape, 0.004, 0.006),
        _travertine("Stoneware", (0.83, 0.78, 0.7), (0.7, 0.62, 0.52)),
        (x, y, z + 0.0005),
        48,
    )


def _light() -> None:
    world = bpy.data.worlds.new("Studio")
    bpy.context.scene.world = world
    boxes = [
        ((-1.0, -0.6, 0.5), 0.5, 0.7, (3.4, 3.3, 3.2)),
        ((1.0, -0.35, 0.35), 0.28, 0.8, (2.2, 2.0, 1.8)),
        ((0.2, -1.0, 1.6), 0.5, 0.3, (2.0, 2.0, 2.1)),
    ]
    t = Tree(world)
    picture = t.add(
        "TexEnvironment", 0, {"image": art.packed_radiance("Studio", art.studio(128, boxes))}
    )
    t.surface(t.add("Background", Color=picture, Strength=0.24))
    sun = m.add_light(
        "Sun",
        "SUN",
        8.5,
        (-2.4, -1.6, 1.9),
        (0.0, 0.1, 0.15),
        angle=radians(1.2),
        color=(1.0, 0.84, 0.64),
    )
    sun.visible_camera = False
    soft = m.add_light(
        "Soft box",
        "AREA",
        9.0,
        (1.3, -1.0, 1.0),
        (0.0, 0.1, 0.2),
        shape="RECTANGLE",
        size=0.6,
        size_y=1.0,
        color=(1.0, 0.93, 0.86),
    )
    soft.visible_camera = False


def _palm() -> None:
    """A palm leaf out of view that throws its shadow on the backdrop."""
    green = plain("Palm", (0.05, 0.12, 0.04), 0.5)
    rng = np.random.default_rng(6)
    for at, turn in (((-1.62, -0.25, 1.75), 0.3), ((-1.5, -0.55, 1.25), -0.15)):
        places = []
        for k in range(26):
            s = k / 25
            foot = (0.62 * s, 0.0, 0.18 * s - 0.28 * s * s)
            reach = 0.4 * (1.0 - 0.62 * s) + 0.04
            places += [
                (
                    foot,
                    (0.55, side * (1.0 - 0.35 * s), 0.25 - 0.3 * s + rng.normal(0.0, 0.05)),
                    reach,
                )
                for side in (-1, 1)
            ]
        frond = p.leaves("Palm", places, green, 0.085, 0.2, 4)
        frond.location, frond.rotation_euler = at, (radians(-52.0), radians(15.0), turn)


def make() -> None:
    scene = m.new_scene(600, 720, "AgX")
    scene.view_settings.exposure = -0.35
    scene.view_settings.look = "AgX - Medium High Contrast"
    wall, marble = _wall(), _marble()
    terrazzo = _terrazzo()
    stone = _travertine("Travertine", (0.86, 0.78, 0.66), (0.72, 0.58, 0.44))
    _backdrop(wall)
    _arch(stone, 0.06, 0.42, 0.5, 0.42, 0.1, 0.16)
    _drum("Marble drum", -0.03, 0.0, 0.185, 0.0, 0.1, marble)
    _drum("Terrazzo drum", 0.29, 0.2, 0.12, 0.0, 0.2, terrazzo)
    _drum("Low drum", -0.32, 0.17, 0.12, 0.0, 0.05, stone)
    _perfume(-0.03, -0.01, 0.1005, radians(-14.0))
    _cream(0.29, 0.19, 0.2005)
    _fruit(0.2, -0.16, 0.0)
    _sprig(-0.32, 0.18, 0.0505)
    m.add_sphere(
        "Pearl",
        0.026,
        plain(
            "Pearl", (0.9, 0.85, 0.8), 0.2, Coat_Weight=1.0, Coat_Roughness=0.1, Sheen_Weight=0.4
        ),
        (-0.2, -0.24, 0.0265),
        40,
    )
    m.add_sphere("Bead", 0.018, bpy.data.materials["Polished gold"], (-0.14, -0.29, 0.0185), 40)
    _palm()
    _light()
    m.add_camera((0.03, -1.75, 0.42), (0.01, 0.1, 0.245), lens=62.0)
    m.save("perfume")


if __name__ == "__main__":
    make()
