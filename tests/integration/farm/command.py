"""photon-splat as a process, and what it has written."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from tests.support.paths import environment

COMMAND = [sys.executable, "-c", "from photon_splat.cli import run; run()"]


def start(folder: Path, *arguments: object, **options: Any) -> subprocess.Popen[str]:
    """The command with a Blender user folder in `folder`, where it runs."""
    return subprocess.Popen(
        [*COMMAND, *map(str, arguments)],
        cwd=folder,
        env=environment(folder / "blender"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def call(folder: Path, *arguments: object, **options: Any) -> tuple[int, str, str]:
    """Exit status, standard output and standard error."""
    process = start(folder, *arguments, **options)
    try:
        output, errors = process.communicate()
    finally:
        process.kill()
    return process.returncode, output, errors


def picture(path: Path) -> dict[str, np.ndarray]:
    """(height, width) float32 by channel, top row first."""
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(str(path))
    assert file is not None, oiio.geterror()
    spec = file.spec()
    pixels = file.read_image(0, 0, 0, spec.nchannels, oiio.FLOAT)
    file.close()
    return {name: pixels[..., i] for i, name in enumerate(spec.channelnames)}


def equal(one: Path, other: Path) -> bool:
    """Whether all channels are the same bit for bit."""
    a, b = picture(one), picture(other)
    return a.keys() == b.keys() and all(a[name].tobytes() == b[name].tobytes() for name in a)
