"""The command line in a console of Windows, which Wine keeps on a pseudo-terminal: names that are
not ASCII are shown, and Ctrl-C ends a render, or at the second time whatever hangs.
"""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import struct
import termios
import time
from typing import Any

from wine import inside
from wine_trial import SECONDS, Trial

ESCAPE = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
CTRL_C = b"\x03"
COMMAND = "import sys; sys.argv[0] = 'photon-splat'; from photon_splat.cli import run; run()"
STUCK = """
import ctypes
from photon_splat import cli
def sleep(*arguments):
    print("here", flush=True)
    ctypes.WinDLL("kernel32").Sleep(2_000_000)
cli.render_frames = sleep
cli.run()
"""
"""A render that hangs in a library which no signal wakes up."""


def console(trial: Trial) -> dict[str, Any]:
    folder = trial.out / "Küche 部屋"
    folder.mkdir()
    began = time.monotonic()
    scene, output = "blend_scenes/cornell_box.blend", inside(folder / "ß 絵.exr")
    render = ["render", scene, "-o", output, "--resolution", "64x64", "--passes", "1000000"]
    missing = inside(folder / "Бюро.blend")
    for what, code, arguments, after, keys, expected, sentence in (
        ("a render", COMMAND, render, "Pass 3", CTRL_C, 1, "interrupted; nothing was written"),
        ("a render that hangs", STUCK, [*render, "--verbose"], "here", 2 * CTRL_C, 130, ""),
        (
            "a name",
            COMMAND,
            ["render", missing, "-o", output],
            "",
            b"",
            1,
            f"{missing} does not exist",
        ),
    ):
        status, shown = press(trial, ["-c", code, *arguments], after, keys)
        if status != expected or sentence not in shown:
            trial.fail(f"console: {what}: status {status}, shown: {shown[-300:]!r}")
    left = sorted(path.name for path in folder.iterdir())
    if left:
        trial.fail(f"console: interrupted renders left {left}")
    seconds = time.monotonic() - began
    print(f"== console, Python {trial.wine.version}: {seconds:.0f} s", flush=True)
    return {"seconds": seconds}


def press(trial: Trial, arguments: list[str], after: str, keys: bytes) -> tuple[int | None, str]:
    """Exit status of Python in a console, None if it had to be ended, and what was shown there. The
    keys are pressed once `after` is shown.
    """
    command = trial.wine.command(*arguments, path=[trial.product, trial.wine.site])
    process, terminal = pty.fork()
    if process == 0:
        os.execvp(command[0], command)
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 50, 250, 0, 0))
    shown, last = b"", time.monotonic() + SECONDS
    while time.monotonic() < last:
        if not select.select([terminal], [], [], 1.0)[0]:
            continue
        try:
            piece = os.read(terminal, 65536)
        except OSError:  # the last program that had it open has ended
            break
        shown += piece
        if keys and after.encode() in shown:
            os.write(terminal, keys)
            keys = b""
    ended = time.monotonic() < last
    trial.wine.end()
    status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    os.close(terminal)
    return status if ended else None, ESCAPE.sub("", shown.decode("utf-8", "replace"))
