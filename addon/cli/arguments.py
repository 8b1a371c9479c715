"""The options of photon-splat render: what they may be, and what they change of settings."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any, NoReturn

from ..core.render.record import SECONDS
from ..core.render.settings import (
    Backend,
    FinalGather,
    Integrator,
    RenderSettings,
)
from .exr import real_path, try_file
from .frames import FIRST, LAST, NUMBERED, frame_list, has_number, with_number
from .parts import part

UNLIMITED_PASSES = 1 << 30
MOST_PHOTONS = 1 << 40


class CommandError(Exception):
    """What went wrong, as one sentence for the user, and the exit status."""

    status = 1


class Interrupted(CommandError):
    """Somebody has ended the render."""


class Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise CommandError(f"{message} (see photon-splat --help)")


def _number(kind: type, low: float, high: float = math.inf) -> Callable[[str], Any]:
    def parse(text: str) -> Any:
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high or math.isinf(value):
            bounds = (
                f"{low:,.12g} or more"
                if math.isinf(high)
                else f"between {low:,.12g} and {high:,.12g}"
            )
            raise argparse.ArgumentTypeError(f"'{text}' is not a number {bounds}")
        return value

    return parse


def _resolution(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if not (
        width.isdecimal()
        and height.isdecimal()
        and 4 <= int(width) <= 65536
        and 4 <= int(height) <= 65536
    ):
        raise argparse.ArgumentTypeError(
            f"'{text}' is not WIDTHxHEIGHT with sides between 4 and 65536 pixels"
        )
    return int(width), int(height)


def add_command(commands: Any) -> None:
    r = commands.add_parser("render", help="render frames of a .blend file to OpenEXR files")
    r.add_argument("scene", type=Path, metavar="SCENE.blend")
    r.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.exr")
    frames = r.add_mutually_exclusive_group()
    frames.add_argument(
        "--frame",
        type=_number(int, FIRST, LAST),
        metavar="N",
        help="frame to render (default: the file's current one)",
    )
    frames.add_argument(
        "--frames",
        type=frame_list,
        metavar="LIST",
        help="frames to render, like 1-10,15; the names of files have # for the number",
    )
    r.add_argument(
        "--skip-existing",
        action="store_true",
        help="leave out frames whose picture is there",
    )
    r.add_argument(
        "--seconds",
        type=_number(float, 1e-3),
        metavar="S",
        help="stop after S seconds, in each view layer; with no --passes, only then",
    )
    r.add_argument(
        "--error",
        type=_number(float, 1e-6),
        metavar="X",
        help="stop at this relative error; with no --passes, only then",
    )
    r.add_argument(
        "--passes", type=_number(int, 1, UNLIMITED_PASSES), metavar="N", help="stop after N passes"
    )
    r.add_argument(
        "--photons-per-pass",
        type=_number(int, 0, MOST_PHOTONS),
        metavar="N",
        help="photon paths of the first pass",
    )
    r.add_argument(
        "--resolution", type=_resolution, metavar="WxH", help="size of the picture in pixels"
    )
    r.add_argument("--seed", type=_number(int, 0, 2**32 - 1), metavar="N")
    r.add_argument("--threads", type=_number(int, 0, 1024), metavar="N", help="0 = all")
    r.add_argument(
        "--integrator",
        choices=[i.value for i in Integrator],
        help="reference: a plain unbiased path tracer",
    )
    r.add_argument(
        "--backend",
        choices=[b.value for b in Backend],
        type=str.upper,
        help="what splats the photons",
    )
    r.add_argument(
        "--max-bounces",
        type=_number(int, 0, 1024),
        metavar="N",
        help="surface bounces between light and camera",
    )
    r.add_argument(
        "--radius-scale",
        type=_number(float, 1e-3, 1e3),
        metavar="X",
        help="multiplies the automatic kernel radius",
    )
    r.add_argument(
        "--point-spacing",
        type=_number(float, 0, 1),
        metavar="X",
        help="distance of gather points, in kernel radii; 0 = one per sample",
    )
    r.add_argument(
        "--no-boundary-correction", dest="boundary_correction", action="store_const", const=False
    )
    r.add_argument(
        "--denoise",
        action=argparse.BooleanOptionalAction,
        help="run Open Image Denoise on the finished picture (default: if the file says so)",
    )
    r.add_argument(
        "--no-adaptive-radius",
        dest="adaptive_radius",
        action="store_const",
        const=False,
        help="one law for all pixels",
    )
    r.add_argument(
        "--no-adaptive-samples",
        dest="adaptive_samples",
        action="store_const",
        const=False,
        help="passes are all alike",
    )
    r.add_argument(
        "--no-adaptive-indirect",
        dest="adaptive_indirect",
        action="store_const",
        const=False,
        help="no camera paths where photons serve badly",
    )
    r.add_argument(
        "--final-gather",
        choices=[g.value for g in FinalGather],
        type=str.upper,
        help="photons light what camera paths meet second",
    )
    r.add_argument(
        "--part",
        type=part,
        metavar="I/N",
        help="render one of N parts: OUT.exr then holds sums for photon-splat merge",
    )
    r.add_argument(
        "--checkpoint",
        type=Path,
        metavar="FILE.exr",
        help="go on from this file if it is there, and keep in it what has been rendered",
    )
    r.add_argument(
        "--checkpoint-every",
        type=_number(float, 0),
        metavar="S",
        help=f"seconds between two checkpoints (default: {SECONDS:g})",
    )
    r.add_argument(
        "--strict",
        action="store_true",
        help="a missing file of the scene is an error, as it always is with --part",
    )
    r.add_argument(
        "--stats", type=Path, metavar="FILE.json", help="write what the render did as JSON"
    )
    r.add_argument(
        "--mkdir", action="store_true", help="make the folders of the files that are written"
    )
    r.add_argument(
        "--progress",
        choices=["bar", "openjd"],
        default="bar",
        help="openjd: lines for programs that run jobs of Open Job Description",
    )
    r.add_argument("--verbose", action="store_true", help="let Blender's own messages through")


def settings_of(options: argparse.Namespace) -> Callable[[RenderSettings], RenderSettings]:
    """Returns a function that applies the options to the scene's own settings."""
    given: dict[str, Any] = {
        name: getattr(options, name)
        for name in (
            "photons_per_pass",
            "seed",
            "threads",
            "max_bounces",
            "radius_scale",
            "point_spacing",
            "boundary_correction",
            "denoise",
            "adaptive_radius",
            "adaptive_samples",
            "adaptive_indirect",
            "passes",
        )
        if getattr(options, name) is not None
    }
    if options.integrator is not None:
        given["integrator"] = Integrator(options.integrator)
    if options.final_gather is not None:
        given["final_gather"] = FinalGather(options.final_gather)
    if options.backend is not None:
        given["backend"] = Backend(options.backend)
    if options.error is not None or options.seconds is not None:
        given |= {
            "error_threshold": options.error or 0.0,
            "time_limit": options.seconds or 0.0,
            "passes": options.passes or UNLIMITED_PASSES,
        }
    elif options.passes is not None:
        given |= {"time_limit": 0.0, "error_threshold": 0.0}
    return lambda plain: replace(plain, **given)


def check_paths(options: argparse.Namespace) -> None:
    if not os.path.isfile(options.scene):
        raise CommandError(
            f"{options.scene} does not exist"
            if not os.path.exists(options.scene)
            else f"{options.scene} is not a file"
        )
    if options.output.suffix.lower() != ".exr":
        raise CommandError(
            f"{options.output} does not end in .exr: pictures are written as OpenEXR"
        )
    if options.frames is not None:
        options = _with_first_frame(options)
    if options.checkpoint is None and options.checkpoint_every is not None:
        raise CommandError("--checkpoint-every needs --checkpoint")
    if options.checkpoint is not None and options.checkpoint.suffix.lower() != ".exr":
        raise CommandError(f"{options.checkpoint} does not end in .exr: checkpoints are OpenEXR")
    given = {
        "--stats": options.stats,
        "--checkpoint": options.checkpoint,
        "--output": options.output,
        "the scene": options.scene,
    }
    for one, other in combinations(given, 2):
        a, b = given[one], given[other]
        if a is not None and b is not None and _same_file(a, b):
            raise CommandError(f"{one} and {other} name the same file")
    for path in filter(None, (options.output, options.stats, options.checkpoint)):
        if options.mkdir:
            _make_folder(path.parent)
        if os.path.isdir(path):  # isdir() is False for names that are too long
            raise CommandError(f"{path} is a folder")
        if not os.path.isdir(path.parent):
            raise CommandError(f"{path} cannot be written: the folder {path.parent} does not exist")
        if not os.access(path.parent, os.W_OK):
            raise CommandError(f"{path} cannot be written: no permission in {path.parent}")
        try_file(path)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CommandError(f"the folder {folder} cannot be made: {error.strerror}") from error


def _with_first_frame(options: argparse.Namespace) -> argparse.Namespace:
    """The files of the first frame, which stand for those of all."""
    first = argparse.Namespace(**vars(options))
    for name in NUMBERED:
        path = getattr(options, name)
        if path is None:
            continue
        if not has_number(path):
            raise CommandError(
                f"{path} has no # for the number of the frame, which --frames needs in "
                f"--{name}: f_####{path.suffix}"
            )
        setattr(first, name, with_number(path, options.frames[0]))
    return first


def _same_file(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except OSError:  # one of them does not exist yet
        return real_path(one) == real_path(other)
