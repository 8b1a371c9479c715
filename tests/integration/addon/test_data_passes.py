"""Passes that tell what is seen: indices, mist, position, mattes and their manifest."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from photon_splat.core.render.cryptomatte import id_bits, id_of, murmur3

from tests.integration.addon.test_motion import keyed
from tests.support import stage
from tests.support.blender import in_blender


def test_hashes_are_those_of_murmur3() -> None:
    known = {"": 0, "hello": 0x248BFA47, "hello, world": 0x149BBB7F}
    known["The quick brown fox jumps over the lazy dog"] = 0x2E4FF723
    assert {text: murmur3(text.encode()) for text in known} == known


def test_ids_are_ordinary_floats() -> None:
    for name in (f"Thing {i}" for i in range(2000)):
        assert np.isfinite(id_of(name))
        assert 0 < (id_bits(name) >> 23) & 255 < 255


def _board() -> Any:
    """Two squares side by side that fill the picture, the right one half transparent before a
    third. Returns the scene.
    """
    import bpy

    made = stage.room(pixels=16)
    made.camera.data.type, made.camera.data.ortho_scale = "ORTHO", 4.0
    bpy.data.objects["Plane"].scale = (0.0, 0.0, 0.0)
    left = stage.plane("Left", half=1.0, location=(-1.0, 0.0, 0.0))
    left.scale = (1.0, 2.0, 1.0)
    right = stage.plane("Right", half=1.0, location=(1.0, 0.0, 1.0))
    right.scale = (1.0, 2.0, 1.0)
    behind = stage.plane("Behind", half=1.0, location=(1.0, 0.0, 0.0))
    behind.scale = (1.0, 2.0, 1.0)
    bpy.context.view_layer.update()
    behind.parent = left
    behind.matrix_parent_inverse = left.matrix_world.inverted()
    glass = stage.material("Half")
    tree = glass.node_tree
    mix, clear = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfTransparent")
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    diffuse = output.inputs["Surface"].links[0].from_socket
    mix.inputs["Fac"].default_value = 0.25
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(diffuse, mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    right.data.materials[0] = glass
    for index, ob in enumerate((left, right, behind), start=3):
        ob.pass_index = index
        ob.data.materials[0].pass_index = 10 * index
    layer = made.view_layers[0]
    for name in ("position", "mist", "object_index", "material_index", "cryptomatte_object"):
        setattr(layer, f"use_pass_{name}", True)
    layer.use_pass_cryptomatte_asset = True
    layer.pass_cryptomatte_depth = 4
    return made


def _mist_from_2_m_to_6(made: Any) -> None:
    import bpy

    made.world = bpy.data.worlds.new("World")
    mist = made.world.mist_settings
    mist.start, mist.depth, mist.falloff = 2.0, 4.0, "LINEAR"


def _coverage(passes: dict[str, np.ndarray], kind: str, name: str) -> np.ndarray:
    total: Any = 0.0
    for i in range(2):
        pair = passes[f"{kind}{i:02}"]
        for at in (0, 2):
            total = total + np.where(pair[..., at] == np.float32(id_of(name)), pair[..., at + 1], 0)
    return np.asarray(total)


@in_blender
def test_passes_of_data() -> None:
    import bpy

    made = _board()
    _mist_from_2_m_to_6(made)
    with stage.watched() as results:
        bpy.ops.render.render()
    passes = results[0].passes
    left, right = np.s_[2:-2, 2:6], np.s_[2:-2, 10:14]
    assert np.all(passes["Object Index"][left] == 3)
    # what is less than half opaque is the first surface where the path ends at it
    index = passes["Object Index"][right]
    assert 0.5 < np.mean(index == 5) < 0.95
    assert np.all((index == 5) | (index == 4))
    assert np.all(passes["Material Index"][right] == 10 * index)
    assert passes["Position"][right][..., 2] == pytest.approx(
        np.where(index == 5, 0.0, 1.0)[..., 0], abs=1e-5
    )
    assert passes["Mist"][left] == pytest.approx(0.5, abs=1e-4)
    # a quarter of the light stays at a distance of 3 m, the rest goes on to 4
    assert passes["Mist"][right] == pytest.approx(0.25 * 0.25 + 0.75 * 0.5, abs=1e-4)
    assert _coverage(passes, "CryptoObject", "Left")[left] == pytest.approx(1.0, abs=1e-5)
    assert _coverage(passes, "CryptoObject", "Right")[right] == pytest.approx(0.25, abs=1e-5)
    assert _coverage(passes, "CryptoObject", "Behind")[right] == pytest.approx(0.75, abs=1e-5)
    assert _coverage(passes, "CryptoAsset", "Left")[right] == pytest.approx(0.75, abs=1e-5)
    assert "CryptoMaterial00" not in passes


@in_blender
def test_media_have_no_depth() -> None:
    """What stands behind a cube of fog shows its own, whether light is scattered before it or
    not.
    """
    import bpy

    made = _board()
    made.view_layers[0].use_pass_z = True
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-1.0, 0.0, 2.0))
    cube = bpy.context.object
    cube.scale = (2.0, 5.0, 1.0)
    fog, tree = stage.empty_material("Fog")
    scatters = tree.nodes.new("ShaderNodeVolumeScatter")
    scatters.inputs["Density"].default_value = 1.0
    stage.output(tree, scatters, "Volume")
    cube.data.materials.append(fog)
    with stage.watched() as results:
        bpy.ops.render.render()
    passes, left = results[0].passes, np.s_[2:-2, 2:6]
    assert passes["Depth"][left] == pytest.approx(4.0, abs=1e-4)
    assert np.all(passes["Object Index"][left] == 3)


@in_blender
def test_what_media_take_is_mist() -> None:
    """A slab 1 m thick that absorbs .5/m over all squares."""
    import math

    import bpy

    made = _board()
    _mist_from_2_m_to_6(made)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 2.0))
    slab = bpy.context.object
    slab.scale = (5.0, 5.0, 1.0)
    fog, tree = stage.empty_material("Fog")
    absorbs = tree.nodes.new("ShaderNodeVolumeAbsorption")
    absorbs.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    absorbs.inputs["Density"].default_value = 0.5
    stage.output(tree, absorbs, "Volume")
    slab.data.materials.append(fog)
    with stage.watched() as results:
        bpy.ops.render.render()
    mist = results[0].passes["Mist"]
    left, right = np.s_[2:-2, 2:6], np.s_[2:-2, 10:14]
    stays = math.exp(-0.5)
    assert mist[left] == pytest.approx(1 - stays * 0.5, abs=1e-4)
    assert mist[right] == pytest.approx(1 - stays * (0.25 * 0.75 + 0.75 * 0.5), abs=1e-4)


@in_blender
def test_colours_are_seen_through_glass_that_the_film_sees_as_clear() -> None:
    """A pane that refracts all light before the left square: two surfaces of white transmission."""
    import bpy

    made = _board()
    made.render.film_transparent = True
    for name in ("diffuse_color", "transmission_color"):
        setattr(made.view_layers[0], f"use_pass_{name}", True)
    pane, tree = stage.empty_material("Pane")
    refracts = tree.nodes.new("ShaderNodeBsdfRefraction")
    refracts.inputs["Roughness"].default_value = 0.0
    stage.surface(tree, refracts)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-1.0, 0.0, 1.0))
    bpy.context.object.scale = (2.0, 5.0, 0.2)
    bpy.context.object.data.materials.append(pane)
    left = np.s_[2:-2, 2:6]
    for clear, surfaces in ((False, 1.0), (True, 2.0)):
        made.cycles.film_transparent_glass = clear
        with stage.watched() as results:
            bpy.ops.render.render()
        passes = results[0].passes
        behind = 0.5 if clear else 0.0
        assert passes["Diffuse Color"][left] == pytest.approx(behind, abs=1e-3)
        assert passes["Transmission Color"][left] == pytest.approx(surfaces, abs=1e-3)


@in_blender
def test_normals_are_those_of_the_first_surface_that_is_opaque_enough() -> None:
    import bpy

    made = _board()
    made.objects["Right"].rotation_euler = (0.3, 0.0, 0.0)
    layer = made.view_layers[0]
    layer.use_pass_normal = True
    right, tilted = np.s_[2:-2, 10:14], (0.0, -math.sin(0.3), math.cos(0.3))
    for threshold, normal in ((0.5, (0.0, 0.0, 1.0)), (0.2, tilted), (0.0, tilted)):
        layer.pass_alpha_threshold = threshold
        with stage.watched() as results:
            bpy.ops.render.render()
        found = results[0].passes["Normal"][right]  # some samples end at what lets light through
        length = np.linalg.norm(found, axis=-1, keepdims=True)
        assert np.allclose(found / length, normal, atol=1e-5), threshold
        assert np.mean(length) > 0.6
        # the depth is that of the same surface, or where the path of the first sample ends before
        depth = results[0].passes["Depth"][right]
        assert np.all(depth < 1e9)
        behind = np.mean(depth > 3.8)
        assert 0.5 < behind < 0.95 if threshold == 0.5 else behind == 0.0, threshold


@pytest.mark.parametrize("by", ["object", "closure"])
@in_blender
def test_a_hole_in_the_picture_has_no_data(by: str) -> None:
    """As in Cycles, where a path ends at what holds out."""
    import bpy

    made = _board()
    if by == "object":
        made.objects["Left"].is_holdout = True
    else:
        tree = made.objects["Left"].data.materials[0].node_tree
        stage.surface(tree, tree.nodes.new("ShaderNodeHoldout"))
    layer = made.view_layers[0]
    for name in ("z", "mist", "normal", "position", "object_index", "cryptomatte_object"):
        setattr(layer, f"use_pass_{name}", True)
    with stage.watched() as results:
        bpy.ops.render.render()
    passes, left = results[0].passes, np.s_[2:-2, 2:6]
    assert np.all(passes["Depth"][left] >= 1e9)
    assert np.all(passes["Mist"][left] == 1.0)
    for name in ("Normal", "Position", "Object Index"):
        assert np.all(passes[name][left] == 0.0), name
    assert np.all(_coverage(passes, "CryptoObject", "Left")[left] == 0.0)
    assert np.all(passes["Object Index"][np.s_[2:-2, 10:14]] != 0.0)


@in_blender
def test_materials_fill_passes_of_their_own() -> None:
    import bpy

    made = _board()
    layer = made.view_layers[0]
    colored, plain = layer.aovs.add(), layer.aovs.add()
    colored.name, plain.name, plain.type = "Tint", "Height", "VALUE"
    for name, tint in (("Left", (0.25, 0.5, 0.75, 1.0)), ("Right", (1.0, 0.0, 0.0, 1.0))):
        tree = bpy.data.objects[name].data.materials[0].node_tree
        for aov in ("Tint", "Height", "Nobody's"):
            node = tree.nodes.new("ShaderNodeOutputAOV")
            node.aov_name = aov
            node.inputs["Color"].default_value = tint
            place = tree.nodes.new("ShaderNodeNewGeometry")
            split = tree.nodes.new("ShaderNodeSeparateXYZ")
            tree.links.new(place.outputs["Position"], split.inputs[0])
            tree.links.new(split.outputs["X"], node.inputs["Value"])
    with stage.watched() as results:
        bpy.ops.render.render()
    passes = results[0].passes
    assert "Nobody's" not in passes
    assert passes["Tint"].shape[2] == 4
    assert passes["Tint"][8, 3] == pytest.approx((0.25, 0.5, 0.75, 1.0))
    assert passes["Tint"][8, 12] == pytest.approx((1.0, 0.0, 0.0, 1.0))
    across = passes["Height"][8, 2:14, 0]
    assert across == pytest.approx(-2.0 + 4.0 * (np.arange(2, 14) + 0.5) / 16, abs=0.03)


@in_blender
def test_outputs_in_groups_and_of_one_name_are_added() -> None:
    import bpy

    made = _board()
    layer = made.view_layers[0]
    colored, plain = layer.aovs.add(), layer.aovs.add()
    colored.name, plain.name, plain.type = "Tint", "Height", "VALUE"
    inner, outer = (bpy.data.node_groups.new(name, "ShaderNodeTree") for name in ("In", "Out"))
    for group in (inner, outer):
        group.interface.new_socket("Tint", in_out="INPUT", socket_type="NodeSocketColor")
        group.nodes.new("NodeGroupInput")
    for aov in ("Tint", "Height"):
        node = inner.nodes.new("ShaderNodeOutputAOV")
        node.aov_name = aov
        inner.links.new(inner.nodes[0].outputs[0], node.inputs["Color"])
        inner.links.new(inner.nodes[0].outputs[0], node.inputs["Value"])
    for mute in (False, True):
        nested = outer.nodes.new("ShaderNodeGroup")
        nested.node_tree, nested.mute = inner, mute
        outer.links.new(outer.nodes[0].outputs[0], nested.inputs[0])
    tree = bpy.data.objects["Left"].data.materials[0].node_tree
    for tint in ((0.25, 0.5, 0.0, 1.0), (0.5, 0.25, 0.5, 1.0)):
        user = tree.nodes.new("ShaderNodeGroup")
        user.node_tree, user.inputs[0].default_value = outer, tint
    own = tree.nodes.new("ShaderNodeOutputAOV")
    own.aov_name, own.inputs["Value"].default_value = "Height", 3.0
    with stage.watched() as results:
        bpy.ops.render.render()
    passes = results[0].passes
    assert passes["Tint"][8, 3, :3] == pytest.approx((0.75, 0.75, 0.5))
    grey = 0.75 * (0.2126 + 0.7152) + 0.5 * 0.0722
    assert passes["Height"][8, 3, 0] == pytest.approx(3.0 + grey, abs=1e-3)
    assert not passes["Tint"][8, 12].any()


@in_blender
def test_a_worlds_outputs_are_named() -> None:
    made = _board()
    layer = made.view_layers[0]
    layer.aovs.add().name = "Tint"
    stage.world(1.0)
    for aov in ("Tint", "Nobody's"):
        made.world.node_tree.nodes.new("ShaderNodeOutputAOV").aov_name = aov
    for wanted in (True, False):
        said = [text for text in stage.exported().warnings if "AOV Output" in text]
        assert len(said) == wanted
        assert all("'Tint'" in text for text in said)
        layer.aovs[0].name = "Shade"


@in_blender
def test_blenders_cryptomatte_node_picks_an_object(tmp_path: str) -> None:
    import bpy
    import OpenImageIO as oiio

    if bpy.app.version < (5, 0, 0):
        return  # the compositor has another interface there
    made = _board()
    tree, end = stage.compositor(made)
    pick = tree.nodes.new("CompositorNodeCryptomatteV2")
    pick.source, pick.scene = "RENDER", made
    pick.layer_name = f"{made.view_layers[0].name}.CryptoObject"
    pick.matte_id = "Behind"
    tree.links.new(pick.outputs["Matte"], end.inputs[0])
    image = made.render.image_settings
    image.media_type, image.file_format, image.color_depth = "IMAGE", "OPEN_EXR", "32"
    made.render.filepath = f"{tmp_path}/matte.exr"
    with stage.watched() as results:
        bpy.ops.render.render(write_still=True)
    matte = oiio.ImageBuf(made.render.filepath).get_pixels(oiio.FLOAT)[::-1, :, 0]
    assert matte.max() > 0.7
    assert matte == pytest.approx(_coverage(results[0].passes, "CryptoObject", "Behind"), abs=1e-4)


@in_blender
def test_the_manifest_is_in_the_file(tmp_path: str) -> None:
    layer, specs = _board().view_layers[0].name, stage.rendered_layers(tmp_path)
    attributes = [one for spec in specs for one in spec.extra_attribs]
    told = {a.name: a.value for a in attributes if a.name.startswith("cryptomatte/")}
    channels = [name for spec in specs for name in spec.channelnames]
    assert {f"{layer}.CryptoObject", f"{layer}.CryptoAsset"} <= set(told.values())
    manifest = next(
        json.loads(told[key.replace("/name", "/manifest")])
        for key, value in told.items()
        if value == f"{layer}.CryptoObject"
    )
    assert manifest["Behind"] == f"{id_bits('Behind'):08x}"
    assert f"{layer}.CryptoObject01.a" in channels


@in_blender
def test_vectors_tell_where_things_come_from_and_go() -> None:
    import bpy

    made = _board()
    made.view_layers[0].use_pass_vector = True
    left = bpy.data.objects["Left"]
    keyed(left, "location", {4: (-1.5, 0.0, 0.0), 5: (-1.0, 0.0, 0.0), 6: (-0.75, 0.25, 0.0)})
    made.frame_set(5)
    with stage.watched() as results:
        bpy.ops.render.render()
        made.render.use_motion_blur = True
        bpy.ops.render.render()
    # 4 pixels a metre; behind the pane hangs what the left square carries along
    vectors = results[0].passes["Vector"]
    for there in (np.s_[2:-2, 2:6], np.s_[2:-2, 10:14]):
        assert np.allclose(vectors[there], (-2.0, 0.0, -1.0, -1.0), atol=1e-3)
    assert not results[1].passes["Vector"].any()
    assert (made.frame_current, left.location.x) == (5, -1.0)


@in_blender
def test_vectors_of_shapes_and_cameras() -> None:
    import bpy

    made = stage.room(pixels=16)
    made.camera.data.type, made.camera.data.ortho_scale = "ORTHO", 4.0
    made.view_layers[0].use_pass_vector = True
    thing = bpy.data.objects["Plane"]
    thing.shape_key_add(name="Basis")
    aside = thing.shape_key_add(name="Aside")
    for point in aside.data:
        point.co.x += 2.5
    keyed(aside, "value", {0: 0.0, 10: 1.0})
    made.frame_set(5)
    with stage.watched() as results:
        bpy.ops.render.render()
        keyed(made.camera, "delta_location", {0: (0.0, 0.0, 0.0), 10: (0.0, 2.0, 0.0)})
        bpy.ops.render.render()
    assert results[0].passes["Vector"][8, 10] == pytest.approx((-1.0, 0.0, -1.0, 0.0), abs=1e-3)
    assert results[1].passes["Vector"][8, 10] == pytest.approx((-1.0, 0.8, -1.0, 0.8), abs=1e-3)


@in_blender
def test_ambient_occlusion_before_a_wall() -> None:
    import bpy

    made = stage.room(pixels=16, passes=64)
    made.camera.data.type, made.camera.data.ortho_scale = "ORTHO", 1.0
    wall = stage.plane("Wall", half=50.0, location=(1.0, 0.0, 0.0))
    wall.rotation_euler = (0.0, 1.5707963, 0.0)
    stage.world(0.5)
    made.world.light_settings.distance = 1000.0
    layer = made.view_layers[0]
    with stage.watched() as results:
        bpy.ops.render.render()
        layer.use_pass_ambient_occlusion = True
        bpy.ops.render.render()
        made.world.light_settings.distance = 0.25
        bpy.ops.render.render()
    pictures = [result.passes["Combined"] for result in results]
    assert np.array_equal(pictures[0], pictures[1])
    assert "Ambient Occlusion" not in results[0].passes
    # a wall without end hides half of what is above the floor
    assert results[1].passes["Ambient Occlusion"].mean() == pytest.approx(0.5, abs=0.03)
    assert np.allclose(results[2].passes["Ambient Occlusion"], 1.0, atol=1e-5)


@in_blender
def test_who_asks_for_none_has_no_labels() -> None:
    stage.room()
    assert stage.exported().labels is None


NOT_MADE = {
    "Debug Sample Count",
    "Render Time",
    "Volume Scatter",
    "Volume Transmit",
    "Volume Majorant",
    "Noisy Shadow Catcher",
    "Denoising Depth",
    "Denoising Specular Albedo",
    "Denoising Roughness",
    "Guiding Color",
    "Guiding Probability",
    "Guiding Average Roughness",
}
"""Passes of Cycles that docs/manual.md names as missing."""


@in_blender
def test_a_compositor_made_for_cycles_finds_its_passes() -> None:
    """The same names, channels and kinds: Blender 5 has other names than those before it."""
    import bpy
    from cycles.engine import list_render_passes
    from photon_splat.blender.passes import blender_name, kind, wanted_passes

    made = _board()
    made.cycles.use_denoising = made.photon_splat.denoise = True
    layer = made.view_layers[0]
    layer.aovs.add().name = "Tint"
    layer.lightgroups.add(name="Lamps")
    for owner in (layer, layer.cycles):
        for name in (prop.identifier for prop in owner.bl_rna.properties):
            if name.startswith(("use_pass_", "pass_debug", "denoising_store")):
                setattr(owner, name, True)
    theirs = {name: rest for name, *rest in list_render_passes(made, layer)}
    ours = {
        blender_name(info.name): [info.channels, kind(info)] for info in wanted_passes(made, layer)
    }
    assert theirs.keys() - ours.keys() <= NOT_MADE
    common = theirs.keys() & ours.keys()
    assert {name: ours[name] for name in common} == {name: theirs[name] for name in common}
    assert bpy.app.version >= (5, 0) or {"DiffDir", "GlossCol", "Env", "IndexOB"} <= ours.keys()


@in_blender
def test_parts_of_the_light_and_the_noisy_picture_reach_blender() -> None:
    """As Blender writes them to a file: light over the colour of what sent it, and the picture
    before it was denoised.
    """
    from tests.reference.agreement.light_passes import parts, switch_on
    from tests.reference.cycles.references import written_passes

    made = _board()
    switch_on()
    layer = made.view_layers[0]
    layer.cycles.denoising_store_passes = True
    made.photon_splat.denoise = True
    with stage.watched():
        passes = written_passes()
    noisy, denoised = passes["Noisy Image"], passes["Combined"]
    assert noisy.shape == denoised.shape
    assert noisy.any()
    assert np.any(noisy[..., :3] != denoised[..., :3])
    assert sum(parts(passes).values()) == pytest.approx(noisy[..., :3], abs=1e-4)
    made.photon_splat.denoise = False
    with stage.watched():
        assert "Noisy Image" not in written_passes()
    assert passes["Denoising Albedo"][8, 3] == pytest.approx(passes["Diffuse Color"][8, 3])
    assert passes["Denoising Normal"][8, 3] == pytest.approx((0.0, 0.0, 1.0), abs=1e-4)


@in_blender
def test_a_picture_that_nothing_has_denoised_is_its_own_noisy_one() -> None:
    """A cancelled render, or a Blender without a denoiser."""
    import bpy
    from photon_splat.blender.passes import with_noisy

    _board().photon_splat.denoise = False
    with stage.watched() as results:
        bpy.ops.render.render()
    assert results[0].noisy is None
    passes = with_noisy(results[0])
    assert passes["Noisy Image"].any()
    assert np.array_equal(passes["Noisy Image"], passes["Combined"])
