"""Which splatter a render gets."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from ..render.settings import Backend
from ..render.splatter import CpuSplatter, Splatter, SplatterFailed
from . import context
from .splatter import GpuSplatter

if TYPE_CHECKING:
    from photon_splat_native import Renderer


def choose_splatter(
    renderer: Renderer, backend: Backend, stop: threading.Event, warnings: list[str]
) -> Splatter:
    """Backend.AUTO: a graphics card if there is one, else the CPU. Backend.GPU: whatever OpenGL
    has, software too.

    `stop` is set when the render is cancelled. ValueError, with one sentence, where Backend.GPU
    cannot be had.
    """
    if backend == Backend.CPU or (backend == Backend.AUTO and not _has_graphics_card()):
        return CpuSplatter(renderer)
    try:
        return GpuSplatter(renderer, stop)
    except SplatterFailed as failure:
        if backend == Backend.GPU:
            raise ValueError(f"the GPU splatter could not be set up: {failure}") from failure
        warnings.append(
            f"The GPU splatter could not be set up ({failure}); the CPU splatter has been used."
        )
        return CpuSplatter(renderer)


def _has_graphics_card() -> bool:
    if not context.may_have_hardware():
        return False
    try:
        return context.submit(context.graphics).result().hardware
    except context.NoGraphics:
        return False
