"""How an export is stopped half-way."""

from __future__ import annotations

from collections.abc import Callable


class Cancelled(Exception):
    """The export was cancelled."""


class Watch:
    """Whatever may take long asks it: once per object, node and image."""

    def __init__(self, should_cancel: Callable[[], bool] | None = None) -> None:
        self._should_cancel = should_cancel

    def go_on(self) -> None:
        """Raises Cancelled if the render has been cancelled."""
        if self._should_cancel is not None and self._should_cancel():
            raise Cancelled
