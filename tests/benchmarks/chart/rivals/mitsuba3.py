"""Mitsuba 3 (PyPI: mitsuba) on our scenes. Its variant llvm_ad_rgb where it finds an LLVM
(DRJIT_LIBLLVM_PATH), else scalar_rgb.
"""

from __future__ import annotations

import time
from math import atan, degrees
from typing import Any

import numpy as np

from tests.benchmarks.chart.rivals.exact import Exact, NoCounterpartError, Surface, with_sun_discs

INTEGRATORS = {"Mitsuba": "path", "Mitsuba, particle tracer": "ptracer"}
GAUSSIAN = 0.27702
"""Standard deviation of the Blackman-Harris window over its half width: Mitsuba has no such filter,
but a Gaussian one.
"""
MOST_SAMPLES = 32
"""A pixel and launch: more take memory, not less time."""


def describe(scene: Exact, method: str, bounces: int) -> dict[str, Any]:
    """Plain data for `render`: dictionaries of mi.load_dict, and meshes as arrays.
    NoCounterpartError if the method cannot do it.
    """
    integrator = INTEGRATORS[method]
    if integrator == "ptracer":
        if any(part.surface.kind != "diffuse" for part in scene.parts):
            raise NoCounterpartError(
                "a particle tracer finds nothing that is seen in glass or mirrors"
            )
        if scene.suns:
            raise NoCounterpartError("of a disc as far as the sun no particle arrives")
    view = scene.view
    film = {
        "type": "hdrfilm",
        "width": view.width,
        "height": view.height,
        "pixel_format": "rgb",
        "component_format": "float32",
    }
    return {
        "integrator": {"type": integrator, "max_depth": bounces + 1},
        "sensor": {
            "type": "perspective",
            "fov": 2 * degrees(atan(view.screen[1])),
            "fov_axis": "x",
            "near_clip": 1e-3,
            "far_clip": 1e6,
            # its camera looks along +Z, +X to the left
            "to_world": view.matrix @ np.diag([-1.0, 1.0, -1.0, 1.0]),
            "film": film
            | {"rfilter": {"type": "gaussian", "stddev": GAUSSIAN * view.filter_radius}},
        },
        "meshes": [
            {
                "name": part.name,
                "positions": part.positions,
                "triangles": part.triangles.astype(np.uint32),
                "normals": part.normals,
                "bsdf": _bsdf(part.surface),
                "radiance": part.surface.emission if any(part.surface.emission) else None,
            }
            for part in with_sun_discs(scene).parts
        ],
    }


def _bsdf(surface: Surface) -> dict[str, Any]:
    color = {"type": "rgb", "value": list(surface.color)}
    if surface.kind == "diffuse":
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": color}}
    if surface.kind == "mirror":
        return {
            "type": "twosided",
            "bsdf": {"type": "conductor", "material": "none", "specular_reflectance": color},
        }
    tint = {"specular_reflectance": color, "specular_transmittance": color}
    return {"type": "dielectric", "int_ior": surface.ior, "ext_ior": 1.0} | tint


def version() -> str:
    """Raises ImportError where it is not installed."""
    return f"{_load().__version__} {_variant()}"


def render(
    description: dict[str, Any], seconds: float, seed: int, threads: int
) -> tuple[np.ndarray, float]:
    """The picture, (height, width, 3) float32 with row 0 at the bottom, and the seconds that
    loading and rendering took.

    As many samples as the time allows, in launches that double; kernels are compiled before the
    clock starts.
    """
    mi = _load()
    mi.set_variant(_variant())
    import drjit

    drjit.set_thread_count(threads)
    np.array(mi.render(_scene(mi, description), spp=1, seed=0))
    started = time.monotonic()
    scene = _scene(mi, description)
    total, samples, count, launch = 0.0, 0, 1, 0
    while True:
        before = time.monotonic()
        total = total + count * np.array(
            mi.render(scene, spp=count, seed=seed * 100003 + launch), np.float64
        )
        samples += count
        launch += 1
        each = (time.monotonic() - before) / count
        left = seconds - (time.monotonic() - started)
        if left < each:
            break
        count = max(1, min(2 * count, MOST_SAMPLES, int(left / each)))
    picture = (total / samples)[::-1].astype(np.float32)
    return picture, time.monotonic() - started


def _load() -> Any:
    import mitsuba

    return mitsuba


def _variant() -> str:
    """The faster one that this machine can run."""
    import drjit

    return "llvm_ad_rgb" if drjit.has_backend(drjit.JitBackend.LLVM) else "scalar_rgb"


def _scene(mi: Any, description: dict[str, Any]) -> Any:
    sensor = description["sensor"] | {
        "to_world": mi.ScalarTransform4f(description["sensor"]["to_world"])
    }
    meshes = {f"mesh_{i}": _mesh(mi, mesh) for i, mesh in enumerate(description["meshes"])}
    return mi.load_dict(
        {"type": "scene", "integrator": description["integrator"], "sensor": sensor} | meshes
    )


def _mesh(mi: Any, mesh: dict[str, Any]) -> Any:
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(mesh["bsdf"])
    if mesh["radiance"] is not None:
        properties["emitter"] = mi.load_dict(
            {"type": "area", "radiance": {"type": "rgb", "value": list(mesh["radiance"])}}
        )
    smooth = mesh["normals"] is not None
    properties["face_normals"] = not smooth
    made = mi.Mesh(
        mesh["name"],
        len(mesh["positions"]),
        len(mesh["triangles"]),
        has_vertex_normals=smooth,
        props=properties,
    )
    values = mi.traverse(made)
    values["vertex_positions"] = mesh["positions"].ravel()
    values["faces"] = mesh["triangles"].ravel()
    if smooth:
        values["vertex_normals"] = mesh["normals"].ravel()
    values.update()
    return made
