"""Blender's shader trees and images as the engine sees them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from photon_splat.core.scene.shading import Feature

from tests.support import stage
from tests.support.blender import in_blender


def _textured(image: Any, name: str = "Painted") -> Any:
    """A diffuse material coloured by `image` on a plane with a UV map; returns its tree."""
    made, tree = stage.empty_material(name)
    shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
    stage.surface(tree, shader)
    ob = stage.plane("Canvas")
    ob.data.uv_layers.new(name="UV")
    ob.data.materials[0] = made
    return tree


def _four_colors(name: str, float_buffer: bool = False) -> Any:
    """2x2: black, red below; green, half blue above."""
    import bpy

    image = bpy.data.images.new(name, 2, 2, float_buffer=float_buffer)
    image.pixels[:] = [0, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0.5, 1]
    return image


TRANSPARENT = "ShaderNodeBsdfTransparent"
COLORS = np.array([[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [0, 0, 0.5]]])


@in_blender
def test_generated_image() -> None:
    _textured(_four_colors("Made"))
    what = stage.exported()
    (texture,) = what.textures
    assert what.materials[0].front.base_color_texture == 0
    assert what.materials[0].front.base_color == (1, 1, 1)
    assert texture.srgb
    assert texture.pixels.dtype == np.uint8
    assert np.allclose(texture.pixels[..., :3] / 255, COLORS, atol=0.003)
    assert what.warnings == []


@in_blender
def test_float_image_is_linear() -> None:
    _textured(_four_colors("Float", float_buffer=True))
    (texture,) = stage.exported().textures
    assert texture.pixels.dtype == np.float32
    assert not texture.srgb
    assert np.allclose(texture.pixels[..., :3], COLORS, atol=1e-6)


@pytest.mark.smoke
@in_blender
def test_packed_image(tmp_path: str) -> None:
    import bpy

    image = _four_colors("Packed")
    image.filepath_raw, image.file_format = f"{tmp_path}/picture.png", "PNG"
    image.save()
    bpy.data.images.remove(image)
    image = bpy.data.images.load(f"{tmp_path}/picture.png")
    image.pack()
    Path(tmp_path, "picture.png").unlink()
    _textured(image)
    what = stage.exported()
    (texture,) = what.textures
    assert texture.srgb
    assert np.allclose(texture.pixels[..., :3] / 255, COLORS, atol=0.003)
    assert what.warnings == []


@in_blender
def test_packed_layers(tmp_path: str) -> None:
    """A picture as Blender saves them with their passes; of a layer Combined is shown."""
    import bpy
    import OpenImageIO as oiio

    spec = oiio.ImageSpec(2, 2, 7, oiio.FLOAT)
    spec.channelnames = tuple(f"View.AO.{c}" for c in "RGB") + tuple(
        f"View.Combined.{c}" for c in "RGBA"
    )
    opaque = np.ones((2, 2, 1))
    values = np.concatenate([np.full((2, 2, 3), 0.5), COLORS[::-1], opaque], axis=2)
    file = oiio.ImageOutput.create(f"{tmp_path}/passes.exr")
    assert file.open(f"{tmp_path}/passes.exr", spec)
    file.write_image(np.ascontiguousarray(values, np.float32))
    file.close()
    image = bpy.data.images.load(f"{tmp_path}/passes.exr")
    image.pack()
    _textured(image)
    what = stage.exported()
    (texture,) = what.textures
    assert np.allclose(texture.pixels[..., :3], COLORS, atol=1e-6)
    assert not texture.srgb
    assert what.warnings == []


@in_blender
def test_a_packed_image_where_the_temporary_folder_is_full(tmp_path: str) -> None:
    from unittest.mock import patch

    import bpy

    image = _four_colors("Packed")
    image.filepath_raw, image.file_format = f"{tmp_path}/picture.png", "PNG"
    image.save()
    image.pack()
    _textured(image)
    full = OSError(28, "No space left on device")
    with patch("tempfile.TemporaryDirectory", side_effect=full) as asked:
        what = stage.exported()
    assert asked.called
    (texture,) = what.textures
    assert np.allclose(texture.pixels[..., :3] / 255, COLORS, atol=0.003)
    assert bpy.data.images["Packed"].packed_file


@in_blender
def test_image_file_and_its_colour_space(tmp_path: str) -> None:
    import bpy

    image = _four_colors("File")
    image.filepath_raw, image.file_format = f"{tmp_path}/picture.png", "PNG"
    image.save()
    bpy.data.images.remove(image)
    image = bpy.data.images.load(f"{tmp_path}/picture.png")
    _textured(image)
    for space, srgb in (("sRGB", True), ("Non-Color", False), ("Linear Rec.709", False)):
        image.colorspace_settings.name = space
        (texture,) = stage.exported().textures
        assert texture.srgb == srgb
        assert np.allclose(texture.pixels[..., :3] / 255, COLORS, atol=0.003), space


@in_blender
def test_missing_image_names_image_and_material(tmp_path: str) -> None:
    import bpy

    image = _four_colors("Lost")
    image.filepath_raw, image.file_format = f"{tmp_path}/lost.png", "PNG"
    image.save()
    bpy.data.images.remove(image)
    image = bpy.data.images.load(f"{tmp_path}/lost.png")
    Path(tmp_path, "lost.png").unlink()
    image.reload()
    _textured(image)
    what = stage.exported()
    said = stage.the_one_warning(what)
    assert (
        said == f"Material 'Painted', node 'Image Texture': image 'lost.png': {tmp_path}/lost.png "
        "cannot be read; shown in pink"
    )
    assert what.textures[0].pixels[0, 0].tolist() == [255, 0, 255, 255]


@in_blender
def test_an_image_texture_without_image() -> None:
    _textured(None)
    said = stage.the_one_warning(stage.exported())
    assert (
        said
        == "Material 'Painted', node 'Image Texture': an image texture has no image; shown in pink"
    )


@in_blender
def test_interpolation_extension_and_one_texture_for_both_uses() -> None:
    image = _four_colors("Made")
    tree = _textured(image)
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    texture.interpolation, texture.extension = "Closest", "CLIP"
    _textured(image, "Second")
    _textured(image, "Third")
    what = stage.exported()
    assert [(t.interpolation, t.extension) for t in what.textures] == [
        ("closest", "clip"),
        ("linear", "repeat"),
    ]


@pytest.mark.smoke
@in_blender
def test_principled_base_colour_and_emission() -> None:
    made, tree = stage.empty_material("Plastic")
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = (0.25, 0.5, 0.75, 1)
    shader.inputs["Emission Color"].default_value = (1, 0.5, 0, 1)
    shader.inputs["Emission Strength"].default_value = 4
    shader.inputs["Specular IOR Level"].default_value = 0
    stage.surface(tree, shader)
    stage.plane().data.materials[0] = made
    what = stage.exported()
    assert what.materials[0].front.base_color == (0.25, 0.5, 0.75)
    assert what.materials[0].front.emission == (4, 2, 0)
    assert what.materials[0].back == what.materials[0].front
    assert what.warnings == []


@pytest.mark.smoke
@in_blender
def test_backfacing_gives_each_side_its_own() -> None:
    made, tree = stage.empty_material("Two sides")
    mix, geometry = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeNewGeometry")
    front, back = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    front.inputs["Strength"].default_value = 3
    back.inputs["Color"].default_value = (0.25, 0.25, 0.25, 1)
    tree.links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    tree.links.new(front.outputs[0], mix.inputs[1])
    tree.links.new(back.outputs[0], mix.inputs[2])
    stage.surface(tree, mix)
    stage.plane().data.materials[0] = made
    what = stage.exported()
    material = what.materials[0]
    assert (material.front.emission, material.front.base_color) == ((3, 3, 3), (0, 0, 0))
    assert (material.back.emission, material.back.base_color) == ((0, 0, 0), (0.25, 0.25, 0.25))
    assert what.warnings == []


@in_blender
def test_mix_and_add_of_shaders_and_colours() -> None:
    made, tree = stage.empty_material("Mixed")
    add, mix = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new("ShaderNodeMixShader")
    one, two, glow = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "BsdfDiffuse", "Emission")
    )
    blend = tree.nodes.new("ShaderNodeMix")
    blend.data_type, blend.blend_type = "RGBA", "MULTIPLY"
    factor, a, b = (
        next(s for s in blend.inputs if s.identifier == name)
        for name in ("Factor_Float", "A_Color", "B_Color")
    )
    factor.default_value, a.default_value, b.default_value = 1.0, (0.5, 0.5, 0.5, 1), (0.5, 1, 0, 1)
    tree.links.new(
        next(s for s in blend.outputs if s.identifier == "Result_Color"), one.inputs["Color"]
    )
    two.inputs["Color"].default_value = (0, 0, 0, 1)
    mix.inputs[0].default_value = 0.25
    for shader, target in (
        (one, mix.inputs[1]),
        (two, mix.inputs[2]),
        (mix, add.inputs[0]),
        (glow, add.inputs[1]),
    ):
        tree.links.new(shader.outputs[0], target)
    stage.surface(tree, add)
    stage.plane().data.materials[0] = made
    what = stage.exported()
    assert np.allclose(what.materials[0].front.base_color, np.array((0.25, 0.5, 0)) * 0.75)
    assert what.materials[0].front.emission == (1, 1, 1)
    assert what.warnings == []


@in_blender
def test_groups_reroutes_and_muted_nodes() -> None:
    import bpy

    group = bpy.data.node_groups.new("Paint", "ShaderNodeTree")
    group.interface.new_socket("Tone", in_out="INPUT", socket_type="NodeSocketColor")
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    given, inner, ending = (
        group.nodes.new(kind)
        for kind in ("NodeGroupInput", "ShaderNodeBsdfDiffuse", "NodeGroupOutput")
    )
    group.links.new(given.outputs[0], inner.inputs["Color"])
    group.links.new(inner.outputs[0], ending.inputs[0])
    made, tree = stage.empty_material("Grouped")
    used = tree.nodes.new("ShaderNodeGroup")
    used.node_tree = group
    color, reroute, muted = (
        tree.nodes.new(kind) for kind in ("ShaderNodeRGB", "NodeReroute", "ShaderNodeInvert")
    )
    color.outputs[0].default_value = (0.125, 0.25, 0.5, 1)
    muted.mute = True
    tree.links.new(color.outputs[0], muted.inputs["Color"])
    tree.links.new(muted.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], used.inputs["Tone"])
    stage.surface(tree, used)
    stage.plane().data.materials[0] = made
    what = stage.exported()
    assert what.materials[0].front.base_color == (0.125, 0.25, 0.5)
    assert what.warnings == []


@in_blender
def test_what_is_more_than_lambert_becomes_a_program() -> None:
    glossy = stage.material("Mirror", (0.75, 0.5, 0.25), "ShaderNodeBsdfAnisotropic")
    noisy, tree = stage.empty_material("Noisy")
    shader, noise = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs["Color"], shader.inputs["Color"])
    stage.surface(tree, shader)
    plastic, tree = stage.empty_material("Plastic")
    stage.surface(tree, tree.nodes.new("ShaderNodeBsdfPrincipled"))
    glowing, tree = stage.empty_material("Glowing")
    glow, wave = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexWave")
    tree.links.new(wave.outputs["Color"], glow.inputs["Color"])
    stage.surface(tree, glow)
    for k, made in enumerate((glossy, noisy, plastic, glowing)):
        stage.plane(f"P{k}").data.materials[0] = made
    what = stage.exported()
    features = [what.programs[material.program].features for material in what.materials]
    assert features == [
        Feature.REST,
        Feature.GATHERS,
        Feature.GATHERS | Feature.REST,
        Feature.EMITS,
    ]
    assert what.warnings == []


@in_blender
def test_features_of_programs() -> None:
    def principled(**inputs: float) -> Feature:
        made, tree = stage.empty_material("Made")
        shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
        for name, value in inputs.items():
            shader.inputs[name.replace("_", " ")].default_value = value
        stage.surface(tree, shader)
        ob.data.materials[0] = made
        what = stage.exported()
        return what.programs[what.materials[0].program].features

    ob = stage.plane()
    matte = Feature.GATHERS | Feature.REST
    assert principled(Roughness=0.2) == matte | Feature.SHARP
    assert principled(Coat_Weight=1.0, Coat_Roughness=0.0) == matte | Feature.SHARP
    assert principled(Metallic=1.0) == Feature.REST
    assert principled(Subsurface_Weight=0.5) == matte | Feature.SUBSURFACE
    assert principled(Subsurface_Weight=0.5, Specular_IOR_Level=0.0) & Feature.SUBSURFACE
    assert principled(Alpha=0.5) == matte | Feature.TRANSPARENT
    assert principled(Emission_Strength=2.0) == matte | Feature.EMITS | Feature.CONSTANT_EMISSION
    assert (
        principled(Emission_Strength=2.0, Coat_Weight=0.5)
        & (Feature.EMITS | Feature.CONSTANT_EMISSION)
        == Feature.EMITS
    )


@in_blender
def test_only_what_programs_ask_for_is_exported() -> None:
    ob = stage.plane()
    mesh = ob.data
    mesh.uv_layers.new(name="UV")
    mesh.uv_layers.new(name="Other")
    mesh.color_attributes.new("Tone", "BYTE_COLOR", "CORNER")
    made, tree = stage.empty_material("Plain")
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    stage.surface(tree, shader)
    mesh.materials[0] = made
    what = stage.exported()
    assert (
        what.meshes[0].shading.attributes,
        what.meshes[0].shading.generated,
        what.instances.attributes,
    ) == ([], None, [])
    tone, other, info = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("VertexColor", "UVMap", "ObjectInfo")
    )
    tone.layer_name, other.uv_map = "Tone", "Other"
    for source, target in (
        (tone.outputs["Color"], "Base Color"),
        (other.outputs[0], "Specular Tint"),
        (info.outputs["Random"], "Roughness"),
    ):
        tree.links.new(source, shader.inputs[target])
    what = stage.exported()
    assert sorted((str(a.domain), a.values.shape) for a in what.meshes[0].shading.attributes) == [
        ("corner", (6, 2)),
        ("corner", (6, 4)),
    ]
    assert [a.values.shape for a in what.instances.attributes] == [(1, 1)]
    assert what.meshes[0].shading.generated is None


@in_blender
def test_meshes_have_only_what_their_own_materials_ask_for() -> None:
    """A mesh that stands in two places has what the materials of both ask for."""
    import bpy

    def asking(name: str) -> Any:
        made, tree = stage.empty_material(f"Asks for {name}")
        shader, asked = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeAttribute")
        asked.attribute_name = name
        tree.links.new(asked.outputs["Color"], shader.inputs["Color"])
        stage.surface(tree, shader)
        return made

    one, two, plain = (stage.plane(name) for name in ("One", "Two", "Plain"))
    for ob in (one, two, plain):
        for name in ("A", "B", "C"):
            ob.data.attributes.new(name, "FLOAT_COLOR", "POINT")
    one.data.materials[0] = asking("A")
    two.data.materials[0] = asking("B")
    other = bpy.data.objects.new("Other", one.data)
    stage.scene().collection.objects.link(other)
    other.material_slots[0].link = "OBJECT"
    other.material_slots[0].material = asking("C")
    what = stage.exported()
    by_owner = dict(zip(what.instances.owners, what.instances.mesh, strict=True))
    found = {owner: len(what.meshes[mesh].shading.attributes) for owner, mesh in by_owner.items()}
    assert found == {"One": 2, "Other": 2, "Two": 1, "Plain": 0}


@pytest.mark.parametrize("by", ["ObjectInfo", "Attribute"])
@in_blender
def test_instances_have_the_colour_of_what_makes_them(by: str) -> None:
    """As in Cycles: of the outermost of all that make them; their index is their own."""
    import bpy

    made, tree = stage.empty_material("Asks")
    shader, info, asked = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "ObjectInfo", by)
    )
    if by == "Attribute":
        asked.attribute_type, asked.attribute_name = "OBJECT", "color"
    tree.links.new(asked.outputs["Color"], shader.inputs["Color"])
    tree.links.new(info.outputs["Object Index"], shader.inputs["Strength"])
    stage.surface(tree, shader)

    def collection(name: str, *things: Any) -> Any:
        kept = bpy.data.collections.new(name)
        for thing in things:
            kept.objects.link(thing)
        return kept

    def maker(name: str, of: Any, color: Any) -> Any:
        empty = bpy.data.objects.new(name, None)
        empty.instance_type, empty.instance_collection = "COLLECTION", of
        empty.color, empty.pass_index = color, 9
        return empty

    ob = stage.plane()
    ob.data.materials[0] = made
    ob.color, ob.pass_index = (1, 0, 0, 0.5), 4
    inner = maker("Inner", collection("A", ob), (0, 1, 0, 1))
    outer = maker("Outer", collection("B", inner), (0, 0, 1, 1))
    stage.scene().collection.objects.link(outer)
    stage.scene().collection.objects.link(inner)
    found = {a.values.shape[1]: a.values for a in stage.exported().instances.attributes}
    assert sorted(map(tuple, found[4].tolist())) == [(0, 0, 1, 1), (0, 1, 0, 1), (1, 0, 0, 0.5)]
    assert found[1].tolist() == [[4.0]] * 3


@in_blender
def test_no_material_and_an_empty_slot() -> None:
    import bpy

    ob = stage.plane()
    ob.data.materials.clear()
    for k in range(2):
        if k:
            ob.data.materials.append(None)
        what = stage.exported()
        if bpy.app.version >= (5, 0, 0):
            assert (
                what.programs[what.materials[0].program].features == Feature.GATHERS | Feature.REST
            )
        else:
            assert np.allclose(what.materials[0].front.base_color, 0.8)
        assert what.warnings == []


@in_blender
def test_values_that_are_no_colour() -> None:
    made = stage.material("Cursed")
    made.node_tree.nodes["Diffuse BSDF"].inputs["Color"].default_value = (float("nan"), 0.5, 0.5, 1)
    negative = stage.material("Negative")
    difference = negative.node_tree.nodes.new("ShaderNodeMix")
    difference.data_type, difference.blend_type = "RGBA", "SUBTRACT"
    for name, value in (
        ("Factor_Float", 1.0),
        ("A_Color", (0.5, 0.5, 0.5, 1)),
        ("B_Color", (0, 1, 0, 1)),
    ):
        next(
            socket for socket in difference.inputs if socket.identifier == name
        ).default_value = value
    result = next(socket for socket in difference.outputs if socket.identifier == "Result_Color")
    negative.node_tree.links.new(result, negative.node_tree.nodes["Diffuse BSDF"].inputs["Color"])
    for k, material in enumerate((made, negative)):
        stage.plane(f"P{k}").data.materials[0] = material
    what = stage.exported()
    assert [m.front.base_color for m in what.materials] == [(0, 0.5, 0.5), (0.5, 0, 0.5)]
    assert what.warnings == [
        "Material 'Cursed', node 'Diffuse BSDF': its Color is not a finite number; taken as 0",
        "Material 'Negative': negative colours are taken as 0",
    ]


@in_blender
def test_material_override_of_a_view_layer() -> None:
    stage.plane().data.materials[0] = stage.material("Own", (0.25, 0, 0))
    stage.scene().view_layers[0].material_override = stage.material("Clay", (0.5, 0.5, 0.5))
    assert [material.name for material in stage.exported().materials] == ["Clay"]


@in_blender
def test_world_and_lamp_nodes() -> None:
    stage.world(0.25)
    lamp = stage.lamp(energy=10)
    lamp.data.color = (1, 0.5, 0)
    what = stage.exported()
    assert what.world == (0.25, 0.25, 0.25)
    assert np.allclose(what.lights[0].strength, (10, 5, 0))


@in_blender
def test_nested_mixes_of_one_source_are_looked_at_once_each() -> None:
    """Sixty in a row, each with the one before on both inputs: a walk that looks at both would
    never end.
    """
    import bpy

    tree = _textured(_four_colors("Made"))
    shader, texture = (
        next(node for node in tree.nodes if node.type == kind)
        for kind in ("BSDF_DIFFUSE", "TEX_IMAGE")
    )
    last = texture.outputs["Color"]
    for _ in range(60):
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type = "RGBA"
        for name in ("A_Color", "B_Color"):
            tree.links.new(last, next(socket for socket in mix.inputs if socket.identifier == name))
        last = next(socket for socket in mix.outputs if socket.identifier == "Result_Color")
    tree.links.new(last, shader.inputs["Color"])
    bpy.context.view_layer.update()
    side = stage.exported().materials[0].front
    assert side.base_color_texture == 0
    assert np.allclose(side.base_color, 1.0)


def _two_colors(tree: Any, output: str, red: str, green: str) -> None:
    """Two output nodes of a kind in an empty tree, the first of which is active: red light for the
    renderer `red`, green light.
    """
    tree.nodes.clear()
    for target, color in ((red, (1, 0, 0, 1)), (green, (0, 1, 0, 1))):
        ending, emission = tree.nodes.new(output), tree.nodes.new("ShaderNodeEmission")
        ending.target = target
        emission.inputs["Color"].default_value = color
        tree.links.new(emission.outputs[0], ending.inputs["Surface"])
    next(node for node in tree.nodes if node.bl_idname == output).is_active_output = True


# As in Cycles: its own output, active or not; else that of all renderers.
OUTPUTS = [
    ("ALL", "CYCLES", "green"),
    ("EEVEE", "CYCLES", "green"),
    ("CYCLES", "ALL", "red"),
    ("EEVEE", "ALL", "green"),
    ("ALL", "EEVEE", "red"),
]


@pytest.mark.parametrize(("red", "green", "expected"), OUTPUTS)
@in_blender
def test_the_output_is_that_of_cycles(red: str, green: str, expected: str) -> None:
    import bpy

    made, tree = stage.empty_material("Two outputs")
    _two_colors(tree, "ShaderNodeOutputMaterial", red, green)
    stage.plane().data.materials[0] = made
    stage.world(1.0)
    _two_colors(stage.scene().world.node_tree, "ShaderNodeOutputWorld", red, green)
    lamp = stage.lamp()
    if bpy.app.version < (5, 0, 0):
        lamp.data.use_nodes = True
    _two_colors(lamp.data.node_tree, "ShaderNodeOutputLight", red, green)
    what = stage.exported()
    color = np.array((1.0, 0.0, 0.0) if expected == "red" else (0.0, 1.0, 0.0))
    assert np.allclose(what.materials[0].front.emission, color)
    assert np.allclose(what.world, color)
    assert np.allclose(what.lights[0].strength, color * 100.0)
    assert what.warnings == []


@in_blender
def test_an_output_for_another_renderer_alone_is_black_and_named() -> None:
    made, tree = stage.empty_material("Viewport only")
    _two_colors(tree, "ShaderNodeOutputMaterial", "EEVEE", "EEVEE")
    stage.plane().data.materials[0] = made
    what = stage.exported()
    assert what.materials[0].front.emission == (0.0, 0.0, 0.0)
    assert what.materials[0].front.base_color == (0.0, 0.0, 0.0)
    assert "'Viewport only': its only output is for another renderer" in stage.the_one_warning(what)


def _beside_a_volume(surface: str) -> Any:
    """A material with a volume, whose surface is `surface`."""
    made, tree = stage.empty_material("Fog")
    output = tree.nodes["Material Output"]
    tree.links.new(tree.nodes.new("ShaderNodeVolumePrincipled").outputs[0], output.inputs["Volume"])
    if surface:
        node = tree.nodes.new("ShaderNode" + surface)
        if surface == "Emission":
            node.inputs["Strength"].default_value = 0.0
        tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


# What Cycles lets pass and what it does not.
@pytest.mark.parametrize(
    ("surface", "clear"),
    [
        ("", True),
        ("AddShader", True),
        ("Emission", True),
        ("BsdfDiffuse", False),
        ("VolumeScatter", False),
    ],
)
@in_blender
def test_a_volume_without_surface_is_clear(surface: str, clear: bool) -> None:
    stage.plane().data.materials[0] = _beside_a_volume(surface)
    what = stage.exported()
    found = what.materials[0]
    assert (found.program >= 0) == clear
    if clear:
        assert what.programs[found.program].features == Feature.TRANSPARENT
    assert what.programs[found.volume].name == "volume of Fog"
    assert not any("left out" in warning for warning in what.warnings if clear)


@in_blender
def test_a_medium_that_hides_from_what_it_scatters_is_named() -> None:
    shown, hidden = stage.plane("Shown"), stage.plane("Hidden")
    shown.visible_diffuse = False
    hidden.visible_volume_scatter = False
    stage.plane("Dry").visible_volume_scatter = False
    shown.data.materials[0] = hidden.data.materials[0] = _beside_a_volume("")
    said = [text for text in stage.exported().warnings if "hides from volume rays" in text]
    assert len(said) == 1
    assert said[0].endswith(": 'Hidden'")


@in_blender
def test_a_material_of_nothing_is_black() -> None:
    made, _ = stage.empty_material("Nothing")
    stage.plane().data.materials[0] = made
    what = stage.exported()
    assert (what.materials[0].program, what.materials[0].front.base_color) == (-1, (0.0, 0.0, 0.0))


def _textured_file(path: Path, pixels: np.ndarray, kind: str, alpha: bool = False) -> Any:
    """A file of `pixels` (straight alpha) as the texture of a diffuse material, whose alpha
    somebody asks for; returns the image.
    """
    import bpy
    import OpenImageIO as oiio

    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
    spec["oiio:UnassociatedAlpha"] = 1
    file = oiio.ImageOutput.create(str(path))
    file.open(str(path), spec)
    file.write_image(np.ascontiguousarray(pixels, np.float32))
    file.close()
    image = bpy.data.images.load(str(path))
    tree = _textured(image)
    if alpha:
        texture, shader = (
            next(node for node in tree.nodes if node.type == kind)
            for kind in ("TEX_IMAGE", "BSDF_DIFFUSE")
        )
        tree.links.new(texture.outputs["Alpha"], shader.inputs["Roughness"])
    return image


ENCODED = np.array([[[0.8, 0.4, 0.2, 0.5]]], np.float32)


@pytest.mark.parametrize("alpha", [False, True])
@in_blender
def test_sixteen_bits_are_multiplied_before_they_are_decoded(tmp_path: str, alpha: bool) -> None:
    """As in Cycles, which decodes them after they are interpolated; a tree that asks for the alpha
    takes that off first.
    """
    _textured_file(Path(tmp_path, "sixteen.png"), ENCODED, "uint16", alpha)
    (texture,) = stage.exported().textures
    assert texture.srgb
    assert np.allclose(texture.pixels[0, 0], (0.4, 0.2, 0.1, 0.5), atol=1e-4)


@in_blender
def test_grey_files_with_alpha_are_not_multiplied(tmp_path: str) -> None:
    """As in Cycles."""
    _textured_file(Path(tmp_path, "grey.png"), ENCODED[..., [0, 3]], "uint8")
    (texture,) = stage.exported().textures
    assert np.allclose(texture.pixels[0, 0] / 255, (0.8, 0.8, 0.8, 0.5), atol=3e-3)


# Of encoded 0.8, 0.4, 0.2, as Cycles shows them.
SPACES = {
    "ACEScg": (1.0986, 0.3499, 0.1598),
    "Linear Rec.2020": (1.0781, 0.3518, 0.1689),
    "Filmic Log": (1.6504, 0.017, 0.0017),
}


@pytest.mark.parametrize("space", SPACES)
@in_blender
def test_color_spaces(tmp_path: str, space: str) -> None:
    import bpy

    image = _textured_file(Path(tmp_path, "space.png"), ENCODED[..., :3], "uint8")
    if space not in image.colorspace_settings.bl_rna.properties["name"].enum_items:
        return  # not in this version of Blender
    image.colorspace_settings.name = space
    what = stage.exported()
    (texture,) = what.textures
    assert not texture.srgb
    assert np.allclose(texture.pixels[0, 0, :3], SPACES[space], rtol=0.01, atol=2e-3), (
        texture.pixels,
        bpy.app.version,
    )
    assert what.warnings == []


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND", "CLIP", "MIRROR"])
@in_blender
def test_a_missing_image_is_pink_everywhere(extension: str) -> None:
    import bpy

    gone = bpy.data.images.new("Gone", 4, 4)
    gone.source, gone.filepath = "FILE", "//gone.png"
    tree = _textured(gone)
    next(node for node in tree.nodes if node.type == "TEX_IMAGE").extension = extension
    (texture,) = stage.exported().textures
    assert texture.extension == "extend"


@in_blender
def test_a_sequence_shows_the_frame_of_its_user(tmp_path: str) -> None:
    """Start, offset, length and repetition as Blender has them."""
    for k in range(1, 6):
        image = _textured_file(
            Path(tmp_path, f"seen_{k:04}.png"), np.full((1, 1, 3), k / 10, np.float32), "uint8"
        )
    tree = stage.scene().objects["Canvas.004"].data.materials[0].node_tree
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    image.source = "SEQUENCE"
    user = texture.image_user
    for at, settings, shown in (
        (3, {}, 3),
        (9, {}, 5),
        (3, {"frame_offset": 1}, 4),
        (3, {"frame_offset": 0, "frame_start": 2}, 2),
        (7, {"frame_start": 1, "use_cyclic": True}, 2),
        (7, {"use_cyclic": False, "frame_duration": 3}, 3),
    ):
        user.frame_duration = 5
        for name, value in settings.items():
            setattr(user, name, value)
        stage.scene().frame_set(at)
        found = stage.exported().textures[-1]
        assert np.allclose(found.pixels[0, 0, :3] / 255, shown / 10, atol=3e-3), (at, settings)


@pytest.mark.parametrize("kind", ["Transparent", "Principled"])
@in_blender
def test_shadows_may_be_told_to_be_opaque(kind: str) -> None:
    """Transparent Shadows of a material: off, shadow rays do not pass, and all others do, as in
    Cycles.
    """
    from photon_splat.core.native import library as native
    from photon_splat.core.native.fill import fill_renderer
    from photon_splat.core.render.settings import RenderSettings

    made, tree = stage.empty_material("Pane")
    if not hasattr(made, "use_transparent_shadow"):
        return
    shader = tree.nodes.new(f"ShaderNodeBsdf{kind}")
    shader.inputs["Color" if kind == "Transparent" else "Alpha"].default_value = (
        (0.5, 0.5, 0.5, 1) if kind == "Transparent" else 0.5
    )
    stage.surface(tree, shader)
    stage.plane().data.materials[0] = made
    found = {}
    for on in (True, False):
        made.use_transparent_shadow = on
        renderer = native.load().Renderer(1)
        fill_renderer(renderer, stage.exported(), RenderSettings())
        renderer.build()
        place, down = np.array([[0.1, 0.2, 1]], np.float32), np.array([[0, 0, -1]], np.float32)
        found[on] = [
            float(renderer.shade_rays(place, down, kind=ray)["transparency"][0, 0])
            for ray in ("shadow", "camera")
        ]
    assert np.allclose(found[True], (0.5, 0.5), atol=0.01)
    assert np.allclose(found[False], (0.0, 0.5), atol=0.01)


@in_blender
def test_packed_tiles(tmp_path: str) -> None:
    """Those of a UDIM image, whose files are gone; and one that never was is pink."""
    for number in (1001, 1002):
        image = _textured_file(
            Path(tmp_path, f"tile.{number}.png"),
            np.full((1, 1, 3), (number - 1000) / 10, np.float32),
            "uint8",
        )
    image.source, image.filepath = "TILED", str(Path(tmp_path, "tile.<UDIM>.png"))
    image.tiles[0].number = 1001
    image.tiles.new(1002)
    image.pack()
    for file in Path(tmp_path).glob("tile.*.png"):
        file.unlink()
    image.tiles.new(1003)
    what = stage.exported()
    shown = [tuple(texture.pixels[0, 0, :3]) for texture in what.textures]
    assert (26, 26, 26) in shown
    assert (51, 51, 51) in shown
    assert (255, 0, 255) in shown
    assert any("1003" in warning for warning in what.warnings)


@in_blender
def test_subsurface_methods() -> None:
    """Blender before 5.2 means the older walk by Random Walk, and scatters forwards only."""
    from photon_splat.export.nodes.values import CONSTANT_BIT, operations

    ob = stage.plane()
    modes = operations()["Subsurface"].operands[-1].modes
    for node_type, setting, anisotropy, place in (
        ("ShaderNodeSubsurfaceScattering", "falloff", "Anisotropy", -2),
        # Thin Wall comes after it
        ("ShaderNodeBsdfPrincipled", "subsurface_method", "Subsurface Anisotropy", -3),
    ):
        made, tree = stage.empty_material("Made")
        shader = tree.nodes.new(node_type)
        shader.inputs[anisotropy].default_value = -0.5
        if node_type == "ShaderNodeBsdfPrincipled":
            shader.inputs["Subsurface Weight"].default_value = 1.0
        stage.surface(tree, shader)
        ob.data.materials[0] = made
        methods = shader.bl_rna.properties[setting].enum_items.keys()
        older = "RANDOM_WALK_LEGACY" not in methods
        for method in methods:
            setattr(shader, setting, method)
            what = stage.exported()
            program = what.programs[what.materials[0].program]
            assert program.features & Feature.SUBSURFACE
            code = program.code.tolist()
            expected = "RANDOM_WALK_LEGACY" if older and method == "RANDOM_WALK" else method
            assert code[place] == modes.index(expected), method
            cosine = program.constants[code[place - 1] - CONSTANT_BIT]
            assert cosine == (0.0 if older else -0.5)
            assert what.warnings == []


@in_blender
def test_thin_walls_of_smooth_glass_let_light_straight_through() -> None:
    made, tree = stage.empty_material("Pane")
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    if "Thin Wall" not in shader.inputs:  # before Blender 5.2
        return
    stage.surface(tree, shader)
    stage.plane().data.materials[0] = made
    shader.inputs["Transmission Weight"].default_value = 1.0
    straight = []
    for thin, roughness in ((False, 0.0), (True, 0.0), (True, 0.5)):
        shader.inputs["Thin Wall"].default_value = thin
        shader.inputs["Roughness"].default_value = roughness
        what = stage.exported()
        assert what.warnings == []
        straight.append(bool(what.programs[0].features & Feature.TRANSPARENT))
    assert straight == [False, True, False]


@in_blender
def test_glass_that_shadow_rays_pass_is_named() -> None:
    """Light gets through it twice: straight, and as a caustic."""
    plane = stage.plane("Pane")
    for name, shader, named in (
        ("Window", "ShaderNodeBsdfGlass", True),
        ("Curtain", "ShaderNodeBsdfDiffuse", False),
    ):
        made, tree = stage.empty_material(name)
        path, mix, clear, other = (
            tree.nodes.new(kind)
            for kind in ("ShaderNodeLightPath", "ShaderNodeMixShader", TRANSPARENT, shader)
        )
        tree.links.new(path.outputs["Is Shadow Ray"], mix.inputs[0])
        tree.links.new(other.outputs[0], mix.inputs[1])
        tree.links.new(clear.outputs[0], mix.inputs[2])
        stage.surface(tree, mix)
        plane.data.materials[0] = made
        warnings = stage.exported().warnings
        assert len(warnings) == named
        assert all(name in warning and "caustic" in warning for warning in warnings)
        made.use_transparent_shadow = False  # then no shadow ray passes
        assert stage.exported().warnings == []
