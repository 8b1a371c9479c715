"""Renders every case with both integrators, compares with Cycles and writes out/oracle/index.html,
worst first.

`python -m tests.reference.cycles.report [--resume] [NAME ...]`. Prints how many pass; the status is
1 if fewer than PASSING do (a case passes if both integrators agree with Cycles). --resume goes on
where a run was stopped: out/oracle/rows.jsonl. A file's own Cycles bounce limits and clamps are not
honoured: Cycles was told to solve the rendering equation, see references.py.
"""

from __future__ import annotations

import argparse
import html
import json
import os
import queue
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tests.reference.cycles import sweep
from tests.reference.cycles.cases import Case
from tests.reference.cycles.gallery import BY_NAME, STEPS, SWEEPS
from tests.reference.cycles.verdict import INTEGRATORS, Verdict, judge, render
from tests.reference.cycles.worker import Worker
from tests.support.compare import save_pictures
from tests.support.paths import ROOT

PASSING = 442
"""How many of all cases and sweeps passed when this was last raised. Never lower it to let a change
through.
"""
OUT = ROOT / "out" / "oracle"
ROWS = OUT / "rows.jsonl"

# What `make test` renders of the gallery.
TELLING = (
    "diffuse_1",
    "glossy_ggx_0.3",
    "glass_multi_0.4",
    "glass_sharp_ior_1.5",
    "metallic_gold_0.2",
    "sheet_translucent",
    "path_transmission",
    "sheen_microfiber_0.3",
    "sheet_alpha_image",
    "principled_roughness_0.25",
    "principled_transmission_0.5_rough",
    "principled_coat_tint",
    "principled_film",
    "principled_everything",
    "normal_map_diffuse",
    "bump_grain",
    "body_slab",
    "subsurface_half",
)


@dataclass
class Row:
    """One case or sweep under one integrator."""

    name: str
    integrator: str
    excess: float
    said: str
    failures: list[str]
    pictures: bool = False


Task = tuple[Callable[[Worker, Any, str], Row], Any, str]


def case_row(worker: Worker, case: Case, integrator: str) -> Row:
    try:
        verdict: Verdict = judge(case, integrator, render(worker, case, integrator, threads=1))
    except (RuntimeError, ValueError, OSError) as error:
        return Row(case.name, integrator, float("inf"), "", [str(error)])
    save_pictures(OUT, f"{case.name}.{integrator}", verdict.ours, verdict.reference)
    said = f"mean {verdict.ratio:.4f} ± {verdict.error:.4f}"
    return Row(case.name, integrator, verdict.excess, said, verdict.failures, True)


def sweep_row(worker: Worker, kind: str, integrator: str) -> Row:
    try:
        ratios, failures = sweep.compare(
            kind, integrator, sweep.measure(worker, kind, integrator), sweep.load()[kind]
        )
    except (RuntimeError, OSError) as error:
        return Row(f"sweep_{kind}", integrator, float("inf"), "", [str(error)])
    worst = max(abs(ratio - 1) for ratio in ratios)
    said = "middle at roughness " + ", ".join(
        f"{r:g}: {ratio:.3f}" for r, ratio in zip(STEPS, ratios, strict=True)
    )
    return Row(f"sweep_{kind}", integrator, worst / sweep.TOLERANCE, said, failures)


def finished_rows() -> list[Row]:
    """What an earlier run left; a row that ended without a picture, as when it was stopped, is to
    be done again.
    """
    rows = (
        [Row(**json.loads(line)) for line in ROWS.read_text().splitlines()]
        if ROWS.is_file()
        else []
    )
    return [row for row in rows if row.said]


def render_all(tasks: list[Task], jobs: int) -> list[Row]:
    """Small pictures gain little from threads: each of `jobs` Blender processes renders with
    one.
    """
    workers: queue.SimpleQueue[Worker] = queue.SimpleQueue()
    writing = threading.Lock()

    def one(task: Task) -> Row:
        make, subject, integrator = task
        worker = workers.get()
        try:
            row = make(worker, subject, integrator)
        finally:
            workers.put(worker)
        with writing, ROWS.open("a") as file:
            file.write(json.dumps(asdict(row)) + "\n")
        state = "FAILED" if row.failures else "ok"
        print(
            f"{state:7}{row.name:36}{row.integrator:10} {row.said[:200]} {'; '.join(row.failures)}",
            flush=True,
        )
        return row

    with tempfile.TemporaryDirectory(prefix="photon_splat_oracle_") as scratch:
        made = [Worker(Path(scratch, str(k))) for k in range(jobs)]
        for worker in made:
            worker.scratch.mkdir()
            workers.put(worker)
        with ThreadPoolExecutor(jobs) as pool:
            rows = list(pool.map(one, tasks))
        for worker in made:
            worker.stop()
    return rows


def page(rows: list[Row], summary: str) -> str:
    parts = [
        "<!doctype html><meta charset=utf-8><title>Photon Splat and Cycles</title>",
        "<style>body{font:14px "
        "sans-serif;background:#222;color:#ddd}img{width:240px;image-rendering:pixelated}"
        "td{vertical-align:top;padding:4px}.bad{color:#f88}.good{color:#8d8}</style>",
        f"<h1>{html.escape(summary)}</h1><p>Worst first. Per case: Photon Splat, Cycles, and five "
        "times the difference "
        "(red: brighter than Cycles, blue: darker). The files' own bounce limits and clamps are "
        "not honoured.</p><table>",
    ]
    for row in sorted(rows, key=lambda row: -row.excess):
        kind = "bad" if row.failures else "good"
        said = "<br>".join(html.escape(text) for text in [row.said, *row.failures] if text)
        parts.append(f"<tr><td><b class={kind}>{row.name}</b><br>{row.integrator}<br>{said}</td>")
        if row.pictures:
            parts += [
                f"<td><img src='{row.name}.{row.integrator}.{kind}.png'></td>"
                for kind in ("ours", "reference", "difference")
            ]
        parts.append("</tr>")
    return "\n".join([*parts, "</table>"])


def _name(task: Task) -> str:
    return f"sweep_{task[1]}" if isinstance(task[1], str) else task[1].name


def main() -> int:
    parser = argparse.ArgumentParser(description="Compare with Cycles' pictures.")
    parser.add_argument("names", nargs="*", help="cases and sweeps (default: all)")
    parser.add_argument(
        "--resume", action="store_true", help="keep what an interrupted run has done"
    )
    parser.add_argument(
        "--jobs",
        type=int,
        default=os.cpu_count() or 1,
        help="Blender processes at a time (default: one per core)",
    )
    options = parser.parse_args()
    sweep_names = {f"sweep_{kind}": kind for kind in SWEEPS}
    unknown = [name for name in options.names if name not in BY_NAME and name not in sweep_names]
    if unknown:
        parser.error(f"no such case: {', '.join(unknown)}")
    names = options.names or [*BY_NAME, *sweep_names]
    cases = [BY_NAME[name] for name in names if name in BY_NAME]
    sweeps = [sweep_names[name] for name in names if name in sweep_names]
    OUT.mkdir(parents=True, exist_ok=True)
    started = time.monotonic()
    tasks: list[Task] = [
        (case_row, case, by)
        for case in cases
        for by in (INTEGRATORS if case.splat else INTEGRATORS[-1:])
    ]
    tasks += [(sweep_row, kind, by) for kind in sweeps for by in INTEGRATORS]
    rows = [row for row in finished_rows() if row.name in names] if options.resume else []
    if not options.resume:
        ROWS.unlink(missing_ok=True)
    done = {(row.name, row.integrator) for row in rows}
    rows += render_all([task for task in tasks if (_name(task), task[2]) not in done], options.jobs)
    passed = {row.name for row in rows} - {row.name for row in rows if row.failures}
    summary = f"{len(passed)} of {len(names)} pass"
    (OUT / "index.html").write_text(page(rows, summary))
    print(f"{summary} ({time.monotonic() - started:.0f} s). Pictures: out/oracle/index.html")
    if not options.names and len(passed) < PASSING:
        print(
            f"That is fewer than the {PASSING} that passed before: "
            f"{', '.join(sorted(set(names) - passed))}",
            file=sys.stderr,
        )
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
