"""photon-splat info: what a part file, a checkpoint or a picture is."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from ..core.render.sums import Sums
from ..core.render.sums_file import SumsFile, SumsFileError
from .arguments import CommandError


def add_command(commands: Any) -> None:
    i = commands.add_parser("info", help="say what a file of Photon Splat holds")
    i.add_argument("file", type=Path, metavar="FILE.exr")
    i.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Raises CommandError."""
    try:
        layers = SumsFile(options.file).headers()
    except SumsFileError as error:
        text = _picture(options.file)
        if text is None:
            raise CommandError(str(error)) from error
    else:
        text = "\n".join(_sums(layer) for layer in layers)
    sys.stdout.write(text)


def _sums(layer: Sums) -> str:
    told = layer.picture
    width, height = layer.size
    lines = [
        f"sums of view layer '{layer.layer}', frame {told['number']} of '{told['file']}'",
        f"size         {width} x {height}",
        f"fingerprint  {told['fingerprint']}",
        f"seed         {told['settings']['seed']}",
        f"engine       Photon Splat {told['engine']}, Blender {told['blender']}",
        f"passes       {layer.passes} of {told['parts']} parts planned",
        f"paths        {', '.join(f'{paths:,}' for paths in layer.paths)} (by photon map)",
    ]
    lines += [f"  {film}: {film.passes} passes, {film.seconds:.1f} s" for film in layer.films]
    return "\n".join(lines) + "\n"


def _picture(path: Path) -> str | None:
    """None: it is no picture of ours."""
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(str(path))
    if file is None:
        return None
    spec = file.spec()
    file.close()
    told = {a.name: a.value for a in spec.extra_attribs if a.name.startswith("photon_splat:")}
    if not told:
        return None
    lines = [f"picture of {spec.getattribute('Software')}, {spec.width} x {spec.height}"]
    lines += [f"{name.removeprefix('photon_splat:'):15} {value}" for name, value in told.items()]
    return "\n".join(lines) + "\n"
