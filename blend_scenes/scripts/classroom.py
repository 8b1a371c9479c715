"""A classroom in the morning: rows of desks and chairs, a blackboard, sun through three windows,
ceiling lamps.
"""

from __future__ import annotations

from math import pi

import bpy
import numpy as np
from mathutils import Matrix

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import classroom_things, rooms
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.things.classroom_things import DEEP, TALL, WIDE
from blend_scenes.scripts.trees import material, plain

Stuff = dict[str, bpy.types.Material]


def _board() -> bpy.types.Material:
    """Slate green, smeared by the sponge."""
    t = material("Blackboard")
    where = t.coordinates("Object")
    smear = t.noise(t.coordinates("Object", (0.8, 1.0, 2.6), (0.0, 0.5, 0.0)), 1.6, 7.0)
    fine = t.noise(t.coordinates("Object", (2.0, 1.0, 14.0), (0.0, 0.7, 0.0)), 3.0, 5.0)
    dust = t.math("MULTIPLY", t.map_range(smear, 0.35, 0.75), t.map_range(fine, 0.3, 0.7, 0.3, 1.0))
    color = t.mix(t.math("MULTIPLY", dust, 0.4), (0.018, 0.045, 0.032), (0.3, 0.33, 0.31))
    return t.principled(Base_Color=color, Roughness=t.map_range(dust, 0.0, 1.0, 0.4, 0.8),
                        Normal=t.bump(t.noise(where, 200.0, 2.0), 0.0005, 0.3))  # fmt: skip


def _stuff() -> Stuff:
    cloth = material("Tinted")
    cloth.principled(Base_Color=cloth.add("ObjectInfo", "Color"), Roughness=0.55)
    paper = material("Paper")
    where = paper.coordinates("Generated")
    line = paper.math(
        "GREATER_THAN",
        paper.add("TexWave", "Fac", {"bands_direction": "Y"}, Vector=where, Scale=5.0),
        0.96,
    )
    paper.principled(
        Base_Color=paper.mix(line, (0.85, 0.84, 0.8), (0.45, 0.55, 0.75)), Roughness=0.7
    )
    plastic = material("Chair plastic")
    tint = plastic.ramp(
        plastic.add("ObjectInfo", "Random"),
        [(0.0, (0.02, 0.1, 0.26)), (0.45, (0.35, 0.05, 0.03)), (0.75, (0.05, 0.2, 0.12))],
        "CONSTANT",
    )
    plastic.principled(Base_Color=tint, Roughness=0.32)
    return {
        "floor": rooms.varnished(
            "Oak floor", (0.78, 0.58, 0.38), (0.58, 0.38, 0.22), 7, 0.9, 0.24, (0.0, 0.0, pi / 2)
        ),
        "desk": rooms.varnished("Beech", (0.86, 0.68, 0.47), (0.74, 0.53, 0.34), 4, 1.1, 0.26),
        "dark": rooms.varnished(
            "Oak", (0.55, 0.37, 0.22), (0.38, 0.24, 0.14), 4, 0.9, 0.3, (0.0, pi / 2, 0.0)
        ),
        "wall": rooms.painted("Wall paint", (0.74, 0.71, 0.62)),
        "ceiling": rooms.painted("Ceiling", (0.84, 0.84, 0.82)),
        "dado": plain("Dado", (0.3, 0.42, 0.38), 0.35),
        "white": plain("White paint", (0.8, 0.79, 0.76), 0.3),
        "steel": plain("Steel tube", (0.55, 0.56, 0.58), 0.25, Metallic=1.0),
        "grey": plain("Grey lacquer", (0.2, 0.21, 0.22), 0.35),
        "rubber": plain("Rubber", (0.02, 0.02, 0.02), 0.7),
        "plastic": plastic.owner,
        "tinted": cloth.owner,
        "paper": paper.owner,
        "board": _board(),
        "chalk": plain("Chalk", (0.85, 0.85, 0.82), 0.9),
        "lamp": m.emission("Lamp", (1.0, 0.96, 0.88), 7.0),
        "pot": plain("Terracotta", (0.5, 0.22, 0.12), 0.7),
        "brass": plain("Brass", (0.85, 0.62, 0.28), 0.25, Metallic=1.0),
        "glass": rooms.thin_pane(),
    }


def _room(s: Stuff) -> None:
    openings = [(y, y + 1.7, 0.95, 2.85) for y in (0.9, 3.6, 6.3)]
    made = [rooms.wall(DEEP, TALL, openings, s["wall"])]
    for opening in openings:
        made += rooms.window(opening, s["white"], s["white"], 3, 2, s["glass"])
    rooms.turned(made, (0.0, DEEP, 0.0), -pi / 2)
    rooms.turned([rooms.wall(WIDE, TALL, [], s["wall"])], (WIDE, DEEP, 0.0), pi)
    rooms.turned([rooms.wall(DEEP, TALL, [], s["wall"])], (WIDE, 0.0, 0.0), pi / 2)
    rooms.turned([rooms.wall(WIDE, TALL, [], s["wall"])], (0.0, 0.0, 0.0), 0.0)
    m.add_boxes("Floor", [((-0.3, -0.3, -0.1), (WIDE + 0.3, DEEP + 0.3, 0.0))], s["floor"])
    m.add_boxes(
        "Ceiling", [((-0.3, -0.3, TALL), (WIDE + 0.3, DEEP + 0.3, TALL + 0.2))], s["ceiling"]
    )
    dado = [((0.0, 0.0, 0.1), (0.006, DEEP, 0.9)), ((WIDE - 0.006, 0.0, 0.1), (WIDE, DEEP, 0.9)),
            ((0.006, DEEP - 0.006, 0.1), (WIDE - 0.006, DEEP, 0.9))]  # fmt: skip
    m.add_boxes("Dado", dado, s["dado"])
    skirting = [((0.0, 0.0, 0.0), (0.02, DEEP, 0.1)), ((WIDE - 0.02, 0.0, 0.0), (WIDE, DEEP, 0.1)),
                ((0.02, DEEP - 0.02, 0.0), (WIDE - 0.02, DEEP, 0.1))]  # fmt: skip
    p.boxes("Skirting", skirting, s["white"], 0.006)
    for y in (1.75, 4.45, 7.15):
        fins = [
            ((0.05, y - 0.75 + 0.075 * k, 0.16), (0.13, y - 0.75 + 0.075 * k + 0.05, 0.76))
            for k in range(20)
        ]
        p.boxes("Radiator", fins, s["white"], 0.015)
        for z in (0.2, 0.72):
            p.tube(
                "Radiator pipe",
                [(0.09, y - 0.8, z), (0.09, y + 0.8, z)],
                0.018,
                s["white"],
                sides=-3,
            )


def _desk(s: Stuff) -> list[bpy.types.Object]:
    """For two; the pupils sit at -Y."""
    legs = []
    for x in (-0.56, 0.56):
        line = [(x, -0.22, 0.015), (x, -0.22, 0.7), (x, 0.22, 0.7), (x, 0.22, 0.015)]
        legs.append(p.tube("Desk frame", line, 0.015, s["steel"], sides=-3))
    legs.append(
        p.tube("Desk bar", [(-0.56, 0.2, 0.62), (0.56, 0.2, 0.62)], 0.012, s["steel"], sides=-3)
    )
    return [
        *legs,
        p.box("Desk top", (-0.65, -0.26, 0.715), (0.65, 0.26, 0.74), s["desk"], 0.008),
        p.box("Shelf", (-0.55, -0.18, 0.56), (0.55, 0.18, 0.575), s["grey"], 0.004),
    ]


def _chair(s: Stuff) -> list[bpy.types.Object]:
    """Seat and back of bent sheet on steel tubes; it looks to +Y."""
    made = []
    for x in (-0.18, 0.18):
        line = [(x, 0.16, 0.01), (x, 0.13, 0.43), (x, -0.15, 0.43), (x, -0.2, 0.82)]
        made.append(p.tube("Chair frame", line, 0.011, s["steel"], sides=-3))
        made.append(
            p.tube("Chair leg", [(x, -0.14, 0.43), (x, -0.22, 0.01)], 0.011, s["steel"], sides=-3)
        )
    for name, width, rows in (
        ("Seat", 0.2, [(0.2, 0.445), (0.17, 0.458), (0.0, 0.448), (-0.14, 0.45), (-0.18, 0.462)]),
        (
            "Back",
            0.2,
            [(-0.158, 0.62), (-0.17, 0.64), (-0.2, 0.78), (-0.208, 0.84), (-0.206, 0.855)],
        ),
    ):
        bend = 0.012 if name == "Seat" else -0.02
        cols = np.linspace(-1.0, 1.0, 5)
        points = [
            (
                width * c,
                y + (bend * (1 - c * c) if name == "Back" else 0.0),
                z - (bend * (1 - c * c) if name == "Seat" else 0.0),
            )
            for y, z in rows
            for c in cols
        ]
        faces = [
            (5 * r + c, 5 * r + c + 1, 5 * r + c + 6, 5 * r + c + 5)
            for r in range(4)
            for c in range(4)
        ]
        sheet = m.add_mesh(name, points, faces, s["plastic"], smooth=True)
        thick = sheet.modifiers.new("Thick", "SOLIDIFY")
        thick.thickness = 0.008
        smooth = sheet.modifiers.new("Smooth", "SUBSURF")
        smooth.levels = smooth.render_levels = 2
        made.append(sheet)
    return made


def _copies(things: list[bpy.types.Object], place: Matrix) -> None:
    for thing in things:
        other = thing.copy()
        bpy.context.scene.collection.objects.link(other)
        other.matrix_world = place @ thing.matrix_world


def _rows(s: Stuff) -> None:
    bpy.context.view_layer.update()
    desk, chair = _desk(s), _chair(s)
    bpy.context.view_layer.update()
    rng = np.random.default_rng(7)
    for row in range(4):
        for column in range(3):
            x, y = 1.75 + 2.0 * column, 1.9 + 1.38 * row
            turn = Matrix.Rotation(rng.normal(0.0, 0.025), 4, "Z")
            at = Matrix.Translation((x + rng.normal(0, 0.03), y + rng.normal(0, 0.03), 0.0)) @ turn
            _copies(desk, at)
            for side in (-0.31, 0.31):
                out = rng.uniform(0.02, 0.3)
                swing = Matrix.Rotation(rng.normal(0.0, 0.16), 4, "Z")
                _copies(chair, at @ Matrix.Translation((side, -0.38 - out, 0.0)) @ swing)
                if rng.random() < 0.75:
                    _school_things(s, at @ Matrix.Translation((side, -0.03, 0.74)), rng)
    for thing in (*desk, *chair):
        bpy.data.objects.remove(thing)


def _school_things(s: Stuff, at: Matrix, rng: np.random.Generator) -> None:
    colors = (
        (0.05, 0.16, 0.4),
        (0.5, 0.06, 0.05),
        (0.08, 0.3, 0.14),
        (0.6, 0.4, 0.05),
        (0.25, 0.1, 0.35),
    )
    z = 0.0
    for _ in range(int(rng.integers(1, 4))):
        thick = float(rng.uniform(0.006, 0.025))
        kind = "paper" if rng.random() < 0.35 else "tinted"
        book = p.box("Exercise book", (-0.08, -0.11, 0.0), (0.08, 0.11, thick), s[kind], 0.002)
        book.color = (*colors[int(rng.integers(len(colors)))], 1.0)
        shift = Matrix.Translation(
            (float(rng.normal(0, 0.015)), float(rng.normal(0, 0.015)), z + 0.0003)
        )
        book.matrix_world = at @ shift @ Matrix.Rotation(float(rng.normal(0, 0.2)), 4, "Z")
        z += thick + 0.0004
    pencil = m.add_lathe(
        "Pencil",
        [(0.0, 0.0), (0.0037, 0.012), (0.0037, 0.16), (0.0, 0.16)],
        s["tinted"],
        (0, 0, 0),
        6,
    )
    pencil.color = (0.7, 0.45, 0.03, 1.0)
    turn = Matrix.Rotation(float(rng.uniform(0, 6)), 4, "Z") @ Matrix.Rotation(pi / 2, 4, "X")
    pencil.matrix_world = at @ Matrix.Translation((0.16, 0.06, 0.0041)) @ turn
    if rng.random() < 0.4:
        beaker = m.add_lathe(
            "Beaker",
            [(0.0, 0.0), (0.035, 0.0), (0.038, 0.09), (0.034, 0.09), (0.032, 0.006), (0.0, 0.006)],
            s["plastic"],
            (0, 0, 0),
            24,
        )
        beaker.matrix_world = at @ Matrix.Translation((-0.2, 0.17, 0.0003))


def make() -> None:
    scene = m.new_scene(960, 540, "AgX")
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.view_settings.exposure = 1.1
    s = _stuff()
    _room(s)
    _rows(s)
    classroom_things.front(s)
    classroom_things.sides(s)
    rooms.outside(1.6, 11.0, (-3.0, 1.3, 2.1), (1.0, 0.9, 0.75))
    m.add_camera((6.9, 0.25, 1.75), (2.7, 7.2, 1.0), lens=22.0)
    m.save("classroom")


if __name__ == "__main__":
    make()
