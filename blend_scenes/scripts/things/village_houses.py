"""Houses of `village`: walls and gables, roofs, windows, doors, chimneys, half-timbering."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import bpy
import numpy as np
from mathutils import Matrix, Vector

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.things.scatter import sheet

Stuff = dict[str, bpy.types.Material]


@dataclass
class House:
    """The front at -Y, `width` along X; the ridge along X."""

    at: tuple[float, float, float]
    turn: float
    width: float = 8.0
    depth: float = 6.5
    tall: float = 5.2
    rise: float = 3.4
    wall: str = "plaster"
    roof: str = "tiles"
    shutters: str = "green"
    timber: bool = False
    tint: tuple[float, float, float] = (0.85, 0.78, 0.65)
    floors: int = 2

    def build(self, s: Stuff, seed: int) -> None:
        before = set(bpy.context.scene.objects)
        rng = np.random.default_rng(seed)
        self._walls(s)
        self._roof(s)
        count = max(2, round(self.width / 2.3))
        door = int(rng.integers(0, count))
        for floor in range(self.floors):
            for k in range(count):
                x = self.width * ((k + 0.5) / count - 0.5)
                if floor == 0 and k == door:
                    self._door(s, x)
                else:
                    self._window(s, x, 0.95 + 2.55 * floor, floor == 0 and rng.random() < 0.6)
        for side in (-1, 1):
            for floor in range(self.floors):
                for y in (-self.depth * 0.22, self.depth * 0.22):
                    self._window(s, y, 0.95 + 2.55 * floor, False, side)
            self._window(s, 0.0, self.tall + 0.5, False, side, 0.7, 1.0)
        if self.timber:
            self._timbers(s)
        self._chimney(s, self.width * rng.uniform(0.18, 0.32), seed)
        place = Matrix.Translation(self.at) @ Matrix.Rotation(self.turn, 4, "Z")
        bpy.context.view_layer.update()
        for thing in set(bpy.context.scene.objects) - before:
            thing.matrix_world = place @ thing.matrix_world

    def _walls(self, s: Stuff) -> None:
        w, d, t, low = self.width / 2, self.depth / 2, self.tall, -1.5
        peak = t + self.rise
        polygons = [
            [(-w, -d, low), (w, -d, low), (w, -d, t), (-w, -d, t)],
            [(w, d, low), (-w, d, low), (-w, d, t), (w, d, t)],
            [(w, -d, low), (w, d, low), (w, d, t), (w, 0.0, peak), (w, -d, t)],
            [(-w, d, low), (-w, -d, low), (-w, -d, t), (-w, 0.0, peak), (-w, d, t)],
        ]
        thing = sheet("Walls", polygons, s[self.wall])
        thing.color = (*self.tint, 1.0)
        e = 0.05
        p.boxes("Plinth", [((-w - e, -d - e, -1.5), (w + e, d + e, 0.45))], s["rubble"], 0.03)

    def _roof(self, s: Stuff) -> None:
        w, d = self.width / 2 + 0.3, self.depth / 2
        slope = np.hypot(d, self.rise)
        down = Vector((0.0, -d, -self.rise)) / slope
        thick = 0.09
        for side in (-1, 1):
            across = Vector((down.x, -side * down.y, down.z)) if side > 0 else down
            out = Vector((0.0, side * self.rise, d)).normalized()
            ridge = Vector((0.0, 0.0, self.tall + self.rise)) + out * 0.02
            eave = ridge + across * (slope + 0.5)
            ends = (-w, w) if side < 0 else (w, -w)
            a, b = (eave + Vector((x, 0.0, 0.0)) for x in ends)
            c, e = (ridge + Vector((x, 0.0, 0.0)) for x in reversed(ends))
            low = [a, b, c, e]
            high = [v + out * thick for v in low]
            polygons = [high, list(reversed(low))]
            polygons += [[low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]] for k in range(4)]
            sheet("Roof", polygons, [s[self.roof], s["wood"]], [0, 1, 1, 1, 1, 1])
            gutter = eave + out * 0.02 + across * 0.05
            p.tube(
                "Gutter",
                [gutter + Vector((x, 0.0, 0.0)) for x in (-w, w)],
                0.06,
                s["zinc"],
                sides=-3,
            )
            pipe = [(w - 0.45, gutter.y, gutter.z), (w - 0.45, side * (d + 0.06), gutter.z - 0.5),
                    (w - 0.45, side * (d + 0.06), 0.05)]  # fmt: skip
            p.tube("Pipe", pipe, 0.04, s["zinc"], sides=-3)
        top = self.tall + self.rise + 0.1
        p.tube("Ridge", [(-w, 0.0, top), (w, 0.0, top)], 0.11, s["ridge"], sides=-4)

    def _onto(self, things: list[bpy.types.Object], side: int, along: float, z: float) -> None:
        """Things made before a wall that faces -Y: to the front (0) or to a gable."""
        if side == 0:
            place = Matrix.Translation((along, -self.depth / 2, z))
        else:
            turn = Matrix.Rotation(side * np.pi / 2, 4, "Z")
            place = Matrix.Translation((side * self.width / 2, along, z)) @ turn
        bpy.context.view_layer.update()
        for thing in things:
            thing.matrix_world = place @ thing.matrix_world

    def _window(
        self, s: Stuff, along: float, z: float, flowers: bool, side: int = 0, width: float = 0.95,
        tall: float = 1.3,
    ) -> None:  # fmt: skip
        h, f = width / 2, 0.07
        frame = [
            ((-h - f, -0.05, -f), (-h, 0.0, tall + f)),
            ((h, -0.05, -f), (h + f, 0.0, tall + f)),
            ((-h, -0.05, tall), (h, 0.0, tall + f)),
            ((-0.03, -0.035, 0.0), (0.03, 0.0, tall)),
            ((-h, -0.03, tall * 0.6), (-0.03, 0.0, tall * 0.6 + 0.04)),
            ((0.03, -0.03, tall * 0.6), (h, 0.0, tall * 0.6 + 0.04)),
        ]
        pane = [[(-h, -0.012, 0.0), (h, -0.012, 0.0), (h, -0.012, tall), (-h, -0.012, tall)]]
        things = [
            p.boxes("Frame", frame, s["white"], 0.006),
            sheet("Pane", pane, s["pane"]),
            p.box("Sill", (-h - 0.12, -0.16, -0.12), (h + 0.12, 0.0, -0.05), s["stone"], 0.012),
        ]
        if side == 0:
            for k in (-1, 1):
                shutter = p.box("Shutter", (-h / 2, -0.03, -0.03), (h / 2, 0.0, tall + 0.03),
                                s[self.shutters], 0.006)  # fmt: skip
                shutter.location = (k * (h * 1.5 + 0.14), -0.035, 0.0)
                shutter.rotation_euler[2] = -k * 0.12
                things.append(shutter)
        if flowers:
            things.append(
                p.box("Box", (-h, -0.36, -0.04), (h, -0.16, 0.13), s["terracotta"], 0.015)
            )
            for name, seed in (("leaf", 3), ("bloom", 8)):
                bush = p.leaves(
                    "Flowers",
                    p.bush(70, 0.5, 0.26, 0.075, seed + int(9 * along + 90), 0.5),
                    s[name],
                    0.6,
                )
                bush.scale, bush.location = (0.9, 0.32, 1.0), (0.0, -0.27, 0.1)
                things.append(bush)
        self._onto(things, side, along, z)

    def _door(self, s: Stuff, along: float) -> None:
        jamb = [((-0.66, -0.1, 0.0), (-0.5, 0.0, 2.2)), ((0.5, -0.1, 0.0), (0.66, 0.0, 2.2)),
                ((-0.66, -0.1, 2.2), (0.66, 0.0, 2.38))]  # fmt: skip
        panels = [((x, -0.055, z), (x + 0.34, 0.0, z + tall)) for x in (-0.4, 0.06)
                  for z, tall in ((0.15, 0.55), (0.85, 1.15))]  # fmt: skip
        roof = [[(-0.95, -0.8, 2.45), (0.95, -0.8, 2.45), (0.95, 0.0, 2.85), (-0.95, 0.0, 2.85)]]
        canopy = sheet("Canopy", roof, s[self.roof])
        canopy.modifiers.new("Thick", "SOLIDIFY").thickness = 0.07
        self._onto([
            p.boxes("Door frame", jamb, s["stone"], 0.012),
            p.box("Door", (-0.5, -0.04, 0.02), (0.5, 0.0, 2.2), s["door"], 0.005),
            p.boxes("Panels", panels, s["door"], 0.012),
            p.boxes("Steps", [((-0.8, -0.75, -1.0), (0.8, -0.05, 0.02)),
                              ((-1.0, -1.1, -1.0), (1.0, -0.75, -0.14))], s["stone"], 0.02),
            m.add_sphere("Knob", 0.035, s["brass"], (0.4, -0.07, 1.05), 16),
            canopy,
        ], 0, along, 0.12)  # fmt: skip

    def _timbers(self, s: Stuff) -> None:
        w, d, t = self.width / 2, self.depth / 2, self.tall
        low, high, b = 2.75, t, 0.08
        parts = [((-w, -d - 0.04, z - b), (w, -d + 0.02, z + b)) for z in (low, high - b)]
        count = max(2, round(self.width / 2.3))
        parts += [((x - b, -d - 0.04, low + b), (x + b, -d + 0.02, high - 2 * b))
                  for x in np.linspace(-w + b, w - b, count + 1)]  # fmt: skip
        p.boxes("Timbers", parts, s["timber"], 0.012)
        for side in (-1, 1):
            x = side * w
            parts = [((x - 0.02, -d, z - b), (x + 0.04, d, z + b)) if side > 0 else
                     ((x - 0.04, -d, z - b), (x + 0.02, d, z + b)) for z in (low, t)]  # fmt: skip
            parts += [
                ((x - 0.04, y - b, low + b), (x + 0.04, y + b, t - b)) for y in (-d + b, 0.0, d - b)
            ]
            p.boxes("Timbers", parts, s["timber"], 0.012)

    def _chimney(self, s: Stuff, x: float, seed: int) -> None:
        top, y = self.tall + self.rise + 0.7, 0.5 + 0.3 * cos(seed)
        low = self.tall + self.rise * (1 - y / (self.depth / 2)) - 0.6
        h = 0.32
        sides = [(-h, -h), (h, -h), (h, h), (-h, h)]
        walls = [
            [(x + a, y + b, low), (x + c, y + d, low), (x + c, y + d, top), (x + a, y + b, top)]
            for (a, b), (c, d) in zip(sides, [*sides[1:], sides[0]], strict=True)
        ]
        sheet("Chimney", walls, s["brick"])
        p.box(
            "Cap",
            (x - h - 0.06, y - h - 0.06, top),
            (x + h + 0.06, y + h + 0.06, top + 0.1),
            s["stone"],
            0.02,
        )
        for k in (-1, 1):
            pot = [
                (0.1, 0.0),
                (0.085, 0.25 + 0.03 * sin(seed)),
                (0.1, 0.3),
                (0.08, 0.3),
                (0.0, 0.2),
            ]
            m.add_lathe("Pot", pot, s["terracotta"], (x + 0.14 * k, y, top + 0.1), 20)
