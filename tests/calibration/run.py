"""Is the error estimate true? `python -m tests.calibration.run [--quick] [--fresh] [SCENE ...]` writes a table and a chart.

What has been measured lies in build/calibration and is taken up again by the next run; --fresh measures anew.

Scenes of blend_scenes/, rendered with the default settings for several times, against two path-traced halves (made once, kept in
build/calibration). Per picture: true RMS error over estimated one, for the whole picture and for the pixels of each decile of the
estimate. A figure of 1 is a perfect estimate; the promise is 0.7 to 1.5.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from tests.bench.scenes import ROOT, from_blend

HERE = Path(__file__).parent
SCENES = {"cornell_box": (96, 96), "interior": (128, 80), "light_types": (128, 48), "instances": (128, 72)}
BUDGETS = (0.3, 1.0, 3.0, 10.0, 30.0)
QUICK_BUDGETS = (0.3, 1.0, 3.0)
REFERENCE_SAMPLES = {"cornell_box": 3000, "interior": 8000, "light_types": 3000, "instances": 8000}  # of each half
KEPT = ROOT / "build" / "calibration"
LOW, HIGH = 0.7, 1.5
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
Figures = dict[str, Any]


def halves(name: str, width: int, height: int) -> np.ndarray:
    """(2, height, width) luminance of two independent path-traced pictures."""
    from photon_splat.core.session import render
    from photon_splat.core.settings import Integrator, RenderSettings

    samples = REFERENCE_SAMPLES[name]
    cache = KEPT / f"{name}_{width}x{height}_{samples}.npy"
    if not cache.exists():
        print(f"   reference of {name}: two halves of {samples} samples (kept for next time)", file=sys.stderr, flush=True)
        scene = from_blend(name, width, height)
        settings = [RenderSettings(passes=samples, seed=seed, integrator=Integrator.REFERENCE) for seed in (71, 72)]
        pictures = [render(scene, half, started=time.monotonic()).passes["Combined"][..., :3] @ LUMINANCE for half in settings]
        cache.parent.mkdir(parents=True, exist_ok=True)
        np.save(cache, np.stack(pictures))
    return np.load(cache).astype(np.float64)


def compare(luminance: np.ndarray, estimate: np.ndarray, truth: np.ndarray) -> Figures:
    """luminance, estimate (H, W); truth (2, H, W). Ratios are true over estimated RMS error."""
    squared = ((luminance - truth[0]) * (luminance - truth[1])).ravel()  # free of the truth's noise
    said = estimate.astype(np.float64).ravel() ** 2
    order = np.argsort(said, kind="stable")

    def ratio(pixels: np.ndarray) -> float:
        return float(np.sqrt(max(squared[pixels].mean(), 0.0) / max(said[pixels].mean(), 1e-30)))

    mean = truth.mean()
    return {
        "true": float(np.sqrt(max(squared.mean(), 0.0)) / mean),
        "ratio": ratio(order),
        "deciles": [ratio(part) for part in np.array_split(order, 10)],
    }


def measure(name: str, budgets: tuple[float, ...]) -> list[Figures]:
    """One render per budget, in seconds from the call."""
    from photon_splat.core.session import render
    from photon_splat.core.settings import RenderSettings

    width, height = SCENES[name]
    truth = halves(name, width, height)
    rows = []
    for seed, budget in enumerate(budgets):
        cache = KEPT / f"row_{name}_{width}x{height}_{budget:g}.json"
        if cache.exists():
            rows.append(json.loads(cache.read_text()))
            continue
        scene = from_blend(name, width, height)
        result = render(scene, RenderSettings(passes=1 << 30, time_limit=budget, seed=seed), started=time.monotonic())
        figures = compare(result.passes["Combined"][..., :3] @ LUMINANCE, result.passes["Error"][..., 0], truth)
        said = result.statistics["error"]
        rows.append({"scene": name, "seconds": budget, "passes": result.statistics["passes"], "said": said} | figures)
        cache.write_text(json.dumps(rows[-1]))
    return rows


def kept(row: Figures) -> bool:
    return all(LOW <= ratio <= HIGH for ratio in (row["ratio"], *row["deciles"]))


def table(rows: list[Figures]) -> str:
    lines = [
        "# Calibration of the error estimate",
        "",
        "True over estimated RMS error of the luminance; 1 is perfect, 0.7 to 1.5 is promised. Made by `make calibration`.",
        "",
        "| scene | s | passes | true | estimated | of it bias | picture | " + " | ".join(f"d{i}" for i in range(1, 11)) + " |",
        "|---|---|---|---|---|---|---|" + "---|" * 10,
    ]
    for row in rows:
        said, deciles = row["said"], " | ".join(f"{d:.2f}" for d in row["deciles"])
        lines.append(
            f"| {row['scene']} | {row['seconds']:g} | {row['passes']} | {row['true']:.4f} | {said['relative_rmse']:.4f} "
            f"| {said['bias']:.4f} | {row['ratio']:.2f} | {deciles} |"
        )
    pictures = [row["ratio"] for row in rows]
    deciles = [d for row in rows for d in row["deciles"]]
    for what, ratios in (("pictures", pictures), ("deciles", deciles)):
        inside = sum(LOW <= r <= HIGH for r in ratios)
        lines += ["", f"{inside} of {len(ratios)} {what} lie between {LOW} and {HIGH}."]
    return "\n".join(lines) + "\n"


def chart(rows: list[Figures], path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(SCENES), figsize=(3.2 * len(SCENES), 3.2), sharey=True)
    for axis, name in zip(axes, SCENES, strict=True):
        mine = [row for row in rows if row["scene"] == name]
        axis.axhspan(LOW, HIGH, color="#e8f0e8")
        axis.axhline(1.0, color="#888", lw=0.8)
        for row in mine:
            axis.plot([row["seconds"]] * 10, row["deciles"], "_", color="#c07030", ms=9)
        axis.plot([row["seconds"] for row in mine], [row["ratio"] for row in mine], "o-", color="#204080", ms=4)
        axis.set(xscale="log", yscale="log", title=name, xlabel="seconds", ylim=(0.1, 10))
        axis.set_yticks([0.2, 0.5, 0.7, 1, 1.5, 2, 5], labels=["0.2", "0.5", "0.7", "1", "1.5", "2", "5"])
        axis.minorticks_off()
    axes[0].set_ylabel("true / estimated error\n(line: picture, dashes: deciles)")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--child"]:
        Path(arguments[1]).write_text(json.dumps(measure(arguments[2], tuple(map(float, arguments[3:])))))
        os._exit(0)  # Blender may hang or die at exit
    quick = "--quick" in arguments
    if "--fresh" in arguments:
        for row in KEPT.glob("row_*.json"):
            row.unlink()
    names = [a for a in arguments if not a.startswith("--")] or list(SCENES)
    unknown = [name for name in names if name not in SCENES]
    if unknown:
        print(f"no such scene: {', '.join(unknown)}; there are {', '.join(SCENES)}", file=sys.stderr)
        return 2
    rows: list[Figures] = []
    with tempfile.TemporaryDirectory(prefix="photon_splat_calibration_") as scratch:
        environment = os.environ | {"BLENDER_USER_RESOURCES": os.path.join(scratch, "blender")}
        for name in names:
            answer = Path(scratch, f"{name}.json")
            command = [sys.executable, "-m", "tests.calibration.run", "--child", str(answer), name]
            command += [str(b) for b in (QUICK_BUDGETS if quick else BUDGETS)]
            subprocess.run(command, cwd=ROOT, env=environment, stdout=sys.stderr, timeout=3600, check=False)
            if not answer.exists():
                print(f"{name} could not be measured", file=sys.stderr)
                return 1
            rows += json.loads(answer.read_text())
    print(table(rows))
    if not quick and len(names) == len(SCENES):
        (HERE / "calibration.md").write_text(table(rows))
        chart(rows, HERE / "calibration.png")
    return 0 if all(map(kept, rows)) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
