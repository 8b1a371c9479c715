"""What a render asks of a splatter, and the one on the CPU."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from .settings import Backend

if TYPE_CHECKING:
    from photon_splat_native import Renderer


class SplatterFailed(Exception):
    """The splatter cannot go on; the message says why. Another splatter can do the pass from its
    beginning.
    """


class Splatter(Protocol):
    """Adds photons to the gather points of a pass. Photons and points live in the native renderer;
    a splatter knows no camera.

    All calls come from the thread that runs the render. Each may raise SplatterFailed, or the
    native module's Cancelled.
    """

    backend: Backend

    def begin_pass(self) -> None:
        """Takes the points of the pass; call it after the renderer's place_points()."""

    def add_photons(self) -> None:
        """Adds the renderer's latest batch of photons. The batch is free to be overwritten when
        this returns.
        """

    def finish_pass(self) -> None:
        """Waits until the points hold the sums of all photons, ready for the renderer's
        resolve().
        """

    def close(self) -> None:
        """Releases everything. Called once, after an error or a cancellation too."""

    def statistics(self) -> dict[str, Any]:
        """Entries of Statistics that only this splatter has."""


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


class ExternalSplatter:
    """A splatter as render_pass() asks for it: each call says whether it can go on."""

    def __init__(self, splatter: Splatter, failed: Callable[[SplatterFailed], None]) -> None:
        self._splatter = splatter
        self._failed = failed
        self._works = True

    def begin_pass(self) -> bool:
        return self._try(self._splatter.begin_pass)

    def add_photons(self) -> bool:
        return self._try(self._splatter.add_photons)

    def finish_pass(self) -> bool:
        return self._try(self._splatter.finish_pass)

    def _try(self, work: Callable[[], None]) -> bool:
        if self._works:
            try:
                work()
            except SplatterFailed as failure:
                self._works = False
                self._failed(failure)
        return self._works
