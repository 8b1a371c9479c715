"""Persistent Data: after every kind of edit the picture is that of a first render, and what could
be used again was.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.integration.addon.test_persistent import PASSES, PHOTONS, corner, named, shoot
from tests.support import stage
from tests.support.blender import in_blender


def _exported() -> int:
    """Meshes and images that the scene's view layer has had exported since its caches were made."""
    from photon_splat.blender import persistent

    return persistent._holders[0].layers[stage.scene().view_layers[0].name].kept.made


def _move(name: str) -> Callable[[], None]:
    def move() -> None:
        named(name).location.x += 0.25

    return move


def _zoom() -> None:
    named("Camera").data.lens *= 1.2


def _enlarge() -> None:
    stage.resize(32, 20)


def _border() -> None:
    render = stage.scene().render
    render.use_border, render.border_min_x, render.border_max_y = True, 0.25, 0.75


def _brighten() -> None:
    named("POINT").data.energy *= 2.0


def _paint() -> None:
    import bpy

    tree = bpy.data.materials["Red"].node_tree
    next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE").inputs[
        "Color"
    ].default_value = (0.1, 0.1, 0.8, 1.0)


def _light_world() -> None:
    stage.world(0.5)


def _bend() -> None:
    mesh = named("Wall").data
    mesh.vertices[0].co.z += 0.5
    mesh.update()


def _modify() -> None:
    named("Wall").modifiers.new("Bevel", "SOLIDIFY").thickness = 0.3


def _add() -> None:
    stage.plane("Another", half=0.3, location=(0.5, 0.0, 0.5))


def _remove() -> None:
    import bpy

    bpy.data.objects.remove(named("Wall"))


def _bounce_less() -> None:
    stage.scene().photon_splat.max_bounces = 1


def _later_frame() -> None:
    stage.scene().frame_set(7)


EDITS: dict[str, tuple[Callable[[], None], bool, bool, int]] = {
    # geometry used again, photons used again, meshes exported
    "nothing": (lambda: None, True, True, 0),
    "later frame": (_later_frame, True, True, 0),
    "camera moved": (_move("Camera"), True, True, 0),
    "lens": (_zoom, True, True, 0),
    "resolution": (_enlarge, True, True, 0),
    "border": (_border, True, True, 0),
    "lamp moved": (_move("POINT"), True, False, 0),
    "lamp brighter": (_brighten, True, False, 0),
    "material": (_paint, True, False, 0),
    "world": (_light_world, True, False, 0),
    "object moved": (_move("Wall"), False, False, 0),
    "mesh edited": (_bend, False, False, 1),
    "modifier": (_modify, False, False, 1),
    "object added": (_add, False, False, 1),
    "object removed": (_remove, False, False, 0),
    "settings": (_bounce_less, False, False, 0),
}


@pytest.mark.parametrize("edit", EDITS)
@in_blender
def test_after_an_edit_the_picture_is_that_of_a_first_render(edit: str) -> None:
    from photon_splat.blender import persistent

    change, geometry, photons, exported = EDITS[edit]
    corner()
    before, first = shoot()
    assert first["reused"] == {"geometry": False, "photons": 0}
    assert first["photons"]["traced"] == PASSES * PHOTONS
    made = _exported()
    change()
    picture, second = shoot()
    assert second["reused"]["geometry"] == geometry
    assert (second["reused"]["photons"] > 0) == photons
    assert second["photons"]["traced"] == (0 if photons else PASSES * PHOTONS)
    assert _exported() - made == exported
    assert second["warnings"] == first["warnings"]
    persistent.free()
    fresh, third = shoot()
    assert third["reused"] == {"geometry": False, "photons": 0}
    assert np.array_equal(picture, fresh)
    assert edit in {"nothing", "later frame"} or not np.array_equal(picture, before)
