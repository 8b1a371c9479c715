"""The OpenGL context: made once per process, on a thread of its own that is the only one to use
it.
"""

from __future__ import annotations

import ctypes
import glob
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    import moderngl

Result = TypeVar("Result")

OPENGL, EXACT_OPENGL = 330, 400
"""The least version, and the one asked for first: its shaders can forbid that operations are fused.
Some drivers give no more than they are asked for.
"""
SOFTWARE = (
    "llvmpipe",
    "softpipe",
    "swrast",
    "swiftshader",
    "software",
    "gdi generic",
    "microsoft basic render",
)
"""Parts of the names of renderers that run on the CPU."""
MOST_DEVICES = 16
LINUX_DEVICES = ("/dev/dri/*", "/dev/nvidia[0-9]*", "/dev/dxg")
"""Without one of these no hardware renderer can answer on Linux."""


class NoGraphics(ValueError):
    """There is no OpenGL context to be had; the message, one sentence, says why."""


@dataclass(frozen=True, slots=True)
class Graphics:
    """gl: the context. finish: waits for all drawing with the GIL released, which moderngl never
    releases.

    idle: a framebuffer to be bound while others are released. moderngl binds the last one again
    whenever it makes or clears another, and OpenGL refuses what has been released. timer: measures
    the card's own time.
    """

    gl: moderngl.Context
    renderer: str
    finish: Callable[[], None]
    idle: moderngl.Framebuffer
    timer: moderngl.Query

    @property
    def hardware(self) -> bool:
        return is_hardware(self.renderer)


_thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="Photon Splat OpenGL")
_graphics: Graphics | None = None


def submit(task: Callable[..., Result], *args: Any) -> Future[Result]:
    """Runs `task` on the OpenGL thread, after everything it was given before."""
    return _thread.submit(task, *args)


def is_hardware(renderer: str) -> bool:
    return not any(name in renderer.lower() for name in SOFTWARE)


def may_have_hardware() -> bool:
    """Whether there may be a graphics card, found out without making a context."""
    return not sys.platform.startswith("linux") or any(
        glob.glob(pattern) for pattern in LINUX_DEVICES
    )


def graphics() -> Graphics:
    """The context of this process, made when first asked for. On the OpenGL thread only. NoGraphics
    where none can be made.
    """
    global _graphics
    if _graphics is None:
        _graphics = _make()
    return _graphics


def discard() -> None:
    """Forgets a context that has failed, so that the next render makes a new one. On the OpenGL
    thread only.
    """
    global _graphics
    if _graphics is not None:
        failed, _graphics = _graphics, None
        failed.gl.release()


def _make() -> Graphics:
    """The first context of a graphics card, else the first one at all."""
    try:
        import glcontext  # noqa: F401
        import moderngl
    except ImportError as error:
        raise NoGraphics(
            f"the GPU splatter needs the Python package {error.name}, which is not installed"
        ) from error
    found: list[tuple[Any, Graphics]] = []
    reasons: list[str] = []
    for make in _contexts():
        try:
            window = make()
            gl = moderngl.create_context(require=OPENGL, context=window)
        except Exception as error:  # glcontext raises nothing more special
            reasons.append(str(error))
            break
        finish = ctypes.CFUNCTYPE(None)(window.load_opengl_function("glFinish"))
        idle = gl.framebuffer([gl.texture((1, 1), 4)])
        found.append(
            (
                window,
                Graphics(gl, str(gl.info["GL_RENDERER"]), finish, idle, gl.query(time=True)),
            )
        )
        if found[-1][1].hardware:
            break
    if not found:
        raise NoGraphics(
            "the GPU splatter needs OpenGL 3.3, and no context could be made "
            f"({'; '.join(reasons)})"
        )
    chosen = found.pop() if found[-1][1].hardware else found.pop(0)
    for _, other in found:
        other.gl.release()
    chosen[0].__enter__()  # current, which the last one made was
    return chosen[1]


def _contexts() -> Iterator[Callable[[], Any]]:
    """Ways to make a context without a window: one per device on Linux (EGL), the system's choice
    elsewhere.
    """
    import glcontext

    if sys.platform.startswith("linux"):
        egl = glcontext.get_backend_by_name("egl")
        for device in range(MOST_DEVICES):
            yield lambda device=device: _best(
                lambda version: egl(mode="standalone", glversion=version, device_index=device)
            )  # type: ignore[misc]
    else:
        yield lambda: _best(
            lambda version: glcontext.default_backend()(mode="standalone", glversion=version)
        )


def _best(make: Callable[[int], Any]) -> Any:
    try:
        return make(EXACT_OPENGL)
    except Exception:  # glcontext raises nothing more special; what the second try says is told
        return make(OPENGL)
