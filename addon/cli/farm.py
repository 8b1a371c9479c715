"""photon-splat farm: writes what Open Job Description, Flamenco or Slurm need to render a file."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any

from ..farm import Animation, FarmError, Job, Still, System, write_bundle
from .arguments import CommandError
from .frames import frame_list
from .opening import open_file
from .process import silence_blender
from .progress import say


def add_command(commands: Any) -> None:
    f = commands.add_parser(
        "farm",
        help="write a job for a render farm",
        allow_abbrev=False,
        epilog="Further options go to photon-splat render, such as --passes 32.",
    )
    f.add_argument("scene", type=Path, metavar="SCENE.blend")
    what = f.add_mutually_exclusive_group(required=True)
    what.add_argument("--still", type=int, metavar="N", help="the current frame in N parts")
    what.add_argument("--animation", action="store_true", help="all frames, each on one machine")
    f.add_argument("--frame", type=int, metavar="N", help="of --still, instead of the current one")
    f.add_argument(
        "--frames", type=frame_list, metavar="LIST", help="of --animation, instead of all"
    )
    f.add_argument(
        "--chunk", type=int, default=5, metavar="N", help="frames of a task (default: 5)"
    )
    f.add_argument("-o", "--output", type=Path, required=True, metavar="BUNDLE")
    f.add_argument(
        "--for",
        dest="system",
        choices=[system.value for system in System],
        default=System.OPENJD.value,
        help="the scheduler (default: openjd)",
    )
    f.add_argument(
        "--results",
        metavar="FOLDER",
        help="where pictures go, as workers reach it (default: BUNDLE/output)",
    )
    f.add_argument(
        "--worker-command",
        default="photon-splat",
        metavar="COMMAND",
        help="the command on the workers (default: photon-splat)",
    )
    f.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Raises CommandError."""
    if not os.path.isfile(options.scene):
        raise CommandError(f"{options.scene} does not exist")
    if options.still is None and options.frame is not None:
        raise CommandError("--frame needs --still")
    if options.still is not None and options.frames is not None:
        raise CommandError("--frames needs --animation")
    try:
        what, limits = _what(options)
        job = Job(
            name=options.scene.stem,
            scene=str(options.scene.resolve()),
            output=options.results or str((options.output / "output").resolve()),
            what=what,
            command=options.worker_command,
            options=(*limits, *options.more),
        )
        then = write_bundle(job, System(options.system), options.output)
    except FarmError as error:
        raise CommandError(str(error)) from error
    if job.doubt():
        say(f"photon-splat: warning: {job.doubt()}\n")
    sys.stdout.write(f"{options.output} is written. Next: {then}\n")


LIMITS = {"--passes", "--seconds", "--error"}


def _what(options: argparse.Namespace) -> tuple[Still | Animation, list[str]]:
    """And the limits of each part, if they are not given: the file's, with its passes divided by
    the number of parts.
    """
    limited = any(word.split("=")[0] in LIMITS for word in options.more)
    if options.still is None:
        if options.frames is not None:
            return Animation(tuple(options.frames), options.chunk), []
        scene = _open(options.scene)
        frames = range(scene.frame_start, scene.frame_end + 1, scene.frame_step)
        return Animation(tuple(frames), options.chunk), []
    if options.frame is not None and limited:
        return Still(options.frame, options.still), []
    scene = _open(options.scene)
    from ..blender.records import limits_of_parts

    still = Still(scene.frame_current if options.frame is None else options.frame, options.still)
    return still, [] if limited else limits_of_parts(scene, still.parts)


def _open(path: Path) -> Any:
    """The file's scene: it knows its frames."""
    output = os.fdopen(os.dup(1), "w", encoding="utf-8", errors="backslashreplace")
    silence_blender()
    sys.stdout = output
    return open_file(path)
