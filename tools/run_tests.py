"""Runs the Python tests, each folder that holds some in a pytest process of its own.

Usage: run_tests.py [-m MARKERS] [-j JOBS] [FOLDER ...]

Tests that are marked as slow run with `-m slow` only (make reference). Folders run side by side, as
much of a test is Blender's start and export, which take one core; what a folder prints comes whole
when it has ended.

Blender keeps its state for a whole process, may hang when it exits, and may die there after the
last test has passed. So every process gets a clean Blender user folder, and writes pytest's exit
status and the processor time it has taken to a file before it exits: that file decides, not the
status of the process. Nothing has a limit of wall time, which a busy machine would break; a process
that hangs is ended all the same (tests/support/hang.py).
"""

from __future__ import annotations

import argparse
import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # for tests

from tests.support.hang import POLL_SECONDS, HangGuard  # noqa: E402

NO_TESTS_COLLECTED = 5
LONGEST = (
    "tests/reference/cycles",
    "tests/reference/integrators",
    "tests/integration/farm",
    "tests/integration/addon",
    "tests/reference/closed_form",
    "tests/robustness",
    "tests/reference/stability",
    "tests/reference/caustics",
    "tests/gpu/splatter",
)
"""Begun first, in this order, so that none of them is left to run alone."""
COMPILED = ROOT / "build" / "pycache"
"""Python code compiled once for all of the processes that tests start, whatever the shell says."""
LAST_WORDS_SECONDS = 10.0
"""For a process that hangs to say where."""

CHILD = """
import os, sys, pytest

class Current:
    def pytest_runtest_logstart(self, nodeid):
        with open(sys.argv[2], "w") as file:
            file.write(nodeid)

status = int(pytest.main(sys.argv[3:], plugins=[Current()]))
with open(sys.argv[1], "w") as file:
    file.write(f"{status} {sum(os.times()[:4]):.0f}")
sys.stdout.flush()
sys.stderr.flush()
os._exit(status)
"""


def main() -> int:
    parser = argparse.ArgumentParser(description="Run the Python tests.")
    parser.add_argument("folders", nargs="*", help="test folders (default: each that holds tests)")
    parser.add_argument(
        "-m", dest="marker", default="not slow", help="pytest's expression of markers (%(default)s)"
    )
    parser.add_argument(
        "-j", dest="jobs", type=int, default=2, help="folders side by side (%(default)s)"
    )
    options = parser.parse_args()
    pytest_options = ["-m", options.marker]
    folders = [Path(folder).resolve() for folder in options.folders] or [
        folder for folder in all_folders() if may_hold(folder, options.marker)
    ]

    failures: list[str] = []
    ran = False
    running: set[subprocess.Popen[bytes]] = set()
    with ThreadPoolExecutor(max(options.jobs, 1)) as pool, ended_on_interrupt(pool, running):
        runs = {
            pool.submit(run_folder, folder, pytest_options, running): folder for folder in folders
        }
        for run in as_completed(runs):
            name = runs[run].relative_to(ROOT).as_posix()
            status, said, seconds = run.result()
            print(f"== {name}\n{said}   {seconds}", flush=True)
            if isinstance(status, str):
                failures.append(f"{name}: {status}")
            elif status != NO_TESTS_COLLECTED:
                ran = True
                if status != 0:
                    failures.append(f"{name}: pytest gave status {status}")
    if not ran and not failures:
        failures.append("not one test was found")
    for failure in failures:
        print(f"FAILED {failure}", file=sys.stderr)
    return 1 if failures else 0


@contextlib.contextmanager
def ended_on_interrupt(
    pool: ThreadPoolExecutor, running: set[subprocess.Popen[bytes]]
) -> Iterator[None]:
    """Ctrl-C reaches this process alone: the tests have sessions of their own."""
    try:
        yield
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in list(running):
            end(process)
        raise


def all_folders() -> list[Path]:
    found = sorted({file.parent for file in (ROOT / "tests").rglob("test_*.py")})
    order = {ROOT / name: place for place, name in enumerate(LONGEST)}
    return sorted(found, key=lambda folder: order.get(folder, len(order)))


def may_hold(folder: Path, marker: str) -> bool:
    """False where no file of the folder names the one marker that is asked for: starting pytest
    there would only import Blender.
    """
    return not marker.isidentifier() or any(
        f"mark.{marker}" in file.read_text() for file in folder.glob("*.py")
    )


def run_folder(
    folder: Path, options: list[str], running: set[subprocess.Popen[bytes]]
) -> tuple[int | str, str, str]:
    """pytest's exit status in that folder, or why there is none; what it printed; what time it
    took. Its process is among `running` while it is.
    """
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="photon_splat_test_") as scratch:
        status_file, current = Path(scratch, "status"), Path(scratch, "current")
        environment = os.environ | {
            "BLENDER_USER_RESOURCES": str(Path(scratch, "blender")),
            "PYTHONUNBUFFERED": "1",
            "PYTHONPYCACHEPREFIX": str(COMPILED),
        }
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        command = [sys.executable, "-c", CHILD, str(status_file), str(current), str(folder)]
        output = Path(scratch, "output")
        with output.open("wb") as log:
            process = subprocess.Popen(
                [*command, *options],
                cwd=ROOT,
                env=environment,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            running.add(process)
            try:
                hang = watch(process, current)
            finally:
                end(process)
                running.discard(process)
        said = output.read_text(errors="replace")
        seconds = f"{time.monotonic() - began:.0f} s"
        if status_file.exists():
            status, computed = status_file.read_text().split()
            return int(status), said, f"{seconds}, {computed} s of processor time"
        ended = f"the process ended with status {process.returncode} in {test_of(current)}"
        return hang or ended, said, seconds


def watch(process: subprocess.Popen[bytes], current: Path) -> str | None:
    """Waits for the end of the process, or says why it will have none."""
    guard, test = HangGuard(process.pid), test_of(current)
    while True:
        try:
            process.wait(POLL_SECONDS)
        except subprocess.TimeoutExpired:
            if test != (test := test_of(current)):
                guard.restart()
            elif reason := guard.check():
                process.send_signal(signal.SIGABRT)  # pytest then prints what all threads do
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(LAST_WORDS_SECONDS)
                return f"{reason} in {test}"
        else:
            return None


def test_of(current: Path) -> str:
    return current.read_text() if current.exists() else "no test yet"


def end(process: subprocess.Popen[bytes]) -> None:
    """The process and what it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


if __name__ == "__main__":
    sys.exit(main())
