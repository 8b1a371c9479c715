"""What the tests of the GPU splatter share. Without a graphics card they run on Mesa's llvmpipe."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from photon_splat.core.gpu import context
from photon_splat.core.gpu.splatter import GpuSplatter
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Scene

RMS, WORST = 1e-4, 1e-3


def need_opengl() -> None:
    """Skip where no OpenGL context can be made at all."""
    try:
        context.submit(context.graphics).result()
    except context.NoGraphics as reason:
        pytest.skip(
            f"{reason}. On Debian: apt-get install libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri"
        )


def prepared(scene: Scene, **settings: object):
    """A renderer with points and one batch of photons of its first pass."""
    made = RenderSettings(**settings)  # type: ignore[arg-type]
    renderer = load().Renderer(2)
    fill_renderer(renderer, scene, made)
    renderer.build()
    renderer.trace_camera(0)
    renderer.place_points(0)
    renderer.trace_photons(0, made.photons_per_pass)
    return renderer


def splat_on_gpu(renderer, most_texels: int | None = None) -> tuple[dict[str, np.ndarray], dict]:
    """The points of `renderer` after its photons, and the splatter's statistics."""
    splatter = GpuSplatter(renderer, threading.Event(), most_texels)
    try:
        splatter.begin_pass()
        splatter.add_photons()
        splatter.finish_pass()
        return renderer.points(), splatter.statistics()["gpu"]
    finally:
        splatter.close()


def expect_agreement(
    cpu: dict[str, np.ndarray], gpu: dict[str, np.ndarray], at_the_edge: int = 0
) -> None:
    """Same points and same photons: irradiance to 1e-4 (RMS) and 1e-3 (worst point above 1 % of the
    mean).

    at_the_edge: pairs of a photon and a point that rounding decides, and that carry no light: one
    splatter may count them and the other not.
    """
    assert np.array_equal(cpu["position"], gpu["position"])
    want, got = cpu["irradiance"].astype(np.float64), gpu["irradiance"].astype(np.float64)
    size, error = np.linalg.norm(want, axis=1), np.linalg.norm(got - want, axis=1)
    assert np.linalg.norm(error) <= RMS * np.linalg.norm(size)
    bright = size > 0.01 * size.sum() / max(len(size), 1)
    assert not bright.any() or (error[bright] / size[bright]).max() <= WORST
    assert not got[size == 0].any(), "light where the CPU splatter has none"
    differ = np.abs(cpu["count"] - gpu["count"]).sum()
    assert differ <= 1e-5 * cpu["count"].sum() + 1 + at_the_edge


def compare(scene: Scene, **settings: object) -> None:
    """The first pass of each photon map by both splatters."""
    renderer = prepared(scene, **settings)
    dark = True
    for layer in range(renderer.photon_maps):
        if layer:
            renderer.select_photon_map(layer)
            renderer.place_points(0)
            renderer.trace_photons(0, renderer.paths_per_pass)
        renderer.splat()
        cpu = renderer.points()
        dark = dark and not cpu["irradiance"].any()
        gpu, _ = splat_on_gpu(renderer)
        expect_agreement(cpu, gpu)
    assert not dark, "the scene is dark"
