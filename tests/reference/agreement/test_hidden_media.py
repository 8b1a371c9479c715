"""Media in objects that hide from some rays: none to these, as in Cycles."""

from __future__ import annotations

import pytest

from tests.reference.agreement.beside import means_beside_cycles
from tests.support import stage
from tests.support.corescene import Integrator


@pytest.mark.parametrize("integrator", list(Integrator))
@pytest.mark.parametrize(
    ("hides_from", "light"),
    [("", "SUN"), ("shadow", "SUN"), ("diffuse", "SUN"), ("diffuse", "WORLD"), ("camera", "WORLD")],
)
def test_fog_that_hides_is_as_bright_as_in_cycles(
    hides_from: str, light: str, integrator: Integrator
) -> None:
    """A floor in a box of fog. Once rays that did not see the box never left the fog: of a sun's
    light .06 to .18 was there.
    """
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(16, 16)
    stage.plane("Floor", 6.0)
    bpy.ops.mesh.primitive_cube_add(size=4.0, location=(0.0, 0.0, 1.9))
    fog, tree = stage.empty_material("Fog")
    scatter = tree.nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Density"].default_value = 0.15
    stage.output(tree, scatter, "Volume")
    box = bpy.context.object
    box.data.materials.append(fog)
    if hides_from:
        setattr(box, f"visible_{hides_from}", False)
    stage.world(0.5 if light == "WORLD" else 0.0)
    if light == "SUN":
        stage.lamp("SUN", 3.0).rotation_euler = (0.3, 0.2, 0.0)
    stage.camera((0.0, 0.0, 3.0)).data.angle = 0.6
    passes = 64 if integrator == Integrator.REFERENCE else 24
    ours, cycles = means_beside_cycles(256, integrator, passes=passes)
    assert ours == pytest.approx(cycles, rel=0.01)
