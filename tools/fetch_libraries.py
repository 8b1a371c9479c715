"""Gives the bpy package of this virtual environment the desktop libraries that the machine lacks,
without root.

Blender as a Python module is linked to X11 and OpenGL libraries although it opens no window. A
server or a container may not have them: then they are taken from the machine's own Debian release,
put among the virtual environment's packages, and loaded by a .pth file when Python starts. Where
nothing is missing, nothing is done.
"""

from __future__ import annotations

import importlib.util
import os
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "native" / "cmake"))
from debian_package import FetchError, fetch  # noqa: E402

PACKAGES = [
    *(
        "libx11-6",
        "libxcb1",
        "libxau6",
        "libxdmcp6",
        "libbsd0",
        "libmd0",
        "libxext6",
        "libxrender1",
        "libxfixes3",
        "libxi6",
    ),
    *(
        "libxkbcommon0",
        "libsm6",
        "libice6",
        "libuuid1",
        "libgl1",
        "libglvnd0",
        "libglx0",
        "libegl1",
    ),
]

LOADER = """# Loads the libraries of this folder, in this order; made by tools/fetch_libraries.py.

import ctypes
import os

for name in {names!r}:
    ctypes.CDLL(os.path.join(os.path.dirname(__file__), name))
"""


def main() -> int:
    spec = importlib.util.find_spec("bpy")
    assert spec is not None
    assert spec.origin is not None
    blender = Path(spec.origin)
    site_packages = Path(sysconfig.get_path("purelib"))
    libraries = site_packages / "blender_system_libraries"
    start = site_packages / "blender_system_libraries.pth"
    shutil.rmtree(libraries, ignore_errors=True)
    start.unlink(missing_ok=True)

    lacking = missing(blender, libraries)
    if not lacking:
        return 0
    print(f"Blender needs libraries that this machine lacks: {' '.join(lacking)}", flush=True)
    cache = ROOT / ".cache" / "debian-libraries"
    try:
        fetch(platform.freedesktop_os_release().get("VERSION_CODENAME", ""), cache, PACKAGES)
    except (FetchError, OSError) as error:
        sys.exit(
            "Install them, on Debian: apt install libx11-6 libxrender1 libxfixes3 libxi6 "
            f"libxkbcommon0 libsm6 libgl1 libegl1 ({error})"
        )

    libraries.mkdir()
    while lacking:
        for name in lacking:
            found = next(cache.glob(f"*/usr/lib/*/{name}"), None) or next(
                cache.glob(f"*/lib/*/{name}"), None
            )
            if found is None:
                sys.exit(f"No Debian package is known for {name}, which Blender needs: install it.")
            shutil.copy(found.resolve(), libraries / name)
        lacking = missing(blender, libraries)
    names = load_order(libraries)
    (libraries / "__init__.py").write_text(LOADER.format(names=names))
    start.write_text(f"import {libraries.name}\n")
    print(f"They were fetched from the Debian archive into {libraries.relative_to(ROOT)}.")
    return 0


def missing(library: Path, extra: Path) -> list[str]:
    """Sonames that the dynamic linker does not find for the library, `extra` searched too."""
    environment = os.environ | {"LD_LIBRARY_PATH": str(extra)}
    listing = subprocess.run(
        ["ldd", library], env=environment, capture_output=True, text=True, check=True
    ).stdout
    return sorted(set(re.findall(r"^\s*(\S+) => not found", listing, re.MULTILINE)))


def load_order(folder: Path) -> list[str]:
    """The folder's libraries, each after those that it needs."""
    names = sorted(path.name for path in folder.iterdir())
    needs = {
        name: [other for other in names if other != name and other in linked(folder / name)]
        for name in names
    }
    order: list[str] = []
    while len(order) < len(names):
        order += [
            name
            for name in names
            if name not in order and all(other in order for other in needs[name])
        ]
    return order


def linked(library: Path) -> set[str]:
    environment = os.environ | {"LD_LIBRARY_PATH": str(library.parent)}
    listing = subprocess.run(
        ["ldd", library], env=environment, capture_output=True, text=True, check=True
    ).stdout
    return set(re.findall(r"^\s*(\S+) =>", listing, re.MULTILINE))


if __name__ == "__main__":
    sys.exit(main())
