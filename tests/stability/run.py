"""`python -m tests.stability.run --truth [CASE ...]` path-traces what test_stability.py compares with."""

from __future__ import annotations

import sys

from tests.stability import truth


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--truth"]:
        truth.make(arguments[1:])
        return 0
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
