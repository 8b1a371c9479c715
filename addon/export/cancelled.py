"""How an export is stopped half-way."""

from __future__ import annotations

from collections.abc import Callable


class Cancelled(Exception):
    """The export was cancelled."""


class Watch:
    """Asked by all that may take long, once per object, node and image."""

    def __init__(self, should_cancel: Callable[[], bool] | None = None) -> None:
        self._should_cancel = should_cancel

    def go_on(self) -> None:
        """Raises Cancelled where the render has been."""
        if self._should_cancel is not None and self._should_cancel():
            raise Cancelled
