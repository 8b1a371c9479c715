"""Error against time, ours and Cycles': `python -m tests.chart [--seeds N] [--budgets S,S,...] [SCENE ...]` (`make chart`).

Writes tests/chart/SCENE.png, figures.csv and equal_time.png. Renders are kept in build/chart by scene and version: a second run only
draws. Measure on a machine that does nothing else.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import sys
from pathlib import Path

from tests.chart import draw, figures, runs
from tests.chart.plan import BUDGETS, CASES, Case, Method, seeds

FOLDER = Path(__file__).resolve().parent
METHODS = (Method.SPLAT, Method.SPLAT_DENOISED, Method.CYCLES, Method.CYCLES_DENOISED)


def measure(case: Case, budgets: list[float], most_seeds: int) -> dict[Method, list[figures.Point]]:
    halves = runs.truth(case)
    found: dict[Method, list[figures.Point]] = {method: [] for method in METHODS}
    for budget in budgets:
        for method in METHODS:
            shots = [runs.shot(case, method, budget, seed) for seed in seeds(budget, most_seeds)]
            found[method].append(figures.point(budget, [s.picture for s in shots], [s.seconds for s in shots], halves))
    return found


def ratios(found: dict[Method, list[figures.Point]]) -> list[str]:
    """Equal error: at each error that Cycles reached, how much earlier we had it; and equal time against the denoised."""
    lines = []
    ours, cycles = found[Method.SPLAT], found[Method.CYCLES]
    for theirs in cycles:
        mine = figures.seconds_to(ours, theirs.rmse)
        first = f"under {ours[0].seconds:.2g} s: more than {theirs.seconds / ours[0].seconds:.0f}x"
        text = first if mine != mine else f"{mine:.2f} s: {theirs.seconds / mine:.0f}x"
        lines.append(f"   equal error {theirs.rmse:.5f}: Cycles {theirs.seconds:.1f} s, ours {text}")
    for p in ours:
        times = figures.seconds_to(cycles, p.rmse) / p.seconds
        lines.append(f"   our error {p.rmse:.5f} after {p.seconds:.2f} s: Cycles {times:.0f} times as long")
    for theirs in found[Method.CYCLES_DENOISED]:
        best = min(figures.rel_mse_at(found[method], theirs.seconds) for method in (Method.SPLAT, Method.SPLAT_DENOISED))
        times = theirs.rel_mse / best
        lines.append(
            f"   equal time {theirs.seconds:.1f} s: relMSE of Cycles, denoised {theirs.rel_mse:.2e}, ours {best:.2e}: {times:.2f}x"
        )
    return lines


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.chart")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="of " + ", ".join(case.scene for case in CASES))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--budgets", default=",".join(f"{b:g}" for b in BUDGETS), help="seconds, with commas")
    options = parser.parse_args(arguments)
    budgets = [float(b) for b in options.budgets.split(",")]
    wanted = [case for case in CASES if not options.scenes or case.scene in options.scenes]
    if not wanted or len(wanted) < len(options.scenes):
        parser.error("no such scene")
    rows = _old_rows({case.scene for case in wanted})
    for case in wanted:
        print(f"== {case.scene} ({case.kind}), {case.width}x{case.height}", flush=True)
        found = measure(case, budgets, options.seeds)
        for method, points in found.items():
            for p in points:
                print(
                    f"   {method:24} {p.seconds:6.2f} s  RMSE {p.rmse:.5f} ({p.low:.5f} to {p.high:.5f})  relMSE {p.rel_mse:.2e}  "
                    f"FLIP {p.flip:.4f}  mean {p.mean_ratio:.4f}"
                )
                rows.append({"scene": case.scene, "method": str(method)} | dataclasses.asdict(p))
            print(f"   {method:24} slope {figures.slope(points):.2f}")
        print("\n".join(ratios(found)), flush=True)
        draw.chart(case, found, FOLDER / f"{case.scene}.png")
        draw.equal_time(case, budgets, runs.truth(case), FOLDER / f"{case.scene}_equal_time.png")
    with (FOLDER / "figures.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows({k: f"{v:.5g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)
    return 0


def _old_rows(anew: set[str]) -> list[dict[str, object]]:
    """Of scenes that are not measured now."""
    path = FOLDER / "figures.csv"
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return [dict(row) for row in csv.DictReader(file) if row["scene"] not in anew]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
