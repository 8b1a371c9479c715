"""tools/kept_warnings.py: a warning is kept until its file is compiled again without one."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.support.paths import ROOT

STEPS = """  [1/3] Building CXX object a.cpp.o
  [2/3] Building CXX object b.cpp.o
  b.cpp:3:7: warning: unused variable 'x' [-Wunused-variable]
  [3/3] Linking CXX static library core.a
"""
AGAIN = "  [1/1] Building CXX object {}.cpp.o\n"


def kept(file: Path, *command: str) -> subprocess.CompletedProcess[str]:
    tool = [sys.executable, str(ROOT / "tools/kept_warnings.py"), str(file)]
    return subprocess.run([*tool, *command], capture_output=True, text=True, check=False)


def build(file: Path, said: str, status: int = 0) -> subprocess.CompletedProcess[str]:
    code = f"import sys; print({said!r}, end=''); sys.exit({status})"
    return kept(file, sys.executable, "-c", code)


def test_a_warning_is_kept_until_its_file_is_compiled_again(tmp_path: Path) -> None:
    file = tmp_path / "warnings.json"
    assert kept(file).returncode == 0
    done = build(file, STEPS)
    assert (done.returncode, done.stdout) == (0, STEPS)
    for _ in range(2):  # asking changes nothing
        asked = kept(file)
        assert asked.returncode == 1
        assert asked.stderr.startswith("Building CXX object b.cpp.o\n")
        assert "warning: unused variable 'x'" in asked.stderr
    build(file, AGAIN.format("a"))
    assert kept(file).returncode == 1
    build(file, AGAIN.format("b"))
    assert kept(file).returncode == 0


def test_a_build_that_fails_says_so_and_keeps_its_warnings(tmp_path: Path) -> None:
    file = tmp_path / "warnings.json"
    assert build(file, STEPS, 3).returncode == 3
    assert kept(file).returncode == 1
