"""What a viewport asks for, what it gets, and the frame of a coarser picture of the same."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..scene import Camera, Frame, PixelFilter, same


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What to show: `frame` is the whole region in pixels of the screen, its border the part to
    render.

    pixel: the least width of the picture's pixels, in pixels of the screen.
    """

    camera: Camera
    frame: Frame
    pixel: int = 1

    def __eq__(self, other: object) -> bool:
        return isinstance(other, View) and all(
            same(getattr(self, name), getattr(other, name)) for name in ("camera", "frame", "pixel")
        )


@dataclass(frozen=True, slots=True)
class Picture:
    """pixels: (height, width, 4) float32 premultiplied scene-linear RGBA, row 0 at the bottom. They
    cover `region` (x, y, width, height, pixels of the screen). samples: camera samples per pixel; 1
    as long as `moving`, from the cache. made: when it was, by time.monotonic().
    """

    pixels: NDArray[np.float32]
    region: tuple[int, int, int, int]
    view: View
    step: int
    samples: int
    moving: bool
    number: int
    made: float = 0.0


def scaled(frame: Frame, step: int, sharp: bool = True) -> tuple[Frame, tuple[int, int, int, int]]:
    """`frame` in pixels `step` times as wide, rounded up, and what of the screen its region then
    covers.

    sharp: each pixel shows what it covers alone; else the filter of `frame` blurs it.
    """
    x, y, width, height = frame.region
    x0, y0, x1, y1 = x // step, y // step, -(-(x + width) // step), -(-(y + height) // step)
    border = (x0, y0, x1 - x0, y1 - y0)
    size = (-(-frame.width // step), -(-frame.height // step))
    coarse = replace(frame, width=size[0], height=size[1], border=border)
    if sharp:
        coarse = replace(coarse, pixel_filter=PixelFilter.BOX, filter_width=1.0)
    return coarse, (x0 * step, y0 * step, border[2] * step, border[3] * step)


def fitted(view: View, frame: Frame, step: int) -> Camera:
    """The camera of `view` for its frame in wider pixels, which may reach beyond it to the right
    and above.
    """
    left, right, bottom, top = view.camera.screen
    right = left + (right - left) * (frame.width * step) / view.frame.width
    top = bottom + (top - bottom) * (frame.height * step) / view.frame.height
    return replace(view.camera, screen=(left, right, bottom, top))
