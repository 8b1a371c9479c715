"""The seed's picture: the indirect light of the Cornell box from 0.05 %, 1 % and 100 % of 1,000,000
photons.

`python -m tests.benchmarks.bench.seed_picture [FILE.png]`, by default
blend_scenes/gallery/seed_photons.png. All three panels have the disc radius that suits the million;
each is brightened by the share of photons it lacks, so that single discs show.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.result import passes_from_film
from photon_splat.core.render.settings import RenderSettings
from PIL import Image

from tests.benchmarks.bench.scenes import ROOT, from_blend

PHOTONS = 1_000_000
SHARES = (0.0005, 0.01, 1.0)
PANEL, FINE = 320, 3
WHITE = 0.35


def panel(scene: object, share: float) -> np.ndarray:
    """(PANEL, PANEL, 3) linear RGB of indirect light alone, row 0 at the top."""
    renderer = load().Renderer(0)
    fill_renderer(
        renderer, scene, RenderSettings(passes=1, photons_per_pass=PHOTONS, point_spacing=0.0)
    )
    renderer.build()
    renderer.trace_camera(0)
    renderer.place_points(0)
    renderer.trace_photons(0, round(PHOTONS * share))
    renderer.splat()
    renderer.resolve()
    passes = passes_from_film(renderer.film())
    indirect = passes["Diffuse Indirect"] * passes["Diffuse Color"] / share
    return indirect.reshape(PANEL, FINE, PANEL, FINE, 3).mean((1, 3))[::-1]


def main(arguments: list[str]) -> int:
    output = (
        Path(arguments[0]) if arguments else ROOT / "blend_scenes" / "gallery" / "seed_photons.png"
    )
    scene = from_blend("cornell_box", PANEL * FINE, PANEL * FINE)
    gap = np.ones((PANEL, 8, 3))
    panels = [np.clip(panel(scene, share) / WHITE, 0.0, 1.0) ** (1 / 2.2) for share in SHARES]
    strip = np.concatenate([panels[0], gap, panels[1], gap, panels[2]], 1)
    output.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray((strip * 255 + 0.5).astype(np.uint8)).save(output, optimize=True)
    print(f"{output}: {', '.join(f'{share:.2%}' for share in SHARES)} of {PHOTONS:,} photons")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
