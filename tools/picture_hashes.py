"""Hashes of pictures, for changes that must not change one: picture_hashes.py [--against FILE] >
FILE

Finished renders of blend_scenes, raw and denoised, one with light groups, and what a viewport shows
when it has come to rest. Where faces coincide, as in street, single pixels may differ from run to
run. With --against the lines are compared with those of an earlier run, and the status says whether
any differs.
"""

from __future__ import annotations

import argparse
import hashlib
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # for tests
RENDERS = {
    "cornell_box": ["--passes", "6", "--resolution", "256x256"],
    "cornell_box denoised": ["--passes", "8", "--denoise", "--resolution", "256x256"],
    "interior": ["--passes", "4", "--resolution", "240x135"],
    "interior denoised": ["--passes", "8", "--denoise", "--resolution", "240x135"],
    "kitchen": ["--passes", "3", "--resolution", "240x135"],
    "caustic_glass": ["--passes", "6", "--resolution", "320x240"],
    "street": ["--passes", "4", "--resolution", "240x135"],
    "many_lights": ["--passes", "4", "--resolution", "240x135"],
    "reference": ["--passes", "4", "--integrator", "reference"],
}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--against", type=Path)
    parser.add_argument("--child", choices=("groups", "viewport"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        print({"groups": light_groups, "viewport": viewport}[options.child]())
        return 0
    before = (
        dict(line.rsplit(" ", 1) for line in options.against.read_text().splitlines())
        if options.against
        else {}
    )
    differ = False
    with tempfile.TemporaryDirectory() as folder:
        for name, arguments in RENDERS.items():
            scene = "cornell_box" if name == "reference" else name.split()[0]
            picture = Path(folder, "picture.exr")
            command = [
                str(Path(sys.executable).parent / "photon-splat"),
                "render",
                f"blend_scenes/{scene}.blend",
            ]
            subprocess.run(
                [*command, "-o", str(picture), *arguments],
                cwd=ROOT,
                check=True,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            differ |= tell(name, hash_of(picture), before)
        for name in ("groups", "viewport"):
            child = subprocess.run(
                [sys.executable, __file__, "--child", name],
                cwd=ROOT,
                check=True,
                capture_output=True,
                text=True,
            )
            differ |= tell(name, child.stdout.split()[-1], before)
    return int(differ)


def tell(name: str, found: str, before: dict[str, str]) -> bool:
    """Prints it; whether it is not what it was."""
    print(name, found, flush=True)
    differs = name in before and before[name] != found
    if differs:
        print(f"{name}: was {before[name]}", file=sys.stderr)
    return differs


def hash_of(picture: Path) -> str:
    import OpenImageIO as oiio

    return hashlib.sha256(oiio.ImageBuf(str(picture)).get_pixels(oiio.FLOAT).tobytes()).hexdigest()[
        :16
    ]


def light_groups() -> str:
    from photon_splat.core.scene import LightKind

    from tests.support.corescene import box, lambert, lamp, perspective, quad, scene, shoot

    view = perspective((3, -4, 2.5), (0, 0, 0.3), 160, 120)
    things = [
        (quad(3.0), lambert((0.7, 0.6, 0.5))),
        (box((-0.5, -0.5, 0), (0.5, 0.5, 1)), lambert((0.2, 0.5, 0.7))),
    ]
    lamps = [
        lamp(LightKind.POINT, 40.0, (1.5, -1.0, 2.0), radius=0.1, light_group=0),
        lamp(LightKind.POINT, 30.0, (-1.5, 1.0, 1.0), radius=0.1, light_group=1),
    ]
    what = scene(view, things, lamps, world=0.2)
    what.light_groups = ["key", "fill"]
    passes = shoot(what, passes=4).passes
    digest = hashlib.sha256()
    for name in sorted(passes):
        digest.update(name.encode() + passes[name].tobytes())
    return digest.hexdigest()[:16]


def viewport() -> str:
    import bpy
    import photon_splat

    from tests.support.window import viewport as window

    photon_splat.register()
    bpy.ops.wm.open_mainfile(filepath=str(ROOT / "blend_scenes/cornell_box.blend"))
    scene = bpy.context.scene
    scene.render.engine = "PHOTON_SPLAT"
    scene.photon_splat.viewport_passes = 4
    with window(width=240, height=135) as v:
        v.settle()
        picture = v.live.controller.picture()
    return hashlib.sha256(picture.pixels.tobytes()).hexdigest()[:16]


if __name__ == "__main__":
    sys.exit(main())
