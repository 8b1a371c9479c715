"""A car on a turntable in a hall: metallic paint under a coat, glass, chrome, rubber, polished
concrete; lit by an HDRI made here, of a sun, windows and soft boxes.
"""

from __future__ import annotations

from math import asin, atan2, cos, hypot, pi, sin

import bpy
import numpy as np

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import artwork as art
from blend_scenes.scripts.things import car_body, car_parts
from blend_scenes.scripts.trees import Tree, material, plain


def _paint() -> bpy.types.Material:
    """Flakes that lean by chance in a red lacquer, darker at a grazing view, under a coat."""
    t = material("Metallic paint")
    flakes = t.add("TexVoronoi", "Color", Vector=t.coordinates("Object"), Scale=700.0)
    lean = t.add("VectorMath", 0, {"operation": "MULTIPLY_ADD"}, i0=flakes, i1=(0.16, 0.16, 0.16),
                 i2=(-0.08, -0.08, -0.08))  # fmt: skip
    sum_ = t.add("VectorMath", 0, {"operation": "ADD"}, i0=t.add("NewGeometry", "Normal"), i1=lean)
    facing = t.add("LayerWeight", "Facing", Blend=0.35)
    return t.principled(
        Base_Color=t.ramp(facing, [(0.0, (0.52, 0.022, 0.02)), (0.8, (0.13, 0.006, 0.012))]),
        Metallic=0.65, Roughness=0.34, Coat_Weight=1.0, Coat_Roughness=0.015,
        Normal=t.add("VectorMath", 0, {"operation": "NORMALIZE"}, i0=sum_),
    )  # fmt: skip


def _concrete() -> bpy.types.Material:
    """Ground and polished, in slabs, worn unevenly."""
    t = material("Polished concrete")
    where = t.coordinates("Object")
    stain = t.image(art.packed("Concrete", art.plaster(256, 71)[0]), t.coordinates("Object", 0.22))
    cloudy = t.noise(where, 0.9, 6.0)
    color = t.mix(
        1.0,
        t.ramp(cloudy, [(0.3, (0.2, 0.195, 0.19)), (0.7, (0.34, 0.33, 0.32))]),
        stain,
        "MULTIPLY",
    )
    joint = t.add("TexBrick", "Fac", {"offset": 0.0}, Vector=where, Scale=1.0, Mortar_Size=0.008,
                  Brick_Width=4.0, Row_Height=4.0)  # fmt: skip
    color = t.mix(t.math("MULTIPLY", joint, 0.75), color, (0.03, 0.03, 0.03))
    return t.principled(
        Base_Color=color,
        Roughness=t.map_range(t.noise(where, 3.5, 7.0), 0.3, 0.7, 0.16, 0.38),
        Normal=t.bump(t.noise(where, 60.0, 3.0), 0.002, 0.15),
    )


def _brushed() -> bpy.types.Material:
    t = material("Brushed steel")
    lines = t.noise(t.coordinates("Object", (400.0, 400.0, 2.0)), 1.0, 2.0)
    return t.principled(Base_Color=(0.6, 0.6, 0.61), Metallic=1.0,
                        Roughness=t.map_range(lines, 0.3, 0.7, 0.2, 0.34))  # fmt: skip


def _stuff() -> dict[str, bpy.types.Material]:
    t = material("Tyre rubber")
    rubber = t.principled(
        Base_Color=(0.018, 0.018, 0.019), Roughness=0.62,
        Normal=t.bump(t.noise(t.coordinates("Object"), 90.0, 2.0), 0.001, 0.3),
    )  # fmt: skip
    t = material("Leather")
    grain = t.add("TexVoronoi", "Distance", Vector=t.coordinates("Object"), Scale=160.0)
    leather = t.principled(
        Base_Color=(0.42, 0.22, 0.1), Roughness=0.45, Normal=t.bump(grain, 0.002, 0.4)
    )
    return {
        "paint": _paint(), "rubber": rubber, "leather": leather,
        "pane": plain("Tinted glass", (0.72, 0.8, 0.78), 0.0, Transmission_Weight=1.0, IOR=1.5),
        "clear": plain("Lens", (1.0, 1.0, 1.0), 0.0, Transmission_Weight=1.0, IOR=1.49),
        "black": plain("Black plastic", (0.012, 0.012, 0.013), 0.35),
        "seal": plain("Seal", (0.012, 0.012, 0.012), 0.55),
        "dark": plain("Dark plastic", (0.008, 0.008, 0.009), 0.3),
        "trim": plain("Trim", (0.03, 0.03, 0.032), 0.5),
        "chrome": plain("Chrome", (0.86, 0.87, 0.89), 0.04, Metallic=1.0),
        "rim": plain("Alloy", (0.62, 0.63, 0.65), 0.22, Metallic=1.0, Coat_Weight=0.6),
        "steel": _brushed(), "red": plain("Caliper red", (0.6, 0.02, 0.015), 0.3),
        "plate": plain("Plate", (0.78, 0.78, 0.74), 0.4),
        "bulb": m.emission("Bulb", (1.0, 0.95, 0.88), 60.0),
    }  # fmt: skip


def _turntable(s: dict[str, bpy.types.Material]) -> None:
    top = material("Turntable top")
    where = top.coordinates("Object")
    stone = top.ramp(
        top.noise(where, 2.0, 6.0), [(0.3, (0.03, 0.031, 0.033)), (0.7, (0.06, 0.06, 0.062))]
    )
    slate = top.principled(
        Base_Color=stone, Roughness=top.map_range(top.noise(where, 8.0, 5.0), 0.3, 0.7, 0.1, 0.26)
    )
    m.add_lathe("Floor", [(14.0, -0.12), (0.0, -0.12)], _concrete(), (0.0, 0.0, 0.0), 96)
    m.add_turned("Turntable", [(2.85, -0.08), (2.85, -0.012), (2.84, 0.0), (0.0, 0.0)], slate,
                 (0.0, 0.0, 0.0), 160)  # fmt: skip
    rim = [
        (2.853, -0.055),
        (2.9, -0.055),
        (2.905, -0.05),
        (2.905, -0.002),
        (2.9, 0.003),
        (2.853, 0.003),
    ]
    m.add_turned("Turntable rim", rim, s["steel"], (0.0, 0.0, 0.0), 160)
    glow = m.emission("Light strip", (1.0, 0.82, 0.6), 5.0)
    m.add_turned("Light strip", [(2.87, -0.1), (2.87, -0.07)], glow, (0.0, 0.0, 0.0), 160)
    m.add_turned("Foot", [(2.86, -0.12), (2.86, -0.055)], s["black"], (0.0, 0.0, 0.0), 160)


def _panes(
    towards: tuple[float, float, float],
    half: tuple[float, float],
    radiance: tuple[float, float, float],
) -> list[tuple[tuple[float, float, float], float, float, tuple[float, float, float]]]:
    """A window of 3 by 4 panes, for art.studio."""
    turn, rise = atan2(towards[1], towards[0]), asin(towards[2] / hypot(*towards))
    made = []
    for column in (-1, 0, 1):
        for row in (-1.5, -0.5, 0.5, 1.5):
            a, b = turn + column * half[0] * 2 / 3, rise + row * half[1] / 2
            bright = tuple(c * (0.75 + 0.2 * (row + 1.5) / 3) for c in radiance)
            at = (cos(a) * cos(b), sin(a) * cos(b), sin(b))
            made.append((at, half[0] * 0.31 * cos(b), half[1] * 0.235, bright))
    return made


def _hall() -> None:
    """Brick walls, windows along two sides with the sun in one, and soft boxes above."""
    lights = []
    for y in (-1.5, -0.95, -0.5, -0.05, 0.4, 0.85, 1.4):
        lights += _panes((-1.0, y, 0.3), (0.15, 0.2), (4.2, 4.6, 5.2))
    for x in (0.9, 0.45, 0.0, -0.45):
        lights += _panes((x, 1.0, 0.27), (0.13, 0.18), (3.0, 3.3, 3.8))
    lights += [
        ((0.2, -0.55, 1.0), 0.5, 0.16, (9.0, 8.8, 8.4)),
        ((-0.3, 0.5, 1.3), 0.6, 0.12, (6.0, 6.0, 6.2)),
        ((1.0, -0.8, 0.45), 0.1, 0.3, (5.0, 4.7, 4.3)),
        ((-0.55, -0.9, 0.85), 0.03, 0.03, (1250.0, 1100.0, 880.0)),
    ]
    high = 384
    pixels = art.studio(high, lights)
    dim = pixels.max(-1) < 0.5
    row, column = np.mgrid[:high, : 2 * high]
    joint = ((row % 6 == 0) | ((column + 7 * (row // 6 % 2)) % 14 == 0)) & (row > high * 0.5)
    worn = 0.55 + 0.9 * np.tile(art.cloud(high, 1.1, 8), (1, 2))
    bricks = np.array((1.15, 0.86, 0.7)) * (worn * np.where(joint, 0.7, 1.0))[..., None]
    pixels = np.where(dim[..., None], pixels * bricks * 0.9, pixels)
    world = bpy.data.worlds.new("Hall")
    bpy.context.scene.world = world
    t = Tree(world)
    picture = art.packed_radiance("Hall", pixels)
    t.surface(
        t.add("Background", Color=t.add("TexEnvironment", 0, {"image": picture}), Strength=0.8)
    )


def make() -> None:
    scene = m.new_scene(960, 540, "AgX")
    scene.view_settings.look = "AgX - Medium High Contrast"
    s = _stuff()
    drape = car_body.make(s["paint"], s["pane"], s["black"], s["seal"])
    car_parts.wheels(s)
    car_parts.lamps(drape, s)
    car_parts.trim(drape, s)
    car_parts.cabin(s)
    car = bpy.data.objects.new("Car", None)
    scene.collection.objects.link(car)
    for thing in list(scene.objects):
        if thing is not car:
            thing.parent = car
    car.rotation_euler[2] = pi * 0.02
    _turntable(s)
    _hall()
    m.add_camera((4.7, -4.3, 1.35), (0.12, -0.05, 0.5), lens=42.0)
    m.save("car")


if __name__ == "__main__":
    make()
