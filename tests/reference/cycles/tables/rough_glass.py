"""Cycles against itself on rough glass:
`python -m tests.reference.cycles.tables.rough_glass [ROUGHNESS]`
prints its mean with and without light samples.

Both ways solve the same equation, and on any other material they agree. The lamp is the gallery's.
What light samples add is light that would have to be refracted by more than a facet can: the half
vector of the two directions lies on the wrong side of one of them. Photon Splat's light samples
count those pairs, too.
"""

from __future__ import annotations

import sys

from tests.reference.cycles.cases import Case
from tests.reference.cycles.gallery import BY_NAME, sweep_case
from tests.reference.cycles.references import render_with_cycles, without_light_samples
from tests.reference.cycles.stages import stage


def means(case: Case, samples: int = 1024) -> tuple[float, float]:
    """Of the whole picture, RGB: with light samples, and without."""
    stage.build(case)
    sampled = render_with_cycles(samples, 1)[..., :3].mean()
    stage.build(case)
    without_light_samples()
    return float(sampled), float(render_with_cycles(4 * samples, 2)[..., :3].mean())


def main() -> int:
    roughness = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    for name, case in (
        ("diffuse", BY_NAME["diffuse_0"]),
        (f"glass, roughness {roughness:g}", sweep_case("glass", roughness)),
    ):
        sampled, scattered = means(case)
        print(
            f"{name:24} with light samples {sampled:.4f}, by scattered rays alone "
            f"{scattered:.4f}: {sampled / scattered:.4f}",
            flush=True,
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
