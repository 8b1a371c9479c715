"""Sums as OpenEXR files: part files, checkpoints, and sums of parts. Every float is kept as it is;
the header says in JSON what it is about.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ..files import WriteError
from ..image_rows import write_rows
from .sums import FORMAT, FilmInfo, Sums

HEADER = "photon_splat:sums"
ROWS = 64
"""Rows that are read at a time."""
COMPRESSION = "zip:1"


class SumsFileError(ValueError):
    """The file cannot be read as sums; the message is one sentence that names it."""


def _openimageio() -> Any:
    try:
        import OpenImageIO as oiio
    except ImportError as error:
        raise SumsFileError(
            f"Parts and checkpoints need OpenImageIO, which this Python lacks ({error})"
        ) from error
    return oiio


def write_sums(path: Path, layers: Sequence[Sums], *, durable: bool = False) -> None:
    """One file for all view layers of a frame, completely or not at all. durable: it is on the disk
    before an older one is replaced. Raises WriteError.
    """
    oiio = _openimageio()
    width, height = layers[0].size
    names: list[str] = []
    planes: list[np.ndarray] = []
    told = []
    for number, layer in enumerate(layers):
        kept = []
        for name, plane in layer.planes.items():
            components, _, _, channels = plane.shape
            kept.append([name, components, channels])
            names += [
                f"{number}.{name}.{component}.{channel}"
                for component in range(components)
                for channel in range(channels)
            ]
            planes += list(plane)
        told.append(
            {
                "picture": layer.picture,
                "films": [asdict(film) for film in layer.films],
                "planes": kept,
            }
        )
    spec = oiio.ImageSpec(width, height, len(names), oiio.FLOAT)
    spec.channelnames = names
    spec.attribute("compression", COMPRESSION)
    spec.attribute(HEADER, json.dumps({"format": FORMAT, "layers": told}))

    write_rows(path, spec, planes, durable=durable)


class SumsFile:
    """The header of a file, and its sums row by row."""

    def __init__(self, path: Path) -> None:
        """Raises SumsFileError."""
        self.path = path
        oiio = _openimageio()
        file = oiio.ImageInput.open(str(path))
        if file is None:
            why = " ".join(oiio.geterror().split()) if os.path.exists(path) else "it does not exist"
            raise SumsFileError(f"{path} cannot be read: {why}")
        spec = file.spec()
        self._channels = {name: i for i, name in enumerate(spec.channelnames)}
        self._count, self._width, self.height = spec.nchannels, spec.width, spec.height
        text = spec.getattribute(HEADER)
        file.close()
        if not text:
            raise SumsFileError(
                f"{path} is no part file and no checkpoint: it holds no sums of Photon Splat"
            )
        told = json.loads(text)
        if told["format"] != FORMAT:
            raise SumsFileError(
                f"{path} is of version {told['format']} of the format; this is {FORMAT}"
            )
        self._told = told["layers"]

    @property
    def floats_per_row(self) -> int:
        return self._count * self._width

    def headers(self) -> list[Sums]:
        """Of each view layer, without planes."""
        return [
            Sums(one["picture"], [FilmInfo(**film) for film in one["films"]], {})
            for one in self._told
        ]

    def rows(self, first: int, last: int) -> list[Sums]:
        """Rows first..last-1, of all view layers; row 0 is the bottom one. Raises
        SumsFileError.
        """
        oiio = _openimageio()
        file = oiio.ImageInput.open(str(self.path))
        if file is None:
            raise SumsFileError(f"{self.path} cannot be read: {oiio.geterror()}")
        pixels = file.read_scanlines(
            self.height - last, self.height - first, 0, 0, self._count, oiio.FLOAT
        )
        why = file.geterror()
        file.close()
        if pixels is None or np.shape(pixels)[0] != last - first:
            raise SumsFileError(f"{self.path} cannot be read: {why}")
        pixels = np.reshape(pixels, (last - first, -1, self._count))[::-1]
        layers = self.headers()
        for number, (layer, told) in enumerate(zip(layers, self._told, strict=True)):
            for name, components, channels in told["planes"]:
                where = [
                    self._channels[f"{number}.{name}.{component}.{channel}"]
                    for component in range(components)
                    for channel in range(channels)
                ]
                plane = pixels[..., where].reshape(*pixels.shape[:2], components, channels)
                layer.planes[name] = np.ascontiguousarray(np.moveaxis(plane, 2, 0))
        return layers

    def read(self) -> list[Sums]:
        """All of it."""
        return self.rows(0, self.height)


__all__ = ["SumsFile", "SumsFileError", "WriteError", "write_sums"]
