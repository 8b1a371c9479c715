"""photon-splat: renders .blend files without a window, for scripts and render farms."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import shutil
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn

from .core.result import Progress, RenderResult
from .core.scene import Frame
from .core.settings import FORCEABLE, SWITCHES, Backend, FinalGather, Integrator, RenderSettings
from .exr import WriteError, channels_of, replace_file, try_file, write_exr

UNLIMITED_PASSES = 1 << 30
MOST_PHOTONS = 1 << 40


class CommandError(Exception):
    """What went wrong, as one sentence for the user."""


class _Parser(argparse.ArgumentParser):
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


COMPONENTS = tuple(dict.fromkeys(FORCEABLE + SWITCHES))


def _component(text: str) -> tuple[str, bool]:
    name, _, state = text.partition("=")
    if state not in ("on", "off") or name not in COMPONENTS:
        raise argparse.ArgumentTypeError(
            f"'{text}' is not NAME=on or NAME=off with one of {', '.join(COMPONENTS)}"
        )
    return name, state == "on"


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


def parser() -> argparse.ArgumentParser:
    top = _Parser(prog="photon-splat", description="Renders Blender files with Photon Splat.")
    commands = top.add_subparsers(dest="command", required=True, metavar="render")
    r = commands.add_parser("render", help="render one frame of a .blend file to an OpenEXR file")
    r.add_argument("scene", type=Path, metavar="SCENE.blend")
    r.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.exr")
    r.add_argument(
        "--frame",
        type=_number(int, -1048574, 1048574),
        metavar="N",
        help="frame to render (default: the file's current one)",
    )
    r.add_argument(
        "--seconds",
        type=_number(float, 1e-3),
        metavar="S",
        help="stop after S seconds; with no --passes, only then",
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
        help="of visible points, in kernel radii; 0 = one per sample",
    )
    r.add_argument(
        "--no-boundary-correction", dest="boundary_correction", action="store_const", const=False
    )
    r.add_argument(
        "--denoise",
        action="store_const",
        const=True,
        help="run Open Image Denoise on the finished picture",
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
        "--no-fallback",
        dest="fallback",
        action="store_const",
        const=False,
        help="no camera paths where photons serve badly",
    )
    r.add_argument(
        "--final-gather",
        choices=[g.value for g in FinalGather],
        type=str.upper,
        help="photons light the second place of paths",
    )
    r.add_argument(
        "--component",
        type=_component,
        action="append",
        default=[],
        metavar="NAME=on|off",
        help="run a part that the plan leaves out, or leave one out (for tests): "
        + ", ".join(COMPONENTS),
    )
    r.add_argument(
        "--stats", type=Path, metavar="FILE.json", help="write what the render did as JSON"
    )
    r.add_argument("--verbose", action="store_true", help="let Blender's own messages through")
    return top


def _settings(options: argparse.Namespace) -> Callable[[RenderSettings], RenderSettings]:
    """The options laid over the scene's own settings."""
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
            "fallback",
            "passes",
        )
        if getattr(options, name) is not None
    }
    given |= {name: on for name, on in options.component if name in SWITCHES}
    given |= {"photons_per_pass": 0} if ("photons", False) in options.component else {}
    given["force"] = tuple(
        dict.fromkeys(name for name, on in options.component if on and name in FORCEABLE)
    )
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


def _say(text: str) -> None:
    """To standard error; where nobody reads it any more the render goes on all the same."""
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(text)
        sys.stderr.flush()


class _ProgressBar:
    """On a terminal a bar that redraws itself, elsewhere a line at each tenth."""

    def __init__(self) -> None:
        self.terminal = sys.stderr.isatty()
        self.tenth = -1

    def show(self, progress: Progress) -> None:
        if self.terminal:
            filled = int(30 * progress.fraction)
            _say(
                f"\r[{'#' * filled}{'.' * (30 - filled)}] {100 * progress.fraction:3.0f} %  "
                f"{progress.message}\x1b[K"
            )
        elif int(10 * progress.fraction) > self.tenth:
            self.tenth = int(10 * progress.fraction)
            _say(f"{10 * self.tenth:3d} %  {progress.message}\n")

    def end(self) -> None:
        if self.terminal:
            _say("\r\x1b[K")


def _open_standard_streams() -> None:
    """Those that the caller has closed lead nowhere: else files that are opened later would take
    their numbers, and what is meant for the user would be written into them.
    """
    while (number := os.open(os.devnull, os.O_RDWR)) < 3:
        pass
    os.close(number)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115


def _silence_blender() -> None:
    """Blender and its libraries print to the descriptors 1 and 2; our own messages keep the real
    standard error.
    """
    sys.stderr = os.fdopen(os.dup(2), "w", buffering=1, encoding="utf-8", errors="backslashreplace")
    quiet = os.open(os.devnull, os.O_WRONLY)
    for descriptor in (1, 2):
        os.dup2(quiet, descriptor)
    os.close(quiet)


def _check_paths(options: argparse.Namespace) -> None:
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
    given = {"--stats": options.stats, "--output": options.output, "the scene": options.scene}
    for one, other in (
        ("--stats", "--output"),
        ("--stats", "the scene"),
        ("--output", "the scene"),
    ):
        if given[one] is not None and _same_file(given[one], given[other]):
            raise CommandError(f"{one} and {other} name the same file")
    for path in filter(None, (options.output, options.stats)):
        if os.path.isdir(path):  # which says no to names that are too long
            raise CommandError(f"{path} is a folder")
        if not os.path.isdir(path.parent):
            raise CommandError(f"{path} cannot be written: the folder {path.parent} does not exist")
        if not os.access(path.parent, os.W_OK):
            raise CommandError(f"{path} cannot be written: no permission in {path.parent}")
        try_file(path)


def _same_file(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except OSError:  # one of them is not there yet
        return os.path.realpath(one) == os.path.realpath(other)


def _open_scene(options: argparse.Namespace) -> Any:
    try:
        import bpy
    except ImportError as error:
        raise CommandError(f"Blender's Python module bpy cannot be loaded: {error}") from error
    from . import register

    register()
    try:
        bpy.ops.wm.open_mainfile(
            filepath=str(options.scene.resolve()), load_ui=False, use_scripts=False
        )
    except RuntimeError as error:
        reason = " ".join(str(error).split()).removeprefix("Error: ")
        raise CommandError(f"{options.scene} cannot be opened: {reason}") from error
    scene = bpy.context.scene
    render = scene.render
    render.engine = "PHOTON_SPLAT"
    render.use_compositing = render.use_sequencer = False
    if options.resolution is not None:
        render.resolution_x, render.resolution_y = options.resolution
        render.resolution_percentage = 100
    if options.frame is not None:
        scene.frame_set(options.frame)
    if scene.camera is None and not any(marker.camera for marker in scene.timeline_markers):
        raise CommandError(
            f"Scene '{scene.name}' has no camera: add one, or set an object as the scene's active "
            "camera"
        )
    return scene


def _render(
    options: argparse.Namespace, scene: Any, interrupted: Callable[[], bool]
) -> list[tuple[str, RenderResult, Frame]]:
    """One result per view layer that is rendered, under its name."""
    import bpy

    from .job import describe, observer

    results: list[tuple[RenderResult, Frame]] = []
    errors: list[BaseException] = []
    bar = _ProgressBar()
    observer.settings = _settings(options)
    observer.on_progress = bar.show
    observer.on_result = lambda result, frame: results.append((result, frame))
    observer.on_error = errors.append
    observer.should_cancel = interrupted
    failure = None
    try:
        bpy.ops.render.render(scene=scene.name)
    except RuntimeError as error:
        failure = error
    bar.end()
    if interrupted():
        raise CommandError("interrupted; nothing was written")
    if errors:
        raise CommandError(describe(errors[0]))
    if failure is not None:
        raise CommandError(" ".join(str(failure).split()).removeprefix("Error: "))
    if not results:
        raise CommandError("Blender rendered no view layer; is at least one enabled for rendering?")
    names = [layer.name for layer in scene.view_layers if layer.use]
    names += [f"Layer {i}" for i in range(len(names), len(results))]
    return [(name, result, frame) for name, (result, frame) in zip(names, results, strict=False)]


def _write(
    options: argparse.Namespace,
    scene: Any,
    results: list[tuple[str, RenderResult, Frame]],
    startup: float,
) -> None:
    from . import version

    _, first, frame = results[0]
    names, planes = channels_of(first.passes)
    for name, result, _ in results[1:]:
        more, others = channels_of(result.passes, f"{name}.", plain=False)
        names += more
        planes += others
    statistics = first.statistics | {"startup_seconds": startup, "version": version()}
    metadata: dict[str, str | int | float] = {
        "Software": f"Photon Splat {version()}",
        "photon_splat:passes": statistics["passes"],
        "photon_splat:photons": str(statistics["photons"]["traced"]),
        "photon_splat:seconds": float(statistics["seconds"]["total"]),
        "photon_splat:integrator": statistics["integrator"],
        **{
            f"photon_splat:{name}": float(statistics["error"][name])
            for name in ("relative_rmse", "standard_error", "bias")
        },
    }
    write_exr(
        options.output,
        names,
        planes,
        frame,
        crop=scene.render.use_crop_to_border,
        metadata=metadata,
    )
    if options.stats is not None:
        replace_file(
            options.stats, lambda path: path.write_text(json.dumps(statistics, indent=2) + "\n")
        )
    for warning in statistics["warnings"]:
        _say(f"photon-splat: warning: {warning}\n")


def _end_at_the_second(number: int) -> None:
    """Once a signal has been heard its next one ends the process, whatever that does meanwhile:
    also where Blender or a library of it hangs, and no Python runs.
    """
    if not sys.platform.startswith("linux") or sys.maxsize < 2**32:
        return
    import ctypes

    class Action(ctypes.Structure):  # of glibc and musl on 64-bit machines
        _fields_ = [
            ("handler", ctypes.c_void_p),
            ("mask", ctypes.c_ulong * 16),
            ("flags", ctypes.c_int),
            ("restorer", ctypes.c_void_p),
        ]

    library, action = ctypes.CDLL(None), Action()
    if library.sigaction(number, None, ctypes.byref(action)) == 0:
        action.flags |= -0x80000000  # SA_RESETHAND
        library.sigaction(number, ctypes.byref(action), None)


def _remove_blenders_folder() -> None:
    """That of its session in the folder for temporary files, which it removes itself only at an
    orderly end.
    """
    bpy = sys.modules.get("bpy")
    if bpy is not None and Path(bpy.app.tempdir).name.startswith("blender_"):
        shutil.rmtree(bpy.app.tempdir, ignore_errors=True)


def main(arguments: list[str] | None = None) -> int:
    """Runs the command and returns its exit status: 0 only if the picture was written."""
    started = time.monotonic()
    stop = False

    def interrupt(*_: object) -> None:
        nonlocal stop
        stop = True
        for one in (signal.SIGINT, signal.SIGTERM):
            signal.signal(one, signal.SIG_DFL)

    try:
        options = parser().parse_args(arguments)
        _check_paths(options)
        if not options.verbose:
            _silence_blender()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, interrupt)
            _end_at_the_second(number)
        scene = _open_scene(options)
        results = _render(options, scene, lambda: stop)
        _write(
            options,
            scene,
            results,
            time.monotonic() - started - results[0][1].statistics["seconds"]["total"],
        )
    except (CommandError, WriteError) as error:
        _say(f"photon-splat: {error}\n")
        return 1
    return 0


def run() -> NoReturn:
    """The console script. Blender's clean-up at exit can crash, so the process ends without it."""
    _open_standard_streams()
    try:
        status = main()
    except SystemExit as leave:  # --help
        status = int(leave.code or 0)
    _remove_blenders_folder()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(status)
