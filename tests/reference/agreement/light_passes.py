"""The passes that light is split into, beside those of Cycles, on random Blender scenes:
python -m tests.reference.agreement.light_passes [--first N] [--count N] [--samples N]
[--passes N] [--stages | --matter]

A line a scene: which passes differ in their mean or in blocks, and whether the parts add up to the
picture. Known to differ: see docs/limitations.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from tests.reference.agreement.compare import blocks
from tests.reference.agreement.run import blender_scene
from tests.support import random_closures, random_matter, random_stage
from tests.support.corescene import shoot

Pictures = Mapping[str, NDArray]
LOBES = ("Diffuse", "Glossy", "Transmission")
OTHERS = ("Volume Direct", "Volume Indirect", "Emission", "Environment")
SWITCHES = [
    f"use_pass_{lobe.lower()}_{part}" for lobe in LOBES for part in ("direct", "indirect", "color")
] + ["use_pass_emit", "use_pass_environment"]
LEAST = 0.003
"""Of the picture's mean: less is nothing to be seen."""


def switch_on() -> None:
    """All of them, in the view layer that is open."""
    import bpy

    layer = bpy.context.view_layer
    for switch in SWITCHES:
        setattr(layer, switch, True)
    layer.cycles.use_pass_volume_direct = layer.cycles.use_pass_volume_indirect = True


def parts(passes: Pictures) -> dict[str, NDArray]:
    """What adds up to the picture: (height, width, 3) each."""
    of_lobes = {
        f"{lobe} {kind}": passes[f"{lobe} {kind}"] * passes[f"{lobe} Color"]
        for lobe in LOBES
        for kind in ("Direct", "Indirect")
    }
    return of_lobes | {name: passes[name] for name in OTHERS}


def left_over(passes: Pictures) -> float:
    """The largest difference of the sum of parts() to the picture, in means of the picture."""
    combined = passes["Combined"][..., :3]
    off = np.abs(sum(parts(passes).values()) - combined)
    return float(off.max() / max(float(combined.mean()), 1e-12))


def differing(ours: tuple[Pictures, Pictures], theirs: tuple[Pictures, Pictures]) -> list[str]:
    """Names of the parts, of two independent halves each, that are not the same beside noise."""
    level = float(theirs[0]["Combined"][..., :3].mean())
    names = []
    split = [parts(passes) for passes in (*ours, *theirs)]
    for name in split[0]:
        a, b, c, d = (blocks(picture[name].astype(np.float64)) for picture in split)
        noise = np.sqrt((a - b) ** 2 + (c - d) ** 2) / 2.0
        noise += noise.mean() / 2.0
        difference, reference = (a + b - c - d) / 2.0, (c + d) / 2.0
        mean = abs(float(difference.mean()))
        allowed = 0.02 * float(reference.mean()) + LEAST * level
        allowed += 3.0 * float(np.sqrt((noise**2).mean() / noise.size))
        off = np.abs(difference) > 4.0 * noise + 0.03 * reference + 0.01 * level
        if mean > allowed or off.mean() > 0.01:
            names.append(name)
    return names


def both(
    seed: int, made_by: ModuleType, samples: int, passes: int
) -> tuple[tuple[Pictures, Pictures], tuple[Pictures, Pictures]]:
    """Ours by splatting and those of Cycles. Needs bpy, where the scene stays open."""
    from tests.reference.cycles.references import passes_of_cycles

    what = blender_scene(made_by, seed)
    switch_on()
    first, second = (shoot(what, passes=passes, seed=number).passes for number in (1, 2))
    return (first, second), (passes_of_cycles(samples, 21), passes_of_cycles(samples, 22))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--samples", type=int, default=128, help="of Cycles")
    parser.add_argument("--passes", type=int, default=24, help="of splatting")
    parser.add_argument("--stages", action="store_true", help="of lamps, lenses and visibility")
    parser.add_argument("--matter", action="store_true", help="of glass, gloss and media")
    options = parser.parse_args()
    made_by = (
        random_stage if options.stages else random_matter if options.matter else random_closures
    )
    tried = wrong = 0
    for seed in range(options.first, options.first + options.count):
        ours, theirs = both(seed, made_by, options.samples, options.passes)
        if not theirs[0]["Combined"][..., :3].any():
            print(f"{seed:4} black", flush=True)
            continue
        names, left = differing(ours, theirs), left_over(ours[0])
        tried, wrong = tried + 1, wrong + bool(names)
        print(f"{seed:4} left over {left:.4f} {', '.join(names)}", flush=True)
    print(f"{tried} scenes: passes differ in {wrong}")


if __name__ == "__main__":
    main()
