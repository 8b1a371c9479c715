"""photon-splat: renders .blend files without a window, for scripts and render farms."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import time
from typing import NoReturn

from .arguments import CommandError, check_paths
from .commands import parse
from .exr import WriteError
from .process import (
    end_at_the_second,
    open_standard_streams,
    remove_blenders_folder,
    silence_blender,
    stop_signals,
)
from .progress import say
from .render import render_frames


def main(arguments: list[str] | None = None) -> int:
    """Runs the command and returns its exit status: 0 only if everything was written, 75 after an
    interrupt that has left a checkpoint.
    """
    started = time.monotonic()
    stop = False

    def interrupt(*_: object) -> None:
        nonlocal stop
        stop = True
        for one in stop_signals():
            signal.signal(one, signal.SIG_DFL)

    try:
        options = parse(arguments)
        if options.command != "render":
            options.run(options)
            return 0
        check_paths(options)
        if not options.verbose:
            silence_blender()
        for number in stop_signals():
            signal.signal(number, interrupt)
            end_at_the_second(number)
        render_frames(options, started, lambda: stop)
    except CommandError as error:
        say(f"photon-splat: {error}\n")
        return error.status
    except WriteError as error:
        say(f"photon-splat: {error}\n")
        return 1
    return 0


def run() -> NoReturn:
    """The console script. Blender's clean-up at exit can crash, so the process ends without it."""
    open_standard_streams()
    try:
        status = main()
    except SystemExit as leave:  # --help
        status = int(leave.code or 0)
    remove_blenders_folder()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(status)
