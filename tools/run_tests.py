"""Runs the Python tests, each folder that holds some in a pytest process of its own.

Usage: run_tests.py [--time-limit SECONDS] [-m MARKER] [FOLDER ...]

Blender keeps its state for a whole process, may hang when it exits, and may die there after the
last test has passed. So every process gets a clean Blender user folder and a time limit, and writes
pytest's exit status to a file before it
exits: that file decides, not the status of the process.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NO_TESTS_COLLECTED = 5

CHILD = """
import os, sys, pytest
status = int(pytest.main(sys.argv[2:]))
with open(sys.argv[1], "w") as file:
    file.write(str(status))
sys.stdout.flush()
sys.stderr.flush()
os._exit(status)
"""


def main() -> int:
    parser = argparse.ArgumentParser(description="Run the Python tests.")
    parser.add_argument(
        "--time-limit", type=float, default=600.0, help="seconds for all folders together"
    )
    parser.add_argument("folders", nargs="*", help="test folders (default: each that holds tests)")
    parser.add_argument("-m", dest="marker", help="only tests with this marker")
    options = parser.parse_args()
    pytest_options = ["-m", options.marker] if options.marker else []
    folders = [Path(folder).resolve() for folder in options.folders] or all_folders()
    deadline = time.monotonic() + options.time_limit

    failures: list[str] = []
    ran = False
    for folder in folders:
        name = folder.relative_to(ROOT).as_posix()
        print(f"== {name}", flush=True)
        status = run_folder(folder, pytest_options, deadline - time.monotonic())
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


def run_folder(folder: Path, options: list[str], seconds: float) -> int | str:
    """pytest's exit status in that folder, or why there is none."""
    with tempfile.TemporaryDirectory(prefix="photon_splat_test_") as scratch:
        status_file = Path(scratch, "status")
        environment = os.environ | {
            "BLENDER_USER_RESOURCES": str(Path(scratch, "blender")),
            "PYTHONUNBUFFERED": "1",
        }
        command = [sys.executable, "-c", CHILD, str(status_file), str(folder), *options]
        if seconds <= 0:
            return "no time was left for it"
        try:
            process = subprocess.run(
                command, cwd=ROOT, env=environment, timeout=seconds, check=False
            )
        except subprocess.TimeoutExpired:
            if not status_file.exists():
                return f"still running after {seconds:.0f} s"
        else:
            if not status_file.exists():
                return (
                    f"the process ended with status {process.returncode} in the middle of the tests"
                )
        return int(status_file.read_text())


if __name__ == "__main__":
    sys.exit(main())
