"""Python for Windows, without a Windows: headers and import libraries for building, and a Python
that Wine can run. It is the one that Maven Central has for Java programs, kept in .cache/windows.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CACHE = ROOT / ".cache" / "windows"
ARTIFACTS = {
    "3.11": "org.bytedeco:cpython:3.11.3-1.5.9:jar:windows-x86_64",
    "3.13": "org.bytedeco:cpython:3.13.5-1.5.12:jar:windows-x86_64",
}
COPY = "org.apache.maven.plugins:maven-dependency-plugin:3.6.1:copy"
SECONDS = 600


class Unavailable(Exception):
    """Why it cannot be had here, as the end of a sentence."""


def home(version: str) -> Path:
    """The folder with include/, libs/, lib/ and python.exe of that version (3.11, 3.13)."""
    folder = CACHE / f"python-{version}"
    if folder.is_dir():
        return folder
    CACHE.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=CACHE) as scratch:
        archive = artifact(ARTIFACTS[version], Path(scratch))
        with zipfile.ZipFile(archive) as jar:
            jar.extractall(Path(scratch, "unpacked"))
        unpacked = Path(scratch, "unpacked/org/bytedeco/cpython/windows-x86_64")
        (unpacked / "bin/python.exe").rename(unpacked / "python.exe")
        unpacked.rename(folder)
    return folder


def artifact(coordinates: str, folder: Path) -> Path:
    """The archive of these coordinates, copied into the folder by Maven."""
    if not shutil.which("mvn"):
        raise Unavailable("it needs Maven (Debian: apt-get install maven)")
    command = ["mvn", "-q", "-B", COPY, f"-Dartifact={coordinates}", f"-DoutputDirectory={folder}"]
    try:
        subprocess.run(command, capture_output=True, text=True, check=True, timeout=SECONDS)
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
        raise Unavailable(f"Maven could not fetch {coordinates}") from error
    return next(folder.glob("*.jar"))


def cmake_arguments(version: str) -> list[str]:
    """What FindPython is told, as it cannot ask a Python for Windows."""
    folder = home(version)
    number = version.replace(".", "")
    return [
        f"-DPython_INCLUDE_DIR={folder / 'include'}",
        f"-DPython_LIBRARY={folder / 'libs' / f'python{number}.lib'}",
        f"-DPython_SABI_LIBRARY={folder / 'libs' / 'python3.lib'}",
    ]
