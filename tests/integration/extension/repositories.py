"""Static extension repositories with versions of the built archive."""

from __future__ import annotations

import sys
import tomllib
import zipfile
from pathlib import Path

from tests.support.paths import ROOT

sys.path.insert(0, str(ROOT / "tools"))
import release

OLD = "0.0.9"


def current_version() -> str:
    return release.manifest_version((ROOT / "addon/blender_manifest.toml").read_text())


def make_new(folder: Path, archive: Path) -> None:
    """A release of the archive alone."""
    release.release(folder, [archive])


def make_old(folder: Path, archive: Path) -> Path:
    """A repository that has the archive as an older version; returns that one's archive."""
    folder.mkdir(parents=True)
    older = folder / archive.name.replace(current_version(), OLD)
    with zipfile.ZipFile(archive) as source, zipfile.ZipFile(older, "w") as target:
        for entry in source.infolist():
            data = source.read(entry)
            if entry.filename == "blender_manifest.toml":
                stated, wanted = (f'version = "{v}"'.encode() for v in (current_version(), OLD))
                assert data.count(stated) == 1
                data = data.replace(stated, wanted)
                assert tomllib.loads(data.decode())["version"] == OLD
            target.writestr(entry, data)
    release.make_index(folder)
    return older
