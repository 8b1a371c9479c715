"""figures.csv: a row for each scene, method and budget; what is not measured anew stays."""

from __future__ import annotations

import csv
from pathlib import Path

from tests.benchmarks.chart.plan import CASES, Method

Row = dict[str, object]


def write(path: Path, rows: list[Row]) -> None:
    rows = sorted(_old_rows(path, rows) + rows, key=_place)
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {k: f"{v:.5g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows
        )


def _key(row: Row) -> tuple[str, str, float]:
    return str(row["scene"]), str(row["method"]), float(str(row["budget"]))


def _place(row: Row) -> tuple[int, int, float]:
    scene, method, budget = _key(row)
    return [case.scene for case in CASES].index(scene), list(Method).index(Method(method)), budget


def _old_rows(path: Path, anew: list[Row]) -> list[Row]:
    if not path.exists():
        return []
    replaced = {_key(row) for row in anew}
    with path.open(newline="") as file:
        return [row for row in map(dict, csv.DictReader(file)) if _key(row) not in replaced]
