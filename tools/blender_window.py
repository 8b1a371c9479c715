"""Debian's Blender with a window, under a virtual X server in a system of its own that is made once
and kept in .cache/blender-SUITE. That needs Linux, root, debootstrap and a Debian mirror.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import debian_chroot

ROOT = Path(__file__).resolve().parent.parent
INSIDE = "/mnt/photon_splat"
"""Where that system has this repository."""
MODULE = "bl_ext.user_default.photon_splat"
PACKAGES = [
    "blender",
    "python3-numpy",
    "python3-cattr",
    "python3-requests",
    "xvfb",
    "xauth",
    "imagemagick",
    "xdotool",
    "libegl1",
    "libegl-mesa0",
    "libgl1-mesa-dri",
]


def options_of(description: str | None) -> argparse.ArgumentParser:
    """For a tool that has an extension's archive and Debian's suite."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("archive", type=Path)
    parser.add_argument("--suite", default="trixie")
    return parser


def make(suite: str, chroot: Path | None = None) -> Path:
    """The folder of Debian's `suite` with Blender in it. Raises debian_chroot.Unavailable."""
    folder = (chroot or ROOT / ".cache" / f"blender-{suite}").resolve()
    debian_chroot.make(suite, folder, PACKAGES, "2 GB")
    return folder


def there(path: Path) -> str:
    """A path of this repository as that system has it."""
    return f"{INSIDE}/{path.resolve().relative_to(ROOT).as_posix()}"


def blender(chroot: Path, user: str, *arguments: str, screen: str = "") -> list[str]:
    """A command that runs Blender in that system, with its user's files in the folder `user`; in a
    window on a screen of its own, WIDTHxHEIGHTxDEPTH, where one is given.
    """
    settings = {"HOME": "/tmp", "BLENDER_USER_RESOURCES": user, "LIBGL_ALWAYS_SOFTWARE": "1"}
    command = [*debian_chroot.inside(chroot, (ROOT, INSIDE)), "env", "-C", INSIDE]
    command += [f"{name}={value}" for name, value in settings.items()]
    if screen:
        command += ["xvfb-run", "-a", "-s", f"-screen 0 {screen}"]
    return [*command, "blender", *arguments]


def install(chroot: Path, user: str, archive: str) -> list[str]:
    """A command that installs and enables an extension's archive."""
    how = ["--command", "extension", "install-file", "-r", "user_default", "--enable"]
    return blender(chroot, user, *how, archive)
