"""Materials of `staircase`."""

from __future__ import annotations

from math import pi

import bpy

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import rooms
from blend_scenes.scripts.trees import material, plain

Stuff = dict[str, bpy.types.Material]


def stuff() -> Stuff:
    wallpaper = material("Wallpaper")
    where = wallpaper.coordinates("Object")
    stripes = wallpaper.add(
        "TexWave", "Fac", {"bands_direction": "DIAGONAL"}, Vector=where, Scale=1.6
    )
    flowers = wallpaper.add("TexVoronoi", "Distance", Vector=where, Scale=11.0, Randomness=0.0)
    mask = wallpaper.math("LESS_THAN", flowers, wallpaper.map_range(stripes, 0.0, 1.0, 0.18, 0.32))
    color = wallpaper.mix(mask, (0.36, 0.44, 0.39), (0.42, 0.5, 0.44))
    wallpaper.principled(Base_Color=color, Roughness=0.75)
    carpet = material("Runner")
    u = carpet.add("SeparateXYZ", "X", Vector=carpet.coordinates("Generated"))
    edge = carpet.math("ABSOLUTE", carpet.math("SUBTRACT", u, 0.5))
    band = carpet.math(
        "MULTIPLY", carpet.math("GREATER_THAN", edge, 0.38), carpet.math("LESS_THAN", edge, 0.44)
    )
    spots = carpet.add(
        "TexVoronoi", "Distance", Vector=carpet.coordinates("Object"), Scale=16.0, Randomness=0.0
    )
    red = carpet.mix(carpet.math("LESS_THAN", spots, 0.22), (0.24, 0.025, 0.03), (0.36, 0.2, 0.09))
    pile = carpet.noise(carpet.coordinates("Object"), 260.0, 2.0)
    carpet.principled(
        Base_Color=carpet.mix(band, red, (0.4, 0.28, 0.12)),
        Roughness=0.95,
        Sheen_Weight=0.4,
        Normal=carpet.bump(pile, 0.004, 0.6),
    )
    return {
        "wallpaper": wallpaper.owner,
        "carpet": carpet.owner,
        "floor": rooms.stone_tiles(
            "Stone floor", (0.88, 0.86, 0.82), (0.36, 0.32, 0.28), (0.58, 0.54, 0.5), 0.6
        ),
        "tread": rooms.varnished(
            "Walnut treads", (0.62, 0.4, 0.24), (0.4, 0.23, 0.13), 5, 0.8, 0.2
        ),
        "rail": rooms.varnished(
            "Walnut rail", (0.52, 0.31, 0.18), (0.34, 0.18, 0.1), 2, 1.2, 0.16, (0.0, pi / 2, 0.0)
        ),
        "white": plain("Gloss paint", (0.78, 0.76, 0.71), 0.22),
        "ceiling": rooms.painted("Ceiling", (0.82, 0.81, 0.78)),
        "brass": plain("Brass", (0.85, 0.62, 0.28), 0.18, Metallic=1.0),
        "gilt": plain("Gilt", (0.8, 0.56, 0.24), 0.35, Metallic=1.0),
        "pot": plain("Glazed pot", (0.06, 0.14, 0.3), 0.12, Coat_Weight=1.0),
        "glow": m.emission("Lamp glass", (1.0, 0.72, 0.42), 14.0),
        "glass": rooms.thin_pane(),
        "clear": plain("Vase glass", (0.9, 1.0, 0.97), 0.0, Transmission_Weight=1.0),
        "book": _book(),
        "iron": plain("Iron", (0.03, 0.03, 0.032), 0.4, Metallic=0.6),
        "shade": plain("Porcelain", (0.85, 0.83, 0.78), 0.15, Coat_Weight=0.6),
    }


def _book() -> bpy.types.Material:
    t = material("Book cloth")
    return t.principled(Base_Color=t.add("ObjectInfo", "Color"), Roughness=0.6)
