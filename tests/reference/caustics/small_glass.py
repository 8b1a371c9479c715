"""The caustic of a glass of 1 % of a room's width after ten seconds: `python -m
tests.reference.caustics.small_glass [SECONDS]`.

small_glass.blend at 640x360. Prints the relative error of the pixels of the table where the caustic
is as bright as all other light or brighter: sqrt(mean(((picture - reference)/reference)^2)), by
Photon Splat and by Cycles in the same time. The reference is the caustic by tracer.py and all other
light by Cycles; it takes minutes to make and is kept in out/caustics.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from blend_scenes.scripts.caustic_shapes import SmallGlass
from tests.reference.caustics.reference import VIEWS, irradiance
from tests.reference.cycles.cases import Case
from tests.reference.cycles.worker import Worker
from tests.support.compare import save_pictures
from tests.support.paths import ROOT

OUT = ROOT / "out" / "caustics"
WIDTH, HEIGHT = 640, 360
CELLS, PHOTONS, REST = 320, 30_000_000, 128
"""Cells of the reference along the view's 16 cm, photons, and pixels of the other light."""


def table_reference() -> tuple[np.ndarray, np.ndarray]:
    """(2, CELLS, CELLS, 3) radiance of the caustic, two halves, and (REST, REST, 3) of the rest;
    seen from above.
    """
    file = OUT / "reference.npz"
    if not file.is_file():
        from tests.reference.caustics.pictures import without_bent_light

        view = VIEWS["small_glass"]
        albedo = np.asarray(view.albedo) / np.pi
        caustic = np.stack(
            [irradiance(view, PHOTONS // 2, seed, CELLS) * albedo for seed in (1, 2)]
        )
        OUT.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(
            file,
            caustic=caustic.astype(np.float32),
            rest=without_bent_light(REST, 512).mean(0).astype(np.float32),
        )
    with np.load(file) as kept:
        return kept["caustic"].astype(float), kept["rest"].astype(float)


def pixel_rays(x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
    """Origin (3,) and directions (HEIGHT, WIDTH, 3) through (x, y) in 0..1 of every pixel, row 0 at
    the bottom. Needs the open scene.
    """
    import bpy

    scene = bpy.context.scene
    camera = scene.camera
    corners = np.array(
        [camera.matrix_world.to_3x3() @ corner for corner in camera.data.view_frame(scene=scene)]
    )
    _, bottom_right, bottom_left, top_left = corners
    u = ((np.arange(WIDTH) + x) / WIDTH)[None, :, None]
    v = ((np.arange(HEIGHT) + y) / HEIGHT)[:, None, None]
    ways = bottom_left + u * (bottom_right - bottom_left) + v * (top_left - bottom_left)
    return np.array(camera.matrix_world.translation), ways / np.linalg.norm(
        ways, axis=-1, keepdims=True
    )


def seen_by_camera(
    caustic: np.ndarray, rest: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radiance of the table in each pixel: caustic halves, rest; and where a pixel shows the
    measured part of the table and no glass.
    """
    from tests.reference.cycles.stages import stage

    stage.build(camera_case())
    view = VIEWS["small_glass"]
    caustics, rests, seen = 0.0, 0.0, np.ones((HEIGHT, WIDTH), bool)
    surfaces = view.surfaces()
    for x in (0.125, 0.375, 0.625, 0.875):
        for y in (0.125, 0.375, 0.625, 0.875):
            origin, ways = pixel_rays(x, y)
            flat = ways.reshape(-1, 3)
            start = np.broadcast_to(origin, flat.shape)
            t = ((view.below - 0.0003) - origin[2]) / ways[..., 2]
            hidden = (
                np.min([surface.shape.hit(start, flat) for surface in surfaces[1:]], 0).reshape(
                    t.shape
                )
                < t
            )
            point = origin + t[..., None] * ways
            place = (point[..., :2] - view.middle) / view.size + 0.5
            seen &= ~hidden & (t > 0) & ((place > 0.01) & (place < 0.99)).all(-1)
            caustics = caustics + _look_up(caustic, place) / 16
            rests = rests + _look_up(rest[None], place)[0] / 16
    return np.asarray(caustics), np.asarray(rests), seen


def _look_up(pictures: np.ndarray, place: np.ndarray) -> np.ndarray:
    size = pictures.shape[1]
    column, row = (np.clip((place[..., k] * size).astype(int), 0, size - 1) for k in (0, 1))
    return pictures[:, row, column]


def camera_case() -> Case:
    return Case("small_glass", "open_scene", {"name": "small_glass"}, WIDTH, HEIGHT)


def by_cycles(seconds: float) -> np.ndarray:
    import bpy

    from tests.reference.cycles import references
    from tests.reference.cycles.stages import stage

    stage.build(camera_case())
    bpy.context.scene.cycles.time_limit = seconds
    return references.render_with_cycles(100_000, 7)[..., :3]


def relative_error(picture: np.ndarray, reference: np.ndarray, part: np.ndarray) -> float:
    """reference: two halves (2, height, width, 3), whose own noise is left out of the figure."""
    mean = reference.mean(0).mean(-1)[part]
    a, b = ((picture - half).mean(-1)[part] / mean for half in reference)
    return float(max(np.mean(a * b), 0.0) ** 0.5)


def main() -> int:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    caustic, rest, seen = seen_by_camera(*table_reference())
    reference = caustic + rest
    part = seen & (caustic.mean((0, -1)) > rest.mean(-1))
    with tempfile.TemporaryDirectory(prefix="photon_splat_glass_") as scratch:
        worker = Worker(Path(scratch))
        started = time.monotonic()
        pictures, statistics = worker.render(
            camera_case(), "splat", [1], passes=1_000_000, time_limit=seconds
        )
        took = time.monotonic() - started
        worker.stop()
    ours = pictures[0, ..., :3]
    cycles = by_cycles(seconds)
    shown = np.where(seen[..., None], reference.mean(0), 0.0)
    save_pictures(OUT, "small_glass", ours, shown)
    save_pictures(OUT, "small_glass_cycles", cycles, shown)
    width = SmallGlass.PROFILE[2][0] * 200
    print(
        f"{int(part.sum())} pixels of caustic of a glass {width:.0f} cm wide; mean radiance "
        f"{reference[:, part].mean():.3f}"
    )
    for name, picture in (("Photon Splat", ours), ("Cycles", cycles)):
        ratio = picture[part].mean() / reference[:, part].mean()
        print(
            f"{name:13} relative error {relative_error(picture, reference, part):.3f}, mean "
            f"{ratio:.3f} of the reference's"
        )
    print(
        f"{seconds:g} s each ({took:.1f} s with start and export, {statistics[0]['passes']} passes)"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
