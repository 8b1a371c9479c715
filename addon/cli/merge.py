"""photon-splat merge: one picture, or the sums of one, from the sums of its parts."""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from ..core.render.cryptomatte import metadata as matte_metadata
from ..core.render.denoise_result import denoise_result
from ..core.render.final_film import final_arrays, final_passes
from ..core.render.result import Passes
from ..core.render.settings import RenderSettings
from ..core.render.sums import DifferentPictures, Sums, added, check_alike
from ..core.render.sums_file import SumsFile, SumsFileError, write_sums
from .arguments import CommandError
from .exr import channels_of, replace_file, try_file, write_exr
from .progress import say

FLOATS_AT_ONCE = 1 << 26
"""Of the rows of all files that are added at a time."""
DISAGREE = 2.0
"""The variance that parts show by their differences over that which they know of, or the other way
round, from which there is a warning.
"""


def add_command(commands: Any) -> None:
    m = commands.add_parser(
        "merge", help="make a picture of part files, checkpoints, or sums of them"
    )
    m.add_argument("parts", type=Path, nargs="+", metavar="PART.exr|FOLDER")
    m.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.exr")
    m.add_argument(
        "--denoise",
        action=argparse.BooleanOptionalAction,
        help="run Open Image Denoise on the picture (default: as the parts were asked to)",
    )
    m.add_argument(
        "--expect", type=int, metavar="N", help="parts there should be (default: as planned)"
    )
    m.add_argument(
        "--keep-sums",
        action="store_true",
        help="write the sums, for another merge, instead of a picture",
    )
    m.add_argument("--threads", type=int, default=0, metavar="N", help="0 = all")
    m.add_argument("--stats", type=Path, metavar="FILE.json", help="write what there is as JSON")
    m.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Raises CommandError and WriteError; nothing is written then."""
    began = time.monotonic()
    _check(options)
    try:
        files = [SumsFile(path) for path in found(options.parts)]
        layers = merged(files, options.threads, components=options.keep_sums)
    except (SumsFileError, DifferentPictures) as error:
        raise CommandError(str(error)) from error
    warnings = missing(layers, options.expect)
    told: dict[str, Any] = {
        "files": [str(file.path) for file in files],
        "layers": [],
        "warnings": warnings,
    }
    if options.keep_sums:
        write_sums(options.output, layers)
        told["layers"] = [_told(layer) for layer in layers]
    else:
        pictures = []
        for layer in layers:
            passes, figures, more = picture(layer, options.denoise, options.threads)
            pictures.append(passes)
            told["layers"].append(_told(layer) | {"error": figures})
            warnings += more
        _write(options.output, layers, pictures, told)
    told["seconds"] = time.monotonic() - began
    if options.stats is not None:
        text = json.dumps(told, indent=2) + "\n"
        replace_file(options.stats, lambda path: path.write_text(text))
    for warning in dict.fromkeys(warnings):
        say(f"photon-splat: warning: {warning}\n")


def found(paths: Iterable[Path]) -> list[Path]:
    """The files, and of a folder those in it that hold sums. Raises CommandError where there are
    none, or a file is there twice.
    """
    files: list[Path] = []
    for path in paths:
        if not path.is_dir():
            files.append(path)
            continue
        inside = [file for file in sorted(path.glob("*.exr")) if not file.name.startswith(".")]
        holding = [file for file in inside if _holds_sums(file)]
        if not holding:
            raise CommandError(f"{path} holds no part files")
        files += holding
    seen: dict[str, Path] = {}
    for file in files:
        real = os.path.realpath(file)
        if real in seen:
            raise CommandError(f"{file} is named twice")
        seen[real] = file
    return files


def _holds_sums(path: Path) -> bool:
    try:
        SumsFile(path)
    except SumsFileError as error:
        return "no part file" not in str(error)  # a broken one is not passed over
    return True


def merged(files: Sequence[SumsFile], threads: int = 0, *, components: bool = False) -> list[Sums]:
    """The sums of all files by view layer; with all components, or the nearest float alone. Raises
    DifferentPictures and SumsFileError.
    """
    headers = [file.headers() for file in files]
    names = list(dict.fromkeys(layer.layer for layers in headers for layer in layers))
    for name in names:
        there = [
            (layer, str(file.path))
            for layers, file in zip(headers, files, strict=True)
            for layer in layers
            if layer.layer == name
        ]
        check_alike([layer for layer, _ in there], [path for _, path in there])
    sizes = {file.height for file in files}
    if len(sizes) > 1:
        raise DifferentPictures("The pictures are not of the same size")
    height = files[0].height
    rows = max(1, min(height, FLOATS_AT_ONCE // max(1, sum(file.floats_per_row for file in files))))

    def add(first: int) -> list[Sums]:
        read = [file.rows(first, min(first + rows, height)) for file in files]
        totals = []
        for name in names:
            total = added([layer for layers in read for layer in layers if layer.layer == name])
            for plane in [] if components else list(total.planes):
                total.planes[plane] = total.planes[plane][:1]
            totals.append(total)
        return totals

    with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
        pieces = list(pool.map(add, range(0, height, rows)))
    return [_joined([piece[i] for piece in pieces]) for i in range(len(names))]


def _joined(pieces: list[Sums]) -> Sums:
    """One picture of its rows, from the bottom up."""
    whole = Sums(pieces[0].picture, pieces[0].films)
    for name in sorted({name for piece in pieces for name in piece.planes}):
        planes = [piece.planes[name] for piece in pieces if name in piece.planes]
        most = max(len(plane) for plane in planes)
        whole.planes[name] = np.concatenate(
            [np.pad(plane, ((0, most - len(plane)), (0, 0), (0, 0), (0, 0))) for plane in planes],
            axis=1,
        )
    return whole


def missing(layers: Sequence[Sums], expected: int | None) -> list[str]:
    """Warnings of parts that are not there."""
    warnings = []
    for layer in layers:
        there = {film.part for film in layer.films}
        wanted = expected or layer.picture["parts"]
        gone = sorted(set(range(1, wanted + 1)) - there)
        if len(there) < wanted and gone:
            names = ", ".join(map(str, gone[:20])) + (" and more" if len(gone) > 20 else "")
            warnings.append(
                f"Of {wanted} parts {len(gone)} are missing ({names}): the picture is noisier"
            )
    return list(dict.fromkeys(warnings))


def picture(
    sums: Sums, denoise: bool | None, threads: int
) -> tuple[Passes, dict[str, float], list[str]]:
    """The passes of a view layer, its error, and warnings."""
    scene, film = sums.scene(), sums.film(threads)
    wants = sums.picture["settings"]["denoise"] if denoise is None else denoise
    arrays = film.film(final_arrays(None, RenderSettings(denoise=wants), scene))
    passes = final_passes(arrays, scene) | sums.data()
    error, warnings = film.error(), list(sums.picture["warnings"])
    between = error["between"]
    if len(sums.films) > 1 and between and not 1 / DISAGREE < between < DISAGREE:
        warnings.append(
            f"The parts differ from each other {between**0.5:.2g} times as much as their own error "
            "estimates say"
        )
    if wants:
        warnings += denoise_result(
            passes,
            arrays,
            scene,
            passes_done=sums.passes,
            samples=sums.samples,
            threads=threads,
            on_card=True,
        )
    return passes, error, warnings


def _told(layer: Sums) -> dict[str, Any]:
    return {
        "name": layer.layer,
        "parts": sorted({film.part for film in layer.films}),
        "passes": layer.passes,
        "samples": layer.samples,
        "render_seconds": sum(film.seconds for film in layer.films),
    }


def _write(
    path: Path, layers: Sequence[Sums], pictures: Sequence[Passes], told: dict[str, Any]
) -> None:
    names: list[str] = []
    planes: list[np.ndarray] = []
    metadata: dict[str, str | int | float] = {
        "Software": f"Photon Splat {layers[0].picture['engine']}",
        "photon_splat:passes": layers[0].passes,
        "photon_splat:parts": len({film.part for film in layers[0].films}),
        "photon_splat:integrator": layers[0].picture["settings"]["integrator"],
        **{
            f"photon_splat:{name}": float(told["layers"][0]["error"][name])
            for name in ("relative_rmse", "standard_error", "bias")
        },
    }
    for i, (layer, passes) in enumerate(zip(layers, pictures, strict=True)):
        prefix = f"{layer.layer}." if i else ""
        more, others = channels_of(passes, prefix, plain=not i)
        names += more
        planes += others
        for matte, things in layer.picture["mattes"].items():
            metadata |= matte_metadata(f"{prefix}{matte}", things)
    write_exr(
        path,
        names,
        planes,
        layers[0].frame,
        crop=layers[0].picture["crop"],
        pixel_aspect=layers[0].picture["pixel_aspect"],
        metadata=metadata,
    )


def _check(options: argparse.Namespace) -> None:
    """Before anything is read."""
    if options.output.suffix.lower() != ".exr":
        raise CommandError(
            f"{options.output} does not end in .exr: pictures are written as OpenEXR"
        )
    for path in options.parts:
        if not path.exists():
            raise CommandError(f"{path} does not exist")
        if path.is_file() and options.output.exists() and path.samefile(options.output):
            raise CommandError(f"--output and a part name the same file, {path}")
    for path in filter(None, (options.output, options.stats)):
        if path.is_dir():
            raise CommandError(f"{path} is a folder")
        try_file(path)
