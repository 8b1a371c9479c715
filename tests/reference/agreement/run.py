"""Splat against reference on random scenes, on random Blender scenes of glass, gloss and media, of
lamps, lenses and visibility or of one closure under one lamp, or on .blend files:
python -m tests.reference.agreement.run [--first N] [--count N] [--passes N] [--samples N]
[--matter | --stages | --closures | --files FILE ... --width N] [--cycles] [--out OUT]

--cycles, for random Blender scenes: the reference integrator against Cycles instead.

A line a scene: mean and blocks off against the reference integrator, the told error over the true
one; scenes that differ leave a sheet in OUT (reference, splat, signed difference: red is brighter,
blue darker by 30 %).
"""

from __future__ import annotations

import argparse
import hashlib
import random
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray
from photon_splat.core.render.settings import Integrator
from photon_splat.core.scene import Scene

from tests.benchmarks.bench.scenes import from_file
from tests.reference.agreement import generator
from tests.reference.agreement.compare import Agreement, agreement
from tests.reference.agreement.generator import random_scene
from tests.support import random_closures, random_matter, random_stage
from tests.support.corescene import shoot

MOST_OFF = 1.0 / 50.0
TOLD_WITHIN = (0.7, 1.5)


def reference(what: Scene, samples: int, kept: Path | None = None) -> list[NDArray]:
    """Two halves; found in the file `kept` or written there."""
    if kept is not None and kept.exists():
        return list(np.load(kept).astype(np.float64))
    halves = [
        shoot(what, Integrator.REFERENCE, passes=samples, seed=seed).passes["Combined"][..., :3]
        for seed in (11, 12)
    ]
    if kept is not None:
        np.save(kept, np.stack(halves))
    return [half.astype(np.float64) for half in halves]


def measure(
    what: Scene, passes: int, samples: int, kept: Path | None = None, **settings: object
) -> tuple[Agreement, list[NDArray]]:
    """How splat and reference agree, and the four pictures."""
    pictures = []
    for seed in (1, 2):
        result = shoot(what, passes=passes, seed=seed, **settings)
        pictures.append(result.passes["Combined"][..., :3].astype(np.float64))
        if seed == 1:
            told, lamps = (
                result.passes["Error"][..., 0].astype(np.float64),
                result.passes["Emission"][..., :3].any(-1),
            )
    pictures += reference(what, samples, kept)
    return agreement((pictures[0], pictures[1]), told, lamps, (pictures[2], pictures[3])), pictures


def sheet(path: Path, pictures: list[NDArray]) -> None:
    ours, reference = (pictures[0] + pictures[1]) / 2, (pictures[2] + pictures[3]) / 2
    scale = 0.75 / max(float(np.percentile(reference, 95)), 1e-9)

    def mean4(x: NDArray) -> NDArray:
        h, w = (n // 4 for n in x.shape[:2])
        return x[: 4 * h, : 4 * w].reshape(h, 4, w, 4, -1).mean((1, 3, 4))

    d = np.clip(
        (mean4(ours) - mean4(reference))
        / (mean4(reference) + 0.05 * reference.mean() + 1e-12)
        / 0.3,
        -1,
        1,
    )
    signed = (
        np.stack([1 - np.clip(-d, 0, 1), 1 - abs(d), 1 - np.clip(d, 0, 1)], -1)
        .repeat(4, 0)
        .repeat(4, 1)
    )
    height, width = signed.shape[:2]
    toned = [np.clip(picture * scale, 0, 1) ** (1 / 2.2) for picture in (reference, ours)]
    image = np.concatenate([*(picture[:height, :width] for picture in toned), signed], 1)
    image = np.ascontiguousarray(image[::-1].repeat(3, 0).repeat(3, 1), np.float32)
    buffer = oiio.ImageBuf(oiio.ImageSpec(image.shape[1], image.shape[0], 3, "uint8"))
    buffer.set_pixels(oiio.ROI(0, image.shape[1], 0, image.shape[0], 0, 1, 0, 3), image)
    buffer.write(str(path))


def blender_scene(made_by: ModuleType, seed: int) -> Scene:
    """Of random_matter, random_stage or random_closures. Needs bpy, where it stays open."""
    import bpy
    from photon_splat.export import export_scene

    made_by.build(random.Random(seed))
    return export_scene(bpy.context.evaluated_depsgraph_get())


def beside_cycles(what: Scene, samples: int) -> tuple[Agreement, list[NDArray]]:
    """The same as measure() of the reference integrator and Cycles, for the scene that is open."""
    from tests.reference.cycles.references import render_with_cycles

    pictures = reference(what, samples)
    pictures += [render_with_cycles(samples, seed)[..., :3].astype(np.float64) for seed in (21, 22)]
    nothing = np.zeros(pictures[0].shape[:2])
    agrees = agreement(
        (pictures[0], pictures[1]), nothing, nothing.astype(bool), (pictures[2], pictures[3])
    )
    return replace(agrees, told_over_true=None), pictures


def scenes(options: argparse.Namespace) -> Iterator[tuple[str, Scene, str]]:
    """Name, scene, and what tells one version of it from another."""
    if options.files:
        for file in options.files:
            version = hashlib.sha256(file.read_bytes()).hexdigest()[:8]
            yield file.stem, from_file(file.resolve(), options.width), f"{version}-{options.width}"
        return
    made_by: ModuleType = generator
    kind = ""
    if options.matter:
        made_by, kind = random_matter, "matter-"
    elif options.stages:
        made_by, kind = random_stage, "stage-"
    elif options.closures:
        made_by, kind = random_closures, "closure-"
    version = hashlib.sha256(Path(made_by.__file__ or "").read_bytes()).hexdigest()[:8]
    for seed in options.only or range(options.first, options.first + options.count):
        what = blender_scene(made_by, seed) if kind else random_scene(seed)
        yield f"{kind}{seed}", what, version


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument(
        "--matter", action="store_true", help="random Blender scenes of glass, gloss and media"
    )
    parser.add_argument("--stages", action="store_true", help="of lamps, lenses and visibility")
    parser.add_argument("--closures", action="store_true", help="of one closure under one lamp")
    parser.add_argument("--cycles", action="store_true", help="path tracer against Cycles")
    parser.add_argument("--files", type=Path, nargs="*", help="instead of random scenes")
    parser.add_argument("--width", type=int, default=160, help="of the files' pictures")
    parser.add_argument("--passes", type=int, default=12)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--out", type=Path, default=Path("out/agreement"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    means = offs = tolds = tried = 0
    for name, what, version in scenes(options):
        began = time.monotonic()
        kept = options.out / f"{name}-{options.samples}-{version}.npy"
        if options.cycles:
            result, pictures = beside_cycles(what, options.samples)
        else:
            result, pictures = measure(what, options.passes, options.samples, kept)
        if not pictures[2].any():
            print(f"{name:4} black", flush=True)
            continue
        ratio = result.told_over_true
        told_right = ratio is None or TOLD_WITHIN[0] <= ratio <= TOLD_WITHIN[1]
        faults = [not result.mean_agrees, result.off > MOST_OFF, not told_right]
        tried, means, offs, tolds = (
            tried + 1,
            means + faults[0],
            offs + faults[1],
            tolds + faults[2],
        )
        if any(faults[:2]):
            sheet(options.out / f"{name}.png", pictures)
        words = " ".join(
            word for word, fault in zip(("MEAN", "BLOCKS", "TOLD"), faults, strict=True) if fault
        )
        print(
            f"{name:4} mean {result.mean:.4f} +- {result.mean_error:.4f} off "
            f"{100 * result.off:4.1f} % error {result.error:.4f} "
            f"told/true {'unknown' if ratio is None else f'{ratio:.2f}'} "
            f"{time.monotonic() - began:5.1f} s {words}",
            flush=True,
        )
    print(f"{tried} scenes: mean wrong in {means}, blocks in {offs}, told error in {tolds}")


if __name__ == "__main__":
    main()
