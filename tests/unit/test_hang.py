"""The guard that ends a hanging test, and the clock that tests hold the program to."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

from tests.support.clock import Stopwatch, processors
from tests.support.hang import HangGuard, killed_if_hung, tree_seconds

COMPUTES = "while True: pass"
SLEEPS = "import time; time.sleep(3600)"
BY_A_CHILD = f"import subprocess, sys; subprocess.run([sys.executable, '-c', '{COMPUTES}'])"


@pytest.mark.parametrize(
    ("program", "limits", "reason"),
    [
        (COMPUTES, {"busy": 0.5}, "computing for "),
        (BY_A_CHILD, {"busy": 0.5}, "computing for "),
        (SLEEPS, {"idle": 1.0}, "doing nothing for "),
    ],
)
def test_what_hangs_is_named(program: str, limits: dict[str, float], reason: str) -> None:
    with subprocess.Popen([sys.executable, "-c", program], start_new_session=True) as process:
        try:
            guard = HangGuard(process.pid, **limits)
            while (found := guard.check()) is None:
                time.sleep(0.02)
        finally:
            _kill_all(process)
    assert found.startswith(reason)


def test_a_test_that_begins_has_all_its_time() -> None:
    with subprocess.Popen([sys.executable, "-c", COMPUTES]) as process:
        try:
            guard = HangGuard(process.pid, busy=0.2)
            while guard.check() is None:
                time.sleep(0.02)
            guard.restart()
            assert guard.check() is None
        finally:
            process.kill()


def test_a_process_that_answers_is_left_alone() -> None:
    with subprocess.Popen(["cat"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as cat:
        assert cat.stdin is not None
        assert cat.stdout is not None
        with killed_if_hung(cat):
            cat.stdin.write("yes\n")
            cat.stdin.flush()
            assert cat.stdout.readline() == "yes\n"
        cat.stdin.close()
        assert cat.wait() == 0


def test_a_stopwatch_counts_what_is_computed_whoever_else_computes() -> None:
    watch, began = Stopwatch(), time.process_time()
    while time.process_time() - began < 0.4:
        pass
    assert watch.seconds() >= 0.4 / processors()


def test_a_stopwatch_counts_what_is_slept_but_not_what_is_waited_for() -> None:
    watch, began = Stopwatch(), time.monotonic()
    time.sleep(0.3)
    slept = time.monotonic() - began
    assert watch.seconds() + watch.waited() >= slept
    assert watch.seconds() < slept + 0.1


def _kill_all(process: subprocess.Popen[bytes]) -> None:
    assert tree_seconds(process.pid) is not None
    os.killpg(process.pid, signal.SIGKILL)
