"""`python -m tests.benchmarks.stability.run [CASE ...]` compares the product with plain methods:
methods.md and methods.png.

`--reference [CASE ...]` path-traces what test_stability.py compares with.
"""

from __future__ import annotations

import sys

from tests.benchmarks.stability import methods
from tests.reference.stability import reference


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--reference"]:
        reference.make(arguments[1:])
    else:
        methods.main(arguments)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
