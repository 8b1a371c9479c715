"""Runs the Python tests, each folder that holds some in a pytest process of its own.

Usage: run_tests.py [-m MARKERS] [FOLDER ...]

Tests that are marked as slow run with `-m slow` only (make reference).

Blender keeps its state for a whole process, may hang when it exits, and may die there after the
last test has passed. So every process gets a clean Blender user folder, and writes pytest's exit
status to a file before it exits: that file decides, not the status of the process. Nothing has a
limit of wall time, which a busy machine would break; a process that hangs is ended all the same
(tests/support/hang.py).
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
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # for tests

from tests.support.hang import POLL_SECONDS, HangGuard  # noqa: E402

NO_TESTS_COLLECTED = 5
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
    file.write(str(status))
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
    options = parser.parse_args()
    pytest_options = ["-m", options.marker]
    folders = [Path(folder).resolve() for folder in options.folders] or all_folders()

    failures: list[str] = []
    ran = False
    for folder in folders:
        name = folder.relative_to(ROOT).as_posix()
        print(f"== {name}", flush=True)
        began = time.monotonic()
        status = run_folder(folder, pytest_options)
        print(f"   {time.monotonic() - began:.0f} s", flush=True)
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


def all_folders() -> list[Path]:
    return sorted({file.parent for file in (ROOT / "tests").rglob("test_*.py")})


def run_folder(folder: Path, options: list[str]) -> int | str:
    """pytest's exit status in that folder, or why there is none."""
    with tempfile.TemporaryDirectory(prefix="photon_splat_test_") as scratch:
        status_file, current = Path(scratch, "status"), Path(scratch, "current")
        environment = os.environ | {
            "BLENDER_USER_RESOURCES": str(Path(scratch, "blender")),
            "PYTHONUNBUFFERED": "1",
        }
        command = [sys.executable, "-c", CHILD, str(status_file), str(current), str(folder)]
        process = subprocess.Popen(
            [*command, *options], cwd=ROOT, env=environment, start_new_session=True
        )
        try:
            hang = watch(process, current)
        finally:
            end(process)
        if status_file.exists():
            return int(status_file.read_text())
        return hang or (f"the process ended with status {process.returncode} in {test_of(current)}")


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
