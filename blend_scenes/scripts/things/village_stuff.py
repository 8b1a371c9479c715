"""Materials of `village`."""

from __future__ import annotations

from typing import Any

import bpy

from blend_scenes.scripts.things import artwork as art
from blend_scenes.scripts.trees import Tree, material, plain

Color = tuple[float, float, float]


def _plaster() -> bpy.types.Material:
    """The object's own colour, stained towards the ground."""
    t = material("Plaster")
    color, height = art.plaster(256, 41)
    place = t.add("NewGeometry", "Position")
    where = t.coordinates("UV", 0.3)
    wall = t.mix(
        1.0, t.add("ObjectInfo", "Color"), t.image(art.packed("Plaster", color), where), "MULTIPLY"
    )
    level = t.math("ADD", t.add("SeparateXYZ", "Y", Vector=t.coordinates("UV")),
                   t.math("MULTIPLY", t.noise(place, 0.9, 5.0), -1.8))  # fmt: skip
    wall = t.mix(t.map_range(level, 0.8, 1.8, 0.55, 0.0), wall, (0.2, 0.17, 0.13))
    rise = t.image(art.packed("Plaster height", height, data=True), where)
    return t.principled(Base_Color=wall, Roughness=0.9, Normal=t.bump(rise, 0.02, 0.5))


def _brick() -> bpy.types.Material:
    t = material("Brick")
    where = t.coordinates("UV")
    brick = t.add("TexBrick", "Color", Vector=where, Scale=1.0, Mortar_Size=0.008, Bias=-0.2,
                  Color1=(0.32, 0.1, 0.055), Color2=(0.2, 0.07, 0.045), Mortar=(0.36, 0.33, 0.28),
                  Brick_Width=0.23, Row_Height=0.075, Mortar_Smooth=0.1)  # fmt: skip
    spots = t.ramp(t.noise(where, 2.0, 8.0), [(0.3, (0.6, 0.58, 0.56)), (0.7, (1.2, 1.15, 1.1))])
    relief = t.math(
        "SUBTRACT", t.math("MULTIPLY", t.noise(where, 60.0, 3.0), 0.3), brick.node.outputs["Fac"]
    )
    return t.principled(Base_Color=t.mix(1.0, brick, spots, "MULTIPLY"), Roughness=0.85,
                        Normal=t.bump(relief, 0.01, 0.7))  # fmt: skip


def _rubble(name: str = "Rubble", scale: float = 3.2) -> bpy.types.Material:
    """Field stones in mortar."""
    t = material(name)
    where = t.add("Mapping", Vector=t.add("NewGeometry", "Position"), Scale=(1.0, 1.0, 1.7))
    stone = t.add("TexVoronoi", "Color", Vector=where, Scale=scale)
    edge = t.add("TexVoronoi", 0, {"feature": "DISTANCE_TO_EDGE"}, Vector=where, Scale=scale)
    tone = t.ramp(
        t.add("SeparateColor", "Red", Color=stone),
        [(0.0, (0.2, 0.18, 0.15)), (0.5, (0.33, 0.29, 0.23)), (1.0, (0.42, 0.39, 0.34))],
    )
    rough = t.noise(where, 14.0, 5.0)
    tone = t.mix(
        0.5, tone, t.ramp(rough, [(0.3, (0.4, 0.4, 0.4)), (0.7, (0.9, 0.9, 0.86))]), "MULTIPLY"
    )
    joint = t.map_range(edge, 0.0, 0.08)
    color = t.mix(joint, (0.27, 0.25, 0.21), tone)
    height = t.math("ADD", t.math("MULTIPLY", joint, 1.0), t.math("MULTIPLY", rough, 0.35))
    return t.principled(Base_Color=color, Roughness=0.88, Normal=t.bump(height, 0.03, 0.8))


def _tiles(name: str, one: Color, two: Color) -> bpy.types.Material:
    """Courses of plain tiles, each a little different, with moss."""
    t = material(name)
    where = t.coordinates("UV")
    tile = t.add("TexBrick", "Color", Vector=where, Scale=1.0, Mortar_Size=0.006, Mortar_Smooth=0.3,
                 Brick_Width=0.24, Row_Height=0.2, Color1=one, Color2=two,
                 Mortar=tuple(0.25 * c for c in two))  # fmt: skip
    course = t.math("FRACT", t.math("DIVIDE", t.add("SeparateXYZ", "Y", Vector=where), 0.2))
    moss = t.map_range(t.noise(where, 0.8, 8.0), 0.5, 0.75, 0.0, 0.8)
    color = t.mix(
        moss,
        t.mix(0.7, tile, t.ramp(t.noise(where, 5.0, 5.0), [(0.3, 0.5), (0.7, 1.15)]), "MULTIPLY"),
        (0.12, 0.12, 0.06),
    )
    height = t.math("SUBTRACT", t.math("SUBTRACT", 1.0, course), tile.node.outputs["Fac"])
    return t.principled(Base_Color=color, Roughness=0.75, Normal=t.bump(height, 0.035, 1.0))


def _wood(name: str, one: Color, two: Color, boards: int) -> bpy.types.Material:
    t = material(name)
    color, height = art.planks(128, boards, len(name), one, two)
    where = t.coordinates("Object", 0.8, (0.0, 1.5708, 0.0))
    wood = t.image(art.packed(name, color), where, projection="BOX", projection_blend=0.1)
    rise = t.image(art.packed(f"{name} height", height, data=True), where, projection="BOX")
    return t.principled(Base_Color=wood, Roughness=0.6, Normal=t.bump(rise, 0.006, 0.7))


def _leaf(name: str, light: Color, dark: Color) -> bpy.types.Material:
    """Lets light through; every twig has a tint of its own."""
    t = material(name)
    color = t.image(art.packed(name, art.leaf(64, light, dark)), t.coordinates("UV"))
    own = t.ramp(t.add("ObjectInfo", "Random"), [(0.0, (0.7, 0.8, 0.6)), (1.0, (1.15, 1.05, 0.8))])
    color = t.mix(1.0, color, own, "MULTIPLY")
    through = t.add("BsdfTranslucent", Color=t.mix(1.0, color, (1.0, 1.0, 0.4), "MULTIPLY"))
    solid = t.add("BsdfPrincipled", Base_Color=color, Roughness=0.45)
    return t.surface(t.add("MixShader", i0=0.35, i1=solid, i2=through))


def ground(lane: Any) -> bpy.types.Material:
    """Grass, and a lane where the attribute `lane` of the mesh is 1."""
    t = material("Ground")
    place = t.add("NewGeometry", "Position")
    wide, fine = t.noise(place, 0.35, 6.0), t.noise(place, 18.0, 4.0)
    grass = t.ramp(
        wide, [(0.3, (0.045, 0.075, 0.018)), (0.5, (0.075, 0.11, 0.026)), (0.7, (0.14, 0.14, 0.05))]
    )
    grass = t.mix(0.6, grass, t.ramp(fine, [(0.3, 0.35), (0.7, 1.3)]), "MULTIPLY")
    sett, height = art.pavers(256, 12, 9)
    where = t.add("Mapping", Vector=place, Scale=(0.55, 0.55, 0.55))
    stone = t.mix(
        0.75,
        t.image(art.packed("Cobbles", sett), where),
        t.ramp(t.noise(place, 0.7, 5.0), [(0.3, (0.42, 0.38, 0.33)), (0.7, (0.85, 0.8, 0.74))]),
        "MULTIPLY",
    )
    edge = t.math(
        "ADD",
        t.add("Attribute", "Fac", {"attribute_name": lane}),
        t.math("MULTIPLY", t.math("SUBTRACT", t.noise(place, 2.5, 6.0), 0.5), 0.7),
    )
    mask = t.map_range(edge, 0.42, 0.58)
    rise = t.mix(mask, fine, t.image(art.packed("Cobble height", height, data=True), where))
    return t.principled(
        Base_Color=t.mix(mask, grass, stone), Roughness=t.map_range(mask, 0.0, 1.0, 0.95, 0.6),
        Normal=t.bump(rise, 0.05, 0.7),
    )  # fmt: skip


def _pane() -> bpy.types.Material:
    """Glass before a dark room, half hidden by curtains."""
    t = material("Window pane")
    where = t.coordinates("Generated")
    away = t.math("ABSOLUTE", t.math("SUBTRACT", t.add("SeparateXYZ", "X", Vector=where), 0.5))
    folds = t.add(
        "TexWave", "Fac", {"bands_direction": "X"}, Vector=where, Scale=5.0, Distortion=0.8
    )
    drawn = t.math(
        "GREATER_THAN", away, t.map_range(t.add("ObjectInfo", "Random"), 0.0, 1.0, 0.2, 0.45)
    )
    room = t.mix(drawn, (0.01, 0.011, 0.013), t.mix(folds, (0.2, 0.19, 0.17), (0.5, 0.48, 0.44)))
    wavy = t.bump(t.noise(t.coordinates("Object"), 2.0, 1.0), 0.02, 0.2)
    return t.principled(Base_Color=room, Roughness=0.03, Normal=wavy)


def stuff() -> dict[str, bpy.types.Material]:
    return {
        "plaster": _plaster(), "brick": _brick(), "rubble": _rubble(),
        "tiles": _tiles("Red tiles", (0.36, 0.12, 0.06), (0.26, 0.085, 0.05)),
        "slate": _tiles("Slate", (0.1, 0.105, 0.12), (0.065, 0.07, 0.08)),
        "wood": _wood("Weathered wood", (0.32, 0.26, 0.2), (0.18, 0.14, 0.11), 4),
        "timber": _wood("Dark timber", (0.14, 0.085, 0.05), (0.07, 0.045, 0.03), 3),
        "door": _wood("Door wood", (0.2, 0.09, 0.04), (0.11, 0.05, 0.025), 6),
        "green": _wood("Green shutters", (0.08, 0.2, 0.12), (0.04, 0.12, 0.07), 8),
        "blue": _wood("Blue shutters", (0.12, 0.24, 0.36), (0.07, 0.15, 0.24), 8),
        "red": _wood("Red shutters", (0.36, 0.08, 0.06), (0.22, 0.05, 0.04), 8),
        "pane": _pane(), "white": plain("White paint", (0.76, 0.74, 0.69), 0.4),
        "stone": plain("Sandstone", (0.46, 0.4, 0.31), 0.8),
        "terracotta": plain("Terracotta", (0.45, 0.18, 0.09), 0.75),
        "zinc": plain("Zinc", (0.42, 0.43, 0.45), 0.45, Metallic=1.0),
        "brass": plain("Brass", (0.83, 0.61, 0.27), 0.25, Metallic=1.0),
        "iron": plain("Iron", (0.03, 0.03, 0.032), 0.5, Metallic=0.5),
        "ridge": plain("Ridge tiles", (0.28, 0.1, 0.06), 0.75),
        "bark": _rubble("Bark", 9.0),
        "leaf": _leaf("Leaf", (0.16, 0.27, 0.06), (0.07, 0.16, 0.03)),
        "lime": _leaf("Lime leaf", (0.24, 0.34, 0.07), (0.12, 0.22, 0.04)),
        "blade": _leaf("Grass blade", (0.18, 0.26, 0.06), (0.1, 0.17, 0.035)),
        "bloom": _leaf("Bloom", (0.85, 0.12, 0.2), (0.6, 0.04, 0.1)),
    }  # fmt: skip


def sky() -> None:
    """Blender's own sky of a clear afternoon, with the disc of its sun."""
    world = bpy.data.worlds.new("Sky")
    bpy.context.scene.world = world
    t = Tree(world)
    air = t.add("TexSky", 0)
    node = air.node
    kinds = [item.identifier for item in node.bl_rna.properties["sky_type"].enum_items]
    node.sky_type = "NISHITA" if "NISHITA" in kinds else "SINGLE_SCATTERING"
    node.sun_disc, node.sun_elevation, node.sun_rotation = True, 0.72, 3.9
    node.sun_size = 0.0095
    t.surface(t.add("Background", Color=air, Strength=0.1))
