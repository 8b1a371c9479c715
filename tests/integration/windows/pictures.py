"""Renders scenes by the command line, for a comparison of two systems: pictures.py FOLDER.

Leaves FOLDER/SCENE.exr; `cornell_box_denoised` is denoised, the film of `cornell_box_large` is
in memory of large pages (native/src/util/large_pages.h).
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

SCENES = ("cornell_box", "instances", "light_types", "caustic_glass", "interior")
DENOISED, LARGE = "cornell_box_denoised", "cornell_box_large"
OPTIONS = ("--resolution", "96x96", "--passes", "3", "--photons-per-pass", "20000", "--verbose")
OPTIONS += ("--no-adaptive-samples",)
"""The adaptive sampler takes more samples here or there for a difference in the last digit, and
then whole regions have other noise: what is compared is what samples bring.
"""
SCENE_FOLDER = Path(__file__).resolve().parents[3] / "blend_scenes"


def main(folder: Path) -> int:
    from photon_splat.cli import main as photon_splat

    for name in SCENES:
        status = render(photon_splat, name, folder / f"{name}.exr")
        if status:
            return status
    more = {DENOISED: ["--denoise"], LARGE: ["--resolution", "600x600", "--passes", "1"]}
    return max(
        render(photon_splat, "cornell_box", folder / f"{name}.exr", *options)
        for name, options in more.items()
    )


def render(photon_splat, scene: str, output: Path, *more: str) -> int:  # type: ignore[no-untyped-def]
    file = str(SCENE_FOLDER / f"{scene}.blend")
    return photon_splat(["render", file, "-o", str(output), *OPTIONS, *more])


if __name__ == "__main__":
    status = main(Path(sys.argv[1]))
    sys.stdout.flush()
    os._exit(status)
