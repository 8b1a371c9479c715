"""What final renders leave for the next while Blender's Persistent Data is on: arrays of meshes and
images, and the native renderer.

Blender then keeps the render engine and its dependency graph, which says what has changed, for one
scene at a time. When it drops them, so do we.
"""

from __future__ import annotations

import atexit
import weakref
from typing import Any

from ..core.render.persistent import Persistent
from ..export.kept import Kept
from .registration import add_handlers, remove_handlers
from .viewport.live import changed


class Held:
    """What one view layer keeps."""

    def __init__(self) -> None:
        self.kept = Kept()
        self.persistent = Persistent()


class _Holder:
    """What the view layers of one render engine keep."""

    def __init__(self, engine: Any) -> None:
        self.engine = weakref.ref(engine, _forget)
        self.layers: dict[str, Held] = {}


_holders: list[_Holder] = []
"""One or none."""


def held_for(engine: Any, depsgraph: Any) -> Held | None:
    """What is held for the view layer that `engine` is to render; None: nothing, this is a preview
    or Persistent Data is off.

    To be called before anything of a render may fail: `depsgraph` says only once what has changed.
    """
    if engine.is_preview:
        return None
    scene = depsgraph.scene
    if not scene.render.use_persistent_data:
        free()
        return None
    if not _holders or _holders[0].engine() is not engine:
        free()
        _holders.append(_Holder(engine))
    layers = _holders[0].layers
    for name in set(layers) - {layer.name for layer in scene.view_layers}:
        del layers[name]
    news = changed(depsgraph)
    for held in layers.values():
        held.kept.forget(news)
    return layers.setdefault(depsgraph.view_layer_eval.name, Held())


def holds() -> bool:
    return bool(_holders)


def free() -> None:
    """Drops everything. A running render keeps what it uses until its end."""
    _holders.clear()


def _forget(engine: Any) -> None:
    """Blender has dropped the engine of this weak reference."""
    _holders[:] = [holder for holder in _holders if holder.engine is not engine]


def _free_before_load(*_: Any) -> None:
    free()


def _forget_after_undo(*_: Any) -> None:
    for holder in _holders:
        for held in holder.layers.values():
            held.kept.clear()


HANDLERS = (
    ("load_pre", _free_before_load),
    ("undo_post", _forget_after_undo),
    ("redo_post", _forget_after_undo),
)


def register() -> None:
    add_handlers(HANDLERS)
    atexit.unregister(free)
    atexit.register(free)


def unregister() -> None:
    free()
    remove_handlers(HANDLERS)
    atexit.unregister(free)
