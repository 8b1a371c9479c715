"""Releases: what `make release` writes, and an update from an older version by Blender's own means,
with the module loaded.
"""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests.integration.extension.repositories import (
    OLD,
    current_version,
    make_new,
    make_old,
    release,
)
from tests.integration.extension.test_extension import ARCHIVES, bare, run

__all__ = ["bare"]

pytestmark = pytest.mark.skipif(
    not ARCHIVES, reason="there is no archive in dist/: make extension builds it"
)


@pytest.fixture(scope="module")
def current() -> str:
    return current_version()


@pytest.fixture(scope="module")
def new(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("release") / "new"
    make_new(folder, ARCHIVES[-1])
    return folder


@pytest.fixture(scope="module")
def old(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("release") / "old"
    make_old(folder, ARCHIVES[-1])
    return folder


def test_a_release_has_sums_and_an_index_of_its_archives(new: Path, current: str) -> None:
    archive = new / ARCHIVES[-1].name
    sums = (new / "SHA256SUMS").read_text().splitlines()
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    assert sums == [f"{digest}  {archive.name}"]
    (entry,) = json.loads((new / "index.json").read_text())["data"]
    assert entry["id"] == "photon_splat"
    assert entry["version"] == current
    assert entry["archive_url"] == f"./{archive.name}"
    assert entry["archive_hash"] == f"sha256:{digest}"
    assert entry["platforms"] == ["linux-x64"]
    assert archive.name in (new / "index.html").read_text()


def test_the_version_has_an_entry_in_the_changelog(
    current: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert release.changes(current)
    monkeypatch.setattr(release, "changes", lambda _: "")
    with pytest.raises(release.NoRelease, match=rf"^CHANGELOG\.md has no entry for {current}\.$"):
        release.release(tmp_path / "none", [])


def test_an_archive_of_another_version_is_refused(old: Path, tmp_path: Path, current: str) -> None:
    (archive,) = old.glob("*.zip")
    sentence = f"{archive.name} is of version {OLD}, not {current}."
    with pytest.raises(release.NoRelease, match=f"^{re.escape(sentence)}$"):
        release.release(tmp_path / "none", [archive])
    assert not (tmp_path / "none").exists()


@pytest.mark.smoke
def test_an_update_is_offered_installed_and_renders(
    bare: Path, old: Path, new: Path, current: str, tmp_path: Path
) -> None:
    script = f"tests/integration/extension/update.py {old} {new} {tmp_path}"
    found = json.loads(run(bare, tmp_path, script))
    assert found["installed"] == OLD
    assert found["offered"] == [current]
    assert found["upgraded"] == ["FINISHED"]
    assert found["after"] == current
    assert found["enabled"]
    assert found["native"].startswith(str(tmp_path / "blender/extensions/.local"))
    assert (found["native before"], found["native after"]) == (OLD, current)
    first, second = (np.load(tmp_path / f"{name}.npy") for name in ("first", "second"))
    assert first.mean() > 0.05
    assert np.array_equal(first, second)
