"""A kitchen counter in the morning: tiles, oiled wood, enamel, copper, steel and glass under a sun
from the side window.

Everything is textured, by packed images and by procedural nodes; made for the gallery and for
comparison with Cycles.
"""

from __future__ import annotations

from math import pi, radians, sin

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import artwork as art
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.trees import Tree, group, material, plain, use_group

LEFT, RIGHT, BACK, FRONT, TOP = -1.75, 2.6, 0.0, -3.4, 2.6
COUNTER, DEPTH = 0.9, 0.64

# Materials ----------------------------------------------------------------------------------------


def _worn() -> bpy.types.NodeTree:
    """A group: a roughness that varies by `Amount` about `Roughness`."""
    tree, given, result = group(
        "Worn",
        [
            ("Vector", "Vector", None),
            ("Roughness", "Float", 0.3),
            ("Amount", "Float", 0.15),
            ("Scale", "Float", 8.0),
        ],
        [("Roughness", "Float")],
    )
    smear = tree.add(
        "TexNoise",
        0,
        Vector=given.outputs["Vector"],
        Scale=given.outputs["Scale"],
        Detail=4.0,
        Distortion=0.6,
    )
    centred = tree.math("SUBTRACT", smear, 0.5)
    tree.links.new(
        tree.math(
            "ADD",
            tree.math("MULTIPLY", centred, given.outputs["Amount"]),
            given.outputs["Roughness"],
        ),
        result.inputs["Roughness"],
    )
    return bpy.data.node_groups["Worn"]


def _roughness(tree: Tree, roughness: float, amount: float, scale: float = 8.0) -> object:
    return use_group(
        tree,
        bpy.data.node_groups["Worn"],
        Vector=tree.coordinates("Object"),
        Roughness=roughness,
        Amount=amount,
        Scale=scale,
    )


def _tiles() -> bpy.types.Material:
    """Glazed tiles in a running bond, each of its own shade, a little wavy."""
    t = material("Tiles")
    where = t.coordinates("UV")
    brick = t.add(
        "TexBrick", "Color", {"offset": 0.5}, Vector=where, Color1=(0.80, 0.82, 0.77),
        Color2=(0.62, 0.70, 0.66), Mortar=(0.55, 0.53, 0.49),
        Scale=1.0, Mortar_Size=0.004, Mortar_Smooth=0.25, Bias=-0.35, Brick_Width=0.2,
        Row_Height=0.085,
    )  # fmt: skip
    joint = brick.node.outputs["Fac"]
    pool = t.noise(where, 22.0, 2.0)
    height = t.math("ADD", t.math("MULTIPLY", joint, -1.0), t.math("MULTIPLY", pool, 0.35))
    color = t.mix(t.math("MULTIPLY", pool, 0.35), brick, (0.9, 0.93, 0.88))
    return t.principled(
        Base_Color=color, Roughness=t.map_range(joint, 0.0, 1.0, 0.12, 0.8),
        Coat_Weight=t.map_range(joint, 0.0, 1.0, 0.6, 0.0),
        Coat_Roughness=0.05, Normal=t.bump(height, 0.003),
    )  # fmt: skip


def _wood(
    name: str,
    color: bpy.types.Image,
    normal: bpy.types.Image,
    scale: float,
    gloss: float,
    turn: float = 0.0,
    shade: float = 1.0,
) -> bpy.types.Material:
    t = material(name)
    where = t.coordinates("Object", (scale,) * 3, (0.0, 0.0, turn))
    picture = t.image(color, where, projection="BOX", projection_blend=0.1)
    toned = t.add("HueSaturation", Color=picture, Saturation=1.05, Value=shade)
    grain = t.image(normal, where, projection="BOX", projection_blend=0.1)
    height = t.add("RGBToBW", Color=grain)
    rough = t.map_range(t.add("RGBToBW", Color=picture), 0.1, 0.6, gloss + 0.15, gloss)
    return t.principled(Base_Color=toned, Roughness=rough, Normal=t.bump(height, 0.0015, 0.6))


def _plaster_wall() -> bpy.types.Material:
    t = material("Plaster")
    where = t.coordinates("Object")
    patch = t.ramp(
        t.noise(where, 1.6, 4.0), [(0.3, (0.80, 0.74, 0.64)), (0.75, (0.88, 0.84, 0.76))]
    )
    return t.principled(
        Base_Color=patch, Roughness=0.85, Normal=t.bump(t.noise(where, 60.0, 5.0), 0.004, 0.5)
    )


def _floor() -> bpy.types.Material:
    t = material("Terracotta")
    where = t.coordinates("UV")
    brick = t.add(
        "TexBrick", "Color", {"offset": 0.0}, Vector=where, Color1=(0.50, 0.21, 0.11),
        Color2=(0.36, 0.13, 0.07), Mortar=(0.36, 0.31, 0.26),
        Scale=1.0, Mortar_Size=0.006, Mortar_Smooth=0.2, Brick_Width=0.3, Row_Height=0.3,
    )  # fmt: skip
    stain = t.noise(where, 5.0, 6.0)
    color = t.mix(t.map_range(stain, 0.35, 0.75, 0.0, 0.45), brick, (0.62, 0.34, 0.2))
    height = t.math("SUBTRACT", t.math("MULTIPLY", stain, 0.4), brick.node.outputs["Fac"])
    return t.principled(
        Base_Color=color,
        Roughness=t.map_range(stain, 0.3, 0.7, 0.3, 0.55),
        Normal=t.bump(height, 0.004, 0.8),
    )


def _cabinet() -> bpy.types.Material:
    t = material("Sage paint")
    where = t.coordinates("Object")
    brush = t.add(
        "TexNoise",
        0,
        Vector=t.add("Mapping", Vector=where, Scale=(60.0, 60.0, 4.0)),
        Scale=1.0,
        Detail=3.0,
    )
    return t.principled(
        Base_Color=(0.155, 0.235, 0.19),
        Roughness=_roughness(t, 0.36, 0.2),
        Normal=t.bump(brush, 0.0006, 0.5),
    )


def _enamel(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    t = material(name)
    dots = t.add("TexVoronoi", "Distance", Vector=t.coordinates("Object"), Scale=90.0)
    speckle = t.ramp(dots, [(0.10, tuple(0.35 * c for c in color)), (0.18, color)])
    return t.principled(Base_Color=speckle, Roughness=0.3, Coat_Weight=1.0, Coat_Roughness=0.03)


def _copper() -> bpy.types.Material:
    t = material("Copper")
    where = t.coordinates("Object")
    tarnish = t.ramp(
        t.noise(where, 9.0, 6.0, Distortion=1.0),
        [(0.35, (0.93, 0.51, 0.34)), (0.62, (0.78, 0.36, 0.2)), (0.8, (0.42, 0.2, 0.14))],
    )
    dents = t.add(
        "TexVoronoi", "Distance", {"feature": "SMOOTH_F1"}, Vector=where, Scale=55.0, Smoothness=0.6
    )
    return t.principled(
        Base_Color=tarnish,
        Metallic=1.0,
        Roughness=_roughness(t, 0.24, 0.2),
        Normal=t.bump(dents, 0.002, 0.35),
    )


def _steel() -> bpy.types.Material:
    t = material("Brushed steel")
    where = t.coordinates("Object")
    lines = t.add(
        "TexNoise",
        0,
        Vector=t.add("Mapping", Vector=where, Scale=(2.0, 2.0, 420.0)),
        Scale=1.0,
        Detail=2.0,
    )
    return t.principled(
        Base_Color=(0.70, 0.69, 0.67), Metallic=1.0,
        Roughness=t.map_range(lines, 0.3, 0.7, 0.22, 0.36), Anisotropic=0.6,
        Normal=t.bump(lines, 0.0002, 0.5),
    )  # fmt: skip


def _lemon() -> bpy.types.Material:
    t = material("Lemon")
    where = t.coordinates("Generated")
    pores = t.add("TexVoronoi", "Distance", {"feature": "F1"}, Vector=where, Scale=26.0)
    ends = t.add("SeparateXYZ", "Z", Vector=where)
    color = t.ramp(
        ends,
        [
            (0.0, (0.55, 0.55, 0.08)),
            (0.14, (0.88, 0.63, 0.03)),
            (0.86, (0.9, 0.66, 0.04)),
            (1.0, (0.6, 0.58, 0.12)),
        ],
    )
    return t.principled(Base_Color=color, Roughness=0.38, Normal=t.bump(pores, 0.0016, 0.8))


def _glass(
    name: str, color: tuple[float, float, float] = (1.0, 1.0, 1.0), roughness: float = 0.0
) -> bpy.types.Material:
    return plain(name, color, roughness, Transmission_Weight=1.0, IOR=1.47)


def _beans(
    name: str, one: tuple[float, float, float], two: tuple[float, float, float], scale: float
) -> bpy.types.Material:
    """What is in a jar: cells of two colours with dark gaps."""
    t = material(name)
    cells = t.add("TexVoronoi", "Distance", Vector=t.coordinates("Object"), Scale=scale)
    kind = t.mix(t.add("SeparateXYZ", "X", Vector=cells.node.outputs["Color"]), one, two)
    dark = t.mix(t.map_range(cells, 0.35, 0.75, 0.0, 0.85), kind, (0.02, 0.012, 0.008))
    return t.principled(
        Base_Color=dark,
        Roughness=0.6,
        Normal=t.bump(cells, 0.006, 0.8, Normal=t.add("NewGeometry", "Normal")),
    )


def _leaf(
    name: str, light: tuple[float, float, float], dark: tuple[float, float, float]
) -> bpy.types.Material:
    """A leaf: glossy in front, and light shines through."""
    t = material(name)
    color = t.image(art.packed(name, art.leaf(64, light, dark)), t.coordinates("UV"))
    through = t.add("BsdfTranslucent", Color=t.mix(1.0, color, (0.85, 1.0, 0.35), "MULTIPLY"))
    shine = t.add("BsdfPrincipled", Base_Color=color, Roughness=0.42)
    return t.surface(t.add("MixShader", i0=0.3, i1=shine, i2=through))


# Things -------------------------------------------------------------------------------------------


def _shell(
    tiles: bpy.types.Material,
    wall: bpy.types.Material,
    floor: bpy.types.Material,
    white: bpy.types.Material,
) -> None:
    """The room; the window is in the left wall."""
    m.add_picture(
        "Floor",
        [(LEFT, FRONT, 0), (RIGHT, FRONT, 0), (RIGHT, BACK, 0), (LEFT, BACK, 0)],
        floor,
        (RIGHT - LEFT, BACK - FRONT),
    )
    m.add_mesh(
        "Ceiling",
        [(LEFT, FRONT, TOP), (LEFT, BACK, TOP), (RIGHT, BACK, TOP), (RIGHT, FRONT, TOP)],
        [(0, 1, 2, 3)],
        white,
    )
    m.add_mesh(
        "Back wall",
        [(LEFT, BACK, 0), (RIGHT, BACK, 0), (RIGHT, BACK, TOP), (LEFT, BACK, TOP)],
        [(0, 1, 2, 3)],
        wall,
    )
    m.add_mesh(
        "Right wall",
        [(RIGHT, BACK, 0), (RIGHT, FRONT, 0), (RIGHT, FRONT, TOP), (RIGHT, BACK, TOP)],
        [(0, 1, 2, 3)],
        wall,
    )
    m.add_mesh(
        "Front wall",
        [(RIGHT, FRONT, 0), (LEFT, FRONT, 0), (LEFT, FRONT, TOP), (RIGHT, FRONT, TOP)],
        [(0, 1, 2, 3)],
        wall,
    )
    y0, y1, z0, z1 = -1.95, -0.42, 1.02, 2.2
    out = LEFT - 0.22
    corners = [(LEFT, y, z) for y in (FRONT, BACK) for z in (0.0, TOP)]
    corners += [(x, y, z) for x in (LEFT, out) for y in (y0, y1) for z in (z0, z1)]
    faces = [
        (0, 4, 5, 1),
        (0, 2, 6, 4),
        (2, 3, 7, 6),
        (3, 1, 5, 7),
        (4, 8, 9, 5),
        (6, 10, 8, 4),
        (7, 11, 10, 6),
        (5, 9, 11, 7),
    ]
    m.add_mesh("Window wall", corners, faces, wall)
    x0, x1, t, middle = LEFT - 0.14, LEFT - 0.09, 0.05, (y0 + y1) / 2
    bars = [
        ((x0, y0, z0), (x1, y0 + t, z1)),
        ((x0, y1 - t, z0), (x1, y1, z1)),
        ((x0, middle - t / 2, z0 + t), (x1, middle + t / 2, z1 - t)),
    ]
    bars += [((x0, y0 + t, z0), (x1, y1 - t, z0 + t)), ((x0, y0 + t, z1 - t), (x1, y1 - t, z1))]
    bars += [
        ((x0 + 0.01, a, 1.78), (x1 - 0.01, b, 1.81))
        for a, b in ((y0 + t, middle - t / 2), (middle + t / 2, y1 - t))
    ]
    p.boxes("Window frame", bars, plain("White paint", (0.78, 0.76, 0.71), 0.35))
    p.box(
        "Window sill",
        (LEFT - 0.2, y0 + 0.002, z0 - 0.03),
        (LEFT + 0.08, y1 - 0.002, z0 + 0.004),
        plain("Sill", (0.74, 0.72, 0.68), 0.3),
        0.006,
    )
    # 12 mm before the wall, with a ledge above.
    y = BACK - 0.012
    m.add_picture(
        "Tiles",
        [(LEFT, y, COUNTER), (RIGHT, y, COUNTER), (RIGHT, y, 1.52), (LEFT, y, 1.52)],
        tiles,
        (RIGHT - LEFT, 0.62),
    )
    p.box(
        "Tile ledge",
        (LEFT, -0.03, 1.5205),
        (RIGHT, -0.0005, 1.55),
        plain("Ledge", (0.66, 0.7, 0.66), 0.2, Coat_Weight=0.5),
        0.008,
    )


def _cupboards(
    paint: bpy.types.Material, wood: bpy.types.Material, brass: bpy.types.Material
) -> None:
    p.box(
        "Worktop",
        (LEFT + 0.002, -DEPTH - 0.03, COUNTER - 0.045),
        (RIGHT - 0.002, -0.014, COUNTER),
        wood,
        0.006,
    )
    p.box(
        "Plinth",
        (LEFT + 0.002, -DEPTH + 0.06, 0.0005),
        (RIGHT - 0.002, -0.02, 0.1),
        plain("Plinth", (0.05, 0.06, 0.05), 0.6),
    )
    p.box(
        "Carcass",
        (LEFT + 0.002, -DEPTH + 0.025, 0.1),
        (RIGHT - 0.002, -0.02, COUNTER - 0.046),
        paint,
    )
    width, y = 0.54, -DEPTH + 0.024
    count = int((RIGHT - LEFT) / width)
    for k in range(count):
        x0, x1 = LEFT + 0.01 + k * width, LEFT + k * width + width - 0.004
        z0, z1 = 0.12, COUNTER - 0.21
        frame = [
            ((x0, y - 0.022, z0), (x0 + 0.07, y, z1)),
            ((x1 - 0.07, y - 0.022, z0), (x1, y, z1)),
        ]
        frame += [
            ((x0 + 0.07, y - 0.022, z0), (x1 - 0.07, y, z0 + 0.07)),
            ((x0 + 0.07, y - 0.022, z1 - 0.07), (x1 - 0.07, y, z1)),
        ]
        frame += [
            ((x0 + 0.07, y - 0.01, z0 + 0.07), (x1 - 0.07, y, z1 - 0.07)),
            ((x0, y - 0.022, z1 + 0.008), (x1, y, COUNTER - 0.06)),
        ]
        p.boxes("Door", frame, paint, 0.003)
        knob = [
            (0.0, 0.0),
            (0.006, 0.0),
            (0.006, 0.012),
            (0.014, 0.016),
            (0.016, 0.024),
            (0.012, 0.03),
            (0.0, 0.031),
        ]
        for x, z in (((x0 + x1) / 2, COUNTER - 0.13), (x1 - 0.035, z1 - 0.12)):
            made = p.turned("Knob", knob, brass, (x, y - 0.022, z), 16, 1)
            made.rotation_euler[0] = radians(90.0)


def _shelf(wood: bpy.types.Material, brass: bpy.types.Material) -> float:
    z = 1.74
    p.box("Shelf", (-1.05, -0.27, z), (1.35, -0.002, z + 0.035), wood, 0.004)
    for x in (-0.85, 0.15, 1.15):
        p.tube(
            "Bracket",
            [
                (x, -0.004, z - 0.2),
                (x, -0.02, z - 0.2),
                (x, -0.15, z - 0.15),
                (x, -0.23, z - 0.03),
                (x, -0.235, z),
            ],
            0.009,
            brass,
        )
        p.box("Bracket plate", (x - 0.014, -0.012, z - 0.25), (x + 0.014, -0.0005, z), brass, 0.003)
    p.tube("Rail", [(-0.85, -0.16, z - 0.13), (1.15, -0.16, z - 0.13)], 0.007, brass, sides=-4)
    return z + 0.035


def _bowls(
    x: float, y: float, z: float, glaze: bpy.types.Material, count: int, radius: float
) -> None:
    outside = [(0.45 * radius, 0.0), (0.5 * radius, 0.012), (0.82 * radius, 0.035), (radius, 0.075)]
    for k in range(count):
        p.turned("Bowl", p.vessel(outside, 0.005, 0.01), glaze, (x, y, z + 0.027 * k + 0.0005), 40)


def _jar(
    x: float,
    y: float,
    z: float,
    height: float,
    radius: float,
    glass: bpy.types.Material,
    inside: bpy.types.Material,
    lid: bpy.types.Material,
    full: float,
) -> None:
    wall = 0.004
    outside = [
        (radius - 0.006, 0.0),
        (radius, 0.008),
        (radius, height * 0.5),
        (radius, height - 0.02),
        (radius * 0.86, height - 0.004),
        (radius * 0.84, height),
    ]
    p.turned("Jar", p.vessel(outside, wall, 0.006), glass, (x, y, z + 0.0005), 40, 0)
    r = radius - wall - 0.0012
    fill = [
        (0.0, 0.0),
        (r * 0.88, 0.0),
        (r, 0.01),
        (r, full * height),
        (r * 0.6, full * height + 0.008),
        (0.0, full * height + 0.012),
    ]
    p.turned("Contents", fill, inside, (x, y, z + 0.011), 32, 0)
    cover = [
        (0.0, 0.0),
        (radius * 0.9, 0.0),
        (radius * 0.93, 0.004),
        (radius * 0.93, 0.022),
        (radius * 0.88, 0.028),
        (0.0, 0.03),
    ]
    p.turned("Lid", cover, lid, (x, y, z + height + 0.0025), 32)


def _bottle(
    x: float, y: float, z: float, oil: bpy.types.Material, cork: bpy.types.Material
) -> None:
    body = [
        (0.0, 0.0),
        (0.034, 0.0),
        (0.038, 0.006),
        (0.038, 0.15),
        (0.03, 0.185),
        (0.014, 0.21),
        (0.0125, 0.265),
        (0.016, 0.27),
        (0.015, 0.283),
        (0.0, 0.284),
    ]
    p.turned("Oil bottle", body, oil, (x, y, z + 0.0005), 40)
    p.turned(
        "Cork",
        [(0.0, 0.0), (0.0095, 0.0), (0.012, 0.03), (0.0, 0.032)],
        cork,
        (x, y, z + 0.2855),
        20,
    )


def _pan(
    x: float, z: float, copper: bpy.types.Material, iron: bpy.types.Material, radius: float
) -> None:
    """It hangs from the rail, its bottom to the wall."""
    outside = [(radius * 0.86, 0.0), (radius * 0.95, 0.006), (radius, 0.02), (radius * 1.03, 0.055)]
    pan = p.turned("Copper pan", p.vessel(outside, 0.003, 0.003), copper, (x, -0.05, z), 48)
    pan.rotation_euler = (radians(84.0), 0.0, 0.0)
    top = z + radius
    p.tube(
        "Pan handle",
        [
            (x, -0.1, top - 0.012),
            (x, -0.11, top + 0.05),
            (x, -0.125, top + 0.12),
            (x, -0.14, top + 0.17),
        ],
        0.008,
        iron,
    )
    p.tube(
        "Hook",
        [
            (x, -0.14, top + 0.165),
            (x, -0.165, top + 0.17),
            (x, -0.17, top + 0.2),
            (x, -0.15, top + 0.21),
        ],
        0.003,
        iron,
    )


def _kettle(x: float, y: float, enamel: bpy.types.Material, wood: bpy.types.Material) -> None:
    z = COUNTER + 0.001
    body = [
        (0.0, 0.0),
        (0.088, 0.0),
        (0.1, 0.008),
        (0.112, 0.05),
        (0.1, 0.11),
        (0.07, 0.145),
        (0.045, 0.155),
        (0.04, 0.162),
        (0.0, 0.17),
    ]
    p.turned("Kettle", body, enamel, (x, y, z), 48)
    p.turned(
        "Kettle knob",
        [(0.0, 0.0), (0.006, 0.0), (0.007, 0.012), (0.015, 0.02), (0.013, 0.032), (0.0, 0.036)],
        wood,
        (x, y, z + 0.169),
        20,
    )
    p.tube(
        "Spout",
        [
            (x + 0.085, y, z + 0.06),
            (x + 0.13, y, z + 0.075),
            (x + 0.145, y, z + 0.13),
            (x + 0.175, y, z + 0.15),
        ],
        0.017,
        enamel,
    )
    arch = [
        (x - 0.09, y, z + 0.125),
        (x - 0.1, y, z + 0.2),
        (x - 0.06, y, z + 0.265),
        (x + 0.06, y, z + 0.265),
        (x + 0.1, y, z + 0.2),
        (x + 0.09, y, z + 0.125),
    ]
    p.tube("Kettle bow", arch, 0.0045, enamel)
    p.tube(
        "Kettle grip",
        [(x - 0.045, y, z + 0.2505), (x, y, z + 0.254), (x + 0.045, y, z + 0.2505)],
        0.011,
        wood,
    )


def _board(wood: bpy.types.Material, steel: bpy.types.Material, dark: bpy.types.Material) -> None:
    """Board with lemons and a knife, and another one leaning on the tiles."""
    z = COUNTER + 0.0005
    p.box("Board", (-0.21, -0.135, 0.0), (0.21, 0.135, 0.022), wood, 0.006, (0.42, -0.4, z), 0.25)
    leaning = p.box(
        "Leaning board", (-0.13, -0.011, 0.0), (0.13, 0.011, 0.3), wood, 0.005, (-0.47, -0.105, z)
    )
    leaning.rotation_euler = (radians(-14.0), 0.0, 0.0)
    lemon = _lemon()
    shape = [
        (0.0, -0.045),
        (0.006, -0.043),
        (0.011, -0.037),
        (0.026, -0.024),
        (0.032, 0.0),
        (0.026, 0.024),
        (0.01, 0.038),
        (0.005, 0.044),
        (0.0, 0.046),
    ]
    top = z + 0.0225
    for dx, dy, dz, tilt, turn in (
        (0.32, -0.36, 0.031, 88, 20),
        (0.4, -0.33, 0.031, 94, 130),
        (0.5, -0.47, 0.031, 85, -40),
    ):
        fruit = p.turned("Lemon", shape, lemon, (dx, dy, top + dz), 24)
        fruit.rotation_euler = (radians(tilt), 0.0, radians(turn))
    blade = [(0.0, -0.018, 0.0), (0.17, -0.018, 0.0), (0.2, 0.006, 0.0), (0.0, 0.012, 0.0)]
    blade = [(x, y, z) for z in (0.0, 0.0016) for x, y, _ in blade]
    knife = m.add_mesh(
        "Blade",
        blade,
        [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
        steel,
    )
    knife.location, knife.rotation_euler = (0.36, -0.475, top + 0.003), (0.0, 0.0, radians(8.0))
    p.box(
        "Knife grip",
        (-0.11, -0.014, -0.0065),
        (0.0, 0.012, 0.0085),
        dark,
        0.004,
        (0.36, -0.475, top + 0.0085),
        radians(8.0),
    )


def _pot(x: float, y: float, steel: bpy.types.Material, iron: bpy.types.Material) -> None:
    """On the hob: a steel pot with a lid."""
    z = COUNTER
    p.box(
        "Hob",
        (x - 0.28, y - 0.24, z + 0.0005),
        (x + 0.28, y + 0.2, z + 0.008),
        plain("Hob glass", (0.012, 0.012, 0.014), 0.06, Coat_Weight=0.5),
        0.003,
    )
    foot = z + 0.0085
    outside = [(0.115, 0.0), (0.122, 0.006), (0.124, 0.06), (0.124, 0.135)]
    p.turned("Pot", p.vessel(outside, 0.003, 0.004), steel, (x - 0.02, y, foot), 48)
    p.turned(
        "Pot lid",
        [(0.0, 0.0), (0.127, 0.0), (0.128, 0.004), (0.09, 0.018), (0.02, 0.025), (0.0, 0.026)],
        steel,
        (x - 0.02, y, foot + 0.1375),
        48,
    )
    p.turned(
        "Lid knob",
        [(0.0, 0.0), (0.008, 0.0), (0.009, 0.012), (0.02, 0.018), (0.017, 0.028), (0.0, 0.03)],
        iron,
        (x - 0.02, y, foot + 0.1625),
        24,
    )
    for side in (-1, 1):
        s = x - 0.02 + side * 0.122
        p.tube(
            "Pot ear",
            [
                (s, y - 0.04, foot + 0.11),
                (s + side * 0.04, y - 0.035, foot + 0.115),
                (s + side * 0.04, y + 0.035, foot + 0.115),
                (s, y + 0.04, foot + 0.11),
            ],
            0.006,
            iron,
        )


def _herbs(
    x: float,
    y: float,
    z: float,
    clay: bpy.types.Material,
    soil: bpy.types.Material,
    green: bpy.types.Material,
    seed: int,
    size: float = 1.0,
) -> None:
    outside = [
        (0.045 * size, 0.0),
        (0.05 * size, 0.005),
        (0.064 * size, 0.095 * size),
        (0.072 * size, 0.097 * size),
        (0.073 * size, 0.118 * size),
    ]
    p.turned("Pot", p.vessel(outside, 0.006, 0.006), clay, (x, y, z + 0.0005), 32, 0)
    p.turned(
        "Soil", [(0.0, 0.0), (0.056 * size, 0.0), (0.0, 0.008)], soil, (x, y, z + 0.1 * size), 24, 0
    )
    p.leaves(
        "Herb",
        p.bush(110, 0.095 * size, 0.2 * size, 0.062 * size, seed),
        green,
        0.55,
        0.3,
        3,
        (x, y, z + 0.09 * size),
    )


def _towel(x: float, y: float, z: float) -> None:
    """It hangs over the rail of a drawer."""
    t = material("Tea towel")
    where = t.coordinates("UV")
    color = t.image(art.packed("Tea towel", art.tea_towel(256)), where)
    height = t.image(
        art.packed("Weave", art.weave(64, 8), data=True),
        t.add("Mapping", Vector=where, Scale=(24.0, 36.0, 1.0)),
    )
    cloth = t.principled(
        Base_Color=color, Roughness=0.9, Sheen_Weight=0.3, Normal=t.bump(height, 0.0008, 0.7)
    )
    columns, rows = 25, 15
    vertices, uvs = [], []
    for row in range(rows):
        for column in range(columns):
            u, v = column / (columns - 1), row / (rows - 1)
            fold = 0.012 * sin(u * 2 * pi * 3.2 + 0.6) * (1.0 - 0.55 * v) + 0.006 * sin(
                u * 19.0 + 2.0 * v
            )
            vertices.append(
                (
                    x + (u - 0.5) * (0.30 - 0.03 * (1.0 - v) * sin(pi * u)),
                    y - 0.018 + fold,
                    z - 0.46 * (1.0 - v),
                )
            )
            uvs.append((u, v))
    corners = [r * columns + c for r in range(rows - 1) for c in range(columns - 1)]
    faces = [(k, k + 1, k + columns + 1, k + columns) for k in corners]
    thing = m.add_mesh("Tea towel", vertices, faces, cloth, smooth=True)
    flat = [uv for face in faces for k in face for uv in uvs[k]]
    thing.data.uv_layers.new(name="UVMap").data.foreach_set("uv", np.array(flat, np.float32))
    brass = bpy.data.materials["Brass"]
    p.tube("Towel rail", [(x - 0.22, y - 0.02, z), (x + 0.22, y - 0.02, z)], 0.006, brass, sides=-4)


def _light() -> None:
    sun = m.add_light(
        "Sun",
        "SUN",
        30.0,
        (-6.0, -2.6, 4.1),
        (-0.1, -0.35, 0.85),
        angle=radians(1.0),
        color=(1.0, 0.86, 0.68),
    )
    sun.visible_camera = False
    window = m.add_light(
        "Window",
        "AREA",
        110.0,
        (LEFT - 0.2, -1.185, 1.62),
        (0.0, -1.185, 1.45),
        shape="RECTANGLE",
        size=1.4,
        size_y=1.1,
        color=(0.72, 0.85, 1.0),
    )
    window.visible_camera = False
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    t = Tree(world)
    t.surface(t.add("Background", Color=(0.6, 0.75, 1.0), Strength=0.8))


def make() -> None:
    scene = m.new_scene(720, 480, "AgX")
    scene.view_settings.exposure = -0.55
    scene.view_settings.look = "AgX - Medium High Contrast"
    _worn()
    oak, oak_height = art.planks(512, 8, 3, (0.74, 0.55, 0.36), (0.42, 0.26, 0.14))
    color, height = art.packed("Oak", oak), art.packed("Oak height", oak_height, data=True)
    worktop = _wood("Oiled oak", color, height, 0.8, 0.3)
    shelf = _wood("Dark oak", color, height, 0.7, 0.42, 0.0, 0.45)
    walnut = _wood("Walnut", color, height, 1.6, 0.4, pi / 2, 0.55)
    brass = plain("Brass", (0.83, 0.61, 0.27), 0.28, Metallic=1.0)
    iron = plain("Iron", (0.04, 0.04, 0.042), 0.4, Metallic=0.3)
    copper, steel, clear = _copper(), _steel(), _glass("Clear glass")
    red, cream = (
        _enamel("Red enamel", (0.55, 0.05, 0.035)),
        _enamel("Cream enamel", (0.82, 0.76, 0.62)),
    )
    blue = _enamel("Blue glaze", (0.16, 0.3, 0.42))
    _shell(_tiles(), _plaster_wall(), _floor(), plain("Ceiling", (0.82, 0.81, 0.78), 0.9))
    _cupboards(_cabinet(), worktop, brass)
    top = _shelf(shelf, brass)
    _bowls(-0.85, -0.14, top, cream, 4, 0.085)
    _bowls(-0.62, -0.13, top, blue, 3, 0.07)
    lentils = _beans("Lentils", (0.75, 0.3, 0.1), (0.55, 0.18, 0.06), 190.0)
    coffee = _beans("Coffee", (0.16, 0.07, 0.03), (0.09, 0.04, 0.02), 130.0)
    peas = _beans("Peas", (0.5, 0.52, 0.2), (0.36, 0.42, 0.12), 150.0)
    for x, high, wide, what, full in (
        (-0.36, 0.2, 0.062, coffee, 0.72),
        (-0.19, 0.16, 0.058, lentils, 0.6),
        (-0.03, 0.21, 0.055, peas, 0.5),
    ):
        _jar(x, -0.14, top, high, wide, clear, what, walnut, full)
    clay = _clay()
    soil = plain("Soil", (0.035, 0.022, 0.014), 0.95)
    basil = _leaf("Basil", (0.2, 0.42, 0.1), (0.07, 0.22, 0.045))
    sage = _leaf("Sage", (0.42, 0.5, 0.36), (0.24, 0.33, 0.21))
    _herbs(0.3, -0.14, top, clay, soil, sage, 4, 0.9)
    _bowls(0.58, -0.14, top, cream, 1, 0.1)
    p.turned(
        "Jug",
        p.vessel(
            [(0.05, 0.0), (0.056, 0.006), (0.075, 0.07), (0.06, 0.14), (0.05, 0.17), (0.057, 0.2)],
            0.005,
            0.006,
        ),
        blue,
        (0.8, -0.14, top + 0.0005),
        40,
    )
    p.tube(
        "Jug handle",
        [
            (0.854, -0.14, top + 0.17),
            (0.91, -0.14, top + 0.17),
            (0.915, -0.14, top + 0.09),
            (0.87, -0.14, top + 0.06),
        ],
        0.008,
        blue,
    )
    _herbs(1.12, -0.14, top, clay, soil, basil, 8, 0.8)
    for x, radius in ((0.36, 0.115), (0.68, 0.095), (0.96, 0.075)):
        _pan(x, 1.26 + (0.115 - radius), copper, iron, radius)
    _board(walnut, steel, iron)
    _kettle(-0.1, -0.3, red, walnut)
    oil = plain("Olive oil", (0.72, 0.66, 0.14), 0.0, Transmission_Weight=1.0, IOR=1.47)
    _bottle(0.76, -0.24, COUNTER, oil, plain("Cork", (0.5, 0.33, 0.2), 0.8))
    _bottle(
        0.88,
        -0.17,
        COUNTER,
        _glass("Vinegar", (0.42, 0.1, 0.06)),
        plain("Stopper", (0.1, 0.07, 0.05), 0.5),
    )
    _pot(-0.85, -0.32, steel, iron)
    _herbs(-1.5, -0.3, COUNTER, clay, soil, basil, 1, 1.25)
    _towel(0.62, -DEPTH + 0.0, COUNTER - 0.13)
    _light()
    m.add_camera((0.62, -2.5, 1.47), (0.0, -0.2, 1.215), lens=34.5)
    m.save("kitchen")


def _clay() -> bpy.types.Material:
    t = material("Clay")
    chalk = t.ramp(
        t.noise(t.coordinates("Object"), 14.0, 5.0),
        [(0.4, (0.5, 0.22, 0.12)), (0.72, (0.66, 0.44, 0.34))],
    )
    return t.principled(Base_Color=chalk, Roughness=0.85)


if __name__ == "__main__":
    make()
