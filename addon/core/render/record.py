"""What a render keeps of its sums: for a part file, for a checkpoint that a later render goes on
from, or, as a rule, nothing.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..scene import Scene
from .parts import Part
from .result import Passes
from .settings import RenderSettings
from .sums import DifferentPictures, FilmInfo, Sums, added, difference, from_film, picture_of
from .sums_file import SumsFile, WriteError, write_sums

SECONDS = 600.0
"""Between two checkpoints, unless somebody asks for another time."""
SAMPLES = "samples"
"""Plane of a checkpoint: what has been seen and chosen of samples."""


class Checkpoint:
    """The file of one frame, for all of its view layers."""

    def __init__(self, path: Path, every: float = SECONDS, *, resume: bool = True) -> None:
        """resume: goes on from the file if it exists; it is replaced otherwise. Raises
        SumsFileError.
        """
        self.path, self.every = path, every
        self.layers: dict[str, Sums] = {}
        self.failure = ""
        self._last = time.monotonic()
        if resume and path.exists():
            self.layers = {sums.layer: sums for sums in SumsFile(path).read()}

    @property
    def due(self) -> bool:
        return time.monotonic() - self._last >= self.every

    def put(self, sums: Sums) -> None:
        """Writes the file. Where that fails the older one stays, and `failure` says why."""
        self.layers[sums.layer] = sums
        try:
            write_sums(self.path, list(self.layers.values()), durable=True)
            self.failure = ""
        except WriteError as error:
            self.failure = str(error)
        self._last = time.monotonic()

    def forget_planes(self, layer: str) -> None:
        """Of a view layer that is put again when more of it is done."""
        if layer in self.layers:
            self.layers[layer] = replace(self.layers[layer], planes={})

    def drop(self, layer: str) -> None:
        """A view layer that is finished; with the last one the file goes."""
        self.layers.pop(layer, None)
        if not self.layers:
            self.path.unlink(missing_ok=True)


class Record:
    """Of one view layer in one render. The calls come in the order of the methods; those up to
    built() and pass_done() on the thread that does passes.
    """

    def __init__(
        self,
        part: Part | None = None,
        *,
        keeps: bool = False,
        checkpoint: Checkpoint | None = None,
        origin: dict[str, Any] | None = None,
    ) -> None:
        """keeps: `total` is wanted, and no picture: nothing is denoised. origin: see
        picture_of().
        """
        self.part = part or Part()
        self.keeps, self.checkpoint = keeps, checkpoint
        self.origin = origin or {}
        self.earlier: Sums | None = None
        self.total: Sums | None = None
        self.picture: dict[str, Any] = {}
        self.data: Passes = {}
        self.started = 0.0
        self._film: Any = None

    @property
    def active(self) -> bool:
        return self.keeps or self.checkpoint is not None or not self.part.whole

    @property
    def seconds_before(self) -> float:
        return sum(film.seconds for film in self.earlier.films) if self.earlier else 0.0

    @property
    def samples_before(self) -> float:
        return self.earlier.samples if self.earlier else 0.0

    def open(self, scene: Scene, settings: RenderSettings, started: float) -> None:
        """Finds what there is of this picture. Raises DifferentPictures if the checkpoint is of
        another one.
        """
        self.started = started
        if not self.active:
            return
        self.picture = picture_of(scene, settings, self.part.count, self.origin)
        there = self.checkpoint
        self.earlier = there.layers.get(self.picture["layer"]) if there else None
        if self.earlier is None or there is None:
            return
        why = difference(self.earlier.picture, self.picture)
        wrong = next((film for film in self.earlier.films if film.part != self.part.number), None)
        if not why and SAMPLES not in self.earlier.planes:
            why = "it is a part file"
        if not why and wrong is not None:
            why = f"it holds part {wrong.part}, and this is part {self.part.number}"
        if why:
            raise DifferentPictures(
                f"The checkpoint {there.path} is not of this render ({why}): remove it, or choose "
                "another file"
            )
        self.part = replace(
            self.part,
            generation=1 + max(film.generation for film in self.earlier.films),
            passes_before=self.earlier.passes,
            paths_before=tuple(self.earlier.paths),
        )

    def set_up(self, renderer: Any) -> None:
        """Before it is built."""
        if self.active:
            self.part.tell(renderer)

    def built(self, renderer: Any, data: Passes) -> None:
        """data: the passes that no film makes."""
        self.data = data
        if self.earlier is None:
            return
        for name, plane in self.earlier.planes.items():
            if name == SAMPLES:
                renderer.set_samples_known(plane[0], self.earlier.films[-1].photons)
            if name.startswith("radius."):
                renderer.set_radii_known(int(name.removeprefix("radius.")), plane[0])

    def pass_done(self, renderer: Any, passes: int, samples: float) -> None:
        """After each pass: writes a checkpoint where one is due. samples: of a pixel so far."""
        if self.checkpoint is not None and self.checkpoint.due:
            self.checkpoint.put(self._all(renderer, passes, samples))
            self.checkpoint.forget_planes(self.picture["layer"])

    def end(self, renderer: Any, passes: int, samples: float) -> Any:
        """When no pass follows, the render cancelled or not: keeps what there is, and returns what
        tells the film of it, or None where nothing has been rendered at all.
        """
        if not self.active:
            return renderer if passes else None
        if passes:
            self.total = self._all(renderer, passes, samples)
            if self.checkpoint is not None:
                self.checkpoint.put(self.total)
        else:
            self.total = self.earlier
        if self.total is None:
            return None
        self._film = self.total.film() if self.earlier else None
        return self._film or renderer

    def error(self, of_render: Any) -> Any:
        """Of the picture: `of_render`, statistics["error"] of the last render, unless there were
        others before it.
        """
        if self.earlier is None or self._film is None:
            return of_render
        return {name: value for name, value in self._film.error().items() if name != "between"}

    def forget(self) -> None:
        """The render is finished: its checkpoint goes."""
        if self.checkpoint is not None:
            self.checkpoint.drop(self.picture["layer"])

    def warnings(self) -> list[str]:
        """For the user."""
        failure = self.checkpoint.failure if self.checkpoint is not None else ""
        return [f"There is no checkpoint of the last passes: {failure}"] if failure else []

    def _all(self, renderer: Any, passes: int, samples: float) -> Sums:
        resumable = self.checkpoint is not None
        samples_known, photons = renderer.samples_known if resumable else (None, [])
        film = FilmInfo(
            self.part.number,
            self.part.generation,
            passes,
            samples,
            time.monotonic() - self.started,
            list(renderer.paths_done),
            photons,
        )
        mine = from_film(self.picture, film, renderer.film_sums(), self.data)
        total = mine if self.earlier is None else added([self.earlier, mine])
        for name in [n for n in total.planes if n == SAMPLES or n.startswith("radius.")]:
            del total.planes[name]
        if samples_known is not None:
            for i, known in enumerate(renderer.radii_known):
                total.planes[f"radius.{i}"] = known[None]
            total.planes[SAMPLES] = samples_known[None]
        return total
