"""Static extension repositories with versions of the built archive."""

from __future__ import annotations

import io
import re
import sys
import tomllib
import zipfile
from pathlib import Path

from tests.support.native_versions import relabelled
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
    """A repository that has the archive as an older version, with a native module of that version;
    returns that one's archive.
    """
    folder.mkdir(parents=True)
    older = folder / _older(archive.name)
    with zipfile.ZipFile(archive) as source, zipfile.ZipFile(older, "w") as target:
        for entry in source.infolist():
            data = source.read(entry)
            if "photon_splat_native-" in entry.filename:
                data = _older_wheel(data)
            elif entry.filename == "blender_manifest.toml":
                data = _older_manifest(data.decode()).encode()
            target.writestr(_older(entry.filename), data)
    release.make_index(folder)
    return older


def _older(text: str) -> str:
    """The text with the older version in the names of archives, wheels and their folders."""
    here, there = (version.replace(".", "_") for version in (current_version(), OLD))
    text = text.replace(f"photon_splat_native_{here}", f"photon_splat_native_{there}")
    return re.sub(rf"(photon_splat(?:_native)?)-{re.escape(current_version())}", rf"\1-{OLD}", text)


def _older_manifest(manifest: str) -> str:
    stated, wanted = (f'version = "{version}"' for version in (current_version(), OLD))
    assert manifest.count(stated) == 1
    manifest = _older(manifest.replace(stated, wanted))
    assert tomllib.loads(manifest)["version"] == OLD
    return manifest


def _older_wheel(wheel: bytes) -> bytes:
    """The version is told by the names, the metadata and the module itself."""
    made = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(wheel)) as source, zipfile.ZipFile(made, "w") as target:
        for entry in source.infolist():
            data = source.read(entry)
            if entry.filename.endswith((".so", ".pyd")):
                data = relabelled(data, current_version(), OLD)
            elif entry.filename.endswith(("METADATA", "RECORD")):
                data = (
                    _older(data.decode())
                    .replace(f"\nVersion: {current_version()}\n", f"\nVersion: {OLD}\n")
                    .encode()
                )
            target.writestr(_older(entry.filename), data)
    return made.getvalue()
