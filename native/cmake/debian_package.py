"""Unpacks packages of the Debian archive without root: debian_package.py SUITE FOLDER NAME...

Prints nothing and leaves FOLDER/NAME/usr/... for each; packages that are there already are kept.
The mirror is the one that this machine's apt uses; apt works with a source list, package lists and
a cache of its own in a temporary folder, so that the system stays as it is, and it checks the
signature of the Debian archive. Exit status 1, with one sentence on stderr, if a package cannot be
had.
"""

from __future__ import annotations

import fcntl
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

KEYRING = Path("/usr/share/keyrings/debian-archive-keyring.gpg")
ATTEMPTS = 3
"""How often each mirror is asked: a network that fails for a moment fails no set-up."""
PAUSE = 20.0
"""Seconds between these attempts."""


class FetchError(Exception):
    """Why a package could not be had, as a sentence."""


def fetch(suite: str, folder: Path, names: list[str]) -> None:
    """Makes FOLDER/NAME hold the files of each package. Raises FetchError."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        missing = [name for name in names if not (folder / name).is_dir()]
        if missing:
            download(suite, folder, missing)


def download(suite: str, folder: Path, names: list[str]) -> None:
    if not (shutil.which("apt-get") and shutil.which("dpkg-deb") and KEYRING.exists()):
        raise FetchError(
            f"apt-get, dpkg-deb and {KEYRING} are needed to fetch {', '.join(names)} from the "
            "Debian archive."
        )
    failure = "this machine's apt names no Debian mirror"
    found = mirrors()
    for number, mirror in enumerate(found * ATTEMPTS):
        if number and number % len(found) == 0:
            time.sleep(PAUSE)
        with tempfile.TemporaryDirectory(prefix="download-", dir=folder) as scratch:
            try:
                unpack_from(mirror, suite, Path(scratch), names)
            except subprocess.CalledProcessError as error:
                failure = error.stderr.strip()
                continue
            except subprocess.TimeoutExpired:
                failure = "the mirror did not answer in time"
                continue
            for name in names:
                Path(scratch, "unpacked", name).rename(folder / name)
            return
    raise FetchError(f"{', '.join(names)} could not be fetched from the Debian archive: {failure}")


def mirrors() -> list[str]:
    """The mirrors that apt's sources name, before the first `apt-get update` too."""
    command = ["apt-get", "indextargets", "--no-release-info", "--format", "$(REPO_URI)"]
    command.append("Created-By: Packages")
    lines = subprocess.run(command, capture_output=True, text=True, check=False).stdout.splitlines()
    return [mirror for mirror in dict.fromkeys(lines) if "security" not in mirror]


def unpack_from(mirror: str, suite: str, scratch: Path, names: list[str]) -> None:
    for part in ("lists/partial", "cache/archives/partial", "debs", "unpacked"):
        (scratch / part).mkdir(parents=True)
    (scratch / "sources.list").write_text(f"deb [signed-by={KEYRING}] {mirror} {suite} main\n")
    options = {
        "Dir::Etc::SourceList": f"{scratch}/sources.list",
        "Dir::Etc::SourceParts": "/dev/null",
        "Dir::State::Lists": f"{scratch}/lists",
        "Dir::Cache": f"{scratch}/cache",
        "Acquire::Languages": "none",
        "Acquire::Retries": "3",
        "APT::Sandbox::User": "root",
        "APT::Update::Error-Mode": "any",
    }
    apt = ["apt-get", "-q", *(f"-o{key}={value}" for key, value in options.items())]
    run([*apt, "update"], scratch)
    run([*apt, "download", *names], scratch / "debs")
    for name in names:
        (archive,) = (scratch / "debs").glob(f"{name}_*.deb")
        run(["dpkg-deb", "-x", str(archive), str(scratch / "unpacked" / name)], scratch)


def run(command: list[str], folder: Path) -> None:
    subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True, timeout=300)


if __name__ == "__main__":
    try:
        fetch(sys.argv[1], Path(sys.argv[2]), sys.argv[3:])
    except FetchError as error:
        sys.exit(str(error))
