"""Materials nobody should make: a finite picture by both integrators, and a warning that names what
was wrong.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.support import stage
from tests.support.blender import in_blender

NAN, INF = math.nan, math.inf
# Node, what its sockets get, and what the warning must say of each;
# native/tests/bsdf/test_bsdf_edges.cpp has many more numbers.
CURSED: list[tuple[str, dict[Any, float], list[str]]] = [
    ("BsdfGlass", {"IOR": 0.0}, ["its IOR is 0, taken as 1e-05"]),
    ("BsdfGlass", {"IOR": 1.0, "Roughness": 1.0}, []),
    ("BsdfGlass", {"IOR": -1.5, "Roughness": 0.0}, ["its IOR is -1.5, taken as 1e-05"]),
    ("BsdfGlass", {"IOR": NAN, "Roughness": INF}, ["IOR", "Roughness"]),
    (
        "BsdfRefraction",
        {"IOR": -1.0, "Roughness": 2.0},
        ["its IOR is -1, taken as 1e-05", "its Roughness is 2, taken as 1"],
    ),
    (
        "BsdfAnisotropic",
        {"Roughness": -1.0, "Anisotropy": 5.0, "Rotation": INF},
        ["its Roughness is -1, taken as 0"],
    ),
    ("BsdfDiffuse", {"Roughness": INF}, ["Roughness"]),
    (
        "BsdfPrincipled",
        {"IOR": 0.0, "Transmission Weight": 3.0},
        ["its IOR is 0, taken as 1e-05", "its Transmission Weight is 3, taken as 1"],
    ),
    (
        "BsdfPrincipled",
        {"Metallic": 7.0, "Roughness": 0.0, "Anisotropic": -9.0},
        ["its Metallic is 7, taken as 1"],
    ),
    (
        "BsdfPrincipled",
        {"Coat Weight": -2.0, "Coat IOR": 0.0, "Sheen Weight": 1e30},
        ["its Coat Weight is -2", "its Coat IOR is 0"],
    ),
    (
        "BsdfPrincipled",
        {"Alpha": 4.0, "Emission Strength": -3.0, "Subsurface Weight": -1.0},
        ["its Alpha is 4, taken as 1"],
    ),
    ("BsdfPrincipled", {"Base Color": 5.0, "Roughness": 1.0}, []),
    ("BsdfPrincipled", {"Base Color": 1.0, "Roughness": 0.0, "Metallic": 1.0}, []),
    ("BsdfPrincipled", {"Base Color": 0.0, "Specular IOR Level": -1.0}, []),
    ("BsdfTransparent", {"Color": 3.0}, []),
    ("MixShader", {0: 7.0}, []),  # its factor; nothing is mixed
    ("MixShader", {0: -3.0}, []),
    ("AddShader", {}, []),
    ("Emission", {"Color": -1.0, "Strength": NAN}, ["Strength"]),
]


def _cursed(name: str, kind: str, values: dict[Any, float]) -> Any:
    """A material of one shader whose sockets get numbers from Value nodes: their own would be held
    to a range.
    """
    made, tree = stage.empty_material(name)
    shader = tree.nodes.new("ShaderNode" + kind)
    for socket, value in values.items():
        number = tree.nodes.new("ShaderNodeValue")
        number.outputs[0].default_value = value
        number.label = str(socket)
        tree.links.new(number.outputs[0], shader.inputs[socket])
    stage.surface(tree, shader)
    return made


def _finite_pictures(**settings: Any) -> list[np.ndarray]:
    """Combined by the splat and by the path tracer; every pass must be finite."""
    import bpy
    from photon_splat.blender.job import observer
    from photon_splat.core.render.settings import Integrator

    results: list[Any] = []
    observer.on_result = lambda result, _: results.append(result)
    stage.scene().render.engine = "PHOTON_SPLAT"
    for integrator in Integrator:
        observer.settings = lambda plain, by=integrator: replace(
            plain, integrator=by, **{"denoise": False} | settings
        )
        bpy.ops.render.render()
    for result in results:
        for name, values in result.passes.items():
            assert np.isfinite(values).all() or name == "Depth", f"{name} is not finite"
    return [result.passes["Combined"] for result in results]


@in_blender
def test_numbers_outside_of_their_range_are_named_and_harmless() -> None:
    stage.room(16, 2, 2000)
    stage.scene().objects["Plane"].location.z = -1.0
    for k, (kind, values, _) in enumerate(CURSED):
        thing = stage.plane(
            f"P{k}", 0.25, location=(0.55 * (k % 4) - 0.8, 0.55 * (k // 4) - 0.8, 0.1)
        )
        thing.data.materials[0] = _cursed(f"M{k}", kind, values)
    what = stage.exported()
    for k, (_, _, said) in enumerate(CURSED):
        warnings = [warning for warning in what.warnings if f"'M{k}'" in warning]
        for words in said:
            assert any(words in warning for warning in warnings), (
                f"M{k}: {words!r} is not said: {warnings}"
            )
        assert said or not warnings, f"M{k} needs no warning: {warnings}"
    for picture in _finite_pictures():
        assert picture[..., :3].mean() > 0


@in_blender
def test_a_thousand_transparent_layers_let_through_what_they_should() -> None:
    """Each takes a thousandth; behind them something shines."""
    clear = stage.material("Clear", (0.999, 0.999, 0.999), "ShaderNodeBsdfTransparent")
    corners = [
        (x, y, 0.001 * k) for k in range(1000) for x, y in ((-3, -3), (3, -3), (3, 3), (-3, 3))
    ]
    layers = stage.add(
        "Layers", stage.mesh("Layers", corners, [range(4 * k, 4 * k + 4) for k in range(1000)])
    )
    layers.data.materials.append(clear)
    glow = stage.plane("Glow", 3.0, location=(0, 0, -1))
    glow.data.materials[0] = stage.material("Glow", (1, 1, 1), "ShaderNodeEmission")
    stage.camera()
    stage.resize(8)
    for picture in _finite_pictures(passes=2, photons_per_pass=100):
        assert picture[..., :3].mean() == pytest.approx(0.999**1000, rel=0.01)


@in_blender
def test_glass_in_glass_in_glass_ends() -> None:
    """Twenty balls one within the other, indices above and below 1: no hang, no light from
    nowhere.
    """
    import bmesh
    import bpy

    stage.room(16, 2, 2000)
    for k in range(20):
        form, ball = bpy.data.meshes.new("Ball"), bmesh.new()
        bmesh.ops.create_icosphere(ball, subdivisions=2, radius=0.9 - 0.04 * k)
        ball.to_mesh(form)
        ball.free()
        form.materials.append(
            _cursed(
                f"G{k}", "BsdfGlass", {"IOR": (1.5, 0.5, 3.0)[k % 3], "Roughness": 0.25 * (k % 2)}
            )
        )
        stage.add("Ball", form, (0, 0, 1))
    for picture in _finite_pictures(max_bounces=1000):
        assert picture[..., :3].mean() < 100.0


@in_blender
def test_more_lobes_than_there_is_room_for_are_named() -> None:
    made, tree = stage.empty_material("Onion")
    above = None
    for _ in range(20):
        shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
        shader.inputs["Coat Weight"].default_value = 0.5
        if above is not None:
            mixed = tree.nodes.new("ShaderNodeMixShader")
            tree.links.new(shader.outputs[0], mixed.inputs[1])
            tree.links.new(above.outputs[0], mixed.inputs[2])
            above = mixed
        else:
            above = shader
    stage.surface(tree, above)
    stage.plane().data.materials[0] = made
    said = (
        "Material 'Onion': its shaders may come to 60 lobes at one point; what is beyond 48 "
        "there is left out"
    )
    assert stage.exported().warnings == [said]


@in_blender
def test_absurd_strengths_are_refused_by_name() -> None:
    """Floats of Blender go as far as 3.4e38; no film could sum such light."""
    stage.room(16, 2, 2000)
    stage.lamp("SPOT", 1e30, (0, 0, 3)).name = "Supernova"
    stage.world(1e30)
    said = " ".join(stage.exported().warnings)
    assert (
        "Lights left out, as they are brighter than numbers of pixels can be: 'Supernova'" in said
    )
    assert "it is brighter than numbers of pixels can be; left out" in said
    for picture in _finite_pictures():
        assert picture[..., :3].mean() > 0
