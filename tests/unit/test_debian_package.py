"""The mirrors that packages of the Debian archive are fetched from."""

from __future__ import annotations

import importlib.util
import shutil
from pathlib import Path

import pytest

from tests.support.paths import ROOT

spec = importlib.util.spec_from_file_location(
    "debian_package", ROOT / "native" / "cmake" / "debian_package.py"
)
assert spec
assert spec.loader
debian_package = importlib.util.module_from_spec(spec)
spec.loader.exec_module(debian_package)


@pytest.mark.skipif(not shutil.which("apt-get"), reason="this machine has no apt")
def test_mirrors_are_known_before_the_first_update(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sources = tmp_path / "sources.list"
    sources.write_text(
        "deb http://mirror.example/debian stable main\n"
        "deb http://mirror.example/debian-security stable-security main\n"
    )
    (tmp_path / "lists" / "partial").mkdir(parents=True)
    config = tmp_path / "apt.conf"
    config.write_text(
        f'Dir::State::Lists "{tmp_path}/lists";\n'
        f'Dir::Etc::SourceList "{sources}";\n'
        'Dir::Etc::SourceParts "/dev/null";\n'
    )
    monkeypatch.setenv("APT_CONFIG", str(config))
    assert debian_package.mirrors() == ["http://mirror.example/debian/"]


def test_a_mirror_that_fails_is_asked_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    def unpack_from(mirror: str, suite: str, scratch: Path, names: list[str]) -> None:
        asked.append(mirror)
        if len(asked) < 4:
            raise debian_package.subprocess.CalledProcessError(100, "apt-get", stderr="no route")
        (scratch / "unpacked" / names[0]).mkdir(parents=True)

    monkeypatch.setattr(debian_package, "mirrors", lambda: ["one", "two"])
    monkeypatch.setattr(debian_package, "unpack_from", unpack_from)
    monkeypatch.setattr(debian_package, "PAUSE", 0.0)
    monkeypatch.setattr(debian_package, "KEYRING", tmp_path)
    monkeypatch.setattr(debian_package.shutil, "which", lambda name: name)
    debian_package.download("stable", tmp_path, ["package"])
    assert asked == ["one", "two", "one", "two"]
    assert (tmp_path / "package").is_dir()
    asked.clear()
    monkeypatch.setattr(debian_package, "ATTEMPTS", 1)
    with pytest.raises(
        debian_package.FetchError, match=r"^package could not be fetched .*no route$"
    ):
        debian_package.download("stable", tmp_path, ["package"])
