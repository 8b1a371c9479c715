"""Error against time, ours, Cycles' and rivals' (`make chart`): `python -m tests.benchmarks.chart
[--scenes SCENE ...] [--times S ...] [--size WIDTHxHEIGHT] [--seeds N]`.

Writes SCENE.png, SCENE_equal_time.png and figures.csv beside this file; with --size to
out/chart/WIDTHxHEIGHT. Renders and references are kept in build/chart by scene, version and size: a
second run only draws. Measure on a machine that does nothing else. Rivals (Mitsuba, LuxCore) are
drawn where they are installed (`make setup-rivals`) and can say the scene exactly; one that gets
another mean on the Cornell box is refused. `--long SCENE ...` gives Cycles a quarter of an hour
there, by samples (plan.LONG); once made, it is drawn by every run.
"""

from __future__ import annotations

import dataclasses
import sys

import numpy as np

from tests.benchmarks.chart import draw, figures, options, runs, table
from tests.benchmarks.chart.plan import (
    BETWEEN,
    CASES,
    LONG,
    MEAN_CASE,
    MEAN_SECONDS,
    MEAN_TOLERANCE,
    RIVALS,
    Case,
    Method,
    seeds,
)
from tests.benchmarks.chart.rivals import driver

METHODS = (Method.SPLAT, Method.SPLAT_DENOISED, Method.CYCLES, Method.CYCLES_DENOISED)


def rivals_of(case: Case) -> list[Method]:
    """Those that are charted; says of the others why not."""
    checked = next(c for c in CASES if c.scene == MEAN_CASE)
    fit = []
    for method in RIVALS:
        if not driver.version(method):
            print(f"   {method}: not installed, left out")
        elif isinstance(reason := driver.description(case, method), str):
            print(f"   {method}: left out, as {reason}")
        else:
            try:
                mean = float(
                    runs.shot(checked, method, MEAN_SECONDS, 1).picture.mean(dtype=np.float64)
                    / np.mean(runs.reference(checked))
                )
            except RuntimeError as error:
                print(f"   {method}: left out, as it failed: {error}")
                continue
            if abs(mean - 1) > MEAN_TOLERANCE:
                print(
                    f"   {method}: left out, as its mean on {checked.scene} is {mean:.4f} times "
                    "the reference's"
                )
            else:
                fit.append(method)
    return fit


def measure(
    case: Case, budgets: list[float], most_seeds: int, long: bool
) -> dict[Method, list[figures.Point]]:
    """`long`: renders Cycles' quarter of an hour; that is taken up wherever it has been made."""
    halves = runs.reference(case)
    methods = [*METHODS, *rivals_of(case)]
    ours = (Method.SPLAT, Method.SPLAT_DENOISED)
    between = [BETWEEN] if min(budgets) < BETWEEN < max(budgets) else []
    asked = [
        (method, budget)
        for budget in sorted({*budgets, *between})
        for method in methods
        if budget in budgets or method in ours
    ]
    if long or runs.path_of(case, Method.CYCLES, LONG, 1).exists():
        asked.append((Method.CYCLES, LONG))
    found: dict[Method, list[figures.Point]] = {method: [] for method in methods}
    for method, budget in asked:
        shots = [
            runs.shot(case, method, budget, seed) for seed in seeds(budget, most_seeds, method)
        ]
        if not all(shot.picture.any() for shot in shots):
            print(f"   {method}: no picture yet after {budget:g} s")
            continue
        point = figures.point(
            budget, [s.picture for s in shots], [s.seconds for s in shots], halves
        )
        if point.rmse > 0:
            found[method].append(point)
        else:
            print(
                f"   {method}: after {budget:g} s nearer to the reference than its two halves are "
                "to "
                "each other, left out"
            )
    return {method: points for method, points in found.items() if points}


def ratios(found: dict[Method, list[figures.Point]]) -> list[str]:
    """Equal error: at each error that Cycles reached, how much earlier we had it; and equal time
    against the denoised.
    """
    lines: list[str] = []
    if lacking := [str(method) for method in METHODS if method not in found]:
        return [f"   no comparison without a picture by {', '.join(lacking)}"]
    ours, cycles = found[Method.SPLAT], found[Method.CYCLES]
    for theirs in cycles:
        mine = figures.seconds_to(ours, theirs.rmse)
        first = f"under {ours[0].seconds:.2g} s: more than {theirs.seconds / ours[0].seconds:.0f}x"
        text = first if mine != mine else f"{mine:.2f} s: {theirs.seconds / mine:.0f}x"
        lines.append(
            f"   equal error {theirs.rmse:.5f}: Cycles {theirs.seconds:.1f} s, ours {text}"
        )
    for p in ours:
        times = figures.seconds_to(cycles, p.rmse) / p.seconds
        bound = (
            f", {cycles[-1].seconds / p.seconds:.0f} at least" if cycles[-1].rmse > p.rmse else ""
        )
        lines.append(
            f"   our error {p.rmse:.5f} after {p.seconds:.2f} s: Cycles {times:.0f} times as "
            f"long{bound}"
        )
    for method in (m for m in found if m in RIVALS):
        for theirs in found[method]:
            mine = figures.seconds_to(ours, theirs.rmse)
            text = (
                f"under {ours[0].seconds:.2g} s"
                if mine != mine
                else f"{mine:.2f} s: {theirs.seconds / mine:.1f}x"
            )
            lines.append(
                f"   equal error {theirs.rmse:.5f}: {method} {theirs.seconds:.1f} s, ours {text}"
            )
    for theirs in found[Method.CYCLES_DENOISED]:
        best = min(
            figures.rel_mse_at(found[method], theirs.seconds)
            for method in (Method.SPLAT, Method.SPLAT_DENOISED)
        )
        times = theirs.rel_mse / best
        lines.append(
            f"   equal time {theirs.seconds:.1f} s: relMSE of Cycles, denoised "
            f"{theirs.rel_mse:.2e}, ours {best:.2e}: {times:.2f}x"
        )
    return lines


def main(arguments: list[str]) -> int:
    asked = options.parsed(arguments)
    rows: list[table.Row] = []
    for case in asked.cases:
        print(f"== {case.scene} ({case.kind}), {case.width}x{case.height}", flush=True)
        found = measure(case, asked.budgets, asked.seeds, case.scene in asked.long)
        for method, points in found.items():
            for p in points:
                print(
                    f"   {method:24} {p.seconds:6.2f} s  RMSE {p.rmse:.5f} ({p.low:.5f} to "
                    f"{p.high:.5f})  relMSE {p.rel_mse:.2e}  "
                    f"FLIP {p.flip:.4f}  mean {p.mean_ratio:.4f}"
                )
                rows.append({"scene": case.scene, "method": str(method)} | dataclasses.asdict(p))
            print(f"   {method:24} slope {figures.slope(points):.2f}")
        print("\n".join(ratios(found)), flush=True)
        draw.chart(case, found, asked.folder / f"{case.scene}.png")
        draw.equal_time(
            case,
            asked.budgets,
            runs.reference(case),
            asked.folder / f"{case.scene}_equal_time.png",
        )
    table.write(asked.folder / "figures.csv", rows)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
