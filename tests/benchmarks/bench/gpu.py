"""The GPU splatter: time against photons, radius and resolution, beside the CPU splatter, and what
overlaps.

    make bench-gpu [GPU_OPTIONS="--only seed renders"]

Prints figures and writes them as JSON and Markdown, with the machine's description, after every
group. GPU times are OpenGL timer queries. Refuses renderers that run on the CPU: --software --quick
tries the command without a card, and its figures say that they are none of a card's.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from photon_splat.core.gpu import context

from tests.benchmarks.bench.gpu_cases import MILLION, Case, cases, measure, renders
from tests.benchmarks.bench.gpu_denoiser import denoisers

SEED_MS = 740.0
"""Lavignotte & Paulin (2003): one million photons on a GeForce FX 5800."""
OVERLAP = 1.15
TITLES = {
    "seed": "A million photons, automatic radius",
    "photons": "Photons",
    "radius": "Kernel radius",
    "resolution": "Resolution",
    "runs": "Longest run of a quad",
    "pixels": "A point per pixel, and the seed's way: discs projected into the image",
    "denoiser": "Open Image Denoise, both parts of a picture and its features",
    "renders": "Whole renders: overlap, and what M(x) on the card could save at most",
}


def commit() -> str:
    """The short hash of what is measured; empty outside of a checkout or without git."""
    if not shutil.which("git"):
        return ""
    asked = ["git", "rev-parse", "--short", "HEAD"]
    git = subprocess.run(
        asked, capture_output=True, text=True, check=False, cwd=Path(__file__).parent
    )
    return git.stdout.strip()


def machine(graphics: context.Graphics) -> dict[str, Any]:
    """What the figures are of. On the OpenGL thread."""
    cpu = platform.processor() or platform.machine()
    if os.path.exists("/proc/cpuinfo"):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        cpu = next(
            (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), cpu
        )
    return {
        "renderer": graphics.renderer,
        "graphics_card": graphics.hardware,
        "opengl": graphics.gl.info["GL_VERSION"],
        "vendor": graphics.gl.info["GL_VENDOR"],
        "cpu": cpu,
        "cores": os.cpu_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "commit": commit(),
    }


def short(value: object) -> str:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.4g}"
    return " ".join(f"{k} {v}" for k, v in value.items()) if isinstance(value, dict) else f"{value}"


def table(rows: list[dict[str, Any]]) -> str:
    columns = list(dict.fromkeys(name for row in rows for name in row))
    lines = [
        columns,
        ["---"] * len(columns),
        *([short(row.get(name, "")) for name in columns] for row in rows),
    ]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def sentences(report: dict[str, Any]) -> list[str]:
    """What the figures of a graphics card say; nothing of software's."""
    groups = report["groups"] if report["machine"]["graphics_card"] else {}
    said = []
    for row in groups.get("seed", []):
        size = f"{row['width']}x{row['height']}"
        gpu, cpu = (row[name] * MILLION / row["photons"] for name in ("gpu_ms", "cpu_ms"))
        said.append(
            f"A million photons at {size}: {gpu:.1f} ms on the card, {cpu:.1f} ms on the CPU, "
            f"{SEED_MS:.0f} ms by the seed."
        )
    for row in groups.get("renders", []):
        if row["backend"] == "GPU":
            verdict = (
                f"{'within' if row['wall_over_busiest'] <= OVERLAP else 'NOT within'} {OVERLAP}"
            )
            said.append(
                f"{row['photons_per_pass']} photons a pass: wall time is "
                f"{row['wall_over_busiest']:.2f} of the busier side's ({verdict}); "
                f"M(x) on the card could save {100 * row['mass_share']:.1f} % of the render at "
                "most."
            )
    return said


def write(report: dict[str, Any], output: Path) -> None:
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text(json.dumps(report, indent=2) + "\n")
    parts = [
        report["heading"],
        "\n".join(f"- {name}: {value}" for name, value in report["machine"].items()),
    ]
    parts += ["\n".join(f"- {s}" for s in sentences(report))] if sentences(report) else []
    parts += [f"## {TITLES[name]}\n\n{table(rows)}" for name, rows in report["groups"].items()]
    output.with_suffix(".md").write_text("\n\n".join(parts) + "\n")


def run(options: argparse.Namespace, graphics: context.Graphics) -> None:
    heading = (
        "# The GPU splatter"
        if graphics.hardware
        else "# A trial run in software: these are no figures of a graphics card"
    )
    report: dict[str, Any] = {
        "heading": heading,
        "machine": context.submit(machine, graphics).result(),
        "groups": {},
    }
    print(heading, graphics.renderer, sep="\n", flush=True)
    measure(Case(160, 90, 1000, cpu=False))  # compiles shaders
    for name in options.only:
        rows = report["groups"][name] = []
        print(f"\n{TITLES[name]}", flush=True)
        found = cases(options.quick).get(name, [])
        others = {"renders": renders, "denoiser": denoisers}
        for row in others[name](options.quick) if name in others else map(measure, found):
            rows.append(row)
            print(
                "  "
                + ", ".join(f"{key} {short(value)}" for key, value in row.items() if short(value)),
                flush=True,
            )
            write(report, options.output)
    print(
        "",
        *sentences(report),
        f"{options.output} and {options.output.with_suffix('.md')} are written.",
        sep="\n",
    )


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--software", action="store_true", help="run on a renderer without a card, too"
    )
    parser.add_argument(
        "--quick", action="store_true", help="small sizes, to see that everything runs"
    )
    parser.add_argument(
        "--only",
        nargs="+",
        choices=list(TITLES),
        default=list(TITLES),
        metavar="GROUP",
        help=", ".join(TITLES),
    )
    parser.add_argument("-o", "--output", type=Path, default=Path("out/bench_gpu.json"))
    options = parser.parse_args(arguments)
    try:
        graphics = context.submit(context.graphics).result()
    except context.NoGraphics as reason:
        print(f"bench-gpu: {reason}", file=sys.stderr)
        return 1
    if not graphics.hardware and not options.software:
        print(
            f"bench-gpu: {graphics.renderer} runs on the CPU; these figures are for graphics "
            "cards (--software tries it)",
            file=sys.stderr,
        )
        return 1
    run(options, graphics)
    return 0


if __name__ == "__main__":
    sys.exit(main())
