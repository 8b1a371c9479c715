"""Failures, cancellation, many renders, other contexts: what a render leaves behind."""

from __future__ import annotations

import ctypes
import threading
import time
from ctypes.util import find_library

import numpy as np
import pytest
from photon_splat.core.gpu import context, painter
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import RenderSettings

from tests.support import corescene as c
from tests.support import gpu_scenes as scenes
from tests.support.clock import Stopwatch

moderngl = pytest.importorskip("moderngl")
pytestmark = pytest.mark.usefixtures("opengl")
SETTINGS = {"passes": 3, "photons_per_pass": 40_000, "seed": 1, "adaptive_samples": False}


def fail_at_call(
    monkeypatch: pytest.MonkeyPatch, method: str, number: int, error: Exception
) -> None:
    """Lets call `number` of a method of the painter do its work and then fail, and all after it
    fail at once.
    """
    calls = []
    real = getattr(painter.Painter, method)

    def wrapped(self: painter.Painter, *args: object) -> object:
        calls.append(1)
        if len(calls) > number:
            raise error
        result = real(self, *args)
        if len(calls) == number:
            raise error
        return result

    monkeypatch.setattr(painter.Painter, method, wrapped)


@pytest.mark.parametrize(
    ("method", "call", "failed_pass"),
    [
        ("begin", 1, 1),
        ("begin", 2, 2),
        ("splat", 1, 1),
        ("splat", 5, 2),
        ("sums", 1, 1),
        ("sums", 3, 3),
    ],
)
@pytest.mark.parametrize(
    "error",
    [moderngl.Error("context lost"), MemoryError(), RuntimeError("OpenGL says GL_OUT_OF_MEMORY")],
)
def test_failure_keeps_the_picture(
    method: str, call: int, failed_pass: int, error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    want = c.picture(scenes.room(16), backend="CPU", **SETTINGS)
    with monkeypatch.context() as patch:
        fail_at_call(patch, method, call, error)
        result = c.shoot(scenes.room(16), backend="GPU", **SETTINGS)
    reason = str(error) or "MemoryError"
    assert result.statistics["warnings"] == [
        f"The GPU splatter failed in pass {failed_pass} ({reason}); the CPU splatter has done the "
        "rest."
    ]
    assert result.statistics["backend"] == "CPU"
    assert result.statistics["passes"] == SETTINGS["passes"]
    got = result.passes["Combined"][..., :3]
    assert np.abs(got - want).max() <= 1e-4 * want.mean()
    # The next render gets a new context.
    assert c.shoot(scenes.room(16), backend="GPU", **SETTINGS).statistics["backend"] == "GPU"


def test_a_real_opengl_error_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A frame that is no longer there: what OpenGL says itself must reach the warnings."""
    real = painter.Painter.sums

    def sums(self: painter.Painter) -> list:
        self._atlases[0].sums.release()
        return real(self)

    monkeypatch.setattr(painter.Painter, "sums", sums)
    statistics = c.shoot(scenes.room(16), backend="GPU", **SETTINGS).statistics
    assert statistics["backend"] == "CPU"
    assert len(statistics["warnings"]) == 1
    assert statistics["warnings"][0].startswith("The GPU splatter failed in pass 1 (")


def live_objects() -> dict[str, int]:
    """How many OpenGL objects there are of each kind. On the OpenGL thread."""
    library = find_library("GL")
    assert library
    gl = ctypes.CDLL(library)
    kinds = ("Texture", "Buffer", "Framebuffer", "VertexArray", "Program", "Shader")
    return {
        kind: sum(bool(getattr(gl, f"glIs{kind}")(name) & 0xFF) for name in range(1, 5000))
        for kind in kinds
    }


def resident_bytes() -> int:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


def test_fifty_renders_leave_nothing() -> None:
    def once() -> None:
        statistics = c.shoot(
            scenes.floor(16),
            backend="GPU",
            passes=2,
            photons_per_pass=2000,
            adaptive_indirect=False,
        ).statistics
        assert statistics["gpu"]["batches"] >= 2

    for _ in range(10):
        once()
    gl, objects, memory = (
        context.submit(context.graphics).result().gl,
        context.submit(live_objects).result(),
        resident_bytes(),
    )
    assert objects["Texture"] >= 1, "not even the one that stays has been found"
    for _ in range(50):
        once()
    assert context.submit(context.graphics).result().gl is gl, "the context was made anew"
    assert context.submit(live_objects).result() == objects
    assert resident_bytes() - memory < 8e6


def test_cancel_within_a_fifth_of_a_second() -> None:
    """At several moments: while tracing, drawing, handing over. The best of three, for others use
    the machine too.
    """
    scene, settings = (
        scenes.room(96),
        RenderSettings(passes=1000, photons_per_pass=1_000_000, radius_scale=3.0, backend="GPU"),
    )

    def seconds_to_cancel(after: float) -> float:
        began = time.monotonic()
        asked: list[Stopwatch] = []

        def should_cancel() -> bool:
            if time.monotonic() - began < after:
                return False
            asked.append(Stopwatch())
            return True

        result = render(scene, settings, started=began, should_cancel=should_cancel)
        taken = asked[0].seconds()
        assert result.cancelled
        return taken

    for after in (0.0, 0.4, 0.9):
        assert min(seconds_to_cancel(after) for _ in range(3)) < 0.2


def test_renders_from_several_threads() -> None:
    want = c.picture(scenes.floor(16), backend="GPU", **SETTINGS)
    got: list[np.ndarray] = []
    threads = [
        threading.Thread(
            target=lambda: got.append(c.picture(scenes.floor(16), backend="GPU", **SETTINGS))
        )
        for _ in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(got) == 3
    assert all(np.array_equal(want, picture) for picture in got)


def test_a_context_of_the_callers_stays_current() -> None:
    """As Blender has one on its own thread."""
    if (
        not context.submit(lambda: context.graphics().gl.info["GL_RENDERER"])
        .result()
        .startswith("llvmpipe")
    ):
        pytest.skip("two contexts on one thread are tried with llvmpipe only")
    own = moderngl.create_context(standalone=True, backend="egl")
    frame = own.framebuffer([own.texture((2, 2), 4)])
    frame.use()
    c.shoot(scenes.floor(8), backend="GPU", passes=1, photons_per_pass=500)
    own.clear(1.0, 0.0, 1.0, 1.0)
    assert frame.read(components=4) == bytes([255, 0, 255, 255] * 4)
    assert own.error == "GL_NO_ERROR"
    frame.release()
    own.release()
