"""Generated coordinates: of where a mesh's vertices were before anything moved them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from photon_splat.core.scene import Mesh
from photon_splat.core.scene.shading import GENERATED

from tests.support import stage
from tests.support.blender import in_blender


def _sheet() -> Any:
    """Of 2 m, that shows its Generated coordinates."""
    import bpy

    stage.camera()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=30, y_subdivisions=30, size=2.0)
    ob = bpy.context.object
    material = bpy.data.materials.new("Places")
    material.use_nodes = True
    tree = material.node_tree
    where = tree.nodes.new("ShaderNodeTexCoord")
    shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(where.outputs["Generated"], shader.inputs["Color"])
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    ob.data.materials.append(material)
    return ob


def _key(ob: Any) -> None:
    ob.shape_key_add(name="Basis")
    raised = ob.shape_key_add(name="Raised")
    for point in raised.data:
        point.co.z += 1.0
    raised.value = 1.0


def _cast(ob: Any) -> None:
    ob.modifiers.new("Cast", "CAST").factor = 0.5


def _bone(ob: Any) -> None:
    import bpy

    bpy.ops.object.armature_add()
    armature = bpy.context.object
    group = ob.vertex_groups.new(name=armature.pose.bones[0].name)
    group.add(range(len(ob.data.vertices)), 1.0, "REPLACE")
    ob.parent, ob.parent_type = armature, "ARMATURE"
    armature.pose.bones[0].location = (0.0, 0.0, 1.0)


def _lattice(ob: Any) -> None:
    import bpy

    lattice = bpy.data.objects.new("Lattice", bpy.data.lattices.new("Lattice"))
    bpy.context.collection.objects.link(lattice)
    for point in lattice.data.points:
        point.co_deform.z += 1.0
    ob.parent, ob.parent_type = lattice, "LATTICE"


WAYS: dict[str, Callable[[Any], None]] = {
    "nothing": lambda ob: None,
    "shape key": _key,
    "modifier": _cast,
    "bone": _bone,
    "lattice": _lattice,
}


@pytest.mark.parametrize("way", WAYS)
@in_blender
def test_generated_is_of_the_mesh_before(way: str) -> None:
    ob = _sheet()
    before = np.array([vertex.co for vertex in ob.data.vertices], np.float32)
    WAYS[way](ob)
    mesh: Mesh = stage.exported().meshes[0]
    moved = not np.allclose(mesh.positions, before, atol=1e-5)
    assert moved == (way != "nothing")
    found = [one for one in mesh.shading.attributes if one.id == GENERATED]
    assert bool(found) == moved
    space = mesh.shading.generated
    assert space is not None
    given = found[0].values if found else mesh.positions * space.scale + space.offset
    wanted = before * 0.5 + 0.5
    assert np.allclose(given[:, :2], wanted[:, :2], atol=1e-5)
