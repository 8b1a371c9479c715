"""Compiler warnings of a build folder, kept until their files are compiled again: the set-up builds
with any compiler, `make test` wants a build without warnings and does not compile all of it twice.

Usage: kept_warnings.py FILE COMMAND...   runs the build, prints what it prints, keeps the warnings
       kept_warnings.py FILE              fails and prints what is kept
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

STEP = re.compile(r"\s*\[\d+/\d+\] (.+)")
"""Ninja's line before what a step printed, as pip indents it."""
WARNING = re.compile(r"(warning: |: warning [A-Z]+\d+:)")


def main() -> int:
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    file, command = Path(sys.argv[1]), sys.argv[2:]
    kept: dict[str, str] = json.loads(file.read_text()) if file.exists() else {}
    if not command:
        for step, said in kept.items():
            print(f"{step}\n{said}", file=sys.stderr)
        return 1 if kept else 0
    build = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace"
    )
    assert build.stdout is not None
    try:
        for step, said in steps(printed(build.stdout)):
            kept.pop(step, None)
            if WARNING.search(said):
                kept[step] = said
    finally:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(kept, indent=1))
    return build.wait()


def printed(lines: Iterable[str]) -> Iterator[str]:
    for line in lines:
        print(line, end="", flush=True)
        yield line


def steps(lines: Iterable[str]) -> Iterator[tuple[str, str]]:
    """What each step of the build is called, and what it printed."""
    step, said = "", ""
    for line in lines:
        if begun := STEP.match(line):
            if step:
                yield step, said
            step, said = begun[1].strip(), ""
        else:
            said += line
    if step:
        yield step, said


if __name__ == "__main__":
    sys.exit(main())
