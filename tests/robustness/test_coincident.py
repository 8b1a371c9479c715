"""Surfaces that coincide: the object that comes last is seen, as in Cycles, by every integrator."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import ALL_RAYS, LightKind, Ray

from tests.support import corescene as c
from tests.support import stage

RED, GREEN = (0.8, 0.05, 0.05), (0.05, 0.8, 0.05)


@pytest.mark.parametrize("integrator", c.BOTH)
@pytest.mark.parametrize(
    "thing", [c.box((-0.5,) * 3, (0.5,) * 3), c.globe(0.6, 3)], ids=["box", "globe"]
)
def test_the_last_of_two_twins_is_seen(thing: c.Mesh, integrator: Integrator) -> None:
    view = c.perspective((2.0, -2.0, 2.0), (0.0, 0.0, 0.0), 24, 24, 0.4)
    lamp = c.lamp(LightKind.POINT, 300.0, (1.0, -1.0, 3.0))
    for first, last in ((RED, GREEN), (GREEN, RED)):
        twins = c.scene(view, [(thing, c.lambert(first)), (thing, c.lambert(last))], [lamp])
        seen = c.picture(twins, integrator, passes=2)[8:16, 8:16].mean((0, 1))
        assert np.argmax(seen) == np.argmax(last)
        assert seen.max() > 10.0 * seen.min()


def test_a_mesh_with_double_faces_is_as_bright_as_without() -> None:
    """A plate whose two triangles stand in its mesh twice, over a floor."""
    view = c.perspective((0.0, -3.0, 2.0), (0.0, 0.0, 0.2), 48, 36)
    plate = [(-0.4, 0.3, 0.6), (0.4, 0.3, 0.6), (0.4, 0.5, 0.1), (-0.4, 0.5, 0.104)]
    faces = [(0, 1, 2), (0, 2, 3)]
    sun = c.lamp(LightKind.SUN, 3.0, (0.0, 0.0, 5.0), (1.0, 1.0, 0.0), angle=0.05)

    def pictures(faces: list) -> list[np.ndarray]:
        things = [(c.mesh(plate, faces), c.lambert(0.8)), (c.quad(2.0), c.lambert(0.8))]
        what = c.scene(view, things, [sun], 0.6)
        return [c.picture(what, way, passes=16, photons_per_pass=50_000) for way in c.BOTH]

    once, twice = pictures(faces), pictures([*faces, *faces])
    for splat, reference in (once, twice):
        assert splat.mean() == pytest.approx(reference.mean(), rel=0.005)
        assert splat.max() < 1.2 * reference.max()
    assert twice[1].mean() == pytest.approx(once[1].mean(), rel=0.005)


@pytest.mark.parametrize(
    "unseen_by", [Ray.DIFFUSE, Ray.DIFFUSE | Ray.SHADOW], ids=["diffuse", "both"]
)
def test_light_stays_in_a_room_where_it_passes_what_stands_on_the_floor(unseen_by: Ray) -> None:
    """Photons pass a box that the rays which see along their way do not; its lowest face lies in
    the floor, which such rays meet.
    """
    view = c.perspective((0.0, -0.9, 1.0), (0.0, 0.5, 0.5), 32, 32, 1.6)
    room = c.box((-1.0, -1.0, 0.0), (1.0, 1.0, 2.0), inwards=True)
    lamp = c.lamp(LightKind.POINT, 30.0, (0.3, 0.2, 1.6), radius=0.1)

    box = c.box((-0.6, -0.6, 0.0), (0.6, 0.6, 0.8))
    what = c.scene(view, [(room, c.lambert(0.8)), (box, c.lambert(0.5))], [lamp])
    seen = ALL_RAYS & ~Ray.CAMERA & ~unseen_by
    what.instances.seen_by = np.array([ALL_RAYS, seen], np.uint32)
    ours = [c.picture(what, passes=32, photons_per_pass=50_000, seed=seed) for seed in (1, 2)]
    reference = c.picture(what, Integrator.REFERENCE, passes=1024)
    assert np.mean(ours) == pytest.approx(reference.mean(), rel=0.01)


def test_a_warning_names_what_lies_in_each_other() -> None:
    """In view, beside it, and in one mesh; not what is near, or meets at an edge."""
    view = c.perspective((0.0, -3.0, 2.0), (0.0, 0.0, 0.0), 24, 18)
    sun = c.lamp(LightKind.SUN, 3.0, (0.0, 0.0, 5.0), angle=0.05)

    def said(*things: c.Mesh) -> list[str]:
        what = c.scene(view, [(thing, c.lambert(0.8)) for thing in things], [sun], 0.6)
        return c.shoot(what, passes=1, photons_per_pass=1000).statistics["warnings"]

    def named(name: str, mesh: c.Mesh) -> c.Mesh:
        mesh.name = name
        return mesh

    floor, box = (
        named("Floor", c.quad(2.0)),
        named("Box", c.box((-0.3, -0.3, 0.0), (0.3, 0.3, 0.5))),
    )
    assert said(floor, box) == []
    assert said(floor, named("Carpet", c.quad(1.0, 1e-4))) == []
    [warning] = said(floor, named("Carpet", c.quad(1.0)))
    assert "('Carpet' in 'Floor')" in warning
    walls = [named(name, c.quad(2.0, 4.0)) for name in ("Ceiling", "Ceiling.001")]
    [warning] = said(floor, *walls)
    assert "('Ceiling' in 'Ceiling.001')" in warning
    plate = [(-0.4, 0.3, 0.6), (0.4, 0.3, 0.6), (0.4, 0.5, 0.1), (-0.4, 0.5, 0.104)]
    faces = [(0, 1, 2), (0, 2, 3)]
    [warning] = said(floor, named("Plate", c.mesh(plate, [*faces, *faces])))
    assert "('Plate' in itself)" in warning


def block_on_a_floor(name: str, size: float, x: float = 0.0, y: float = 0.0) -> Any:
    """Before a camera and below a lamp; without a material."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.camera()
    stage.lamp()
    stage.plane("Floor", 2.0)
    bpy.ops.mesh.primitive_cube_add(size=size, location=(x, y, size / 2))
    bpy.context.object.name = name
    return bpy.context.object


def said_of_the_file() -> list[str]:
    """The warnings of a short render."""
    import bpy
    from photon_splat.export import export_scene

    bpy.context.view_layer.update()
    what = export_scene(bpy.context.evaluated_depsgraph_get())
    return c.shoot(what, passes=1, photons_per_pass=1000).statistics["warnings"]


def test_a_warning_names_what_lies_in_each_other_behind_glass() -> None:
    """A block of glass that stands on the floor: its foot is seen through it."""
    block = block_on_a_floor("Block", 1.0, 0.2, 0.1)
    block.data.materials.append(stage.material("Glass", (1, 1, 1), "ShaderNodeBsdfGlass"))
    [warning] = said_of_the_file()
    assert "('Block' in 'Floor')" in warning or "('Floor' in 'Block')" in warning
    block.location.z += 0.001
    assert said_of_the_file() == []


def test_a_warning_names_fog_that_ends_in_the_floor() -> None:
    """Seen through the fog, whether it casts a shadow or none; not fog a millimetre higher."""
    fog = block_on_a_floor("Fog", 2.0)
    made, tree = stage.empty_material("Fog")
    stage.output(tree, tree.nodes.new("ShaderNodeVolumeScatter"), "Volume")
    fog.data.materials.append(made)
    for fog.visible_shadow in (True, False):
        [warning] = said_of_the_file()
        assert "('Fog' in 'Floor')" in warning
        assert "rays miss them" in warning
    fog.location.z += 0.001
    assert said_of_the_file() == []


@pytest.mark.parametrize("integrator", c.BOTH)
@pytest.mark.parametrize("through", ["ShaderNodeBsdfTransparent", "ShaderNodeBsdfGlass"])
@pytest.mark.parametrize("half", [1.0, 0.7], ids=["equal", "smaller"])
def test_a_wall_shows_through_a_pane_that_lies_on_it(
    half: float, through: str, integrator: Integrator
) -> None:
    """A pane of a transmittance of .5 on the floor of a room, outside of which it burns, is paint
    on that floor.
    """
    import bpy
    from photon_splat.export import export_scene

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24)
    stage.camera((0.0, 0.0, 1.5))
    stage.lamp("AREA", 5.0, (0.0, 0.0, 1.6))
    made, tree = stage.empty_material("Pane")
    shader = tree.nodes.new(through)
    shader.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    if through == "ShaderNodeBsdfGlass":
        shader.inputs["IOR"].default_value = 1.0
    stage.surface(tree, shader)
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 0.0, 1.0))
    bpy.context.object.data.materials.append(stage.material("Wall", (0.8, 0.8, 0.8)))
    pane = stage.plane("Pane", half)
    pane.data.materials[0] = made
    fire = stage.material("Fire", (5.0, 0.0, 0.0), "ShaderNodeEmission")
    stage.plane("Fire", 3.0, location=(0.0, 0.0, -0.5)).data.materials[0] = fire

    def seen() -> np.ndarray:
        bpy.context.view_layer.update()
        what = export_scene(bpy.context.evaluated_depsgraph_get())
        return c.picture(what, integrator, passes=256 if integrator is Integrator.REFERENCE else 32)

    exact = seen()
    pane.location.z = 3e-7  # now rounding does not put it behind the floor anywhere
    before = seen()
    pane.data.materials[0] = stage.material("Paint", (0.4, 0.4, 0.4))
    pane.location.z = 1e-4
    painted = seen()
    for picture in (exact, before):
        assert picture[..., 0].mean() == pytest.approx(picture[..., 1].mean(), rel=1e-3)
    assert before.mean() == pytest.approx(painted.mean(), rel=0.01)


def test_a_clear_shadow_catcher_may_lie_on_the_floor() -> None:
    """It is passed as one that stands off the floor, and the floor shows through it."""
    import bpy
    from photon_splat.export import export_scene

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24)
    stage.camera((0.0, 0.0, 3.0))
    stage.lamp()
    stage.world(0.5)
    stage.plane("Floor", 2.0)
    stage.plane("Shade", 0.3, location=(0.3, 0.2, 0.5))
    made, tree = stage.empty_material("Clear")
    stage.surface(tree, tree.nodes.new("ShaderNodeBsdfTransparent"))
    catcher = stage.plane("Catcher", 1.5)
    catcher.data.materials[0] = made
    catcher.is_shadow_catcher = True

    def seen(height: float) -> np.ndarray:
        catcher.location.z = height
        bpy.context.view_layer.update()
        return c.picture(export_scene(bpy.context.evaluated_depsgraph_get()), passes=8)

    above = seen(1e-3)
    assert above.mean() > 0.1
    assert seen(2e-7) == pytest.approx(above, rel=0.02)


def test_light_passes_each_of_two_panes_in_a_floor_once() -> None:
    """Two panes of a transmittance of .5 and .6 on the floor of a room are as paint of both."""
    import bpy
    from photon_splat.export import export_scene

    bpy.ops.wm.read_homefile(use_empty=True)
    stage.scene()
    stage.resize(24)
    stage.camera((0.0, 0.0, 1.5))
    stage.lamp("AREA", 5.0, (0.0, 0.0, 1.6))
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 0.0, 1.0))
    bpy.context.object.data.materials.append(stage.material("Wall", (0.8, 0.8, 0.8)))
    panes = []
    for transmittance in (0.5, 0.6):
        made, tree = stage.empty_material("Pane")
        shader = tree.nodes.new("ShaderNodeBsdfTransparent")
        shader.inputs["Color"].default_value = (transmittance,) * 3 + (1.0,)
        stage.surface(tree, shader)
        panes.append(stage.plane("Pane", 0.8, location=(0.0, 0.0, 3e-7 * (1 + len(panes)))))
        panes[-1].data.materials[0] = made

    def seen() -> np.ndarray:
        bpy.context.view_layer.update()
        return c.picture(export_scene(bpy.context.evaluated_depsgraph_get()), passes=32)

    both = seen()
    panes[0].data.materials[0] = stage.material("Paint", (0.24, 0.24, 0.24))
    panes[0].location.z = 1e-4
    panes[1].location.z = 5.0
    assert both.mean() == pytest.approx(seen().mean(), rel=0.01)
