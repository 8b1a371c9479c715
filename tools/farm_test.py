"""Renders a job of photon-splat farm on a Slurm of one node: array, merge, and a task that is ended
and queued again. The daemons are Debian's, from packages that are unpacked into a folder and not
installed, on ports of their own, without authentication.

Usage: farm_test.py [FOLDER for packages]
"""

from __future__ import annotations

import contextlib
import getpass
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = (
    "slurmctld",
    "slurmd",
    "slurm-client",
    "slurm-wlm-basic-plugins",
    "libmunge2",
    "libhwloc15",
    "liblua5.1-0",
)
CONFIGURATION = """\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
AuthInfo=cred_expire=5
PluginDir={plugins}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldPort={port}
SlurmdPort={node_port}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
MpiDefault=none
ReturnToService=2
KillWait=60
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs=3 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class CannotRun(Exception):
    """Why there is no such test here; one sentence."""


def main() -> int:
    packages = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / ".cache/slurm").resolve()
    try:
        system = unpack(packages)
    except CannotRun as reason:
        print(f"Slurm is not tested: {reason}")
        return 0
    with (
        tempfile.TemporaryDirectory(prefix="photon_splat_farm_") as folder,
        Cluster(system, Path(folder)) as cluster,
    ):
        renders_and_merges(cluster)
        goes_on_after_sigterm(cluster)
        merges_nothing_after_a_failure(cluster)
    print("Slurm has rendered, merged, and gone on after SIGTERM.")
    return 0


def unpack(folder: Path) -> Path:
    """The folder with Debian's packages in it."""
    if not (shutil.which("apt-get") and shutil.which("dpkg")):
        raise CannotRun("this is no Debian, whose packages it takes")
    root = folder / "root"
    if not (root / "usr/sbin/slurmctld-wlm").exists():
        folder.mkdir(parents=True, exist_ok=True)
        done = subprocess.run(["apt-get", "-qq", "download", *PACKAGES], cwd=folder, check=False)
        if done.returncode:
            raise CannotRun("apt-get cannot download slurmctld")
        for package in folder.glob("*.deb"):
            subprocess.run(["dpkg", "-x", package, root], check=True)
    return root


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


class Cluster:
    def __init__(self, system: Path, folder: Path) -> None:
        self.folder = folder
        self.system = system
        plugins = system / "usr/lib/x86_64-linux-gnu/slurm-wlm"
        for name in ("state", "spool"):
            (folder / name).mkdir()
        (folder / "slurm.conf").write_text(
            CONFIGURATION.format(
                host=socket.gethostname().split(".")[0],
                user=getpass.getuser(),
                plugins=plugins,
                folder=folder,
                port=free_port(),
                node_port=free_port(),
            )
        )
        libraries = f"{plugins}:{plugins.parent}"
        self.environment = os.environ | {
            "SLURM_CONF": str(folder / "slurm.conf"),
            "LD_LIBRARY_PATH": libraries,
            "PATH": f"{system}/usr/bin:{ROOT}/.venv/bin:{os.environ['PATH']}",
            "BLENDER_USER_RESOURCES": str(folder / "blender"),
        }
        self.daemons: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Cluster:
        sbin = self.system / "usr/sbin"
        for name, options in (
            ("slurmctld-wlm", ["-D"]),
            ("slurmd-wlm", ["-D", "-d", str(sbin / "slurmstepd-wlm")]),
        ):
            with open(self.folder / f"{name}.log", "wb") as log:
                self.daemons.append(
                    subprocess.Popen(
                        [sbin / name, *options], env=self.environment, stdout=log, stderr=log
                    )
                )
        last = time.monotonic() + 60
        while "idle" not in self.call("sinfo", "-h", "-o", "%T", check=False):
            if time.monotonic() > last or any(one.poll() is not None for one in self.daemons):
                logs = "".join(path.read_text()[-3000:] for path in self.folder.glob("*.log"))
                self.__exit__()
                raise SystemExit(f"Slurm does not start:\n{logs}")
            time.sleep(0.5)
        return self

    def __exit__(self, *_: object) -> None:
        for daemon in reversed(self.daemons):
            daemon.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                daemon.wait(20)
            daemon.kill()

    def call(self, *command: object, check: bool = True) -> str:
        done = subprocess.run(
            [str(word) for word in command],
            env=self.environment,
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )
        if check and done.returncode:
            raise SystemExit(f"{command[0]} failed: {done.stderr}")
        return done.stdout

    def submit(self, bundle: Path, **more: str) -> list[str]:
        """Numbers of the jobs: array, merge."""
        environment = self.environment
        self.environment = environment | more
        try:
            said = self.call(bundle / "submit.sh")
        finally:
            self.environment = environment
        return [line.split()[-1] for line in said.splitlines()]

    def states(self, job: str) -> set[str]:
        """Of all tasks of a job."""
        said = self.call("scontrol", "show", "job", job, check=False)
        return {word.split("=")[1] for word in said.split() if word.startswith("JobState=")}

    def wait(self, jobs: list[str], ended: set[str]) -> None:
        last = time.monotonic() + 300
        while not all(self.states(job) <= ended for job in jobs):
            if time.monotonic() > last:
                logs = "\n".join(
                    f"{path}:\n{path.read_text()[-1500:]}" for path in self.folder.rglob("*.log")
                )
                raise SystemExit(f"jobs do not end: {[self.states(job) for job in jobs]}\n{logs}")
            time.sleep(0.5)


def write(cluster: Cluster, name: str, *options: object, command: str = "photon-splat") -> Path:
    bundle = cluster.folder / name
    scene = ROOT / "blend_scenes/cornell_box.blend"
    farm = ["photon-splat", "farm", scene, "--still", 3, "--frame", 1, "--for", "slurm"]
    small = ["--resolution", "32x32", "--photons-per-pass", 5000, "--threads", 1]
    cluster.call(*farm, "-o", bundle, "--worker-command", command, *small, *options)
    return bundle


def renders_and_merges(cluster: Cluster) -> None:
    bundle = write(cluster, "still", "--passes", 2)
    cluster.wait(cluster.submit(bundle), {"COMPLETED"})
    assert (bundle / "output/cornell_box.exr").exists()
    assert len(list((bundle / "output/parts").iterdir())) == 3


def goes_on_after_sigterm(cluster: Cluster) -> None:
    """SIGTERM as before a preemption: the task is queued again and ends as if nothing had been."""
    bundle = write(cluster, "ended", "--passes", 4000, "--no-adaptive-samples")
    jobs = cluster.submit(bundle)
    log = bundle / f"output/logs/{jobs[0]}_2.log"
    last = time.monotonic() + 120
    while not (log.exists() and "openjd_status: Pass" in log.read_text()):
        assert time.monotonic() < last, "the task does not begin"
        time.sleep(0.2)
    cluster.call("scancel", "--batch", "--signal=TERM", f"{jobs[0]}_2")
    cluster.wait(jobs, {"COMPLETED"})
    text = log.read_text()
    assert "the checkpoint" in text, text
    assert "going on from" in text, text
    said = cluster.call("photon-splat", "info", bundle / "output/parts/cornell_box.part_2.exr")
    assert "passes       4000 of 3 parts planned" in said, said
    assert "part 2, generation 1:" in said, said
    assert (bundle / "output/cornell_box.exr").exists()


def merges_nothing_after_a_failure(cluster: Cluster) -> None:
    failing = cluster.folder / "failing"
    failing.write_text('#!/bin/sh\ncase "$*" in *"--part 2/3"*) exit 3;; esac\nphoton-splat "$@"\n')
    failing.chmod(0o755)
    bundle = write(cluster, "failed", "--passes", 1, command=str(failing))
    array, merge = cluster.submit(bundle)
    cluster.wait([array], {"COMPLETED", "FAILED"})
    assert "FAILED" in cluster.states(array)
    cluster.wait([merge], {"CANCELLED", "FAILED", "DEADLINE"})
    assert not (bundle / "output/cornell_box.exr").exists()


if __name__ == "__main__":
    sys.exit(main())
