"""What the nodes of a lamp read from the instance that it is."""

from __future__ import annotations

import numpy as np

from tests.support import stage
from tests.support.corescene import Integrator, shoot


def test_lamps_of_instances_have_the_values_of_each_as_in_cycles() -> None:
    """Two empties stand for one lamp: red is their own colour, green a property of the lamp, blue
    a number of each instance.
    """
    import bpy
    from photon_splat.export import export_scene

    from tests.reference.cycles.references import render_with_cycles

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24, 12)
    stage.plane("Floor", 4.0)
    lamp = stage.lamp("POINT", 300.0, (0, 0, 0))
    lamp["tint"] = [0.2, 0.7, 0.4]
    lamp.data.use_nodes = True
    tree = lamp.data.node_tree
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    info, tint, parts, joined = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("ObjectInfo", "Attribute", "SeparateXYZ", "CombineXYZ")
    )
    tint.attribute_type, tint.attribute_name = "OBJECT", "tint"
    tree.links.new(info.outputs["Color"], parts.inputs[0])
    tree.links.new(parts.outputs["X"], joined.inputs["X"])
    tree.links.new(tint.outputs["Fac"], joined.inputs["Y"])
    tree.links.new(info.outputs["Random"], joined.inputs["Z"])
    tree.links.new(joined.outputs[0], emission.inputs["Color"])
    held = bpy.data.collections.new("Held")
    bpy.context.scene.collection.objects.unlink(lamp)
    held.objects.link(lamp)
    for side, red in ((-2.0, 0.25), (2.0, 1.0)):
        empty = stage.add("Empty", None, (side, 0, 1.5))
        empty.instance_type, empty.instance_collection = "COLLECTION", held
        empty.color = (red, 0.5, 0.5, 1.0)
    stage.camera((0, 0, 6))
    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    ours = shoot(what, Integrator.SPLAT, seed=1, passes=16, photons_per_pass=20_000).passes
    cycles = render_with_cycles(64, 21)[..., :3]
    means = [
        [part.mean(axis=(0, 1)) for part in np.split(picture[..., :3], 2, axis=1)]
        for picture in (ours["Combined"], cycles)
    ]
    np.testing.assert_allclose(means[0], means[1], rtol=0.02)
