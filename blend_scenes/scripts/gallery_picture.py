"""Renders a scene for the gallery: `python -m blend_scenes.scripts.gallery_picture NAME [--seconds
S] [--resolution WxH] [--final-gather AUTO|ON|OFF] [--out FILE.png]`.

Photon Splat with its denoiser, then the scene's own view transform, so that the picture is what
Blender would show.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]


def developed(scene: Path, exr: Path, png: Path) -> None:
    """Write the Combined pass of `exr` with the view settings of `scene` as an 8-bit PNG."""
    import bpy
    import OpenImageIO as oiio

    bpy.ops.wm.open_mainfile(filepath=str(scene), load_ui=False, use_scripts=False)
    picture = oiio.ImageBuf(str(exr))
    if picture.has_error:
        raise RuntimeError(picture.geterror())
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder, "plain.exr")
        oiio.ImageBufAlgo.channels(picture, ("R", "G", "B", "A")).write(str(plain))
        image = bpy.data.images.load(str(plain))
        settings = bpy.context.scene.render.image_settings
        if hasattr(settings, "media_type"):
            settings.media_type = "IMAGE"
        settings.file_format, settings.color_mode, settings.color_depth, settings.compression = (
            "PNG",
            "RGB",
            "8",
            100,
        )
        image.save_render(str(png), scene=bpy.context.scene)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name")
    parser.add_argument("--seconds", default="240")
    parser.add_argument("--resolution", default="480x320")
    parser.add_argument("--final-gather", default="AUTO")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    scene = HERE / f"{options.name}.blend"
    with tempfile.TemporaryDirectory() as folder:
        exr = Path(folder, "picture.exr")
        command = [
            sys.executable,
            "-c",
            "from photon_splat.cli import run; run()",
            "render",
            str(scene),
            "-o",
            str(exr),
            "--denoise",
            "--final-gather",
            options.final_gather,
        ]
        status = subprocess.run(
            [*command, "--seconds", options.seconds, "--resolution", options.resolution],
            check=False,
        ).returncode
        if status == 0:
            developed(scene, exr, options.out or HERE / "gallery" / f"{options.name}.png")
    return status


if __name__ == "__main__":
    sys.exit(main())
