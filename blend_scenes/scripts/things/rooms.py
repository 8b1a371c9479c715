"""What `staircase` and `classroom` share: walls with windows, varnish, stone, books, pictures, the
sky outside. The inside of a wall faces +Y before it is turned.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import bpy
import numpy as np
from mathutils import Matrix

from blend_scenes.scripts import modelling as m
from blend_scenes.scripts.things import artwork as art
from blend_scenes.scripts.things import parts as p
from blend_scenes.scripts.things.scatter import sheet
from blend_scenes.scripts.trees import Tree, material

Color = tuple[float, float, float]
Opening = tuple[float, float, float, float]  # low and high along the wall, low and high z
WALL = 0.3  # m thick


def varnished(
    name: str, light: Color, dark: Color, boards: int, scale: float, roughness: float = 0.28,
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0), where: str = "Object", coat: float = 0.5,
) -> bpy.types.Material:  # fmt: skip
    """Boards under varnish, worn unevenly; the grain runs along X before `turn`."""
    t = material(name)
    color, height = art.planks(256, boards, 3 * len(name), light, dark)
    place = t.coordinates(where, scale, turn)
    wood = t.image(art.packed(name, color), place, projection="BOX", projection_blend=0.05)
    rise = t.image(art.packed(f"{name} height", height, data=True), place, projection="BOX")
    worn = t.noise(t.coordinates("Object"), 2.2, 6.0)
    return t.principled(
        Base_Color=wood, Roughness=t.map_range(worn, 0.3, 0.7, roughness - 0.06, roughness + 0.1),
        Coat_Weight=coat, Coat_Roughness=0.08, Normal=t.bump(rise, 0.002, 0.5),
    )  # fmt: skip


def stone_tiles(name: str, one: Color, two: Color, vein: Color, size: float) -> bpy.types.Material:
    """Polished slabs of two veined stones in a chequer."""
    t = material(name)
    where = t.coordinates("Object")
    checker = t.add("TexChecker", "Fac", Vector=where, Scale=1.0 / size)
    stones = []
    for k, ground in enumerate((one, two)):
        picture = art.packed(f"{name} {k}", art.marble(256, 21 + k, ground, vein))
        stones.append(t.image(picture, t.coordinates("Object", 0.8 / size, (0.0, 0.0, 0.9 * k))))
    joint = t.add("TexBrick", "Fac", {"offset": 0.0}, Vector=where, Scale=1.0, Mortar_Size=0.003,
                  Brick_Width=size, Row_Height=size)  # fmt: skip
    color = t.mix(joint, t.mix(checker, *stones), (0.1, 0.095, 0.09))
    rough = t.map_range(t.noise(where, 4.0, 6.0), 0.3, 0.7, 0.05, 0.16)
    return t.principled(
        Base_Color=color, Roughness=t.math("ADD", rough, t.math("MULTIPLY", joint, 0.4)),
        Normal=t.bump(t.math("SUBTRACT", 1.0, joint), 0.002, 0.6),
    )  # fmt: skip


def painted(name: str, color: Color, roughness: float = 0.6) -> bpy.types.Material:
    """Paint on plaster, with the marks of the roller."""
    t = material(name)
    where = t.coordinates("Object")
    tone = t.mix(
        t.map_range(t.noise(where, 0.8, 5.0), 0.3, 0.7, 0.0, 0.25),
        color,
        tuple(0.82 * c for c in color),
    )
    return t.principled(
        Base_Color=tone, Roughness=roughness, Normal=t.bump(t.noise(where, 110.0, 2.0), 0.001, 0.25)
    )


def turned(things: Sequence[bpy.types.Object], at: Sequence[float], turn: float) -> None:
    """Moves what was made at the origin."""
    bpy.context.view_layer.update()
    place = Matrix.Translation(at) @ Matrix.Rotation(turn, 4, "Z")
    for thing in things:
        thing.matrix_world = place @ thing.matrix_world


def wall(
    long: float, tall: float, openings: Sequence[Opening], stuff: bpy.types.Material
) -> bpy.types.Object:
    """From x = 0 to `long`, its inside at y = 0; openings sorted along it."""
    parts = []
    at = 0.0
    for x0, x1, z0, z1 in openings:
        parts.append(((at, -WALL, 0.0), (x0, 0.0, tall)))
        if z0 > 0.0:
            parts.append(((x0, -WALL, 0.0), (x1, 0.0, z0)))
        parts.append(((x0, -WALL, z1), (x1, 0.0, tall)))
        at = x1
    parts.append(((at, -WALL, 0.0), (long, 0.0, tall)))
    return m.add_boxes("Wall", parts, stuff)


def window(
    opening: Opening, frame: bpy.types.Material, sill: bpy.types.Material, columns: int, rows: int,
    pane: bpy.types.Material | None = None,
) -> list[bpy.types.Object]:  # fmt: skip
    """Frame, bars, sill, and a pane if it is given, in an opening of a wall."""
    x0, x1, z0, z1 = opening
    f, y0, y1 = 0.06, -0.2, -0.13
    bars = [
        ((x0, y0, z0), (x0 + f, y1, z1)),
        ((x1 - f, y0, z0), (x1, y1, z1)),
        ((x0 + f, y0, z0), (x1 - f, y1, z0 + f)),
        ((x0 + f, y0, z1 - f), (x1 - f, y1, z1)),
    ]
    for k in range(1, columns):
        x = x0 + (x1 - x0) * k / columns
        bars.append(((x - 0.025, y0 + 0.01, z0 + f), (x + 0.025, y1 - 0.01, z1 - f)))
    for k in range(1, rows):
        z = z0 + (z1 - z0) * k / rows
        bars.append(((x0 + f, y0 + 0.02, z - 0.018), (x1 - f, y1 - 0.02, z + 0.018)))
    things = [p.boxes("Window frame", bars, frame, 0.006)]
    if z0 > 0.1:
        low, high = (x0 - 0.05, y1 - 0.02, z0 - 0.04), (x1 + 0.05, 0.1, z0 + 0.01)
        things.append(p.box("Sill", low, high, sill, 0.008))
    if pane is not None:
        y = (y0 + y1) / 2
        things.append(sheet("Pane", [[(x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1)]], pane))
    return things


def thin_pane() -> bpy.types.Material:
    """Glass as interiors are modelled with: it mirrors, and lets all else straight through."""
    t = material("Window glass")
    mirror = t.add(
        "BsdfGlossy" if hasattr(bpy.types, "ShaderNodeBsdfGlossy") else "BsdfAnisotropic",
        Color=(1.0, 1.0, 1.0),
        Roughness=0.0,
    )
    clear = t.add("BsdfTransparent", Color=(0.96, 0.98, 0.97))
    return t.surface(t.add("MixShader", i0=t.add("Fresnel", IOR=1.5), i1=clear, i2=mirror))


def books(
    at: Sequence[float], long: float, seed: int, stuff: bpy.types.Material, tall: float = 0.26
) -> list[bpy.types.Object]:
    """A row along X, their backs towards -Y; tinted by the objects' colour."""
    rng = np.random.default_rng(seed)
    colors = [
        (0.3, 0.05, 0.04),
        (0.04, 0.1, 0.2),
        (0.06, 0.16, 0.08),
        (0.5, 0.4, 0.25),
        (0.12, 0.06, 0.04),
        (0.55, 0.5, 0.42),
        (0.35, 0.2, 0.05),
    ]
    things, x = [], 0.0
    while x < long:
        thick, high = rng.uniform(0.018, 0.05), tall * rng.uniform(0.72, 1.0)
        book = p.box("Book", (0.0, -rng.uniform(0.13, 0.17), 0.0), (thick, 0.0, high), stuff, 0.003)
        book.location = (at[0] + x, at[1], at[2])
        book.color = (*colors[int(rng.integers(len(colors)))], 1.0)
        things.append(book)
        x += thick + 0.001
    return things


def picture(
    name: str, pixels: np.ndarray, width: float, tall: float, frame: bpy.types.Material
) -> list[bpy.types.Object]:
    """Framed, its back at y = 0, facing +Y, its middle at the origin."""
    t = material(name)
    face = t.principled(
        Base_Color=t.image(art.packed(name, np.clip(pixels, 0, 1)), t.coordinates("UV")),
        Roughness=0.35,
    )
    w, h, f = width / 2, tall / 2, 0.045
    sheet_ = m.add_picture(
        name, [(w, 0.015, -h), (-w, 0.015, -h), (-w, 0.015, h), (w, 0.015, h)], face
    )
    bars = [((-w - f, 0.0, -h - f), (-w, 0.035, h + f)), ((w, 0.0, -h - f), (w + f, 0.035, h + f)),
            ((-w, 0.0, h), (w, 0.035, h + f)), ((-w, 0.0, -h - f), (w, 0.035, -h))]  # fmt: skip
    return [sheet_, p.boxes("Picture frame", bars, frame, 0.008)]


def landscape(size: int, seed: int, low: Color, high: Color) -> np.ndarray:
    """A painting: ridges before a sky."""
    v, _ = (np.mgrid[:size, :size] + 0.5) / size
    color = art.blend(v, low, high) + 0.12 * (art.cloud(size, 1.5, seed)[..., None] - 0.5)
    for k in range(4):
        ridge = 0.62 - 0.15 * k + 0.16 * (art.cloud(size, 1.9, seed + k)[3] - 0.5)
        tone = np.array(low) * (0.75 - 0.17 * k) + 0.05 * (
            art.cloud(size, 0.8, seed + 9 + k)[..., None] - 0.5
        )
        color = np.where((v < ridge[None, :])[..., None], tone, color)
    return color


def outside(strength: float, sun: float, towards: tuple[float, float, float], tint: Color) -> None:
    """A sky with clouds, a sun lamp, and a lawn."""
    world = bpy.data.worlds.new("Sky")
    bpy.context.scene.world = world
    t = Tree(world)
    sky = art.packed_radiance("Sky", art.summer_sky(96, (0.0, 0.0, 1.0), 0.0, 5))
    t.surface(
        t.add("Background", Color=t.add("TexEnvironment", 0, {"image": sky}), Strength=strength)
    )
    m.add_light("Sun", "SUN", sun, towards, (0.0, 0.0, 0.0), angle=0.0093, color=tint)
    t = material("Lawn")
    grass = t.ramp(
        t.noise(t.coordinates("Object"), 0.8, 6.0),
        [(0.3, (0.05, 0.09, 0.02)), (0.7, (0.13, 0.16, 0.05))],
    )
    lawn = t.principled(Base_Color=grass, Roughness=0.9)
    m.add_boxes("Lawn", [((-40.0, -40.0, -0.6), (40.0, 40.0, -0.5))], lawn)


def pot_plant(
    at: Sequence[float], s: dict[str, bpy.types.Material], tall: float, seed: int
) -> None:
    t = material("Plant leaf")
    color = t.image(
        art.packed("Plant leaf", art.leaf(64, (0.14, 0.3, 0.1), (0.05, 0.16, 0.05))),
        t.coordinates("UV"),
    )
    leaf = t.principled(Base_Color=color, Roughness=0.3, Coat_Weight=0.2)
    pot = [(0.12, 0.0), (0.15, 0.02), (0.19, 0.3), (0.2, 0.32)]
    p.turned("Pot", p.vessel(pot, 0.015, 0.25), s["pot"], at, 40)
    places = p.bush(90, 0.42 * tall, 0.8 * tall, 0.34 * tall, seed, 0.9)
    thing = p.leaves("Plant", places, leaf, 0.32, 0.35, 5, (at[0], at[1], at[2] + 0.27))
    thing.rotation_euler[2] = pi * 0.1 * seed
    for k in range(6):
        a = 1.05 * k
        stem = [
            (0.03 * np.cos(a), 0.03 * np.sin(a), 0.25),
            (0.16 * tall * np.cos(a), 0.16 * tall * np.sin(a), 0.27 + 0.6 * tall),
        ]
        p.tube("Stem", stem, 0.01, leaf, at, sides=-3)
