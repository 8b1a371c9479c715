"""Draws what a graphics card has shown:
`python -m tests.benchmarks.bench.gpu_chart FOLDER OUT.png`.

FOLDER holds splatting.json (of tests.benchmarks.bench.gpu) and equal_time.csv (of
tests.benchmarks.chart.equal_time --card).
"""

from __future__ import annotations

import argparse
import csv
import json
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
from matplotlib import pyplot as plt

SERIES = {
    "gpu_ms": "card: copies and drawing",
    "busy_ms": "the thread that feeds it",
    "pairs_ms": "search for pairs, on the CPU",
    "cpu_ms": "CPU splatter, its search included",
    "trace_ms": "tracing the photons, on the CPU",
}


def splatting(axes: Any, rows: list[dict[str, Any]]) -> None:
    photons = [row["photons"] for row in rows]
    for name, label in SERIES.items():
        each = [row[name] * 1e6 / row["photons"] for row in rows]
        axes.plot(photons, each, marker="o", label=label)
    axes.set(xscale="log", yscale="log", xlabel="photons", ylabel="ms a million photons")
    axes.set_title("Splatting at 1920x1080")
    axes.legend(fontsize=7)


def equal_time(axes: Any, rows: list[dict[str, str]]) -> None:
    """Ratios of relMSE, Cycles' over ours."""
    pairs = list(dict.fromkeys(row["pair"] for row in rows))
    files = list(dict.fromkeys(row["file"] for row in rows))
    for k, pair in enumerate(pairs):
        ratios = [float(row["ratio"]) for row in rows if row["pair"] == pair]
        rival = "Cycles on the card" if pair.endswith(" card") else "Cycles on 16 cores"
        label = f"{rival}, {pair.removesuffix(' card')}"
        places = [i + 0.2 * (k - 1.5) for i in range(len(files))]
        axes.bar(places, ratios, width=0.19, label=label)
    axes.axhline(1.0, color="black", linewidth=0.8)
    axes.set(yscale="log", ylabel="relMSE of Cycles over ours: above 1 we are ahead")
    axes.set_xticks(range(len(files)), files)
    axes.set_title("Equal time (5 s asked) at 1920x1080")
    axes.legend(fontsize=7)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("output", type=Path)
    options = parser.parse_args()
    report = json.loads((options.folder / "splatting.json").read_text())
    with (options.folder / "equal_time.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4))
    splatting(left, report["groups"]["photons"])
    equal_time(right, rows)
    figure.tight_layout()
    figure.savefig(options.output, dpi=110)


if __name__ == "__main__":
    main()
