"""Cases of textures."""

from __future__ import annotations

import tempfile
from typing import Any

import numpy as np

from tests.reference.nodes.cases import Case, Sources, enum, exists, since


def cases() -> list[Case]:
    found = [*_noises(), *_voronois(), *_waves(), *_patterns(), *_images(), *_environments()]
    found += [
        Case(f"image tiles {thing}", "ShaderNodeTexImage", "Color", build=_tiled, thing=thing)
        for thing in ("plane", "sphere")
    ]
    found += [
        Case(f"IES {name}", "ShaderNodeTexIES", "Fac", given, {"Strength": 0.2, "Vector": "p"})
        for name, given in (
            ("without text", {"mode": "INTERNAL"}),
            ("without file", {"mode": "EXTERNAL"}),
            ("of no such file", {"mode": "EXTERNAL", "filepath": "//none.ies"}),
        )
    ]
    return found + (_gabors() if exists("ShaderNodeTexGabor") else [])


def _noises() -> list[Case]:
    found = []
    for dimensions in ("1D", "2D", "3D", "4D"):
        for kind in enum("ShaderNodeTexNoise", "noise_type"):
            inputs = {
                "Vector": "p",
                "W": "y",
                "Scale": 1.7,
                "Detail": 2.4,
                "Roughness": 0.6,
                "Lacunarity": 2.1,
                "Offset": 0.6,
                "Gain": 1.4,
            }
            properties = {"noise_dimensions": dimensions, "noise_type": kind}
            found.append(
                Case(
                    f"noise {dimensions} {kind}",
                    "ShaderNodeTexNoise",
                    "Fac",
                    properties,
                    inputs,
                    noise=True,
                )
            )
        inputs = {"Vector": "p", "W": "x", "Scale": 1.3, "Detail": 3.0, "Distortion": 0.8}
        properties = {"noise_dimensions": dimensions, "normalize": False}
        found.append(
            Case(
                f"noise {dimensions} color",
                "ShaderNodeTexNoise",
                "Color",
                properties,
                inputs,
                noise=True,
            )
        )
    sweeps: list[dict[str, Any]] = [
        {"Detail": 0.0},
        {"Detail": "u", "Roughness": "v"},
        {"Lacunarity": "y", "Detail": 4.0},
        {"Scale": "x"},
        {"Roughness": 0.0, "Detail": 5.0},
        {"Detail": 20.0},
        {"Distortion": "x"},
    ]
    for k, inputs in enumerate(sweeps):
        found.append(
            Case(
                f"noise sweep {k}",
                "ShaderNodeTexNoise",
                "Fac",
                inputs={"Vector": "p", "Scale": 1.5} | inputs,
                noise=True,
            )
        )
    found.append(
        Case(
            "noise on a sphere",
            "ShaderNodeTexNoise",
            "Color",
            inputs={"Scale": 3.0},
            thing="sphere",
            noise=True,
        )
    )
    for dimensions in ("1D", "2D", "3D", "4D"):
        inputs = {"Vector": "s", "W": "t"}
        found += [
            Case(
                f"white noise {dimensions} {output}",
                "ShaderNodeTexWhiteNoise",
                output,
                {"noise_dimensions": dimensions},
                inputs,
                noise=True,
            )
            for output in ("Value", "Color")
        ]
    found.append(Case("white noise alone", "ShaderNodeTexWhiteNoise", "Color", noise=True))
    return found


def _voronois() -> list[Case]:
    found = []
    node = "ShaderNodeTexVoronoi"
    base = {
        "Vector": "p",
        "W": "y",
        "Scale": 1.6,
        "Randomness": 0.9,
        "Smoothness": 0.5,
        "Exponent": 1.5,
    }
    for dimensions in ("1D", "2D", "3D", "4D"):
        for feature in enum(node, "feature"):
            metrics = (
                ("EUCLIDEAN",)
                if feature in {"DISTANCE_TO_EDGE", "N_SPHERE_RADIUS"}
                else tuple(enum(node, "distance"))
            )
            for metric in metrics if dimensions in {"2D", "3D"} else metrics[:1]:
                properties = {
                    "voronoi_dimensions": dimensions,
                    "feature": feature,
                    "distance": metric,
                }
                output = "Radius" if feature == "N_SPHERE_RADIUS" else "Distance"
                found.append(
                    Case(
                        f"voronoi {dimensions} {feature} {metric}",
                        node,
                        output,
                        properties,
                        base,
                        noise=True,
                    )
                )
            if feature in {"F1", "F2", "SMOOTH_F1"}:
                properties = {"voronoi_dimensions": dimensions, "feature": feature}
                outputs = (
                    ["Color"]
                    + (["Position"] if dimensions != "1D" else [])
                    + (["W"] if dimensions in {"1D", "4D"} else [])
                )
                found += [
                    Case(
                        f"voronoi {dimensions} {feature} {o}", node, o, properties, base, noise=True
                    )
                    for o in outputs
                ]
            if feature not in {"DISTANCE_TO_EDGE", "N_SPHERE_RADIUS"} or (
                feature == "DISTANCE_TO_EDGE"
            ):
                properties = {
                    "voronoi_dimensions": dimensions,
                    "feature": feature,
                    "normalize": True,
                }
                inputs = base | {"Detail": 2.5, "Roughness": 0.4, "Lacunarity": 2.2}
                found.append(
                    Case(
                        f"voronoi {dimensions} {feature} fractal",
                        node,
                        "Distance",
                        properties,
                        inputs,
                        noise=True,
                    )
                )
    for k, inputs in enumerate(
        (
            {"Randomness": "u"},
            {"Smoothness": "v"},
            {"Exponent": "y"},
            {"Randomness": 0.0},
            {"Scale": "x"},
        )
    ):
        properties = {
            "feature": "SMOOTH_F1" if k == 1 else "F1",
            "distance": "MINKOWSKI" if k == 2 else "EUCLIDEAN",
        }
        found.append(
            Case(f"voronoi sweep {k}", node, "Distance", properties, base | inputs, noise=True)
        )
    # Cycles of Blender 4.5 rounds other places in one cell of twenty
    for dimensions in ("2D", "3D", "4D") if since(5, 0) else ():
        for feature in ("F1", "F2"):
            properties = {"voronoi_dimensions": dimensions, "feature": feature}
            cells = Case("", node, "Position", properties, base)
            found.append(
                Case(
                    f"voronoi {dimensions} {feature} cells at random",
                    "",
                    "",
                    build=lambda tree, cells=cells: _at_random(tree, cells),
                )
            )
    return found


def _at_random(tree: Any, cells: Case) -> Any:
    """White noise of a position, which tells its last bit."""
    noise = tree.nodes.new("ShaderNodeTexWhiteNoise")
    tree.links.new(cells.make(tree), noise.inputs["Vector"])
    return noise.outputs["Color"]


def _waves() -> list[Case]:
    found = []
    node = "ShaderNodeTexWave"
    for profile in enum(node, "wave_profile"):
        for kind, name in (("BANDS", "bands_direction"), ("RINGS", "rings_direction")):
            for direction in enum(node, name):
                properties = {"wave_type": kind, name: direction, "wave_profile": profile}
                inputs = {"Vector": "p", "Scale": 1.3, "Phase Offset": 0.7}
                found.append(
                    Case(f"wave {profile} {kind} {direction}", node, "Fac", properties, inputs)
                )
    inputs = {
        "Vector": "p",
        "Distortion": 2.0,
        "Detail": 2.5,
        "Detail Scale": 1.5,
        "Detail Roughness": 0.6,
    }
    found.append(Case("wave distorted", node, "Color", inputs=inputs | {"Scale": 1.0}, noise=True))
    found.append(
        Case(
            "wave swept",
            node,
            "Color",
            inputs=inputs | {"Scale": "u", "Phase Offset": "y"},
            noise=True,
        )
    )
    return found


def _patterns() -> list[Case]:
    kinds = enum("ShaderNodeTexGradient", "gradient_type")
    found = [
        Case(
            f"gradient {kind}",
            "ShaderNodeTexGradient",
            "Fac",
            {"gradient_type": kind},
            {"Vector": "p"},
        )
        for kind in kinds
    ]
    found.append(Case("gradient generated", "ShaderNodeTexGradient", "Color", thing="sphere"))
    for depth in range(11):
        properties = {"turbulence_depth": depth}
        found.append(
            Case(
                f"magic {depth}",
                "ShaderNodeTexMagic",
                "Color",
                properties,
                {"Vector": "p", "Scale": 1.7, "Distortion": 1.3},
            )
        )
    found.append(
        Case(
            "magic fac",
            "ShaderNodeTexMagic",
            "Fac",
            inputs={"Vector": "p", "Scale": "x", "Distortion": "y"},
        )
    )
    colors = {"Color1": "c", "Color2": (0.9, 0.1, 0.3, 1.0)}
    for output in ("Color", "Fac"):
        found.append(
            Case(
                f"checker {output}",
                "ShaderNodeTexChecker",
                output,
                inputs={"Vector": "p", "Scale": 1.7} | colors,
            )
        )
        sizes = {
            "Scale": 1.3,
            "Mortar Size": 0.05,
            "Mortar Smooth": 0.6,
            "Bias": 0.2,
            "Brick Width": 0.6,
            "Row Height": 0.3,
        }
        inputs = {"Vector": "p", "Mortar": (0.1, 0.2, 0.3, 1.0)} | colors | sizes
        properties: dict[str, Any] = {
            "offset": 0.3,
            "squash": 1.4,
            "offset_frequency": 3,
            "squash_frequency": 2,
        }
        found.append(Case(f"brick {output}", "ShaderNodeTexBrick", output, properties, inputs))
        # At the default scale of 5 the mortar's rim is so steep that the rounding of places shows.
        inputs = {"Vector": "p", "Scale": 1.0}
        found.append(Case(f"brick plain {output}", "ShaderNodeTexBrick", output, inputs=inputs))
    found.append(
        Case(
            "brick swept",
            "ShaderNodeTexBrick",
            "Color",
            inputs={"Vector": "p", "Bias": "x", "Mortar Smooth": "v", "Mortar Size": 0.1},
        )
    )
    return found


def _gabors() -> list[Case]:
    found = []
    for kind, orientation in (
        ("2D", {"Orientation 2D": "x"}),
        ("3D", {"Orientation 3D": (0.3, 0.7, 0.5)}),
    ):
        for output in ("Value", "Phase", "Intensity"):
            inputs = {
                "Vector": "p",
                "Scale": 1.4,
                "Frequency": 2.3,
                "Anisotropy": 0.7,
            } | orientation
            found.append(
                Case(
                    f"gabor {kind} {output}",
                    "ShaderNodeTexGabor",
                    output,
                    {"gabor_type": kind},
                    inputs,
                    noise=True,
                )
            )
        inputs = {"Vector": "p", "Scale": 1.1, "Frequency": "v", "Anisotropy": "u"}
        found.append(
            Case(
                f"gabor {kind} swept",
                "ShaderNodeTexGabor",
                "Value",
                {"gabor_type": kind},
                inputs,
                noise=True,
            )
        )
    return found


def picture(
    name: str,
    floats: bool = False,
    alpha: bool = True,
    space: str = "",
    mode: str = "",
    packed: bool = False,
    file: str = "",
    channels: int = 4,
) -> Any:
    """A small coloured image, 12 x 8, that is like no turned or mirrored copy of itself. `packed`:
    from a PNG within the .blend. `file`: from one on disk, of such a format and so many channels.
    """
    import bpy

    image = bpy.data.images.get(name)
    if image is not None:
        return image
    image = bpy.data.images.new(name, 12, 8, alpha=alpha, float_buffer=floats)
    if space:
        image.colorspace_settings.name = space
    if mode:
        image.alpha_mode = mode
    rng = np.random.default_rng(7)
    pixels = rng.random((8, 12, 4)).astype(np.float32)
    pixels[..., 3] = 0.3 + 0.7 * pixels[..., 3] if alpha else 1.0
    pixels[2:4, :, 3] = 1.0
    if floats:
        pixels[..., :3] *= 2.0
    if file:
        bpy.data.images.remove(image)
        image = bpy.data.images.load(_written(pixels[..., :channels], file))
        image.name = name
        if space:
            image.colorspace_settings.name = space
        image.alpha_mode = mode or "STRAIGHT"
        return image
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    if packed:
        with tempfile.TemporaryDirectory() as folder:
            image.filepath_raw, image.file_format = f"{folder}/packed.png", "PNG"
            image.save()
            bpy.data.images.remove(image)
            image = bpy.data.images.load(f"{folder}/packed.png")
            image.name = name
            if space:
                image.colorspace_settings.name = space
            image.alpha_mode = mode or "STRAIGHT"
            image.pack()
    return image


def _written(pixels: np.ndarray, kind: str) -> str:
    """Path of a new file: png and bits of a channel, or exr."""
    import OpenImageIO as oiio

    depth = {"png8": oiio.UINT8, "png16": oiio.UINT16, "exr": oiio.HALF}[kind]
    path = f"{tempfile.mkdtemp(prefix='photon_splat_image_')}/image.{kind.rstrip('0123456789')}"
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, depth)
    spec["oiio:UnassociatedAlpha"] = 1
    out = oiio.ImageOutput.create(path)
    assert out.open(path, spec), oiio.geterror()
    out.write_image(np.ascontiguousarray(pixels))
    out.close()
    return path


def _image(**given: Any) -> Any:
    def setup(node: Any) -> None:
        properties = {"name": "straight"} | given
        node.image = picture(**properties)

    return setup


def _images() -> list[Case]:
    found = []
    node = "ShaderNodeTexImage"
    for projection in enum(node, "projection"):
        for extension in enum(node, "extension"):
            properties = {"projection": projection, "extension": extension}
            found.append(
                Case(
                    f"image {projection} {extension}",
                    node,
                    "Color",
                    properties,
                    {"Vector": "p"},
                    setup=_image(),
                )
            )
        properties = {"projection": projection, "projection_blend": 0.4}
        found.append(
            Case(
                f"image {projection} on a sphere",
                node,
                "Color",
                properties,
                setup=_image(),
                thing="sphere",
            )
        )
        generated: dict[str, Any] = {
            "projection": projection,
            "projection_blend": 0.7,
            "interpolation": "Closest",
        }
        found.append(
            Case(
                f"image {projection} closest",
                node,
                "Color",
                generated,
                {"Vector": "q"},
                setup=_image(),
                thing="sphere",
            )
        )
    for interpolation in enum(node, "interpolation"):
        for extension in enum(node, "extension"):
            properties = {"interpolation": interpolation, "extension": extension}
            found.append(
                Case(
                    f"image {interpolation} {extension}",
                    node,
                    "Color",
                    properties,
                    {"Vector": "p"},
                    setup=_image(),
                )
            )
    variants: dict[str, dict[str, Any]] = {
        "straight": {"alpha": True},
        "packed": {"mode": "CHANNEL_PACKED"},
        "ignored": {"mode": "NONE"},
        "opaque": {"alpha": False},
        "data": {"space": "Non-Color"},
        "float": {"floats": True},
        "float data": {"floats": True, "space": "Non-Color"},
        "float straight": {"floats": True, "mode": "STRAIGHT"},
        "float premultiplied": {"floats": True, "mode": "PREMUL"},
        "premultiplied": {"mode": "PREMUL"},
        "linear bytes": {"space": "Linear Rec.709"},
        "packed file": {"packed": True},
        "packed premultiplied": {"packed": True, "mode": "PREMUL"},
        "packed channels": {"packed": True, "mode": "CHANNEL_PACKED"},
        "deep file": {"file": "png16"},
        "deep premultiplied file": {"file": "png16", "mode": "PREMUL"},
        "deep channels": {"file": "png16", "mode": "CHANNEL_PACKED"},
        "deep data": {"file": "png16", "space": "Non-Color"},
        "deep grey": {"file": "png16", "channels": 1},
        "deep opaque": {"file": "png16", "channels": 3},
        "half file": {"file": "exr"},
        "half sRGB": {"file": "exr", "space": "sRGB"},
        "grey file": {"file": "png8", "channels": 1},
        "grey and alpha": {"file": "png8", "channels": 2},
    }
    sources: dict[str, dict[str, Any]] = {
        "buffer": {},
        "float buffer": {"floats": True},
        "packed": {"packed": True},
        **{kind: {"file": kind} for kind in ("png8", "png16", "exr")},
    }
    variants |= {
        f"{kind} in {space}, {mode.lower()}": given | {"space": space, "mode": mode}
        for kind, given in sources.items()
        for space in ("Rec.1886", "Linear Rec.2020", "Non-Color")
        for mode in ("STRAIGHT", "PREMUL")
    }
    for name, given in variants.items():
        setup = _image(name=name, **given)
        found.append(Case(f"image of {name}", node, "Color", inputs={"Vector": "uv"}, setup=setup))
        found.append(Case(f"alpha of {name}", node, "Alpha", inputs={"Vector": "uv"}, setup=setup))
        found.append(
            Case(f"both of {name}", "", "", build=lambda tree, setup=setup: _both(tree, setup))
        )
    for name in ("grey file", "deep grey", "grey and alpha", "deep opaque", "straight"):
        setup, clip = _image(name=name, **variants[name]), {"extension": "CLIP"}
        found += [
            Case(f"{what} outside of {name}", node, socket, clip, {"Vector": "p"}, setup=setup)
            for what, socket in (("image", "Color"), ("alpha", "Alpha"))
        ]
    setup = _image(name="straight")
    found.append(
        Case("image whose alpha leads nowhere", "", "", build=lambda tree: _dead_end(tree, setup))
    )
    return found


def _dead_end(tree: Any, setup: Any) -> Any:
    """Colour; alpha goes through a reroute and a node to nothing."""
    image = tree.nodes.new("ShaderNodeTexImage")
    on, end = tree.nodes.new("NodeReroute"), tree.nodes.new("ShaderNodeBsdfTransparent")
    setup(image)
    tree.links.new(image.outputs["Alpha"], on.inputs[0])
    tree.links.new(on.outputs[0], end.inputs[0])
    return image.outputs["Color"]


def _both(tree: Any, setup: Any) -> Any:
    """Colour times 2 plus alpha: both outputs are used."""
    image, sum_of = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeVectorMath")
    setup(image)
    tree.links.new(image.outputs["Color"], sum_of.inputs[0])
    tree.links.new(image.outputs["Alpha"], sum_of.inputs[1])
    return sum_of.outputs[0]


def _environments() -> list[Case]:
    found = []
    node = "ShaderNodeTexEnvironment"
    for projection in enum(node, "projection"):
        for thing, vector in (("plane", {"Vector": "p"}), ("sphere", {})):
            for interpolation in ("Linear", "Closest", "Cubic"):
                properties = {"projection": projection, "interpolation": interpolation}
                name = f"environment {projection} {thing} {interpolation}"
                found.append(
                    Case(
                        name,
                        node,
                        "Color",
                        properties,
                        vector,
                        setup=_image(name="opaque", alpha=False),
                        thing=thing,
                    )
                )
    return found


def _tiled(tree: Any) -> Any:
    """UDIM tiles 1001, 1002 and 1011 over three by three; the others are not there."""
    import bpy

    folder = tempfile.mkdtemp(prefix="photon_splat_tiles_")
    rows, columns = np.mgrid[:8, :8] / 8.0
    for number in (1001, 1002, 1011):
        one = bpy.data.images.new("tile", 8, 8)
        one.pixels.foreach_set(
            np.stack([columns, rows, np.full((8, 8), (number % 7) / 7.0), np.ones((8, 8))], -1)
            .astype(np.float32)
            .ravel()
        )
        one.filepath_raw, one.file_format = f"{folder}/tile.{number}.png", "PNG"
        one.save()
    image = bpy.data.images.load(f"{folder}/tile.1001.png")
    image.source, image.filepath = "TILED", f"{folder}/tile.<UDIM>.png"
    for number in (1002, 1011):
        if number not in [tile.number for tile in image.tiles]:
            image.tiles.new(number)
    scaled = tree.nodes.new("ShaderNodeMapping")
    scaled.inputs["Scale"].default_value = (2.9, 2.9, 1.0)
    tree.links.new(Sources(tree).get("uv"), scaled.inputs["Vector"])
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation = image, "Closest"
    tree.links.new(scaled.outputs[0], node.inputs["Vector"])
    return node.outputs["Color"]
