"""Registers classes and handlers with Blender so that this can be done and undone at any time: a
handler may already be gone when it is to be removed, and a class may still be registered by scripts
that have been reloaded since.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import bpy

Handlers = Sequence[tuple[str, Callable[..., None]]]
"""Lists of bpy.app.handlers, and what is called from there."""


def register_classes(classes: Sequence[Any]) -> None:
    for cls in classes:
        if cls.is_registered:
            continue
        known = getattr(bpy.types, getattr(cls, "bl_idname", "") or cls.__name__, None) or getattr(
            bpy.types, cls.__name__, None
        )
        if known is not None and known is not cls and known.__module__ == cls.__module__:
            bpy.utils.unregister_class(known)
        bpy.utils.register_class(cls)


def unregister_classes(classes: Sequence[Any]) -> None:
    """In reverse order."""
    for cls in reversed(classes):
        if cls.is_registered:
            bpy.utils.unregister_class(cls)


def add_handlers(handlers: Handlers) -> None:
    """Adds handlers that Blender keeps when it loads a file."""
    remove_handlers(handlers)
    for name, handler in handlers:
        getattr(bpy.app.handlers, name).append(bpy.app.handlers.persistent(handler))


def remove_handlers(handlers: Handlers) -> None:
    """Removes the handlers, and handlers of the same names that reloaded scripts have added."""
    for name, handler in handlers:
        known = getattr(bpy.app.handlers, name)
        for old in list(known):
            if _name_of(old) == _name_of(handler):
                known.remove(old)


def _name_of(handler: Any) -> tuple[str, str]:
    return getattr(handler, "__module__", ""), getattr(handler, "__qualname__", repr(handler))
