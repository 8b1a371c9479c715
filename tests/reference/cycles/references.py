"""Makes the Cycles references anew: `python -m tests.reference.cycles.references [NAME ...]` (all
cases without names).

Two independent halves of each picture go to tests/reference/cycles/references/NAME.npz as float16
(rounding of 0.05 % a pixel, far below the noise): half_1 and half_2, (height, width, 4) RGBA, row 0
at the bottom, only the border where there is one. Alpha is left out of the gallery's pictures that
are opaque.

Cases with light_samples=False are rendered with their lamp as a plane that rays find by chance.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tests.reference.cycles.cases import CASES, Case
from tests.reference.cycles.gallery import ALL, BY_NAME

FOLDER = Path(__file__).resolve().parent / "references"


def cycles_settings(samples: int, seed: int) -> None:
    """Tell Cycles to solve the rendering equation, nothing less: no clamp, no blur, no denoiser, no
    early end of a path.
    """
    import bpy

    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = samples, seed
    cycles.use_animated_seed = False
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = cycles.light_sampling_threshold = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = (
        cycles.transmission_bounces
    ) = 64
    cycles.volume_bounces = cycles.max_bounces
    cycles.transparent_max_bounces = 64
    # The default arranges noise so that it cancels between neighbours; the block tests need
    # independent pixels.
    cycles.sampling_pattern = "TABULATED_SOBOL"
    cycles.use_light_tree = True
    scene.render.use_persistent_data = False


def render_with_cycles(samples: int, seed: int, render_pass: str = "") -> np.ndarray:
    """The current scene as (height, width, 4) float32, row 0 at the bottom; of a border only its
    inside. All channels of another pass than Combined. One view, if there are several.
    """
    import bpy

    cycles_settings(samples, seed)
    scene = bpy.context.scene
    render = scene.render
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    if render_pass:
        return written_passes()[render_pass]
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth, render.image_settings.color_mode = "32", "RGBA"
    with tempfile.TemporaryDirectory() as folder:
        render.filepath = str(Path(folder, "half.exr"))
        bpy.ops.render.render(write_still=True)
        (written,) = Path(folder).iterdir()  # with the suffix of a view, where there are several
        image = bpy.data.images.load(str(written))
        image.colorspace_settings.name = "Non-Color"
        width, height = image.size
        pixels = np.empty(width * height * 4, np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
    picture = pixels.reshape(height, width, 4)
    if render.use_border and not render.use_crop_to_border:
        x0, x1 = (round(f * width) for f in (render.border_min_x, render.border_max_x))
        y0, y1 = (round(f * height) for f in (render.border_min_y, render.border_max_y))
        picture = picture[y0:y1, x0:x1]
    return picture


def passes_of_cycles(samples: int, seed: int) -> dict[str, np.ndarray]:
    """written_passes() of Cycles."""
    cycles_settings(samples, seed)
    return written_passes()


def written_passes() -> dict[str, np.ndarray]:
    """All passes that the view layer asks for, rendered and written by Blender, by our names:
    (height, width, channels) float32, row 0 at the bottom.
    """
    import bpy
    import OpenImageIO as oiio
    from photon_splat.blender.passes import own_name

    render = bpy.context.scene.render
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    render.image_settings.file_format, render.image_settings.color_depth = (
        "OPEN_EXR_MULTILAYER",
        "32",
    )
    begin, passes = f"{bpy.context.view_layer.name}.", {}
    with tempfile.TemporaryDirectory() as folder:
        render.filepath = str(Path(folder, "half.exr"))
        bpy.ops.render.render(write_still=True)
        file = oiio.ImageInput.open(render.filepath)
        part = 0  # Blender 5: one for each pass
        while file.seek_subimage(part, 0):
            names = list(file.spec().channelnames)
            pixels = file.read_image(part, 0, 0, file.spec().nchannels, oiio.FLOAT)[::-1]
            for name in {channel.rsplit(".", 1)[0] for channel in names}:
                wanted = [
                    f"{name}.{letter}" for letter in "RGBAXYZW" if f"{name}.{letter}" in names
                ]
                passes[own_name(name.removeprefix(begin))] = np.ascontiguousarray(
                    pixels[..., [names.index(channel) for channel in wanted]]
                )
            part += 1
        file.close()
    return passes


def without_light_samples() -> None:
    """Makes every rectangular area lamp of the scene a plane that emits the same and hides nothing,
    found by scattered rays alone.
    """
    import bpy
    from mathutils import Vector

    from blend_scenes.scripts import modelling as m
    from tests.reference.cycles.gallery import BACKFACING, add, mix, node, transparent
    from tests.reference.cycles.stages.gallery_stage import build_material

    scene = bpy.context.scene
    scene.world.cycles.sampling_method = "NONE"
    for lamp in [thing for thing in scene.objects if thing.type == "LIGHT"]:
        data = lamp.data
        if data.type != "AREA" or data.shape != "RECTANGLE" or data.spread < 3.14:
            raise ValueError(f"the lamp {lamp.name!r} has no plane that emits the same")
        half_x, half_y = data.size / 2, data.size_y / 2
        corners = [
            Vector((x, y, 0))
            for x, y in ((-half_x, half_y), (half_x, half_y), (half_x, -half_y), (-half_x, -half_y))
        ]
        front = node(
            "Emission",
            Color=tuple(data.color),
            Strength=data.energy / (math.pi * data.size * data.size_y),
        )
        glow = build_material(
            "Glow", add(mix(BACKFACING, front, node("Emission", Strength=0.0)), transparent())
        )
        glow.cycles.emission_sampling = "NONE"
        plane = m.add_mesh(
            "Plane", [tuple(lamp.matrix_world @ corner) for corner in corners], [(0, 1, 2, 3)], glow
        )
        plane.visible_camera, plane.visible_shadow = lamp.visible_camera, False
        bpy.data.objects.remove(lamp)


def make(case: Case) -> None:
    from tests.reference.cycles.stages import stage

    halves = []
    for seed in (1, 2):
        stage.build(case)
        if not case.light_samples:
            without_light_samples()
        picture = render_with_cycles(case.samples, seed, case.render_pass)
        halves.append(picture if case.alpha or case in CASES else picture[..., :3])
    FOLDER.mkdir(exist_ok=True)
    np.savez_compressed(
        FOLDER / f"{case.name}.npz",
        half_1=halves[0].astype(np.float16),
        half_2=halves[1].astype(np.float16),
    )


def load(case: Case) -> np.ndarray:
    """The two halves as (2, height, width, 4) float64."""
    with np.load(FOLDER / f"{case.reference or case.name}.npz") as file:
        return np.stack([file["half_1"], file["half_2"]]).astype(np.float64)


def main(names: list[str]) -> int:
    unknown = [name for name in names if name not in BY_NAME]
    if unknown:
        print(
            f"no such case: {', '.join(unknown)}; there are {', '.join(BY_NAME)}", file=sys.stderr
        )
        return 2
    for name in names or [case.name for case in ALL if not case.reference]:
        started = time.monotonic()
        make(BY_NAME[name])
        halves = load(BY_NAME[name])
        difference = float(
            np.abs(halves[0, ..., :3] - halves[1, ..., :3]).mean()
            / max(abs(halves[..., :3].mean()), 1e-9)
        )
        seconds = time.monotonic() - started
        print(
            f"{name:28} {seconds:6.1f} s  mean {halves[..., :3].mean():.4f}  noise "
            f"{difference:.3f}",
            file=sys.stderr,
            flush=True,
        )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
