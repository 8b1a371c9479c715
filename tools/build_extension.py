"""Builds the extension that Blender installs: build_extension.py [--windows] OUTPUT_FOLDER
PYTHON...

Each PYTHON is the interpreter of a virtual environment that has the build tools, bpy and moderngl:
what it makes serves Blenders with its version of Python (the native module made by 3.12 or later:
with later ones, too). Nothing is bundled that Blender ships. The archives are made and checked by
Blender's own extension tool, which the bpy package has; prints their paths.

--windows: one for Windows besides, compiled by the first PYTHON's ziglang (requirements-cross.txt).
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from windows_python import Unavailable, cmake_arguments

ROOT = Path(__file__).resolve().parent.parent
BUNDLED = ("moderngl", "glcontext")
"""Packages besides the native module, in the version that the virtual environment has."""
ALSO = ("3.12", "3.14")
"""Pythons of Blenders that Linux distributions build: the stable native module serves them, the
packages have wheels for each.
"""
PIP = ("-m", "pip", "-q", "--disable-pip-version-check")
FIND_TOOL = """
import importlib.util, pathlib
package = pathlib.Path(importlib.util.find_spec("bpy").origin).parent
print(*package.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
"""
VERSIONS = (
    "from importlib.metadata import version; print(*(f'{name}=={version(name)}' for "
    f"name in {BUNDLED}))"
)
PLATFORMS = {
    "linux_x86_64": "linux-x64",
    "win_amd64": "windows-x64",
    "macosx_x86_64": "macos-x64",
    "macosx_arm64": "macos-arm64",
}
"""Blender's name of a platform, by that of a wheel without the system's version."""


def main() -> int:
    arguments = sys.argv[1:]
    windows = arguments[:1] == ["--windows"]
    if len(arguments) < 2 + windows:
        print(__doc__, file=sys.stderr)
        return 2
    output, pythons = Path(arguments[windows]).resolve(), arguments[windows + 1 :]
    output.mkdir(parents=True, exist_ok=True)
    for old in output.glob("photon_splat-*.zip"):
        old.unlink()
    print(build(output, pythons, make_wheels))
    if windows:
        zig = pythons[0]
        print(build(output, pythons, lambda *of: make_windows_wheels(zig, *of)))
    return 0


def build(output: Path, pythons: list[str], wheels: Callable[[str, Path], None]) -> Path:
    """The archive for one platform, whose wheels are made by wheels(PYTHON, folder)."""
    with tempfile.TemporaryDirectory() as scratch:
        source, made = Path(scratch, "photon_splat"), Path(scratch, "archive")
        made.mkdir()
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / "addon", source, ignore=ignored)
        shutil.copytree(ROOT / "shaders", source / "shaders", ignore=ignored)
        shutil.copy(ROOT / "LICENSE", source)
        for python in pythons:
            wheels(python, source / "wheels")
        add_to_manifest(
            source / "blender_manifest.toml",
            sorted(wheel.name for wheel in (source / "wheels").iterdir()),
        )
        tool = run(pythons[0], "-c", FIND_TOOL)
        folders = ("--source-dir", str(source), "--output-dir", str(made))
        run(pythons[0], tool, "build", *folders, "--split-platforms")
        (archive,) = made.glob("photon_splat-*.zip")
        run(pythons[0], tool, "validate", str(archive))
        return Path(shutil.copy(archive, output))


def make_wheels(python: str, folder: Path) -> None:
    wheel = (*PIP, "wheel", "--no-build-isolation", "--no-deps", "-w", str(folder))
    run(python, *wheel, str(ROOT / "native"))
    download = (*PIP, "download", "--only-binary", ":all:", "--no-deps", "-d", str(folder))
    packages = run(python, "-c", VERSIONS).split()
    run(python, *download, *packages)
    if any("-abi3-" in wheel.name for wheel in folder.glob("photon_splat_native-*")):
        for version in ALSO:
            run(python, *download, "--python-version", version, *packages)


def make_windows_wheels(zig: str, python: str, folder: Path) -> None:
    """zig: the Python that has ziglang."""
    version = run(python, "-c", "import sys; print('%d.%d' % sys.version_info[:2])")
    toolchain = ROOT / "native/cmake/toolchains/windows-x86_64.cmake"
    try:
        arguments = [f"-DCMAKE_TOOLCHAIN_FILE={toolchain}", *cmake_arguments(version)]
    except Unavailable as reason:
        sys.exit(f"The extension for Windows cannot be built: {reason}.")
    environment = {
        "CMAKE_ARGS": shlex.join(arguments),
        "PHOTON_SPLAT_PYTHON": os.path.abspath(zig),
        "_PYTHON_HOST_PLATFORM": "win-amd64",
    }
    place = "build-dir=../build/native-{cache_tag}-windows"
    wheel = (*PIP, "wheel", "--no-build-isolation", "--no-deps", "-w", str(folder), "-C", place)
    run(python, *wheel, str(ROOT / "native"), **environment)
    download = (*PIP, "download", "--only-binary", ":all:", "--no-deps", "-d", str(folder))
    packages = run(python, "-c", VERSIONS).split()
    run(python, *download, "--platform", "win_amd64", "--python-version", version, *packages)


def add_to_manifest(manifest: Path, wheels: list[str]) -> None:
    """The manifest, which is for all platforms, gets the wheels and the platform that they are
    for.
    """
    (native, *_) = (wheel for wheel in wheels if wheel.startswith("photon_splat_native-"))
    platform = PLATFORMS[
        re.sub(r"(\d+_)+(?=x86_64|arm64)", "", native.removesuffix(".whl").split("-")[-1])
    ]
    lines = [
        f'platforms = ["{platform}"]',
        "wheels = [",
        *(f'  "./wheels/{wheel}",' for wheel in wheels),
        "]",
    ]
    head, table, rest = manifest.read_text(encoding="utf-8").partition("\n[permissions]")
    manifest.write_text(head + "\n".join(lines) + "\n" + table + rest, encoding="utf-8")


def run(*command: str, **environment: str) -> str:
    """What the command prints. SystemExit, with what it wrote, if it fails."""
    done = subprocess.run(
        command,
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
