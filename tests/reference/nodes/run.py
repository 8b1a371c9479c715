"""Our programs against Cycles' shaders: `python -m tests.reference.nodes.run [--every N] [--json
FILE] [NAME ...]`.

Prints passed/total and every case that fails. NAME: only cases whose name contains it. --every N:
each Nth case.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from tests.reference.nodes.stage import SHIFT

EXACT, NOISE = 1.0 / 255.0, 0.005
# A pixel's centre may lie on a jump of the function by rounding: so many pixels of a cell may
# differ.
STRAY = 0.006
# Neither side goes on below what is shifted to black; beyond this no picture has a use for a
# number.
LARGEST = 1e6


def worst(case: Any, ours: np.ndarray, reference: np.ndarray) -> tuple[float, float]:
    """(share of pixels that differ, largest difference among the rest) of a case; differences are
    relative above 1.
    """
    allowed = NOISE if case.noise else EXACT
    ours, reference = (
        np.clip(np.nan_to_num(picture, nan=0.0), -SHIFT, LARGEST) for picture in (ours, reference)
    )
    difference = (np.abs(ours - reference) / np.maximum(1.0, np.abs(reference))).max(axis=-1)
    off = difference > allowed
    return float(off.mean()), float(difference[~off].max(initial=0.0))


def compare(names: list[str], every: int, dump: Path | None = None) -> dict[str, Any]:
    """Runs inside Blender."""
    import photon_splat

    from tests.reference.nodes import stage
    from tests.reference.nodes.cases import all_cases

    photon_splat.register()
    cases = [case for case in all_cases() if not names or any(name in case.name for name in names)][
        ::every
    ]
    stage.build(cases)
    started = time.monotonic()
    reference, positions = stage.cycles()
    rendered = time.monotonic()
    ours, warnings = stage.ours(positions)
    failed = {}
    for k, case in enumerate(cases):
        share, rest = worst(case, stage.cell(ours, k), stage.cell(reference, k))
        if share > STRAY:
            failed[case.name] = {"differ": share, "rest": rest}
    seconds = {"cycles": rendered - started, "ours": time.monotonic() - rendered}
    if dump is not None:
        cells = {
            case.name: (stage.cell(ours, k), stage.cell(reference, k))
            for k, case in enumerate(cases)
            if case.name in failed or len(cases) < 40
        }
        np.savez(
            dump,
            **{
                f"{name}/{who}": cell
                for name, both in cells.items()
                for who, cell in zip(("ours", "cycles"), both, strict=True)
            },
        )
    return {
        "total": len(cases),
        "passed": len(cases) - len(failed),
        "failed": failed,
        "warnings": warnings,
        "seconds": seconds,
    }


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--json", type=Path)
    parser.add_argument(
        "--dump", type=Path, help="writes the cells of what fails to this .npz file"
    )
    options = parser.parse_args(arguments)
    said = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # Blender prints to stdout
    result = compare(options.names, options.every, options.dump)
    for name, figures in result["failed"].items():
        print(f"  {name}: {figures['differ']:.1%} of the pixels differ", file=said)
    for warning in result["warnings"]:
        print(f"  warned: {warning}", file=said)
    times = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in result["seconds"].items())
    print(
        f"nodes: {result['passed']} of {result['total']} cases agree with Cycles ({times})",
        file=said,
        flush=True,
    )
    if options.json:
        options.json.write_text(json.dumps(result))
    return 0


if __name__ == "__main__":
    code = main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(code)
