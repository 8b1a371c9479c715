"""instances.blend: a thousand pebbles of ten thousand triangles each, 10.3 million in all, from two
meshes.

Half are scattered by geometry nodes (instance on points, turned and scaled per point), half are
collection instances.
"""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

from . import modelling as m

CELLS = 29  # per cube edge: 6 * 29^2 quads = 10,092 triangles
SIDE, SPACING = 32, 0.25


def pebble_data(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A bumpy stone about 0.2 m long that stands on z = 0: vertices (V, 3) and quads (F, 4)."""
    rng = np.random.default_rng(seed)
    edge = np.tan(np.linspace(-np.pi / 4, np.pi / 4, CELLS + 1))
    u, v = np.meshgrid(edge, edge, indexing="ij")
    one = np.ones_like(u)
    sides = np.stack(
        [
            np.stack(s, -1)
            for s in (
                (u, v, one),
                (v, u, -one),
                (one, u, v),
                (-one, v, u),
                (v, one, u),
                (u, -one, v),
            )
        ]
    )
    points, inverse = np.unique(np.round(sides.reshape(-1, 3), 9), axis=0, return_inverse=True)
    index = inverse.reshape(6, CELLS + 1, CELLS + 1)
    quads = np.stack(
        [index[:, :-1, :-1], index[:, 1:, :-1], index[:, 1:, 1:], index[:, :-1, 1:]], -1
    ).reshape(-1, 4)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    height = np.ones(len(points))
    for octave in range(4):
        waves = rng.normal(size=(5, 3)) * 1.6 * 1.9**octave
        height += (
            0.09 / 1.9**octave * np.sin(points @ waves.T + rng.uniform(0, 2 * np.pi, 5)).sum(1) / 2
        )
    stone = points * height[:, None] * (0.10, 0.075, 0.055)
    stone[:, 2] -= stone[:, 2].min()
    return np.round(stone, 5), quads


def _scatter(points: bpy.types.Object, pebble: bpy.types.Object) -> None:
    """Geometry nodes that put `pebble` on every vertex of `points`, turned and scaled by a value of
    its own.
    """
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    source, result = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    instance, what = (
        tree.nodes.new("GeometryNodeInstanceOnPoints"),
        tree.nodes.new("GeometryNodeObjectInfo"),
    )
    turn, size = (
        tree.nodes.new("FunctionNodeRandomValue"),
        tree.nodes.new("FunctionNodeRandomValue"),
    )
    what.inputs["Object"].default_value = pebble
    what.inputs["As Instance"].default_value = True
    turn.data_type, size.data_type = "FLOAT_VECTOR", "FLOAT"
    turn.inputs["Max"].default_value = (0.3, 0.3, 6.2832)
    for socket, value in zip(
        [s for s in size.inputs if s.type == "VALUE"], (0.7, 1.2), strict=False
    ):
        socket.default_value = value
    tree.links.new(source.outputs[0], instance.inputs["Points"])
    tree.links.new(what.outputs["Geometry"], instance.inputs["Instance"])
    tree.links.new(turn.outputs["Value"], instance.inputs["Rotation"])
    tree.links.new(next(s for s in size.outputs if s.type == "VALUE"), instance.inputs["Scale"])
    tree.links.new(instance.outputs["Instances"], result.inputs[0])
    modifier = points.modifiers.new("Scatter", "NODES")
    modifier.node_group = tree


def make() -> None:
    scene = m.new_scene(640, 360)
    rng = np.random.default_rng(7)
    m.set_world((0.55, 0.7, 1.0), 0.5)
    m.add_mesh(
        "Sand",
        [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)],
        [(0, 1, 2, 3)],
        m.diffuse("Sand", (0.52, 0.44, 0.33)),
    )
    grey = m.add_mesh(
        "Grey pebble", *pebble_data(1), m.diffuse("Grey stone", (0.34, 0.35, 0.37)), smooth=True
    )
    rust = m.add_mesh(
        "Rust pebble", *pebble_data(2), m.principled("Rust stone", (0.56, 0.31, 0.2)), smooth=True
    )

    place = np.stack(np.meshgrid(np.arange(SIDE), np.arange(SIDE), indexing="ij"), -1).reshape(
        -1, 2
    )
    spots = (place - (SIDE - 1) / 2 + rng.uniform(-0.12, 0.12, (SIDE * SIDE, 2))) * SPACING
    even = place.sum(1) % 2 == 0

    points = m.add_mesh(
        "Scattered pebbles",
        [(x, y, -0.005) for x, y in spots[even]],
        [],
        m.diffuse("None", (0.5, 0.5, 0.5)),
    )
    _scatter(points, grey)

    group = bpy.data.collections.new("Pebble")
    group.objects.link(rust)
    for x, y in spots[~even]:
        stand = m.add_object("Stone", None)
        stand.instance_type, stand.instance_collection = "COLLECTION", group
        stand.empty_display_size = 0.02
        stand.matrix_world = Matrix.LocRotScale(
            Vector((x, y, -0.005)),
            Euler((*rng.uniform(0.0, 0.25, 2), rng.uniform(0.0, 6.2832))),
            Vector(rng.uniform(0.7, 1.2, 3)),
        )
    for original in (grey, rust):
        scene.collection.objects.unlink(original)

    m.add_light(
        "Sun", "SUN", 4.0, (0.0, 0.0, 5.0), (1.6, 1.2, 4.0), angle=0.01, color=(1.0, 0.92, 0.8)
    )
    m.add_camera((0.0, -4.7, 1.35), (0.0, -1.0, 0.0), lens=35.0)
    m.save("instances")


if __name__ == "__main__":
    make()
