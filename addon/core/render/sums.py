"""What a film has summed up, apart from the render that made it: sums of several films are added
without any rounding, so that neither order nor grouping changes a bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..native.library import load
from ..scene import Aperture, Camera, Frame, Labels, PixelFilter, Scene
from .fingerprint import fingerprint
from .result import Passes
from .settings import RenderSettings
from .shadow_catcher import has_catchers

FORMAT = 4
OF_LENGTH = ("passes", "time_limit", "error_threshold", "threads", "backend")
"""Settings in which renders of one picture may differ."""
ADDED = ("sum", "error", "group")
"""Kinds of planes that are added; those of others are taken from the first film."""

Planes = dict[str, NDArray[np.float32]]


class DifferentPictures(ValueError):
    """Sums that do not belong together; the message says why."""


@dataclass(slots=True)
class FilmInfo:
    """One render whose film is in the sums. samples: of a pixel, on average. paths: by photon
    map. photons: likewise those of the next pass over those of the first.
    """

    part: int
    generation: int
    passes: int
    samples: float
    seconds: float
    paths: list[int]
    photons: list[float]

    @property
    def name(self) -> tuple[int, int]:
        return self.part, self.generation

    def __str__(self) -> str:
        return f"part {self.part}" + (f", generation {self.generation}" * (self.generation > 0))


@dataclass(slots=True)
class Sums:
    """Of one view layer. picture: what all renders of it have in common. planes: by kind and name
    ("sum.diffuse_direct") (components, height, width, channels), row 0 at the bottom, whose exact
    sum over components is the value, the first the nearest float to it; one that is missing is 0.
    """

    picture: dict[str, Any]
    films: list[FilmInfo] = field(default_factory=list)
    planes: Planes = field(default_factory=dict)

    @property
    def layer(self) -> str:
        return str(self.picture["layer"])

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        width, height = self.frame.region[2:]
        return width, height

    @property
    def frame(self) -> Frame:
        kept = dict(self.picture["frame"])
        kept["pixel_filter"] = PixelFilter(kept["pixel_filter"])
        kept["border"] = tuple(kept["border"]) if kept["border"] else None
        return Frame(**kept)

    @property
    def passes(self) -> int:
        return sum(film.passes for film in self.films)

    @property
    def samples(self) -> float:
        return sum(film.samples for film in self.films)

    @property
    def paths(self) -> list[int]:
        maps = max((len(film.paths) for film in self.films), default=0)
        return [
            sum(film.paths[i] for film in self.films if i < len(film.paths)) for i in range(maps)
        ]

    def scene(self) -> Scene:
        """An empty scene that asks for the same passes of the same frame."""
        told, labels = self.picture, self.picture["labels"]
        lens = Aperture(**told["aperture"]) if told["aperture"] else None
        scene = Scene(Camera(np.eye(4), (-1.0, 1.0, -1.0, 1.0), aperture=lens), self.frame)
        scene.light_groups, scene.shadow_pass = list(told["light_groups"]), told["shadow_pass"]
        if told["catchers"]:
            scene.instances.catcher = np.zeros(0, bool)
        if labels is not None:
            scene.labels = Labels(list(labels))
        return scene

    def data(self) -> Passes:
        """The passes that no film makes."""
        return {
            name.removeprefix("data."): np.ascontiguousarray(plane[0])
            for name, plane in self.planes.items()
            if name.startswith("data.")
        }

    def film(self, threads: int = 0) -> Any:
        """A film of them, whose film() and error() are those of the native module."""
        width, height = self.size
        groups = len(self.picture["light_groups"])
        made = load().SummedFilm(
            width,
            height,
            groups,
            self.frame.exposure,
            self.frame.transparent,
            self.picture["catchers"],
            threads,
        )

        def nearest(kind: str) -> Planes:
            return {
                name.removeprefix(f"{kind}."): np.ascontiguousarray(plane[0])
                for name, plane in self.planes.items()
                if name.startswith(f"{kind}.")
            }

        light = np.zeros((groups, height, width, 3), np.float32)
        for name, plane in nearest("group").items():
            light[int(name)] = plane
        made.set(
            nearest("sum") | nearest("first"), nearest("error"), light, self.passes, len(self.films)
        )
        return made


def picture_of(
    scene: Scene, settings: RenderSettings, parts: int, origin: dict[str, Any]
) -> dict[str, Any]:
    """What all renders of a picture have in common, as JSON carries it. origin: who renders what:
    engine, blender, file, scene, number of the frame, layer; whether a border is cropped; a pixel's
    width over its height; names in mattes, and warnings.
    """
    kept = {name: value for name, value in asdict(settings).items() if name not in OF_LENGTH}
    frame = asdict(scene.frame)
    return {
        "format": FORMAT,
        "engine": "",
        "blender": "",
        "file": "",
        "scene": "",
        "number": 0,
        "layer": "",
        "crop": False,
        "pixel_aspect": 1.0,
        "mattes": {},
        "warnings": [],
        **origin,
        "parts": parts,
        "fingerprint": fingerprint(scene),
        "settings": {
            name: list(value) if isinstance(value, tuple) else value for name, value in kept.items()
        },
        "frame": frame | {"border": list(frame["border"]) if frame["border"] else None},
        "aperture": asdict(scene.camera.aperture) if scene.camera.aperture else None,
        "light_groups": list(scene.light_groups),
        "catchers": has_catchers(scene),
        "shadow_pass": scene.shadow_pass,
        "labels": list(scene.labels.passes) if scene.labels is not None else None,
    }


def from_film(picture: dict[str, Any], film: FilmInfo, sums: dict[str, Any], data: Passes) -> Sums:
    """Of one render; `sums`: what the native film_sums() tells."""
    planes = {f"sum.{name}": array[None] for name, array in sums["summed"].items()}
    planes |= {f"first.{name}": array[None] for name, array in sums["first"].items()}
    planes |= {f"error.{name}": array[None] for name, array in sums["error"].items()}
    planes |= {f"group.{i}": array[None] for i, array in enumerate(sums["light_groups"])}
    planes |= {f"data.{name}": array[None] for name, array in data.items()}
    return Sums(picture, [film], planes)


def difference(one: dict[str, Any], other: dict[str, Any]) -> str:
    """Why renders of these two pictures do not go together, as the end of a sentence; "" if they
    do.
    """
    sayings = {
        "format": "the version of the format is {} and {}",
        "engine": "the engine is Photon Splat {} and {}",
        "blender": "Blender is {} and {}",
        "layer": "the view layer is '{}' and '{}'",
        "number": "the frame is {} and {}",
        "parts": "the picture is planned for {} parts and for {}",
    }
    for key, saying in sayings.items():
        if one.get(key) != other.get(key):
            return saying.format(one.get(key), other.get(key))
    for key in sorted({*one["settings"], *other["settings"]}):
        a, b = one["settings"].get(key), other["settings"].get(key)
        if a != b:
            return f"{key} is {a} and {b}"
    if one["frame"] != other["frame"]:
        return "size, border, exposure or another setting of the film is not the same"
    if one["labels"] != other["labels"] or one["light_groups"] != other["light_groups"]:
        return "passes or light groups are not the same"
    if one["fingerprint"] != other["fingerprint"]:
        return "the scene is not the same"
    return ""


def check_alike(sums: Sequence[Sums], names: Sequence[str]) -> None:
    """names: of the files, for the message. Raises DifferentPictures if they are of different
    pictures, or if the film of a render is in two of them.
    """
    seen: dict[tuple[int, int], str] = {}
    for one, name in zip(sums, names, strict=True):
        why = difference(sums[0].picture, one.picture)
        if why:
            raise DifferentPictures(f"{names[0]} and {name} do not go together: {why}")
        for film in one.films:
            if film.name in seen:
                raise DifferentPictures(f"{film} is in {seen[film.name]} and in {name}")
            seen[film.name] = name


def added(sums: Sequence[Sums]) -> Sums:
    """The sums of several, without rounding; what is not added is that of the lowest part. They
    have been checked.
    """
    ordered = sorted(sums, key=lambda one: min(film.name for film in one.films))
    planes: Planes = {}
    for name in sorted({name for one in sums for name in one.planes}):
        there = [one.planes[name] for one in ordered if name in one.planes]
        if name.split(".")[0] not in ADDED:
            if name in ordered[0].planes:
                planes[name] = ordered[0].planes[name]
            continue
        shape = there[0].shape[1:]
        terms = np.concatenate([plane.reshape(len(plane), -1) for plane in there])
        planes[name] = load().exact_sums(terms).reshape(-1, *shape)
    films = sorted((film for one in sums for film in one.films), key=lambda film: film.name)
    return Sums(ordered[0].picture, films, planes)
