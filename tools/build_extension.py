"""Builds the extension that Blender installs: build_extension.py OUTPUT_FOLDER PYTHON...

Each PYTHON is the interpreter of a virtual environment that has the build tools, bpy and moderngl:
what it makes serves Blenders with its version of Python (the native module made by 3.12 or later:
with later ones, too). Nothing is bundled that Blender ships. The archive is made by Blender's own
extension tool, which the bpy package has; prints its path.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

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
    if len(sys.argv) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    output, pythons = Path(sys.argv[1]).resolve(), sys.argv[2:]
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        source = Path(scratch, "photon_splat")
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / "addon", source, ignore=ignored)
        shutil.copytree(ROOT / "shaders", source / "shaders", ignore=ignored)
        shutil.copy(ROOT / "LICENSE", source)
        for python in pythons:
            make_wheels(python, source / "wheels")
        add_to_manifest(
            source / "blender_manifest.toml",
            sorted(wheel.name for wheel in (source / "wheels").iterdir()),
        )
        tool = run(pythons[0], "-c", FIND_TOOL)
        for old in output.glob("photon_splat-*.zip"):
            old.unlink()
        run(
            pythons[0],
            tool,
            "build",
            "--source-dir",
            str(source),
            "--output-dir",
            str(output),
            "--split-platforms",
        )
    (archive,) = output.glob("photon_splat-*.zip")
    print(archive)
    return 0


def make_wheels(python: str, folder: Path) -> None:
    run(
        python,
        *PIP,
        "wheel",
        "--no-build-isolation",
        "--no-deps",
        "-w",
        str(folder),
        str(ROOT / "native"),
    )
    download = (*PIP, "download", "--only-binary", ":all:", "--no-deps", "-d", str(folder))
    packages = run(python, "-c", VERSIONS).split()
    run(python, *download, *packages)
    if any("-abi3-" in wheel.name for wheel in folder.glob("photon_splat_native-*")):
        for version in ALSO:
            run(python, *download, "--python-version", version, *packages)


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


def run(*command: str) -> str:
    """What the command prints. SystemExit, with what it wrote, if it fails."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
