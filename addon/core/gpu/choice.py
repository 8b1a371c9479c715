"""Which splatter a render gets."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from ..render.settings import Backend
from ..render.splatter import CpuSplatter, Splatter, SplatterFailed
from .splatter import GpuSplatter

if TYPE_CHECKING:
    from photon_splat_native import Renderer


def choose_splatter(renderer: Renderer, backend: Backend, stop: threading.Event) -> Splatter:
    """Backend.GPU: whatever OpenGL has, software too. Else the CPU, which no graphics card has
    beaten yet (docs/graphics_card.md).

    `stop` is set when the render is cancelled. ValueError, with one sentence, where Backend.GPU
    cannot be had.
    """
    if backend != Backend.GPU:
        return CpuSplatter(renderer)
    try:
        return GpuSplatter(renderer, stop)
    except SplatterFailed as failure:
        raise ValueError(f"the GPU splatter could not be set up: {failure}") from failure
