"""Any .blend files, at equal time beside Cycles: `python -m tests.benchmarks.chart.equal_time
[--width N] [--seconds S,S,...] [--card] [--table OUT.csv] FILE ...` (`make equal-time
FILES=...`).

Cycles is given its limit first, raw and denoised; we are given the seconds that its call took in
the end, as Cycles counts neither start-up nor denoising. The ratio is relMSE of Cycles over ours:
above 1 we are ahead. The reference is two halves by our path tracer. What hardly a path finds is
missing in them: such files have a mean far from 1, and their ratios say little. Measure on a
machine that does nothing else.

--card: beside Cycles on a graphics card as well, and the reference is by that, too: on large
pictures no other one is known well enough.
"""

from __future__ import annotations

import argparse
import csv
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tests.benchmarks.chart import figures, runs
from tests.benchmarks.chart.plan import Case, Method

PAIRS = (
    (Method.CYCLES, Method.SPLAT),
    (Method.CYCLES_DENOISED, Method.SPLAT_DENOISED),
)
CARD_PAIRS = (
    (Method.CYCLES_CARD, Method.SPLAT),
    (Method.CYCLES_CARD_DENOISED, Method.SPLAT_DENOISED),
)
WINDOW = 7
"""Of relMSE's denominator: the references are noisy ones."""
SIZE = """
import bpy, sys
bpy.ops.wm.open_mainfile(filepath=sys.argv[1], load_ui=False, use_scripts=False)
r = bpy.context.scene.render
print("SIZE", r.resolution_x * r.pixel_aspect_x, r.resolution_y * r.pixel_aspect_y)
"""
COLUMNS = ["file", "asked", "pair", "cycles_s", "our_s", "cycles", "ours", "ratio", "means"]


def case_of(path: Path, width: int, reference_seconds: float, reference: str) -> Case:
    """The longer side of the picture has `width` pixels."""
    said = subprocess.run(
        [sys.executable, "-c", SIZE, str(path)], capture_output=True, text=True, timeout=300
    ).stdout
    line = next(line for line in said.splitlines() if line.startswith("SIZE"))
    x, y = (float(word) for word in line.split()[1:])
    scale = width / max(x, y)
    size = (max(round(x * scale), 8), max(round(y * scale), 8))
    return Case(path.stem, *size, "file", reference, reference_seconds, path.resolve())


def compare(
    case: Case, seconds: list[float], pairs: Sequence[tuple[Method, Method]]
) -> list[list[object]]:
    halves = runs.reference(case)
    rows: list[list[object]] = []
    for asked in seconds:
        for theirs, ours in pairs:
            cycles = runs.shot(case, theirs, asked, 1)
            mine = runs.shot(case, ours, round(cycles.seconds, 1), 1)
            points = [
                figures.point(asked, [shot.picture], [shot.seconds], halves, WINDOW)
                for shot in (cycles, mine)
            ]
            errors = [p.rel_mse for p in points]
            ratio = errors[0] / errors[1] if errors[1] > 0 else float("nan")
            means = "/".join(f"{p.mean_ratio:.3f}" for p in points)
            pair = "denoised" if ours == Method.SPLAT_DENOISED else "raw"
            pair += " card" if (theirs, ours) in CARD_PAIRS else ""
            rows.append(
                [case.scene, asked, pair, cycles.seconds, mine.seconds, *errors, ratio, means]
            )
            print(
                f"{case.scene:20} {asked:5g} s {pair:13} Cycles {cycles.seconds:6.1f} s "
                f"{errors[0]:.5f}  ours {mine.seconds:6.1f} s {errors[1]:.5f}  "
                f"ratio {ratio:6.2f}  means {means}",
                flush=True,
            )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--seconds", default="5,20")
    parser.add_argument("--reference-seconds", type=float, default=60.0)
    parser.add_argument("--card", action="store_true")
    parser.add_argument("--table", type=Path)
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    options = parser.parse_args()
    seconds = [float(s) for s in options.seconds.split(",")]
    rows: list[list[object]] = []
    pairs = (*PAIRS, *CARD_PAIRS) if options.card else PAIRS
    reference = "cycles-card" if options.card else "paths"
    for path in options.files:
        try:
            case = case_of(path, options.width, options.reference_seconds, reference)
            rows += compare(case, seconds, pairs)
        except (RuntimeError, StopIteration, subprocess.TimeoutExpired) as error:
            print(f"{path.stem}: {str(error)[-300:] or 'cannot be opened'}", flush=True)
    if options.table:
        with options.table.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])
    ratios = [float(str(row[7])) for row in rows if row[7] == row[7]]
    if ratios:
        print(f"median {np.median(ratios):.2f}, least {min(ratios):.2f}, of {len(ratios)}")


if __name__ == "__main__":
    main()
