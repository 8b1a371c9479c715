"""What a render asks of a splatter, and the one on the CPU."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from .settings import Backend

if TYPE_CHECKING:
    from photon_splat_native import Renderer


class SplatterFailed(Exception):
    """The splatter cannot go on; its message says why. The pass can be splatted anew by another
    one.
    """


class Splatter(Protocol):
    """Adds photons to the visible points of a pass. Photons and points are in the native renderer;
    no camera is needed.

    All calls come from the thread that runs the render. Each may raise SplatterFailed, or the
    native module's Cancelled.
    """

    backend: Backend

    def begin_pass(self) -> None:
        """Takes the points of the pass; call it after the renderer's place_points()."""

    def add_photons(self) -> None:
        """Adds the renderer's latest batch of photons. They may be in use no longer when it
        returns.
        """

    def finish_pass(self) -> None:
        """Sees to it that the points hold the sums of all photons, ready for the renderer's
        resolve().
        """

    def close(self) -> None:
        """Gives everything back; called once, after an error or cancellation too."""

    def statistics(self) -> dict[str, Any]:
        """What it adds to the statistics of the render."""


class CpuSplatter:
    """The native splatter. Its sums go straight into the points."""

    backend = Backend.CPU

    def __init__(self, renderer: Renderer) -> None:
        self._renderer = renderer

    def begin_pass(self) -> None:
        pass

    def add_photons(self) -> None:
        self._renderer.splat()

    def finish_pass(self) -> None:
        pass

    def close(self) -> None:
        pass

    def statistics(self) -> dict[str, Any]:
        return {}
