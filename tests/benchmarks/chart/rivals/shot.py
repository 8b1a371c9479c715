"""A rival's render, in the rivals' own Python: `python -m tests.benchmarks.chart.rivals.shot METHOD
SCENE.pickle SECONDS SEED OUT.npz`; with `--version METHOD` it prints the version, or fails where
that is not installed.
"""

from __future__ import annotations

import os
import pickle
import sys
from pathlib import Path

import numpy as np

from tests.benchmarks.chart.rivals import of


def main(arguments: list[str]) -> None:
    if arguments[0] == "--version":
        print("version:", of(arguments[1]).version())
        return
    method, scene, seconds, seed, output = arguments
    threads = len(os.sched_getaffinity(0))
    picture, took = of(method).render(
        pickle.loads(Path(scene).read_bytes()), float(seconds), int(seed), threads
    )
    np.savez(output, picture=picture, seconds=took)


if __name__ == "__main__":
    main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)
