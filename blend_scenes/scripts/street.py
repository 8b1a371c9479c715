"""A lane in an old town on a summer day, lit by nothing but an HDRI made here: plaster, setts,
shutters, awnings, plants, a bicycle.

Facades share one group for weathered plaster; every tint comes from Object Info, so that one
material serves all houses.
"""

from __future__ import annotations

from math import cos, pi, radians, sin

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import artwork as art
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.trees import Tree, group, material, plain, use_group

HALF = 2.3  # of the lane's width, m
END = 30.0

# Materials ----------------------------------------------------------------------------------------


def _weathered() -> bpy.types.NodeTree:
    """A group: the colour of a plastered wall, stained towards the ground, and its normal."""
    color, height = art.plaster(384, 31)
    tones, rise = art.packed("Plaster", color), art.packed("Plaster height", height, data=True)
    tree, given, result = group(
        "Weathered plaster",
        [("Color", "Color", (0.8, 0.6, 0.4)), ("Damp", "Float", 1.0)],
        [("Color", "Color"), ("Normal", "Vector")],
    )
    place = tree.add("NewGeometry", "Position")
    where = tree.add("Mapping", Vector=place, Scale=(0.28, 0.28, 0.28))
    wall = tree.mix(
        1.0,
        given.outputs["Color"],
        tree.image(tones, where, projection="BOX", projection_blend=0.2),
        "MULTIPLY",
    )
    edge = tree.math(
        "ADD",
        tree.add("SeparateXYZ", "Z", Vector=place),
        tree.math("MULTIPLY", tree.noise(place, 1.1, 5.0), -1.6),
    )
    damp = tree.math("MULTIPLY", tree.map_range(edge, -0.6, 0.3, 1.0, 0.0), given.outputs["Damp"])
    flaked = tree.map_range(tree.noise(place, 0.75, 7.0, Roughness=0.62), 0.61, 0.63)
    bare = tree.mix(tree.noise(place, 9.0, 4.0), (0.42, 0.33, 0.25), (0.56, 0.46, 0.36))
    color_out = tree.mix(
        tree.math("MULTIPLY", damp, 0.6), tree.mix(flaked, wall, bare), (0.26, 0.22, 0.17)
    )
    relief = tree.math(
        "SUBTRACT",
        tree.image(rise, where, projection="BOX", projection_blend=0.2),
        tree.math("MULTIPLY", flaked, 0.4),
    )
    tree.links.new(color_out, result.inputs["Color"])
    tree.links.new(tree.bump(relief, 0.02, 0.6), result.inputs["Normal"])
    return bpy.data.node_groups["Weathered plaster"]


def _facade(weathered: bpy.types.NodeTree) -> bpy.types.Material:
    t = material("Facade")
    tint = t.ramp(
        t.add("ObjectInfo", "Random"),
        [
            (0.0, (0.80, 0.53, 0.27)),
            (0.2, (0.78, 0.38, 0.24)),
            (0.4, (0.85, 0.68, 0.44)),
            (0.6, (0.72, 0.34, 0.27)),
            (0.8, (0.86, 0.77, 0.6)),
        ],
        "CONSTANT",
    )
    own = t.add("ObjectInfo", "Color")
    wall = use_group(t, weathered, "Color", Color=t.mix(0.85, tint, own))
    return t.principled(Base_Color=wall, Roughness=0.9, Normal=wall.node.outputs["Normal"])


def _setts() -> bpy.types.Material:
    t = material("Setts")
    color, height = art.pavers(384, 11, 4)
    where = t.coordinates("UV")
    stone = t.image(art.packed("Setts", color), where)
    worn = t.noise(t.coordinates("Object"), 0.7, 4.0)
    toned = t.mix(t.map_range(worn, 0.3, 0.7, 0.1, 0.55), stone, (0.32, 0.28, 0.24), "MULTIPLY")
    relief = t.normal_map(
        art.packed("Setts normals", art.normals(height, 0.05), data=True), where, 0.9
    )
    return t.principled(
        Base_Color=toned, Roughness=t.map_range(worn, 0.3, 0.7, 0.55, 0.36), Normal=relief
    )


def _curb() -> bpy.types.Material:
    t = material("Granite")
    where = t.coordinates("Object")
    grains = t.add("TexVoronoi", "Color", Vector=where, Scale=160.0)
    grey = t.ramp(
        t.add("SeparateColor", "Red", Color=grains),
        [(0.0, (0.2, 0.19, 0.18)), (0.5, (0.4, 0.38, 0.36)), (1.0, (0.55, 0.53, 0.5))],
    )
    slab = t.add(
        "TexBrick",
        "Fac",
        {"offset": 0.0},
        Vector=t.coordinates("UV"),
        Scale=1.0,
        Mortar_Size=0.008,
        Mortar_Smooth=0.3,
        Brick_Width=1.1,
        Row_Height=5.0,
    )
    color = t.mix(slab, t.mix(t.noise(where, 2.0, 4.0), grey, (0.5, 0.47, 0.42)), (0.12, 0.1, 0.09))
    return t.principled(
        Base_Color=color,
        Roughness=0.6,
        Normal=t.bump(t.math("SUBTRACT", t.noise(where, 40.0, 3.0), slab), 0.004, 0.5),
    )


def _louvres(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    """Painted shutters: slats by a wave, faded where the sun bites."""
    t = material(name)
    where = t.coordinates("Object")
    slats = t.add("TexWave", "Fac", {"bands_direction": "Z"}, Vector=where, Scale=5.5)
    faded = t.mix(
        t.map_range(t.noise(where, 3.0, 6.0), 0.4, 0.75, 0.0, 0.5), color, (0.55, 0.53, 0.47)
    )
    shade = t.mix(t.map_range(slats, 0.0, 0.25, 0.75, 0.0), faded, tuple(0.25 * c for c in color))
    return t.principled(Base_Color=shade, Roughness=0.5, Normal=t.bump(slats, 0.008, 0.6))


def _pane() -> bpy.types.Material:
    """Old window glass before a dark room with a curtain."""
    t = material("Window pane")
    where = t.coordinates("Generated")
    across = t.add("SeparateXYZ", "X", Vector=where)
    fold = t.add(
        "TexWave", "Fac", {"bands_direction": "X"}, Vector=where, Scale=5.0, Distortion=0.8
    )
    drawn = t.math(
        "GREATER_THAN",
        t.math("ABSOLUTE", t.math("SUBTRACT", across, 0.5)),
        t.map_range(t.add("ObjectInfo", "Random"), 0.0, 1.0, 0.2, 0.5),
    )
    room = t.mix(drawn, (0.012, 0.013, 0.015), t.mix(fold, (0.16, 0.15, 0.13), (0.42, 0.4, 0.36)))
    wavy = t.bump(t.noise(t.coordinates("Object"), 3.0, 1.0), 0.02, 0.25)
    return t.principled(Base_Color=room, Roughness=0.04, Normal=wavy, Specular_IOR_Level=0.7)


def _timber(
    name: str, light: tuple[float, float, float], dark: tuple[float, float, float], boards: int
) -> bpy.types.Material:
    t = material(name)
    color, height = art.planks(256, boards, 12, light, dark)
    where = t.add(
        "Mapping",
        Vector=t.coordinates("Object"),
        Rotation=(0.0, pi / 2, 0.0),
        Scale=(0.7, 0.7, 0.7),
    )
    wood = t.image(art.packed(name, color), where, projection="BOX")
    rise = t.image(art.packed(f"{name} height", height, data=True), where, projection="BOX")
    return t.principled(
        Base_Color=wood,
        Roughness=0.55,
        Coat_Weight=0.25,
        Coat_Roughness=0.3,
        Normal=t.bump(rise, 0.006, 0.8),
    )


def _roof() -> bpy.types.Material:
    t = material("Roof tiles")
    where = t.coordinates("Object")
    rows = t.add("TexWave", "Fac", {"bands_direction": "Y"}, Vector=where, Scale=1.6)
    color = t.ramp(
        t.noise(where, 6.0, 5.0),
        [(0.3, (0.4, 0.17, 0.1)), (0.55, (0.55, 0.28, 0.17)), (0.75, (0.62, 0.45, 0.32))],
    )
    return t.principled(Base_Color=color, Roughness=0.85, Normal=t.bump(rows, 0.05))


def _canvas(
    name: str, one: tuple[float, float, float], two: tuple[float, float, float], stripes: float
) -> bpy.types.Material:
    """Striped canvas that lets light through."""
    t = material(name)
    where = t.coordinates("UV")
    u = t.add("SeparateXYZ", "X", Vector=where)
    stripe = t.math("GREATER_THAN", t.math("FRACT", t.math("MULTIPLY", u, stripes)), 0.5)
    color = t.mix(stripe, one, two)
    worn = t.mix(
        t.map_range(t.noise(where, 6.0, 5.0), 0.4, 0.8, 0.0, 0.3), color, (0.6, 0.56, 0.48)
    )
    weave = t.bump(
        t.image(bpy.data.images["Weave"], t.add("Mapping", Vector=where, Scale=(60.0, 30.0, 1.0))),
        0.001,
        0.5,
    )
    cloth = t.add("BsdfDiffuse", Color=worn, Roughness=0.3, Normal=weave)
    return t.surface(t.add("MixShader", i0=0.35, i1=cloth, i2=t.add("BsdfTranslucent", Color=worn)))


def _leaf(
    name: str, light: tuple[float, float, float], dark: tuple[float, float, float]
) -> bpy.types.Material:
    t = material(name)
    color = t.image(art.packed(name, art.leaf(64, light, dark)), t.coordinates("UV"))
    through = t.add("BsdfTranslucent", Color=t.mix(1.0, color, (0.9, 1.0, 0.4), "MULTIPLY"))
    return t.surface(
        t.add(
            "MixShader",
            i0=0.3,
            i1=t.add("BsdfPrincipled", Base_Color=color, Roughness=0.45),
            i2=through,
        )
    )


def _car_paint(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    """Lacquer over flakes."""
    t = material(name)
    flakes = t.add("TexVoronoi", "Color", Vector=t.coordinates("Object"), Scale=900.0)
    tilt = t.add(
        "VectorMath",
        0,
        {"operation": "MULTIPLY_ADD"},
        i0=flakes,
        i1=(0.25, 0.25, 0.25),
        i2=(-0.125, -0.125, -0.125),
    )
    normal = t.add(
        "VectorMath", 0, {"operation": "ADD"}, i0=t.add("NewGeometry", "Normal"), i1=tilt
    )
    return t.principled(
        Base_Color=color, Metallic=0.5, Roughness=0.3, Coat_Weight=1.0, Coat_Roughness=0.02,
        Normal=t.add("VectorMath", 0, {"operation": "NORMALIZE"}, i0=normal),
    )  # fmt: skip


# Houses -------------------------------------------------------------------------------------------


class House:
    """A front from y0 to y1 on one side of the lane (-1: left), its windows and its door."""

    def __init__(
        self,
        stuff: dict[str, bpy.types.Material],
        side: int,
        y0: float,
        y1: float,
        height: float,
        tint: tuple[float, float, float],
    ) -> None:
        self.stuff, self.side, self.y0, self.y1, self.height = stuff, side, y0, y1, height
        self.x = side * HALF
        wall = m.add_boxes(
            "House",
            [((min(self.x, side * 6.5), y0, 0.0), (max(self.x, side * 6.5), y1, height))],
            stuff["facade"],
        )
        wall.color = (*tint, 1.0)
        self.box("Cornice", -0.12, y0, height, 0.16, y1, height + 0.14, stuff["stone"])
        self.box("Roof edge", -0.12, y0, height + 0.1405, 0.42, y1, height + 0.2, stuff["roof"])
        self.box("Plinth", 0.0, y0, 0.0, 0.05, y1, 0.55, stuff["stone"])

    def box(
        self,
        name: str,
        d0: float,
        y0: float,
        z0: float,
        d1: float,
        y1: float,
        z1: float,
        stuff: bpy.types.Material,
        round_by: float = 0.0,
    ) -> bpy.types.Object:
        """d: distance from the front into the lane."""
        a, b = self.x - self.side * d0, self.x - self.side * d1
        middle = ((a + b) / 2, (y0 + y1) / 2, z0)
        low, high = (
            (min(a, b) - middle[0], y0 - middle[1], 0.0),
            (max(a, b) - middle[0], y1 - middle[1], z1 - z0),
        )
        return p.box(name, low, high, stuff, round_by, middle)

    def window(
        self,
        y: float,
        z: float,
        shutters: str,
        width: float = 0.9,
        tall: float = 1.45,
        open_: bool = True,
        flowers: int = 0,
    ) -> None:
        s, half = self.stuff, width / 2
        self.box("Pane", 0.002, y - half, z, 0.012, y + half, z + tall, s["pane"])
        for a, b, c, d in (
            (-half, -half + 0.06, 0.0, tall),
            (half - 0.06, half, 0.0, tall),
            (-0.03, 0.03, 0.0, tall),
            (-half + 0.06, half - 0.06, 0.0, 0.07),
        ):
            self.box("Frame", 0.0125, y + a, z + c, 0.045, y + b, z + d, s["white"])
        for level in (0.36, 0.68, 0.955):
            self.box(
                "Bar",
                0.0125,
                y - half + 0.0605,
                z + level * tall,
                0.035,
                y - 0.0305,
                z + level * tall + 0.035,
                s["white"],
            )
            self.box(
                "Bar",
                0.0125,
                y + 0.0305,
                z + level * tall,
                0.035,
                y + half - 0.0605,
                z + level * tall + 0.035,
                s["white"],
            )
        rim = 0.12
        self.box("Surround", 0.0, y - half - rim, z, 0.035, y - half, z + tall + rim, s["stone"])
        self.box("Surround", 0.0, y + half, z, 0.035, y + half + rim, z + tall + rim, s["stone"])
        self.box("Lintel", 0.0, y - half, z + tall, 0.035, y + half, z + tall + rim, s["stone"])
        self.box(
            "Sill",
            0.0,
            y - half - rim - 0.04,
            z - 0.09,
            0.14,
            y + half + rim + 0.04,
            z - 0.001,
            s["stone"],
            0.01,
        )
        if open_:
            for way in (-1, 1):
                hinge = y + way * (half + rim * 0.5)
                self.box(
                    "Shutter",
                    0.04,
                    min(hinge, hinge + way * half),
                    z + 0.01,
                    0.085,
                    max(hinge, hinge + way * half),
                    z + tall + 0.02,
                    s[shutters],
                )
        if flowers:
            self.flowers(y, z, width, flowers)

    def flowers(self, y: float, z: float, width: float, seed: int) -> None:
        s = self.stuff
        self.box(
            "Flower box",
            0.15,
            y - width / 2,
            z - 0.13,
            0.36,
            y + width / 2,
            z + 0.06,
            s["clay"],
            0.01,
        )
        x = self.x - self.side * 0.26
        for k in range(4):
            at = (x, y + (k - 1.5) * width / 4, z + 0.06)
            p.leaves(
                "Geranium leaves",
                p.bush(45, 0.19, 0.2, 0.12, seed + k, 0.2),
                s["leaf"],
                0.8,
                0.3,
                2,
                at,
            )
            p.leaves(
                "Geranium",
                p.bush(26, 0.2, 0.32, 0.065, seed + 40 + k, 0.9),
                s["bloom"],
                1.0,
                0.1,
                2,
                at,
            )

    def door(self, y: float, wood: str, width: float = 1.05, tall: float = 2.25) -> None:
        s, half = self.stuff, width / 2
        self.box("Door", 0.002, y - half, 0.14, 0.03, y + half, tall, s[wood])
        for a, b in ((-half + 0.1, -0.05), (0.05, half - 0.1)):
            for c, d in ((0.35, 1.0), (1.15, tall - 0.15)):
                self.box("Panel", 0.0305, y + a, c, 0.055, y + b, d, s[wood], 0.012)
        self.box("Jamb", 0.0, y - half - 0.18, 0.0, 0.07, y - half, tall, s["stone"])
        self.box("Jamb", 0.0, y + half, 0.0, 0.07, y + half + 0.18, tall, s["stone"])
        self.box(
            "Door lintel",
            0.0,
            y - half - 0.18,
            tall,
            0.09,
            y + half + 0.18,
            tall + 0.22,
            s["stone"],
        )
        self.box("Step", 0.051, y - half - 0.2, 0.0, 0.4, y + half + 0.2, 0.13, s["stone"], 0.015)
        m.add_sphere(
            "Door knob", 0.035, s["brass"], (self.x - self.side * 0.09, y - 0.02, 1.08), 20
        )

    def lantern(self, y: float, z: float) -> None:
        s, x = self.stuff, self.x - self.side * 0.45
        p.tube(
            "Bracket",
            [
                (self.x, y, z + 0.25),
                (self.x - self.side * 0.2, y, z + 0.42),
                (x, y, z + 0.42),
                (x, y, z + 0.3),
            ],
            0.014,
            s["iron"],
        )
        cage = [(0.0, 0.0), (0.07, 0.0), (0.11, 0.26), (0.0, 0.27)]
        p.turned("Lantern glass", cage, s["frosted"], (x, y, z), 6, 0).data.polygons.foreach_set(
            "use_smooth", [False] * 18
        )
        p.turned(
            "Lantern top",
            [(0.0, 0.0), (0.135, 0.0), (0.06, 0.07), (0.03, 0.09), (0.0, 0.1)],
            s["iron"],
            (x, y, z + 0.271),
            6,
            0,
        )

    def awning(
        self, y0: float, y1: float, z: float, reach: float, cloth: bpy.types.Material
    ) -> None:
        out = self.x - self.side * reach
        count = 24
        vertices, uvs, faces = [], [], []
        for k in range(count + 1):
            y = y0 + (y1 - y0) * k / count
            wave = 0.03 * abs(sin(k * pi / 2))
            vertices += [(self.x, y, z), (out, y, z - 0.75), (out, y, z - 0.98 + wave)]
            uvs += [(k / count, 1.0), (k / count, 0.2), (k / count, 0.0)]
        for k in range(count):
            for j in (0, 1):
                a = 3 * k + j
                faces.append((a, a + 1, a + 4, a + 3))
        thing = m.add_mesh("Awning", vertices, faces, cloth)
        thing.data.uv_layers.new(name="UVMap").data.foreach_set(
            "uv", np.array([uvs[v] for face in faces for v in face], np.float32).ravel()
        )


# On the street ------------------------------------------------------------------------------------


def _ground(setts: bpy.types.Material, granite: bpy.types.Material) -> None:
    w, count = 1.55, 34
    vertices, faces, uvs = [], [], []
    y0, y1 = -6.0, END
    for k in range(count + 1):
        y = y0 + (y1 - y0) * k / count
        for i in range(9):
            x = -w + 2 * w * i / 8
            vertices.append((x, y, -0.05 + 0.05 * (x / w) ** 2))
    for k in range(count):
        for i in range(8):
            a = 9 * k + i
            face = (a, a + 1, a + 10, a + 9)
            faces.append(face)
            uvs += [(vertices[v][0] / 1.25, vertices[v][1] / 1.25) for v in face]
    road = m.add_mesh("Lane", vertices, faces, setts, smooth=True)
    road.data.uv_layers.new(name="UVMap").data.foreach_set("uv", np.array(uvs, np.float32).ravel())
    for side in (-1, 1):
        a, b = sorted((side * w, side * (HALF + 0.02)))
        top = 0.07
        walk = m.add_mesh("Pavement", *m.box_data((a, y0, -0.1), (b, y1, top)), granite)
        flat = []
        for face in walk.data.polygons:
            flat += [
                value
                for v in face.vertices
                for value in (walk.data.vertices[v].co.y, walk.data.vertices[v].co.x)
            ]
        walk.data.uv_layers.new(name="UVMap").data.foreach_set("uv", flat)
        p.rounded(walk, 0.025)


def _table(x: float, y: float, stuff: dict[str, bpy.types.Material]) -> None:
    z = 0.071
    p.turned(
        "Table top",
        [(0.0, 0.0), (0.3, 0.0), (0.31, 0.008), (0.31, 0.02), (0.3, 0.025), (0.0, 0.025)],
        stuff["marble"],
        (x, y, z + 0.7),
        40,
        0,
    )
    p.turned(
        "Table leg",
        [
            (0.0, 0.0),
            (0.18, 0.0),
            (0.17, 0.02),
            (0.03, 0.05),
            (0.022, 0.35),
            (0.022, 0.66),
            (0.08, 0.699),
            (0.0, 0.6995),
        ],
        stuff["iron"],
        (x, y, z),
        24,
    )
    cup = [(0.02, 0.0), (0.026, 0.004), (0.038, 0.03), (0.042, 0.055)]
    for dx, dy in ((-0.1, 0.08), (0.12, -0.05)):
        p.turned(
            "Saucer",
            [(0.0, 0.0), (0.04, 0.0), (0.07, 0.012), (0.068, 0.015), (0.04, 0.005), (0.0, 0.005)],
            stuff["white"],
            (x + dx, y + dy, z + 0.7255),
            28,
        )
        p.turned(
            "Cup", p.vessel(cup, 0.003, 0.005), stuff["white"], (x + dx, y + dy, z + 0.7315), 28
        )


def _chair(x: float, y: float, turn: float, stuff: dict[str, bpy.types.Material]) -> None:
    """A bistro chair: iron and wooden slats."""
    c, s = cos(turn), sin(turn)

    def at(px: float, py: float, pz: float) -> tuple[float, float, float]:
        return (x + px * c - py * s, y + px * s + py * c, 0.071 + pz)

    for side in (-0.18, 0.18):
        p.tube(
            "Chair side",
            [
                at(side, -0.19, 0.0),
                at(side, -0.17, 0.45),
                at(side, 0.0, 0.46),
                at(side, 0.16, 0.45),
                at(side, 0.21, 0.0),
            ],
            0.011,
            stuff["iron"],
            sides=-3,
        )
        p.tube(
            "Chair back",
            [at(side, 0.17, 0.44), at(side, 0.22, 0.65), at(side, 0.26, 0.88)],
            0.011,
            stuff["iron"],
        )
    slats = [((-0.2, -0.18 + 0.072 * k, 0.463), (0.2, -0.125 + 0.072 * k, 0.48)) for k in range(5)]
    p.boxes("Chair seat", slats, stuff["green"], 0.004, (x, y, 0.071), turn)
    p.boxes(
        "Chair back slats",
        [
            ((-0.19, 0.212 + 0.016 * k, 0.6 + 0.1 * k), (0.19, 0.23 + 0.016 * k, 0.66 + 0.1 * k))
            for k in range(3)
        ],
        stuff["green"],
        0.004,
        (x, y, 0.071),
        turn,
    )


def _planter(
    x: float,
    y: float,
    stuff: dict[str, bpy.types.Material],
    seed: int,
    size: float,
    bloom: bool = False,
) -> None:
    outside = [
        (0.15 * size, 0.0),
        (0.16 * size, 0.01),
        (0.22 * size, 0.34 * size),
        (0.25 * size, 0.35 * size),
        (0.25 * size, 0.4 * size),
    ]
    z = 0.0705
    p.turned("Planter", p.vessel(outside, 0.02, 0.02), stuff["clay"], (x, y, z), 32, 0)
    p.turned(
        "Earth",
        [(0.0, 0.0), (0.2 * size, 0.0), (0.0, 0.01)],
        stuff["soil"],
        (x, y, z + 0.35 * size),
        20,
        0,
    )
    p.leaves(
        "Bush",
        p.bush(int(190 * size), 0.34 * size, 0.75 * size, 0.15, seed, 0.6),
        stuff["leaf"],
        0.5,
        0.3,
        3,
        (x, y, z + 0.33 * size),
    )
    if bloom:
        p.leaves(
            "Blossom",
            p.bush(90, 0.36 * size, 0.8 * size, 0.07, seed + 7, 0.9),
            stuff["bloom"],
            0.9,
            0.1,
            2,
            (x, y, z + 0.34 * size),
        )


def _bicycle(
    x: float, y: float, turn: float, lean: float, stuff: dict[str, bpy.types.Material]
) -> None:
    """Along its own x axis, the front wheel at +x."""
    stand = bpy.data.objects.new("Bicycle", None)
    bpy.context.scene.collection.objects.link(stand)
    stand.location, stand.rotation_euler = (x, y, 0.075), (lean, 0.0, turn)
    r = 0.33
    rear, front, crank, seat, head = (
        (-0.5, 0, r),
        (0.52, 0, r),
        (-0.06, 0, 0.3),
        (-0.2, 0, 0.78),
        (0.34, 0, 0.8),
    )
    made = []

    def bar(
        a: tuple[float, float, float],
        b: tuple[float, float, float],
        radius: float,
        stuff_: bpy.types.Material,
    ) -> None:
        made.append(
            p.tube(
                "Bar",
                [a, tuple((u + v) / 2 for u, v in zip(a, b, strict=True)), b],
                radius,
                stuff_,
                sides=-3,
            )
        )

    paint, chrome, rubber = stuff["lacquer"], stuff["chrome"], stuff["rubber"]
    low_head = (0.38, 0.0, 0.62)
    for a, b in ((crank, seat), (seat, head), (crank, low_head), (head, low_head)):
        bar(a, b, 0.017, paint)
    for side in (-0.05, 0.05):
        bar((rear[0], side, r), (crank[0], side * 0.4, crank[2]), 0.009, paint)
        bar((rear[0], side, r), (seat[0], side * 0.3, seat[2] - 0.03), 0.008, paint)
        bar((front[0], side, r), (low_head[0], side, low_head[2]), 0.01, chrome)
    bar(seat, (-0.225, 0, 0.9), 0.012, chrome)
    bar(head, (0.33, 0, 0.93), 0.012, chrome)
    made.append(
        p.tube(
            "Handlebar",
            [
                (0.2, -0.27, 0.95),
                (0.36, -0.25, 0.97),
                (0.4, -0.05, 0.95),
                (0.4, 0.05, 0.95),
                (0.36, 0.25, 0.97),
                (0.2, 0.27, 0.95),
            ],
            0.011,
            chrome,
        )
    )
    saddle = p.box(
        "Saddle",
        (-0.13, -0.075, 0.0),
        (0.12, 0.075, 0.05),
        stuff["leather"],
        0.022,
        (-0.235, 0.0, 0.9),
    )
    made.append(saddle)
    for cx, _, cz in (rear, front):
        for radius, thick, what in ((r - 0.02, 0.019, rubber), (r - 0.045, 0.012, chrome)):
            wheel = p.tube("Wheel", circle_xz(radius), thick, what, (cx, 0.0, cz), closed=True)
            made.append(wheel)
        for k in range(14):
            a = 2 * pi * k / 14
            made.append(
                p.tube(
                    "Spoke",
                    [
                        (cx, 0, cz),
                        (cx + 0.14 * cos(a), 0, cz + 0.14 * sin(a)),
                        (cx + 0.28 * cos(a), 0, cz + 0.28 * sin(a)),
                    ],
                    0.0022,
                    chrome,
                    sides=-1,
                )
            )
        made.append(
            p.tube(
                "Mudguard",
                [
                    (cx + (r + 0.03) * cos(a), 0, cz + (r + 0.03) * sin(a))
                    for a in np.linspace(0.35, 2.7, 9)
                ],
                0.014,
                paint,
            )
        )
    basket = p.box(
        "Basket", (-0.11, -0.15, 0.0), (0.13, 0.15, 0.2), stuff["wicker"], 0.02, (0.55, 0.0, 0.76)
    )
    made.append(basket)
    flowers = p.leaves(
        "Basket flowers",
        p.bush(70, 0.15, 0.22, 0.09, 3, 0.9),
        stuff["bloom"],
        0.8,
        0.2,
        3,
        (0.56, 0.0, 0.92),
    )
    green = p.leaves(
        "Basket leaves",
        p.bush(50, 0.17, 0.18, 0.13, 5, 0.5),
        stuff["leaf"],
        0.5,
        0.3,
        3,
        (0.56, 0.0, 0.92),
    )
    for thing in (*made, flowers, green):
        thing.parent = stand


def circle_xz(radius: float, count: int = 24) -> list[tuple[float, float, float]]:
    return [
        (radius * cos(2 * pi * k / count), 0.0, radius * sin(2 * pi * k / count))
        for k in range(count)
    ]


def _bunting(y: float, z: float, cloths: list[bpy.types.Material]) -> None:
    count, sag = 13, 0.55
    line = [
        (-HALF + 2 * HALF * k / 24, y, z - sag * (1 - (2 * k / 24 - 1) ** 2)) for k in range(25)
    ]
    p.tube("Line", line, 0.006, bpy.data.materials["Iron"], sides=-1)
    for k in range(count):
        x = -HALF + 2 * HALF * (k + 0.5) / count
        top = z - sag * (1 - (x / HALF) ** 2) - 0.004
        w, h = 0.13, 0.3
        thing = m.add_mesh(
            "Flag",
            [(x - w, y, top), (x + w, y, top), (x, y + 0.05, top - h)],
            [(0, 2, 1)],
            cloths[k % len(cloths)],
        )
        thing.data.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 1, 0.5, 0, 1, 1])


def _wicker() -> bpy.types.Material:
    t = material("Wicker")
    height = t.image(bpy.data.images["Weave"], t.coordinates("Object", 11.0), projection="BOX")
    color = t.mix(height, (0.2, 0.12, 0.06), (0.58, 0.41, 0.23))
    return t.principled(Base_Color=color, Roughness=0.7, Normal=t.bump(height, 0.008))


def _stuff() -> dict[str, bpy.types.Material]:
    art.packed("Weave", art.weave(64, 8), data=True)
    weathered = _weathered()
    t = material("Limestone")
    where = t.add("NewGeometry", "Position")
    pale = t.ramp(t.noise(where, 5.0, 6.0), [(0.3, (0.52, 0.46, 0.37)), (0.7, (0.7, 0.65, 0.55))])
    stone = t.principled(
        Base_Color=pale, Roughness=0.8, Normal=t.bump(t.noise(where, 35.0, 5.0), 0.006, 0.6)
    )
    t = material("Clay")
    clay = t.principled(
        Base_Color=t.mix(
            t.noise(t.coordinates("Object"), 7.0, 5.0), (0.45, 0.19, 0.1), (0.68, 0.42, 0.3)
        ),
        Roughness=0.85,
    )
    t = material("Table marble")
    marble = t.principled(
        Base_Color=t.image(
            art.packed("Marble", art.marble(256, 5, (0.9, 0.89, 0.86), (0.5, 0.47, 0.45))),
            t.coordinates("Object", 1.5),
            projection="BOX",
        ),
        Roughness=0.15,
    )
    return {
        "facade": _facade(weathered), "stone": stone, "roof": _roof(), "pane": _pane(),
        "clay": clay, "marble": marble,
        "white": plain("White paint", (0.78, 0.76, 0.7), 0.4),
        "iron": plain("Iron", (0.03, 0.032, 0.034), 0.45, Metallic=0.4),
        "brass": plain("Brass", (0.83, 0.61, 0.27), 0.25, Metallic=1.0),
        "chrome": plain("Chrome", (0.78, 0.78, 0.8), 0.12, Metallic=1.0),
        "rubber": plain("Rubber", (0.02, 0.02, 0.021), 0.7),
        "leather": plain("Leather", (0.24, 0.11, 0.05), 0.45, Coat_Weight=0.3),
        "frosted": plain("Frosted glass", (0.85, 0.84, 0.78), 0.4),
        "soil": plain("Soil", (0.04, 0.025, 0.016), 0.95),
        "blue": _louvres("Blue shutters", (0.09, 0.22, 0.32)),
        "olive": _louvres("Olive shutters", (0.13, 0.2, 0.11)),
        "brown": _louvres("Brown shutters", (0.22, 0.1, 0.05)),
        "green": plain("Green slats", (0.05, 0.16, 0.09), 0.4, Coat_Weight=0.4),
        "door": _timber("Chestnut", (0.36, 0.2, 0.1), (0.2, 0.1, 0.05), 6),
        "blue door": _timber("Blue door", (0.13, 0.28, 0.36), (0.07, 0.17, 0.24), 6),
        "leaf": _leaf("Leaf", (0.2, 0.36, 0.1), (0.07, 0.2, 0.05)),
        "bloom": _leaf("Blossom", (0.9, 0.2, 0.3), (0.72, 0.05, 0.14)),
        "lacquer": _car_paint("Mint lacquer", (0.16, 0.42, 0.38)), "wicker": _wicker(),
    }  # fmt: skip


def make() -> None:
    scene = m.new_scene(720, 480, "AgX")
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.view_settings.exposure = -0.75
    s = _stuff()
    _ground(_setts(), _curb())
    ochre, rose, cream, brick, sand = (
        (0.83, 0.56, 0.24),
        (0.80, 0.46, 0.36),
        (0.87, 0.76, 0.55),
        (0.66, 0.29, 0.2),
        (0.83, 0.68, 0.47),
    )
    left = [
        (-6.0, 1.8, 8.6, rose, "olive"),
        (1.8, 8.0, 9.8, cream, "blue"),
        (8.0, 13.5, 8.2, ochre, "brown"),
        (13.5, 20.0, 10.0, brick, "olive"),
        (20.0, END, 9.0, sand, "blue"),
    ]
    right = [
        (-6.0, 3.0, 9.2, sand, "brown"),
        (3.0, 9.5, 8.4, ochre, "olive"),
        (9.5, 15.0, 9.8, rose, "blue"),
        (15.0, 22.0, 8.4, cream, "brown"),
        (22.0, END, 9.6, brick, "olive"),
    ]
    for side, row in ((-1, left), (1, right)):
        for number, (y0, y1, height, tint, shutters) in enumerate(row):
            house = House(s, side, y0, y1, height, tint)
            count = max(2, round((y1 - y0) / 2.6))
            for floor, z in enumerate((3.55, 6.2)):
                for k in range(count):
                    y = y0 + (y1 - y0) * (k + 0.5) / count
                    if y < 0.5:
                        continue
                    near = y < 12.0 and floor == 0
                    house.window(
                        y,
                        z,
                        shutters,
                        open_=True,
                        flowers=10 * number + 3 * k + 1 if near and (k + number) % 2 == 0 else 0,
                    )
            for k in range(count):
                y = y0 + (y1 - y0) * (k + 0.5) / count
                if y < 0.5:
                    continue
                if (k + number + (side > 0)) % 2 == 0:
                    house.door(y, "blue door" if (number + (side > 0)) % 2 else "door")
                else:
                    house.window(y, 0.95, shutters, 1.0, 1.5)
            if y0 > 0.0:
                house.lantern(y0 + 0.25, 2.75)
            if side < 0 and number == 1:
                house.awning(
                    2.2,
                    6.6,
                    3.1,
                    1.25,
                    _canvas("Red awning", (0.6, 0.07, 0.06), (0.86, 0.82, 0.72), 11.0),
                )
            if side > 0 and number == 2:
                house.awning(
                    10.2,
                    13.4,
                    3.0,
                    1.1,
                    _canvas("Green awning", (0.1, 0.3, 0.2), (0.86, 0.82, 0.72), 9.0),
                )
    # The lane ends at a house across it, with an arch painted as a dark door, and a tower behind.
    end = m.add_boxes("House at the end", [((-7.0, END, 0.0), (7.0, END + 4.0, 7.5))], s["facade"])
    end.color = (*cream, 1.0)
    tower = m.add_boxes("Tower", [((-2.6, END + 4.01, 0.0), (1.2, END + 8.0, 15.0))], s["facade"])
    tower.color = (*sand, 1.0)
    m.add_boxes("Tower top", [((-2.8, END + 3.8, 15.001), (1.4, END + 8.2, 15.4))], s["stone"])
    p.turned(
        "Tower roof",
        [(0.0, 0.0), (2.9, 0.0), (0.0, 3.6)],
        s["roof"],
        (-0.7, END + 6.0, 15.401),
        4,
        0,
    ).rotation_euler[2] = pi / 4
    p.box("Gate", (-1.1, END - 0.03, 0.0), (1.1, END - 0.001, 2.9), s["door"])
    for x in (-1.4, 1.1):
        p.box("Gate post", (x, END - 0.1, 0.0), (x + 0.3, END - 0.0005, 3.2), s["stone"])
    p.box("Gate lintel", (-1.1, END - 0.1, 2.9), (1.1, END - 0.0005, 3.2), s["stone"])
    for x in (-1.5, 1.5):
        p.box("Pane", (x - 0.4, END - 0.02, 4.4), (x + 0.4, END - 0.001, 5.9), s["pane"])
    for y, turn in ((3.2, 0.3), (5.2, -0.2)):
        _table(-1.85, y, s)
        _chair(-1.87, y - 0.62, pi + turn, s)
        _chair(-1.83, y + 0.62, turn * 0.5, s)
    _planter(-1.95, 1.75, s, 11, 1.05, True)
    _planter(-1.95, 7.1, s, 12, 1.0)
    _planter(1.98, 4.6, s, 13, 0.9, True)
    _planter(1.98, 7.0, s, 14, 1.15)
    _planter(1.98, 10.2, s, 15, 1.0, True)
    _bicycle(1.88, 2.75, radians(96.0), radians(-9.0), s)
    flags = [
        _canvas("Flag red", (0.66, 0.1, 0.08), (0.66, 0.1, 0.08), 1.0),
        _canvas("Flag yellow", (0.85, 0.6, 0.12), (0.85, 0.6, 0.12), 1.0),
        _canvas("Flag blue", (0.12, 0.32, 0.5), (0.12, 0.32, 0.5), 1.0),
        _canvas("Flag white", (0.84, 0.82, 0.76), (0.84, 0.82, 0.76), 1.0),
    ]
    for y, z in ((6.0, 5.6), (9.0, 5.9), (12.5, 5.5), (16.5, 5.8)):
        _bunting(y, z, flags)
    world = bpy.data.worlds.new("Summer sky")
    bpy.context.scene.world = world
    t = Tree(world)
    sky = art.packed_radiance("Summer sky", art.summer_sky(256, (-0.45, -0.5, 1.0), 15.0, 7))
    t.surface(t.add("Background", Color=t.add("TexEnvironment", 0, {"image": sky}), Strength=1.0))
    m.add_camera((0.25, -1.6, 1.62), (-0.08, 9.0, 2.25), lens=27.0)
    m.save("street")


if __name__ == "__main__":
    make()
