"""Files that are written completely or not at all, and names with the number of a frame."""

from __future__ import annotations

import contextlib
import os
import re
import stat
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

_HASHES = re.compile(r"#+(?=[^#]*$)")
WAIT = 2.0
"""Seconds that a file may stay open in another program, such as a virus scanner, on Windows."""


class WriteError(Exception):
    """The file could not be written; the message is one sentence that names it."""


def replace_file(path: Path, write: Callable[[Path], object]) -> None:
    """Calls write(temporary path) and then moves the file to `path`, so that `path` is written
    completely or not at all. Raises WriteError. A symbolic link stays, and its target is replaced;
    permissions stay. Where only the last step fails, as on Windows while another program has the
    file open, the new one stays beside it, and the error names it.
    """
    with _error_of(path, "could not be written"):
        temporary = _temporary(path)
        try:
            write(temporary)
            os.chmod(temporary, _mode_of(path))
            _move(temporary, real_path(path))
        finally:
            with contextlib.suppress(OSError):
                temporary.unlink(missing_ok=True)


def try_file(path: Path) -> None:
    """Raises WriteError if replace_file() would fail: no such folder, no permission, or something
    that is no file. Leaves nothing behind.
    """
    with _error_of(path, "cannot be written"):
        if os.path.lexists(path) and os.path.exists(path) and not os.path.isfile(path):
            raise OSError("it is no ordinary file")
        if sys.platform == "win32" and os.path.isfile(path) and not os.access(path, os.W_OK):
            raise OSError("it is read-only")  # elsewhere the folder's permissions count
        _temporary(path).unlink()


def real_path(path: Path) -> Path:
    """The path without symbolic links. Where Windows cannot tell it, as of some paths of more than
    260 characters, the absolute path.
    """
    try:
        return Path(os.path.realpath(path))
    except OSError:
        return Path(os.path.abspath(path))


@contextlib.contextmanager
def _error_of(path: Path, what: str):  # type: ignore[no-untyped-def]
    try:
        yield
    except (OSError, ValueError) as error:  # ValueError: a name with a null in it
        raise WriteError(f"{path} {what}: {getattr(error, 'strerror', None) or error}") from error


def _temporary(path: Path) -> Path:
    """A new empty file beside what `path` leads to."""
    real = real_path(path)
    with contextlib.suppress(FileNotFoundError):
        os.lstat(real)  # may say that the name is too long
    number, name = tempfile.mkstemp(prefix=".", suffix=f".partial{real.suffix}", dir=real.parent)
    os.close(number)
    return Path(name)


def _move(temporary: Path, path: Path) -> None:
    """Replaces the file. OSError, which names where the new one is kept, if that is refused."""
    last = time.monotonic() + WAIT
    while True:
        try:
            os.replace(temporary, path)
            return
        except PermissionError as error:
            if sys.platform == "win32" and time.monotonic() < last:
                time.sleep(0.05)
                continue
            kept = _unused(path)
            os.rename(temporary, kept)
            raise OSError(f"{error.strerror}; the new file is {kept}") from error


def _unused(path: Path) -> Path:
    """A name beside that of the file which no file has."""
    number = 1
    while (other := path.with_name(f"{path.stem}.{number}{path.suffix}")).exists():
        number += 1
    return other


def _mode_of(path: Path) -> int:
    """Permissions of the file, or those of new files."""
    try:
        return stat.S_IMODE(os.stat(path).st_mode)
    except OSError:
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask


def has_number(path: Path) -> bool:
    """Whether the file's name has a place for the number of a frame."""
    return "#" in path.name


def with_number(path: Path, frame: int) -> Path:
    """The last row of # in the file's name becomes the frame, with zeros in front, as in Blender:
    f_####.exr is f_0007.exr, or f_-007.exr.
    """
    name = _HASHES.sub(lambda hashes: f"{frame:0{len(hashes[0])}d}", path.name)
    return path.with_name(name)
