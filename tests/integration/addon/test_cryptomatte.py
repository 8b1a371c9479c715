"""Cryptomatte through Blender's own node, beside Cycles' of the same scene."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from photon_splat.core.render.cryptomatte import id_bits

from tests.support import stage
from tests.support.blender import in_blender

NAMES = [f"Thing {k}" for k in range(20)]
SIZE = 96


def _twenty() -> Any:
    """Twenty tilted sheets and balls that hide parts of each other, before a lens that blurs."""
    import bpy

    from blend_scenes.scripts import modelling as m

    made = m.new_scene(SIZE, SIZE)
    chance = np.random.default_rng(4)
    for k, name in enumerate(NAMES):
        where = (*chance.uniform(-1.3, 1.3, 2), chance.uniform(-1.0, 1.0))
        material = stage.material(name, chance.uniform(0.2, 0.8, 3))
        if k % 2:
            made_of = m.add_sphere(name, chance.uniform(0.2, 0.4), material, where, 24)
        else:
            made_of = stage.plane(name, chance.uniform(0.2, 0.5), location=where)
            made_of.data.materials[0] = material
        made_of.rotation_euler = chance.uniform(-0.8, 0.8, 3)
    stage.lamp("SUN", 3.0, (0, 0, 5))
    camera = stage.camera((0, 0, 5))
    camera.data.dof.use_dof, camera.data.dof.focus_distance = True, 5.0
    camera.data.dof.aperture_fstop = 0.5
    made.view_layers[0].use_pass_cryptomatte_object = True
    made.cycles.samples, made.cycles.use_denoising = 1024, False
    made.cycles.use_adaptive_sampling = False
    made.photon_splat.passes, made.photon_splat.photons_per_pass = 4, 1000
    made.photon_splat.error_threshold, made.photon_splat.denoise = 0.0, False
    bpy.context.view_layer.update()
    return made


def _mattes(made: Any, engine: str, folder: str) -> NDArray[np.float32]:
    """(20, height, width) that the node picks, four in a picture's channels."""
    import bpy
    import OpenImageIO as oiio

    made.render.engine = engine
    tree, end = stage.compositor(made)
    four = tree.nodes.new("CompositorNodeCombineColor")
    tree.links.new(four.outputs[0], end.inputs[0])
    picks = [tree.nodes.new("CompositorNodeCryptomatteV2") for _ in range(4)]
    for channel, pick in enumerate(picks):
        pick.source, pick.scene = "RENDER", made
        pick.layer_name = f"{made.view_layers[0].name}.CryptoObject"
        tree.links.new(pick.outputs["Matte"], four.inputs[channel])
    image = made.render.image_settings
    image.media_type, image.file_format = "IMAGE", "OPEN_EXR"
    image.color_depth, image.color_mode = "32", "RGBA"
    found = []
    for first in range(0, len(NAMES), 4):
        for pick, name in zip(picks, NAMES[first : first + 4], strict=True):
            pick.matte_id = name
        made.render.filepath = f"{folder}/{engine}.{first}.exr"
        bpy.ops.render.render(write_still=True)
        pixels = oiio.ImageBuf(made.render.filepath).get_pixels(oiio.FLOAT)
        found += [pixels[..., channel] for channel in range(4)]
    return np.stack(found)


@pytest.mark.slow
@in_blender
def test_the_node_picks_each_of_twenty_objects(tmp_path: str) -> None:
    """Coverage as in Cycles to a hundredth: of each matte's sum, and of its pixels in the mean
    square.
    """
    import bpy

    if bpy.app.version < (5, 0, 0):
        return  # the compositor has another interface there
    made = _twenty()
    theirs, ours = (_mattes(made, engine, tmp_path) for engine in ("CYCLES", "PHOTON_SPLAT"))
    assert (theirs.max(axis=(1, 2)) > 0.5).all()
    sums = ours.sum(axis=(1, 2)) / theirs.sum(axis=(1, 2))
    rms = np.sqrt(np.square(ours - theirs).mean(axis=(1, 2)))
    assert np.abs(sums - 1.0).max() < 0.01
    assert rms.max() < 0.01


@in_blender
def test_the_manifest_names_all_twenty(tmp_path: str) -> None:
    made = _twenty()
    made.render.engine = "PHOTON_SPLAT"
    attributes = [one for spec in stage.rendered_layers(tmp_path) for one in spec.extra_attribs]
    told = {a.name: a.value for a in attributes if a.name.startswith("cryptomatte/")}
    (manifest,) = (json.loads(value) for key, value in told.items() if key.endswith("/manifest"))
    assert {name: manifest[name] for name in NAMES} == {
        name: f"{id_bits(name):08x}" for name in NAMES
    }


@in_blender
def test_what_has_no_material_is_named_as_in_cycles(tmp_path: str) -> None:
    from blend_scenes.scripts import modelling as m

    made = m.new_scene(8, 8)
    stage.plane("Bare", 1.0).data.materials.clear()
    stage.camera((0, 0, 5))
    made.view_layers[0].use_pass_cryptomatte_material = True
    made.render.engine, made.photon_splat.passes = "PHOTON_SPLAT", 1
    attributes = [one for spec in stage.rendered_layers(tmp_path) for one in spec.extra_attribs]
    (manifest,) = (json.loads(a.value) for a in attributes if a.name.endswith("/manifest"))
    assert manifest["default_surface"] == f"{id_bits('default_surface'):08x}"
