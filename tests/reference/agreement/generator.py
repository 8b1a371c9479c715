"""Random scenes: sizes of floors, distances and sizes of lamps, rooms and fields, clutter. The same
seed makes the same scene.
"""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from photon_splat.core.scene import Light, LightKind, Material, Mesh, Scene

from tests.support.corescene import box, globe, lambert, lamp, mesh, perspective, scene

WIDTH, HEIGHT = 96, 72
Draw = np.random.Generator
Thing = tuple[Mesh, Material]


def log_uniform(draw: Draw, low: float, high: float) -> float:
    return float(np.exp(draw.uniform(np.log(low), np.log(high))))


def placed(thing: Mesh, matrix: np.ndarray) -> Mesh:
    points = thing.positions.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    normals = thing.corner_normals
    if normals is not None:
        turned = normals.astype(float) @ np.linalg.inv(matrix[:3, :3])
        normals = (turned / np.linalg.norm(turned, axis=-1, keepdims=True)).astype(np.float32)
    return Mesh(thing.name, points.astype(np.float32), thing.triangles, normals)


def turn(
    draw: Draw, place: np.ndarray, scale: np.ndarray | float = 1.0, *, tumbled: bool = False
) -> np.ndarray:
    """A matrix that turns about z, or any way, scales and moves."""
    matrix = np.eye(4)
    angle = draw.uniform(0.0, 2.0 * pi)
    matrix[:2, :2] = [[cos(angle), -sin(angle)], [sin(angle), cos(angle)]]
    if tumbled:
        matrix[:3, :3] = np.linalg.qr(draw.normal(size=(3, 3)))[0]
        matrix[:3, 0] *= np.sign(np.linalg.det(matrix[:3, :3]))
    matrix[:3, :3] *= scale
    matrix[:3, 3] = place
    return matrix


def level(x: float, y: float, z: float = 0.0, name: str = "floor") -> Mesh:
    """A rectangle of half sides x and y."""
    return mesh([(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)], [(0, 1, 2, 3)], name)


def leaf(draw: Draw, place: np.ndarray, size: float) -> Mesh:
    return placed(level(1.0, 0.4, name="leaf"), turn(draw, place, size, tumbled=True))


def thing(draw: Draw, place: np.ndarray, size: float) -> Mesh:
    """Of about `size`, standing at `place` or pushed a little into what is there."""
    sunk = np.array([0.0, 0.0, size * draw.uniform(-0.3, 0.5)])
    match draw.integers(6):
        case 0:
            return placed(
                box((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)),
                turn(draw, place, size * draw.uniform(0.4, 1.4, 3)),
            )
        case 1:
            return placed(globe(0.5, 3, smooth=True), turn(draw, place + sunk, size))
        case 2:
            return placed(globe(0.5, 2), turn(draw, place + sunk, size * draw.uniform(0.5, 1.2, 3)))
        case 3:  # a slab
            return placed(
                box((-0.5, -0.5, 0.0), (0.5, 0.5, 0.06)),
                turn(draw, place + sunk, size * draw.uniform(0.7, 2.0)),
            )
        case 4:  # a pole
            return placed(box((-0.04, -0.04, 0.0), (0.04, 0.04, 2.0)), turn(draw, place, size))
        case _:
            return leaf(draw, place + abs(sunk) + [0.0, 0.0, 0.3 * size], size * 0.6)


def clutter(draw: Draw, reach: float) -> list[Mesh]:
    """Things on the floor within `reach`; sometimes a pile of them that run into each other."""
    things = []
    for _ in range(draw.integers(2, 14)):
        place = np.array([*draw.uniform(-reach, reach, 2), 0.0])
        things.append(thing(draw, place, log_uniform(draw, 0.05, 0.5) * reach))
    if draw.random() < 0.3:
        size = 0.25 * reach
        centre = np.array([*draw.uniform(-0.5 * reach, 0.5 * reach, 2), 0.0])
        for _ in range(draw.integers(5, 25)):
            at = centre + np.array([*draw.normal(0.0, size, 2), abs(draw.normal(0.0, 0.6 * size))])
            things.append(
                placed(
                    globe(0.5, 2 + int(draw.integers(2)), smooth=bool(draw.integers(2))),
                    turn(draw, at, size),
                )
            )
    return things


def lamps(draw: Draw, reach: float, ceiling: float | None) -> list[Light]:
    """One to four, near or far, small or large; in a room below its ceiling."""
    found = []
    for _ in range(draw.integers(1, 5)):
        distance = log_uniform(draw, 0.6, 40.0) * reach
        angle, height = draw.uniform(0.0, 2.0 * pi), draw.uniform(0.3, 1.2)
        place = np.array([distance * cos(angle), distance * sin(angle), distance * height])
        if ceiling is not None:
            place = np.array(
                [*draw.uniform(-0.8 * reach, 0.8 * reach, 2), ceiling * draw.uniform(0.5, 0.98)]
            )
            distance = ceiling
        power = 40.0 * distance**2 * log_uniform(draw, 0.3, 3.0)
        radius = 0.0 if draw.random() < 0.3 else log_uniform(draw, 1e-4, 0.15) * distance
        aim = (*draw.uniform(-0.5 * reach, 0.5 * reach, 2), 0.0)
        match draw.integers(4) if ceiling is None else draw.integers(3):
            case 0:
                found.append(
                    lamp(
                        LightKind.POINT,
                        power,
                        tuple(place),
                        radius=radius,
                        soft_falloff=bool(draw.integers(2)),
                    )
                )
            case 1:
                found.append(
                    lamp(
                        LightKind.SPOT,
                        power,
                        tuple(place),
                        aim,
                        radius=radius,
                        spot_size=draw.uniform(0.5, 2.5),
                        spot_blend=draw.random(),
                    )
                )
            case 2:
                side = log_uniform(draw, 0.01, 0.5) * distance
                found.append(
                    lamp(
                        LightKind.AREA,
                        power,
                        tuple(place),
                        aim,
                        size=(side, side * draw.uniform(0.3, 1.0)),
                    )
                )
            case _:
                found.append(
                    lamp(
                        LightKind.SUN,
                        draw.uniform(1.0, 6.0),
                        tuple(place),
                        aim,
                        angle=draw.uniform(0.0, 0.1),
                    )
                )
    return found


def random_color(draw: Draw) -> Material:
    return lambert(tuple(draw.uniform(0.05, 0.9, 3).tolist()))


def room(draw: Draw, reach: float, ceiling: float) -> list[Thing]:
    """One wall of which may be missing; alone or on a ground."""
    whole = box((-reach, -reach, 0.0), (reach, reach, ceiling), inwards=True)
    missing = int(draw.integers(0, 7))
    triangles = (
        whole.triangles
        if missing > 5
        else np.delete(whole.triangles, (2 * missing, 2 * missing + 1), 0)
    )
    things = [(Mesh("room", whole.positions, triangles), random_color(draw))]
    if draw.random() < 0.5:
        half = log_uniform(draw, 2.0, 1000.0) * reach
        things.append((level(half, half, -0.01 * reach), random_color(draw)))
    return things


def field(draw: Draw, reach: float) -> list[Thing]:
    """A floor, small or endless, sometimes with a wall."""
    x, y = (log_uniform(draw, 1.2, 1000.0) * reach for _ in range(2))
    things = [(level(x, y), random_color(draw))]
    if draw.random() < 0.3:
        at = draw.uniform(0.5, 1.0) * reach
        corners = [(-x, at, 0.0), (x, at, 0.0), (x, at, reach), (-x, at, reach)]
        things.append((mesh(corners, [(0, 1, 2, 3)], "wall"), random_color(draw)))
    return things


def random_scene(seed: int) -> Scene:
    draw = np.random.default_rng(seed)
    reach = log_uniform(draw, 0.05, 50.0)
    ceiling = None
    if draw.random() < 0.45:
        ceiling = reach * draw.uniform(0.8, 2.0)
        things = room(draw, reach, ceiling)
    else:
        things = field(draw, reach)
    things += [(one, random_color(draw)) for one in clutter(draw, reach)]
    world = (
        0.0
        if ceiling is not None and draw.random() < 0.7
        else (draw.uniform(0.0, 0.6) if draw.random() < 0.6 else 0.0)
    )
    shining = lamps(draw, reach, ceiling)
    if draw.random() < 0.25:  # a mesh that shines
        size = log_uniform(draw, 0.02, 0.3) * reach
        place = np.array(
            [
                *draw.uniform(-0.7 * reach, 0.7 * reach, 2),
                draw.uniform(0.3, 0.75) * (ceiling or reach),
            ]
        )
        things.append(
            (
                placed(globe(0.5, 2), turn(draw, place, size)),
                lambert(0.5, 10.0 * (reach / size) ** 2),
            )
        )
    if ceiling is None:
        angle, far = draw.uniform(0.0, 2.0 * pi), draw.uniform(1.5, 3.5) * reach
        eye = (far * cos(angle), far * sin(angle), draw.uniform(0.4, 2.0) * reach)
    else:
        eye = (*draw.uniform(-0.9 * reach, 0.9 * reach, 2), ceiling * draw.uniform(0.3, 0.9))
    aim = (*draw.uniform(-0.4 * reach, 0.4 * reach, 2), 0.15 * reach)
    return scene(perspective(eye, aim, WIDTH, HEIGHT, 1.0), things, shining, world)
