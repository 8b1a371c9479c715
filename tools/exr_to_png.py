"""exr_to_png.py IN.exr OUT.png  writes the Combined pass as an 8-bit sRGB picture."""

from __future__ import annotations

import sys

import numpy as np
import OpenImageIO as oiio
from PIL import Image


def main(source: str, target: str) -> None:
    picture = oiio.ImageBuf(source)
    if picture.has_error:
        sys.exit(f"{source}: {picture.geterror()}")
    names = list(picture.spec().channelnames)
    linear = picture.get_pixels(oiio.FLOAT)[..., [names.index(name) for name in "RGBA"]]
    color = np.clip(linear[..., :3], 0.0, 1.0)
    encoded = np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1 / 2.4) - 0.055)
    alpha = np.clip(linear[..., 3:], 0.0, 1.0)
    Image.fromarray((np.concatenate([encoded, alpha], -1) * 255.0 + 0.5).astype(np.uint8)).save(
        target
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
