"""What a click on Render gives, beside Cycles with its own defaults: `python -m
tests.benchmarks.chart.defaults [--scenes SCENE ...] [--size WIDTHxHEIGHT | --scale X]` (`make
defaults`). Writes defaults.csv; with --size to out/chart/WIDTHxHEIGHT.

Seconds of the render call, relMSE, FLIP (figures.py) and the mean over the reference's, of a
picture of `scale` times the chart's width. Measure on a machine that does nothing else.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
from pathlib import Path

from tests.benchmarks.chart import figures, runs
from tests.benchmarks.chart.options import add_choice, chosen, folder_of
from tests.benchmarks.chart.plan import Case, Method

METHODS = (Method.SPLAT_DEFAULT, Method.CYCLES_DEFAULT)
COLUMNS = ["scene", "size", "method", "seconds", "relMSE", "FLIP", "mean"]


def smaller(case: Case, scale: float) -> Case:
    """Its reference takes as much less time as it has fewer pixels."""
    return dataclasses.replace(
        case,
        width=round(case.width * scale),
        height=round(case.height * scale),
        reference_seconds=max(case.reference_seconds * scale * scale, 20.0),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    add_choice(parser)
    parser.add_argument("--scale", type=float, default=1.0)
    options = parser.parse_args()
    rows: list[list[str]] = []
    for case in chosen(options):
        if options.scale != 1.0:
            case = smaller(case, options.scale)
        halves = runs.reference(case)
        for method in METHODS:
            shot = runs.shot(case, method, 0.0, 1)
            point = figures.point(0.0, [shot.picture], [shot.seconds], halves)
            found = (point.seconds, point.rel_mse, point.flip, point.mean_ratio)
            size = f"{case.width}x{case.height}"
            rows.append([case.scene, size, method.value, *(f"{x:.5g}" for x in found)])
            print(
                f"{case.scene:14} {size:10} {method:24} {point.seconds:7.1f} s  "
                f"relMSE {point.rel_mse:.6f}  FLIP {point.flip:.4f}  mean {point.mean_ratio:.4f}",
                flush=True,
            )
    write(folder_of(options) / "defaults.csv", rows)


def write(path: Path, rows: list[list[str]]) -> None:
    """What is not measured anew stays."""
    scenes = {row[0] for row in rows}
    if path.exists():
        with path.open(newline="") as file:
            rows = [row for row in csv.reader(file) if row[0] not in {*scenes, "scene"}] + rows
    with path.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])


if __name__ == "__main__":
    main()
