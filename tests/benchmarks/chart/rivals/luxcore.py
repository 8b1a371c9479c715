"""LuxCore (PyPI: pyluxcore) on our scenes: its path tracer, the same with its photon cache, and its
bidirectional one.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from tests.benchmarks.chart.rivals.exact import Exact, NoCounterpartError, Part, Surface, View

METHODS = ("LuxCore", "LuxCore, bidirectional", "LuxCore, PhotonGI")
PHOTONS = {
    "path.photongi.sampler.type": "RANDOM",
    "path.photongi.photon.maxcount": 1_000_000,
    "path.photongi.photon.maxdepth": 12,
    "path.photongi.indirect.enabled": True,
    "path.photongi.indirect.maxsize": 0,  # until its own threshold of convergence
    "path.photongi.indirect.haltthreshold": 0.05,
    "path.photongi.indirect.lookup.radius": 0.05,
    "path.photongi.caustic.enabled": True,
    "path.photongi.caustic.maxsize": 1_000_000,
    "path.photongi.caustic.lookup.radius": 0.01,
    "path.photongi.caustic.updatespp": 8,
    "path.photongi.caustic.updatespp.radiusreduction": 0.96,
    "path.photongi.caustic.updatespp.minradius": 0.002,
}
"""As its add-on for Blender sets the cache up, but for discs that fit scenes a metre wide and
shrink, and photons that are ready within seconds: the add-on's twenty millions by its Metropolis
sampler take minutes before the first sample.
"""


def describe(scene: Exact, method: str, bounces: int) -> dict[str, Any]:
    """Plain data for `render`: properties of the scene and of the render, meshes as lists.
    NoCounterpartError where it has none.
    """
    if scene.suns:
        raise NoCounterpartError("rays do not meet its sun")
    view = scene.view
    camera = view.matrix
    properties: dict[str, Any] = {
        "scene.camera.type": "perspective",
        "scene.camera.lookat.orig": camera[:3, 3].tolist(),
        "scene.camera.lookat.target": (camera[:3, 3] - camera[:3, 2]).tolist(),
        "scene.camera.up": camera[:3, 1].tolist(),
        # so that the window is measured on the plane z = -1, as ours
        "scene.camera.fieldofview": 90.0,
        "scene.camera.screenwindow": _window(view),
        "scene.camera.lensradius": 0.0,
        "scene.camera.autofocus.enable": False,
        "scene.camera.cliphither": 1e-3,
        "scene.camera.clipyon": 1e6,
    }
    for i, part in enumerate(scene.parts):
        properties |= _material(f"scene.materials.material_{i}", part.surface)
        properties |= {
            f"scene.objects.object_{i}.shape": f"mesh_{i}",
            f"scene.objects.object_{i}.material": f"material_{i}",
        }
    config: dict[str, Any] = {
        "renderengine.type": "BIDIRCPU" if method == "LuxCore, bidirectional" else "PATHCPU",
        "sampler.type": "SOBOL",
        "sampler.sobol.adaptive.strength": 0.0,
        "film.width": view.width,
        "film.height": view.height,
        "film.filter.type": "BLACKMANHARRIS",
        "film.filter.width": view.filter_radius,
        "film.imagepipelines.0.0.type": "NOP",
        "path.clamping.variance.maxvalue": 0.0,
        "light.maxdepth": bounces,
    }
    config |= {
        f"path.pathdepth.{kind}": bounces for kind in ("total", "diffuse", "glossy", "specular")
    } | {"path.maxdepth": bounces}
    if method == "LuxCore, PhotonGI":
        config |= PHOTONS
    return {
        "scene": properties,
        "config": config,
        "meshes": [_mesh(f"mesh_{i}", part) for i, part in enumerate(scene.parts)],
    }


def _window(view: View) -> list[float]:
    """Its pictures are a pixel lower than ours."""
    left, right, bottom, top = view.screen
    pixel = (top - bottom) / view.height
    return [left, right, bottom - pixel, top - pixel]


def _material(at: str, surface: Surface) -> dict[str, Any]:
    color = list(surface.color)
    if surface.kind == "glass":
        return {
            f"{at}.type": "glass",
            f"{at}.kr": color,
            f"{at}.kt": color,
            f"{at}.interiorior": surface.ior,
            f"{at}.exteriorior": 1.0,
        }
    if surface.kind == "mirror":
        return {f"{at}.type": "mirror", f"{at}.kr": color}
    matte = {f"{at}.type": "matte", f"{at}.kd": color}
    return matte | ({f"{at}.emission": list(surface.emission)} if any(surface.emission) else {})


def _mesh(name: str, part: Part) -> dict[str, Any]:
    def triples(values: np.ndarray) -> list[tuple]:
        return [tuple(row) for row in values.tolist()]

    normals = None if part.normals is None else triples(part.normals)
    return {
        "name": name,
        "points": triples(part.positions),
        "triangles": triples(part.triangles),
        "normals": normals,
    }


def version() -> str:
    """Raises ImportError where it is not installed."""
    return str(_load().Version())


def render(
    description: dict[str, Any], seconds: float, seed: int, threads: int
) -> tuple[np.ndarray, float]:
    """The picture, (height, width, 3) float32 with row 0 at the bottom, and the seconds that
    loading and rendering took.

    Black if not every pixel has had a sample.
    """
    lux = _load()
    lux.Init()
    lux.SetLogHandler(lambda kind, message: None)
    started = time.monotonic()
    scene = lux.Scene()
    for mesh in description["meshes"]:
        scene.DefineMesh(
            mesh["name"], mesh["points"], mesh["triangles"], mesh["normals"], None, None, None
        )
    scene.Parse(_properties(lux, description["scene"]))
    settings = description["config"] | {"renderengine.seed": seed, "native.threads.count": threads}
    session = lux.RenderSession(lux.RenderConfig(_properties(lux, settings), scene))
    session.Start()
    while time.monotonic() - started < seconds:
        time.sleep(min(0.02, max(seconds - (time.monotonic() - started), 0.0)))
    session.UpdateStats()
    finished = session.GetStats().Get("stats.renderengine.pass").GetInt() >= 1
    session.Stop()
    width, height = description["config"]["film.width"], description["config"]["film.height"]
    picture = np.zeros((height, width, 3), np.float32)
    if finished:
        session.GetFilm().GetOutputFloat(lux.FilmOutputType.RGB_IMAGEPIPELINE, picture, 0)
    return picture, time.monotonic() - started


def _load() -> Any:
    import pyluxcore

    return pyluxcore


def _properties(lux: Any, values: dict[str, Any]) -> Any:
    made = lux.Properties()
    for key, value in values.items():
        made.Set(lux.Property(key, value))
    return made
