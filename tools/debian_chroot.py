"""A Debian system in a folder of its own, for programs that this machine's Debian lacks.

Making one needs Linux, root, debootstrap and a Debian mirror; it is made once and kept.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KEYRING = Path("/usr/share/keyrings/debian-archive-keyring.gpg")


class Unavailable(Exception):
    """Why the system cannot be had here, as the end of a sentence."""


def make(suite: str, chroot: Path, packages: list[str], size: str) -> None:
    """Makes `chroot` hold the suite (trixie, sid) with these packages, unless it does already.

    size: how much is about to be fetched, for the message. Raises Unavailable.
    """
    if not sys.platform.startswith("linux") or os.geteuid() != 0:
        raise Unavailable("it needs Linux and root")
    packed = chroot / "photon_splat_packages"
    if packed.exists() and packed.read_text().split() == packages:
        return
    if any(f" {chroot}/" in line for line in Path("/proc/self/mounts").read_text().splitlines()):
        raise Unavailable(f"something is still mounted below {chroot}; unmount it first")
    if not shutil.which("unshare"):
        raise Unavailable("it needs unshare (Debian: apt-get install util-linux)")
    if not shutil.which("debootstrap") or not KEYRING.exists():
        raise Unavailable(
            f"it needs debootstrap and {KEYRING} (Debian: apt-get install debootstrap "
            "debian-archive-keyring)"
        )
    sys.path.insert(0, str(ROOT / "native/cmake"))
    from debian_package import mirrors

    found = mirrors()
    if not found:
        raise Unavailable("this machine's apt names no Debian mirror")
    print(f"Making {chroot} (some minutes, about {size})", flush=True)
    shutil.rmtree(chroot, ignore_errors=True)
    chroot.parent.mkdir(parents=True, exist_ok=True)
    install = ["apt-get", "install", "-y", "--no-install-recommends", *packages]
    base = [
        "debootstrap",
        "--variant=minbase",
        "--include=ca-certificates",
        f"--keyring={KEYRING}",
        suite,
        str(chroot),
        found[0],
    ]
    with chroot.with_suffix(".log").open("w") as log:
        try:
            subprocess.run(base, stdout=log, stderr=log, check=True)
            guard = chroot / "usr/sbin/policy-rc.d"
            guard.write_text("#!/bin/sh\nexit 101\n")
            guard.chmod(0o755)
            subprocess.run(
                ["chroot", chroot, "env", "DEBIAN_FRONTEND=noninteractive", *install],
                stdout=log,
                stderr=log,
                check=True,
            )
        except subprocess.CalledProcessError as error:
            raise Unavailable(f"{error.cmd[0]} failed; see {log.name}") from error
    packed.write_text("\n".join(packages))


def inside(chroot: Path, *folders: tuple[Path, str]) -> list[str]:
    """What a command is to begin with that shall run in the system, with /proc, /dev, /sys and
    folders of this machine at places of its own. They are mounted for the command alone: when it
    ends, however it ends, nothing is left that could be removed with the system.
    """
    places = [(Path(f"/{name}"), chroot / name) for name in ("proc", "dev", "sys")]
    places += [(folder, chroot / place.lstrip("/")) for folder, place in folders]
    for _, place in places:
        place.mkdir(parents=True, exist_ok=True)
    mounts = [shlex.join(["mount", "--rbind", str(one), str(place)]) for one, place in places]
    script = " && ".join([*mounts, 'exec chroot "$@"'])
    namespace = ["unshare", "--mount", "--propagation", "private"]
    return [*namespace, "sh", "-c", script, "sh", str(chroot)]
