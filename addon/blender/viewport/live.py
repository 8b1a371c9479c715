"""The viewports that are rendered now, each with its thread; none outlives the engine that Blender
made for it.
"""

from __future__ import annotations

import atexit
import time
import weakref
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.native.bounds import world_bounds
from ...core.scene import Camera, Frame, Scene
from ...core.viewport.controller import Controller
from ...export import export_contents
from ...export.kept import Kept, identity
from ...export.report import Report
from ..properties import viewport_settings
from ..registration import add_handlers, remove_handlers
from .draw import Canvas
from .view import view_of

POLL_SECONDS = 0.02
NOWHERE = Camera(np.eye(4), (-1.0, 1.0, -1.0, 1.0))
"""A camera for a scene that gets its view later."""

lives: list[Live] = []
"""All viewports in Rendered shading."""


class Live:
    """One viewport in Rendered shading: made with its engine, closed when that is gone."""

    def __init__(self, engine: Any) -> None:
        self.engine = weakref.ref(engine)
        self.controller = Controller()
        self.canvas = Canvas()
        self.kept = Kept()
        self.error = ""
        self.warnings: list[str] = []
        self.seconds = {"export": 0.0, "draw": 0.0}
        """Seconds of the last export and the last draw, both on Blender's thread."""
        self._scene: Scene | None = None
        self._bounds: NDArray[np.float64] | None = None
        self._told: tuple[Any, ...] = ()

    @property
    def is_new(self) -> bool:
        return self._scene is None and not self.error

    def update(self, context: Any, depsgraph: Any) -> None:
        """Exports what has changed. On Blender's thread."""
        started = time.monotonic()
        self.kept.forget(changed(depsgraph))
        try:
            report = Report()
            scene = export_contents(
                depsgraph, NOWHERE, Frame(1, 1), report, self.kept, visible_in(context.space_data)
            )
            settings = viewport_settings(depsgraph.scene_eval)
        except (ValueError, RuntimeError, MemoryError) as error:
            self.error = " ".join(str(error).split()) or type(error).__name__
            return
        self.kept.forget_unused()
        self.error, self.warnings = "", scene.warnings
        self._scene, self._bounds = scene, None
        self.controller.set_scene(scene, settings)
        self.seconds["export"] = time.monotonic() - started

    def draw(self, engine: Any, context: Any, depsgraph: Any) -> None:
        """Says where the camera is and draws the latest picture. On Blender's thread."""
        started = time.monotonic()
        scene, space, rv3d = depsgraph.scene_eval, context.space_data, context.region_data
        bounds = self._scene_bounds() if not rv3d.is_perspective else None
        local = (
            space.camera.evaluated_get(depsgraph)
            if space.use_local_camera and space.camera
            else None
        )
        self.controller.set_view(
            view_of(context.region, space, rv3d, scene, pixel_size(scene, context), bounds, local)
        )
        picture = self.controller.picture()
        if picture is not None:
            engine.bind_display_space_shader(scene)
            self.canvas.draw(picture)
            engine.unbind_display_space_shader()
        status, progress, error = self.controller.status()
        if error or self.error:
            engine.update_stats("Photon Splat", f"Error: {error or self.error}")
        else:
            samples = picture.samples if picture else 0
            done = f"{status} {100 * progress:.0f} %" if status else f"{samples} passes"
            warning = self.controller.warning
            engine.update_stats("Photon Splat", f"{done}, {warning}" if warning else done)
        self.seconds["draw"] = time.monotonic() - started

    def news(self) -> bool:
        """Whether there is a new picture whose drawing has not been requested yet."""
        picture, (status, progress, error) = self.controller.picture(), self.controller.status()
        now = (picture.number if picture else 0, status, int(20 * progress), error)
        told, self._told = self._told, now
        return told != now

    def close(self) -> None:
        self.controller.close()
        self.canvas.clear()
        self.kept.clear()
        self._scene = None

    def _scene_bounds(self) -> NDArray[np.float64] | None:
        if self._bounds is None and self._scene is not None:
            self._bounds = world_bounds(self._scene)
        return self._bounds


def live_of(engine: Any) -> Live:
    """The viewport of a bpy.types.RenderEngine, made when it is first asked for."""
    live = getattr(engine, "live", None)
    if live is None:
        live = engine.live = Live(engine)
        lives.append(live)
        if not bpy.app.timers.is_registered(_poll):
            bpy.app.timers.register(_poll, first_interval=POLL_SECONDS, persistent=True)
    return live


def changed(depsgraph: Any) -> set[int]:
    """Identities of the data-blocks whose arrays have to be read again."""
    found = set()
    for update in depsgraph.updates:
        block = update.id
        if update.is_updated_geometry or isinstance(block, bpy.types.Image):
            found.add(identity(block))
    return found


def visible_in(space: Any) -> Any:
    """What a 3D viewport shows, if it does not show everything: a test of instances of the
    graph.
    """
    if space is None or not (space.local_view or space.use_local_collections):
        return None

    def visible(instance: Any) -> bool:
        return bool((instance.parent or instance.object).original.visible_in_viewport_get(space))

    return visible


def pixel_size(scene: Any, context: Any) -> int:
    """How many pixels of the screen a pixel of the picture is wide, by Blender's setting."""
    size = scene.render.preview_pixel_size
    if size != "AUTO":
        return int(size)
    return 2 if context.preferences.system.pixel_size > 1.5 else 1


def close_all() -> None:
    """Ends every viewport's thread; the viewports that stay open begin anew."""
    while lives:
        live = lives.pop()
        engine = _engine(live)
        if engine is not None:
            engine.live = None
        live.close()


def _engine(live: Live) -> Any:
    """The engine of a viewport, or None if Blender has dropped it."""
    engine = live.engine()
    if engine is None:
        return None
    try:
        engine.as_pointer()
    except ReferenceError:
        return None
    return engine


def _poll() -> float | None:
    """Blender's timer: has new pictures drawn, and ends what has lost its engine."""
    for live in list(lives):
        engine = _engine(live)
        if engine is None:
            lives.remove(live)
            live.close()
        elif live.news():
            engine.tag_redraw()
    return POLL_SECONDS if lives else None


def _close_before_load(*_: Any) -> None:
    close_all()


def _forget_after_undo(*_: Any) -> None:
    for live in lives:
        live.kept.clear()


HANDLERS = (
    ("load_pre", _close_before_load),
    ("undo_post", _forget_after_undo),
    ("redo_post", _forget_after_undo),
)


def register() -> None:
    add_handlers(HANDLERS)
    atexit.unregister(close_all)
    atexit.register(close_all)


def unregister() -> None:
    close_all()
    if bpy.app.timers.is_registered(_poll):
        bpy.app.timers.unregister(_poll)
    remove_handlers(HANDLERS)
    atexit.unregister(close_all)
