"""Plain photon maps on the same failures, in numpy: `python -m tests.benchmarks.stability.run`
writes methods.md and methods.png beside this file.

All get photons of the product's tracer, on all surfaces whether in view or not, and estimate
irradiance at 2x2 places per pixel, with discs that hold 200 photons on median and with such of 800:
the better one counts. "Seed's method": Lavignotte and Paulin 2003, each photon's power over the
area of its own surface within its disc.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from photon_splat.core.native.bounds import world_bounds
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.result import Passes
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Mesh, PixelFilter, Scene
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tests.reference.stability.cases import CASES, PIXELS, Case
from tests.reference.stability.reference import BLOCK, bounced, reference_of
from tests.support.compare import block_means

if TYPE_CHECKING:
    from photon_splat_native import Renderer

HERE = Path(__file__).parent
FINE = 2
PER_DISC = (200, 800)
"""Photons in a disc on median, or of a gathering: each plain method shows the better of both."""
PASSES = 16
SAMPLES = 100_000
"""Points that stand for the area of the surfaces."""
MOST_PHOTONS = 60_000
EVERYWHERE = 1 << 34
"""Bytes for photons that are kept: those are on all surfaces, not on visible ones alone."""
BEYOND = (13, 20)
"""Failures on gloss and in mirrors."""
CREASE = np.cos(np.radians(25))


@dataclass
class Places:
    """Where light is wanted: positions (N, 3), normals (N, 3), the tracer's keys of surface and
    side (N,), albedo / pi (N,).
    """

    position: np.ndarray
    normal: np.ndarray
    key: np.ndarray
    weight: np.ndarray


@dataclass
class Photons:
    position: np.ndarray
    normal: np.ndarray
    key: np.ndarray
    power: np.ndarray


def places_of(scene: Scene) -> Places:
    fine = replace(
        scene.frame,
        width=PIXELS * FINE,
        height=PIXELS * FINE,
        pixel_filter=PixelFilter.BOX,
        filter_width=1e-3,
    )
    scene = replace(scene, frame=fine)
    passes = render(
        scene,
        RenderSettings(passes=1, photons_per_pass=1, adaptive_indirect=False),
        started=time.monotonic(),
    ).passes
    n = PIXELS * FINE
    at = (np.arange(n) + 0.5) / n
    left, right, bottom, top = scene.camera.screen
    x, y = np.meshgrid(left + (right - left) * at, bottom + (top - bottom) * at)
    depth = passes["Depth"][..., 0].astype(float)
    scale = np.ones_like(depth) if scene.camera.orthographic else depth
    local = np.stack([x * scale, y * scale, -depth, np.ones_like(depth)], -1).reshape(-1, 4)
    seen = (depth < 1e9).ravel()
    weight = passes["Diffuse Color"].mean(-1).ravel() / np.pi * seen
    position = (local @ scene.camera.matrix.T)[:, :3] * seen[:, None]
    points = renderer_after_camera(
        scene,
        RenderSettings(passes=1, photons_per_pass=1, point_spacing=0.0, adaptive_indirect=False),
    ).points()
    _, nearest = cKDTree(points["position"] + world_bounds(scene).mean(0)).query(position)
    return Places(
        position, passes["Normal"].reshape(-1, 3).astype(float), points["key"][nearest], weight
    )


def renderer_after_camera(scene: Scene, settings: RenderSettings) -> Renderer:
    """With points, for photons of all surfaces."""
    renderer = load().Renderer(0)
    fill_renderer(renderer, scene, settings)
    renderer.options.kept_photon_bytes = EVERYWHERE
    renderer.build()
    renderer.trace_camera(0)
    renderer.place_points(0)
    return renderer


def photons_of(scene: Scene, paths: int) -> Photons:
    settings = RenderSettings(
        passes=1, photons_per_pass=paths, max_bounces=64, caustics=False, adaptive_indirect=False
    )
    renderer = renderer_after_camera(scene, settings)
    renderer.trace_photons(0, paths)
    got = renderer.photons()
    position = got["position"] + world_bounds(scene).mean(0)
    return Photons(
        position, got["normal"].astype(float), got["key"], got["power"].mean(-1).astype(float)
    )


@dataclass(frozen=True)
class Disc:
    photons: int
    radius: float


class Surfaces:
    """Points spread over all meshes; patch: triangles joined across edges flatter than 25
    degrees.
    """

    def __init__(self, meshes: list[Mesh]) -> None:
        corners, patches, first = [], [], 0
        for mesh in meshes:
            _, same = np.unique(np.round(mesh.positions, 6), axis=0, return_inverse=True)
            triangles = mesh.positions[mesh.triangles].astype(float)
            normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
            normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
            ids = same.reshape(-1)[mesh.triangles]
            edges = np.sort(
                np.concatenate([ids[:, [0, 1]], ids[:, [1, 2]], ids[:, [2, 0]]]), axis=1
            )
            owner = np.tile(np.arange(len(triangles)), 3)
            order = np.lexsort(edges.T)
            twin = (edges[order][1:] == edges[order][:-1]).all(1)
            a, b = owner[order][1:][twin], owner[order][:-1][twin]
            flat = (normals[a] * normals[b]).sum(1) > CREASE
            graph = coo_matrix((np.ones(flat.sum()), (a[flat], b[flat])), (len(triangles),) * 2)
            count, patch = connected_components(graph, directed=False)
            corners.append(triangles)
            patches.append(patch + first)
            first += count
        triangle, patch = np.concatenate(corners), np.concatenate(patches)
        area = (
            np.linalg.norm(
                np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]), axis=1
            )
            / 2
        )
        random = np.random.default_rng(1)
        pick = random.choice(len(area), SAMPLES, p=area / area.sum())
        u, v = random.random((2, SAMPLES))
        u, v = np.where(u + v > 1, (1 - u, 1 - v), (u, v))
        t = triangle[pick]
        self.point = t[:, 0] + u[:, None] * (t[:, 1] - t[:, 0]) + v[:, None] * (t[:, 2] - t[:, 0])
        self.patch, self.area = patch[pick], area.sum() / SAMPLES
        self.patch_area = np.bincount(patch, area)
        normals = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
        self.normal = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        self.far = 10 * np.ptp(self.point, axis=0).max()
        self.tree = cKDTree(np.concatenate([self.point, 0.01 * self.far * self.normal], axis=1))

    def patch_of(self, position: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Of each place, on whichever side."""
        places = (
            np.concatenate([position, 0.01 * self.far * side * normal], axis=1) for side in (1, -1)
        )
        (near, front), (_, behind) = (self.tree.query(place, workers=-1) for place in places)
        return self.patch[np.where(near > 0.005 * self.far, behind, front)]

    def area_within(self, position: np.ndarray, patch: np.ndarray, radius: float) -> np.ndarray:
        spread = cKDTree(np.column_stack([self.point, self.far * self.patch]))
        counts = spread.query_ball_point(
            np.column_stack([position, self.far * patch]), radius, return_length=True, workers=-1
        )
        return np.minimum(np.maximum(counts, 1) * self.area, self.patch_area[patch])


def _within(tree: cKDTree, places: Places, radius: float, values: np.ndarray) -> np.ndarray:
    """Sum of values of the photons within the radius of each place."""
    lists = tree.query_ball_point(places.position, radius, workers=-1)
    return np.array([values[found].sum() for found in lists])


def fixed_radius(places: Places, photons: Photons, disc: Disc, _: Surfaces) -> np.ndarray:
    return _within(cKDTree(photons.position), places, disc.radius, photons.power) / (
        np.pi * disc.radius**2
    )


def nearest(places: Places, photons: Photons, disc: Disc, _: Surfaces) -> np.ndarray:
    distance, index = cKDTree(photons.position).query(places.position, disc.photons, workers=-1)
    index = np.minimum(index, len(photons.power) - 1)
    facing = (photons.normal[index] * places.normal[:, None]).sum(-1) > 0
    reach = np.where(np.isfinite(distance[:, -1]), distance[:, -1], np.inf)
    return (photons.power[index] * facing).sum(1) / (np.pi * reach**2)


def progressive(places: Places, photons: Photons, disc: Disc, _: Surfaces) -> np.ndarray:
    """Knaus and Zwicker 2011: each pass its photons, radii shrinking as pass^(-1/6)."""
    turn = np.arange(len(photons.power)) % PASSES
    total = np.zeros(len(places.weight))
    for i in range(PASSES):
        mine = turn == i
        r = 2 * disc.radius * (i + 1) ** (-1 / 6)
        total += _within(cKDTree(photons.position[mine]), places, r, photons.power[mine]) / (
            np.pi * r**2
        )
    return total


def seeds(places: Places, photons: Photons, disc: Disc, surfaces: Surfaces) -> np.ndarray:
    _, key = np.unique(np.concatenate([photons.key, places.key]), return_inverse=True)
    key, own = key[: len(photons.key)], key[len(photons.key) :]
    near = surfaces.patch_of(photons.position, photons.normal)
    patch = np.array(
        [np.bincount(near[key == k], minlength=1).argmax() for k in range(key.max() + 1)]
    )[key]
    density = photons.power / surfaces.area_within(photons.position, patch, disc.radius)
    tree = cKDTree(np.column_stack([photons.position, surfaces.far * key]))
    lists = tree.query_ball_point(
        np.column_stack([places.position, surfaces.far * own]), disc.radius, workers=-1
    )
    return np.array([density[found].sum() for found in lists])


METHODS = {
    "fixed radius, no ids": fixed_radius,
    "k nearest photons": nearest,
    "progressive radius only": progressive,
    "seed's method (2003)": seeds,
}


def _bounced_reference(case: Case, passes: Passes) -> tuple[np.ndarray, np.ndarray]:
    """Reference of the bounced light, and which pixels show diffuse surfaces alone."""
    if case.name == "furnace":
        return np.full((PIXELS, PIXELS), 0.5), np.ones((PIXELS, PIXELS), bool)
    if not case.whole:
        return reference_of(case), np.ones((PIXELS, PIXELS), bool)
    direct = (passes["Diffuse Direct"] * passes["Diffuse Color"]).mean(-1).astype(float)
    diffuse = passes["Diffuse Color"].mean(-1)
    return reference_of(case) - direct, diffuse > 0.999 * diffuse.max()


def errors_of(case: Case) -> dict[str, float]:
    """Worst block of the bounced light by each method, relative to the reference's mean (or the
    case's unit).
    """
    scene = case.make()
    settings = RenderSettings(passes=case.passes, photons_per_pass=case.photons, max_bounces=64)
    passes = render(scene, settings, started=time.monotonic()).passes
    reference, known = _bounced_reference(case, passes)
    mean = reference[known].mean()
    unit = mean if mean > 0 else case.unit

    def worst(picture: np.ndarray) -> float:
        return float(
            np.abs(block_means(((picture - reference) * known)[..., None], BLOCK)).max() / unit
        )

    out = {"Photon Splat": worst(bounced(passes))}
    places, photons = places_of(scene), photons_of(scene, case.passes * case.photons)
    if len(photons.power) == 0:
        return out | dict.fromkeys(METHODS, worst(np.zeros((PIXELS, PIXELS))))
    if len(photons.power) > MOST_PHOTONS:
        kept = np.random.default_rng(2).choice(len(photons.power), MOST_PHOTONS, replace=False)
        share = len(photons.power) / MOST_PHOTONS
        photons = Photons(
            photons.position[kept],
            photons.normal[kept],
            photons.key[kept],
            photons.power[kept] * share,
        )
    seen, surfaces = places.weight > 0, Surfaces(scene.meshes)
    out |= dict.fromkeys(METHODS, np.inf)
    for count in PER_DISC:
        distance, _ = cKDTree(photons.position).query(places.position[seen], [count], workers=-1)
        finite = distance[np.isfinite(distance)]
        disc = Disc(
            count,
            float(np.median(finite))
            if len(finite)
            else float(np.ptp(photons.position, axis=0).max()),
        )
        for name, method in METHODS.items():
            light = (method(places, photons, disc, surfaces) * places.weight).reshape(
                PIXELS, FINE, PIXELS, FINE
            )
            out[name] = min(out[name], worst(light.mean((1, 3))))
    return out


def table(rows: dict[str, dict[str, float]]) -> str:
    tolerances = {case.name: case.tolerance for case in CASES}
    names = ["Photon Splat", *METHODS]
    lines = [
        "# Where photon density estimation fails, by method",
        "",
        "Error of the worst block of 4x4 pixels, relative to the mean of the bounced light; bold "
        "where the case's tolerance is exceeded.",
        f"The plain methods get at most {MOST_PHOTONS:,} of the product's photons and show the "
        "better of two sizes of discs. Those photons",
        "are on all surfaces (the product traces on for what is in view). Made by `make "
        "stability`.",
        "",
        "| case | tolerance | " + " | ".join(names) + " |",
        "|---|---|" + "---|" * len(names),
    ]
    for case, errors in rows.items():
        cells = [
            f"{errors[name]:.3f}" if errors[name] <= tolerances[case] else f"**{errors[name]:.3f}**"
            for name in names
        ]
        lines.append(f"| {case} | {tolerances[case]:g} | " + " | ".join(cells) + " |")
    broken = [
        sum(errors[name] > tolerances[case] for case, errors in rows.items()) for name in names
    ]
    lines.append(f"| broken of {len(rows)} | | " + " | ".join(map(str, broken)) + " |")
    return "\n".join(lines) + "\n"


def chart(rows: dict[str, dict[str, float]], path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    tolerances = {case.name: case.tolerance for case in CASES}
    names = ["Photon Splat", *METHODS]
    ratio = np.array([[rows[case][name] / tolerances[case] for name in names] for case in rows])
    figure, axis = plt.subplots(figsize=(7.5, 0.36 * len(rows) + 1.6))
    axis.imshow(np.log10(np.clip(ratio, 0.1, 10)), cmap="RdYlGn_r", vmin=-1, vmax=1, aspect="auto")
    for i, case in enumerate(rows):
        for j, name in enumerate(names):
            axis.text(j, i, f"{rows[case][name]:.2g}", ha="center", va="center", fontsize=8)
    axis.set_xticks(
        range(len(names)), labels=[name.replace(" ", "\n", 1) for name in names], fontsize=8
    )
    axis.set_yticks(range(len(rows)), labels=list(rows), fontsize=8)
    axis.set_title("error of the worst block; green: within the tolerance", fontsize=9)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def compare(names: list[str]) -> dict[str, dict[str, float]]:
    """Cases in which what matters is seen on diffuse surfaces: the plain methods know no others."""
    rows = {}
    for case in CASES:
        if case.failure in BEYOND or (names and case.name not in names):
            continue
        began = time.monotonic()
        rows[case.name] = errors_of(case)
        errors = ", ".join(f"{name} {error:.3f}" for name, error in rows[case.name].items())
        print(
            f"{case.name}: {errors} ({time.monotonic() - began:.0f} s)", file=sys.stderr, flush=True
        )
    return rows


def main(names: list[str]) -> None:
    rows = compare(names)
    print(table(rows))
    if not names:
        (HERE / "methods.md").write_text(table(rows))
        chart(rows, HERE / "methods.png")
