"""The seed's comparison: photons looked up for each point (direct) against photons splatted (dual).
`python -m tests.benchmarks.chart.seed_comparison`

The same photons of cornell_box at 512x512 and the same points, one per pixel. Direct: a k-d tree
over the photons (scipy's, in C++), the k nearest of each point, on all cores; the tree's making
counts. Dual: this engine's splatter, with discs that hold k photons; once for a point per pixel,
once for the sparse points that renders use. Writes seed_comparison.png and .csv beside this file.
Needs bpy.
"""

from __future__ import annotations

import csv
import os
import sys
import time
from pathlib import Path

import matplotlib as mpl
import numpy as np
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Scene
from scipy.spatial import cKDTree

from tests.benchmarks.bench.scenes import from_blend

mpl.use("Agg")
from matplotlib import pyplot as plt

HERE = Path(__file__).resolve().parent
SIZE = 512
PHOTONS = (30_000, 100_000, 300_000, 1_000_000, 3_000_000)
NEAREST = (50, 200)
PER_DISC = 200
"""Photons that a render's discs hold."""
BATCH = 1 << 17
REPEATS = 3


def dual(
    scene: Scene, photons: int, k: int, spacing: float
) -> tuple[float, dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Seconds of the splatter (least of several passes), then points and photons of the last
    one.
    """
    settings = RenderSettings(
        photons_per_pass=photons,
        radius_scale=(k / PER_DISC) ** 0.5,
        point_spacing=spacing,
        caustics=False,
        adaptive_samples=False,
    )
    seconds, kept = [], []
    for repeat in range(REPEATS):
        renderer = load().Renderer(0)
        fill_renderer(renderer, scene, settings)
        renderer.build()
        renderer.trace_camera(0)
        renderer.place_points(0)
        kept = []
        before = renderer.statistics()["seconds"]["splat"]
        for first in range(0, photons, BATCH):
            renderer.trace_photons(first, min(BATCH, photons - first))
            renderer.splat()
            if repeat + 1 == REPEATS:
                kept.append(renderer.photons())
        seconds.append(renderer.statistics()["seconds"]["splat"] - before)
    together = {
        name: np.concatenate([batch[name] for batch in kept])
        for name in ("position", "power", "normal")
    }
    return min(seconds), renderer.points(), together


def direct(
    points: dict[str, np.ndarray], photons: dict[str, np.ndarray], k: int
) -> tuple[float, np.ndarray]:
    """Seconds, and mean irradiance (N,) of the k nearest photons of each point that face its way,
    by the seed's kernel estimate.
    """
    power = photons["power"].mean(-1)
    began = time.monotonic()
    tree = cKDTree(photons["position"])
    distance, index = tree.query(points["position"], k, workers=os.cpu_count() or 1)
    facing = np.einsum("nkc,nc->nk", photons["normal"][index], points["normal"]) > 0
    reach = distance[:, -1:]
    irradiance = (
        (power[index] * facing * (1 - (distance / reach) ** 2)).sum(1)
        * 2
        / (np.pi * reach[:, 0] ** 2)
    )
    return time.monotonic() - began, irradiance


def main() -> int:
    scene = from_blend("cornell_box", SIZE, SIZE)
    rows = []
    for k in NEAREST:
        for count in PHOTONS:
            splat, points, photons = dual(scene, count, k, 0.0)
            sparse, few, _ = dual(scene, count, k, RenderSettings().point_spacing)
            looked_up, irradiance = direct(points, photons, k)
            inner = points["mass"] > 0.999  # where no edge cuts the disc, both estimate the same
            agreement = float(irradiance[inner].sum() / points["irradiance"][inner].mean(-1).sum())
            row = {
                "k": k,
                "photons": len(photons["power"]),
                "points": len(points["mass"]),
                "sparse_points": len(few["mass"]),
            }
            row |= {
                "direct_seconds": looked_up,
                "splat_seconds": splat,
                "sparse_splat_seconds": sparse,
                "means_direct_over_dual": agreement,
            }
            rows.append(row)
            print("  ", {name: round(value, 4) for name, value in row.items()}, flush=True)
    with (HERE / "seed_comparison.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(
            {
                name: f"{value:.4g}" if isinstance(value, float) else value
                for name, value in row.items()
            }
            for row in rows
        )
    draw(rows)
    return 0


def draw(rows: list[dict[str, float]]) -> None:
    figure, axes = plt.subplots(1, len(NEAREST), figsize=(10, 4.2), sharey=True)
    lines = {
        "direct_seconds": ("k nearest photons of each point", "#4477aa", "-"),
        "splat_seconds": ("splatted, a point per pixel", "#d95f02", "--"),
    }
    lines["sparse_splat_seconds"] = ("splatted, sparse points", "#d95f02", "-")
    for axis, k in zip(axes, NEAREST, strict=True):
        mine = [row for row in rows if row["k"] == k]
        for name, (label, color, line) in lines.items():
            axis.loglog(
                [row["photons"] for row in mine],
                [row[name] for row in mine],
                line,
                color=color,
                marker="o",
                ms=4,
                label=label,
            )
        axis.set(xlabel="photons", title=f"{k} photons per estimate, {mine[0]['points']:,} points")
        axis.grid(which="both", alpha=0.25)
    axes[0].set_ylabel("seconds")
    axes[0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(HERE / "seed_comparison.png", dpi=100)


if __name__ == "__main__":
    sys.stdout.flush()
    status = main()
    sys.stdout.flush()
    os._exit(status)  # Blender may hang or die at exit
