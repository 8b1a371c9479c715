"""Makes a release: release.py FOLDER ARCHIVE...

FOLDER gets the archives, SHA256SUMS, and the index.json and index.html of a static extension
repository, made by Blender's own extension tool: put it on any web server, or give Blender the
file's URL, and it installs and updates the extension from there.

The version is that of addon/blender_manifest.toml; CHANGELOG.md must have an entry for it, and all
archives must be of it.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import sys
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
from build_extension import FIND_TOOL, run  # noqa: E402


class NoRelease(Exception):
    """Why there can be none, as a sentence."""


def main() -> int:
    if len(sys.argv) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    folder, archives = Path(sys.argv[1]).resolve(), [Path(name) for name in sys.argv[2:]]
    try:
        release(folder, archives)
    except NoRelease as reason:
        sys.exit(str(reason))
    for path in sorted(folder.iterdir()):
        print(path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path)
    return 0


def release(folder: Path, archives: list[Path]) -> None:
    version = manifest_version((ROOT / "addon/blender_manifest.toml").read_text(encoding="utf-8"))
    if not changes(version):
        raise NoRelease(f"CHANGELOG.md has no entry for {version}.")
    for archive in archives:
        with zipfile.ZipFile(archive) as file:
            inside = manifest_version(file.read("blender_manifest.toml").decode())
        if inside != version:
            raise NoRelease(f"{archive.name} is of version {inside}, not {version}.")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for archive in archives:
        shutil.copy(archive, folder)
    sums = [f"{digest(path)}  {path.name}\n" for path in sorted(folder.glob("*.zip"))]
    (folder / "SHA256SUMS").write_text("".join(sums))
    make_index(folder)


def manifest_version(manifest: str) -> str:
    return str(tomllib.loads(manifest)["version"])


def changes(version: str) -> str:
    """The entry of that version in CHANGELOG.md, without its heading; "" if there is none."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    entry = re.search(rf"(?ms)^## {re.escape(version)}$\n(.*?)(?=^## |\Z)", text)
    return entry[1].strip() if entry else ""


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def make_index(folder: Path) -> None:
    """index.json and index.html, by the extension tool of this Python's bpy package."""
    tool = run(sys.executable, "-c", FIND_TOOL)
    run(sys.executable, tool, "server-generate", "--repo-dir", str(folder), "--html")


if __name__ == "__main__":
    sys.exit(main())
