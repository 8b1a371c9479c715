"""What Blender hands to an engine that draws a viewport, without a window: the graph is Blender's,
the rest is made up.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

import numpy as np

SECONDS = 600.0
"""After which it is taken for hung."""


class Engine:
    """A stand-in for bpy.types.RenderEngine. `gone`: Blender has freed it."""

    def __init__(self) -> None:
        self.gone = False
        self.redraws = 0
        self.stats = ("", "")

    def as_pointer(self) -> int:
        if self.gone:
            raise ReferenceError("StructRNA of type Engine has been removed")
        return id(self)

    def tag_redraw(self) -> None:
        self.redraws += 1

    def update_stats(self, head: str, text: str) -> None:
        self.stats = (head, text)

    def bind_display_space_shader(self, scene: Any) -> None: ...

    def unbind_display_space_shader(self) -> None: ...


def projection_matrix(
    left: float,
    right: float,
    bottom: float,
    top: float,
    near: float,
    far: float,
    orthographic: bool = False,
) -> np.ndarray:
    """An OpenGL projection matrix as a 3D viewport of Blender has it; left, right, bottom and top
    are those of the near plane in a perspective.
    """
    m = np.zeros((4, 4))
    m[0, 0], m[1, 1] = 2 / (right - left), 2 / (top - bottom)
    x, y, z = (
        (right + left) / (right - left),
        (top + bottom) / (top - bottom),
        (far + near) / (far - near),
    )
    if orthographic:
        m[2, 2], m[3, 3] = -2 / (far - near), 1
        m[:3, 3] = -x, -y, -z
    else:
        m[0, 0], m[1, 1] = m[0, 0] * near, m[1, 1] * near
        m[:3, 2] = x, y, -z
        m[2, 3], m[3, 2] = -2 * far * near / (far - near), -1
    return m


def context(
    width: int = 64,
    height: int = 36,
    eye: np.ndarray | None = None,
    window: np.ndarray | None = None,
    **space: Any,
) -> Any:
    """A viewport that looks from `eye` (a matrix; default: from above)."""
    if eye is None:
        eye = np.eye(4)
        eye[2, 3] = 6.0
    if window is None:
        window = projection_matrix(
            -0.05, 0.05, -0.05 * height / width, 0.05 * height / width, 0.1, 100
        )
    perspective = window[3, 3] == 0
    settings = {
        "clip_start": 0.1,
        "clip_end": 100.0,
        "use_render_border": False,
        "use_local_camera": False,
        "camera": None,
        "local_view": None,
        "use_local_collections": False,
    }
    rv3d = SimpleNamespace(
        view_matrix=np.linalg.inv(eye).astype(np.float32),
        window_matrix=window.astype(np.float32),
        is_perspective=perspective,
        view_perspective="PERSP" if perspective else "ORTHO",
    )
    return SimpleNamespace(
        region=SimpleNamespace(width=width, height=height),
        space_data=SimpleNamespace(**settings | space),
        region_data=rv3d,
        preferences=SimpleNamespace(system=SimpleNamespace(pixel_size=1.0)),
    )


class Canvas:
    """A stand-in for the Canvas, which needs a window: it keeps what was drawn."""

    def __init__(self) -> None:
        self.drawn: list[Any] = []

    def draw(self, picture: Any) -> None:
        if not self.drawn or self.drawn[-1].number != picture.number:
            self.drawn.append(picture)

    def clear(self) -> None:
        self.drawn.clear()


class Viewport:
    """A viewport in Rendered shading that Blender updates with each change of its graph."""

    def __init__(self, **settings: Any) -> None:
        from photon_splat.blender.viewport import live_of

        self.engine, self.context = Engine(), context(**settings)
        self.live = live_of(self.engine)
        self.live.canvas = self.canvas = Canvas()  # type: ignore[assignment]
        self.updates = 0

    def update(self, depsgraph: Any) -> None:
        self.updates += 1
        self.live.update(self.context, depsgraph)

    def draw(self) -> Any:
        """What is drawn now, if anything is."""
        import bpy

        self.live.draw(self.engine, self.context, bpy.context.evaluated_depsgraph_get())
        return self.canvas.drawn[-1] if self.canvas.drawn else None

    def settle(self) -> Any:
        """The last picture of what there is now."""
        deadline = time.monotonic() + SECONDS
        while time.monotonic() < deadline:
            picture = self.draw()
            if picture is not None and self.live.controller.idle and picture.samples > 1:
                return picture
            assert "Error" not in self.engine.stats[1], self.engine.stats
            time.sleep(0.002)
        raise AssertionError(f"not done within {SECONDS} s: {self.live.controller.status()}")


@contextmanager
def viewport(**settings: Any) -> Iterator[Viewport]:
    """A viewport that hears of every change of the scene, as in Blender's window."""
    import bpy
    from photon_splat.blender.viewport import close_all

    made = Viewport(**settings)

    def tell(scene: Any, depsgraph: Any) -> None:
        made.update(depsgraph)

    told_of = (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post)
    for handlers in told_of:
        handlers.append(tell)
    try:
        made.update(bpy.context.evaluated_depsgraph_get())
        yield made
    finally:
        for handlers in told_of:
            if tell in handlers:  # a file that is loaded takes it away
                handlers.remove(tell)
        close_all()


def refresh(change: Callable[[], Any]) -> None:
    """Does `change` and has Blender work out what comes of it, once."""
    import bpy

    change()
    bpy.context.view_layer.update()
