"""Plain photon maps on the same failures, in numpy: `python -m tests.stability.run` writes methods.md and methods.png beside this file.

All get the product's photons of one case and estimate irradiance at the centres of 3x3 places per pixel, with a disc that holds 200
photons on median. "Seed's method": Lavignotte and Paulin 2003, each photon's power over the area of its own surface within its disc.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from photon_splat.core.native import load
from photon_splat.core.native_scene import fill_renderer, world_bounds
from photon_splat.core.scene import Mesh, PixelFilter, Scene
from photon_splat.core.session import render
from photon_splat.core.settings import RenderSettings
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tests.compare import block_means
from tests.stability.cases import CASES, PIXELS, Case
from tests.stability.truth import BLOCK, bounced, shoot, truth_of

HERE = Path(__file__).parent
FINE = 3
PER_DISC = 200
PASSES = 16
SAMPLES = 150_000
"""Points that stand for the area of the surfaces."""
MOST_PHOTONS = 100_000
CREASE = np.cos(np.radians(25))


@dataclass
class Places:
    """Where light is wanted: positions (N, 3), normals (N, 3), albedo / pi (N,)."""

    position: np.ndarray
    normal: np.ndarray
    weight: np.ndarray


@dataclass
class Photons:
    position: np.ndarray
    normal: np.ndarray
    power: np.ndarray


def places_of(scene: Scene) -> Places:
    fine = replace(scene.frame, width=PIXELS * FINE, height=PIXELS * FINE, pixel_filter=PixelFilter.BOX, filter_width=1e-3)
    scene = replace(scene, frame=fine)
    passes = render(scene, RenderSettings(passes=1, photons_per_pass=1, fallback=False), started=time.monotonic()).passes
    n = PIXELS * FINE
    at = (np.arange(n) + 0.5) / n
    left, right, bottom, top = scene.camera.screen
    x, y = np.meshgrid(left + (right - left) * at, bottom + (top - bottom) * at)
    depth = passes["Depth"][..., 0].astype(float)
    scale = np.ones_like(depth) if scene.camera.orthographic else depth
    local = np.stack([x * scale, y * scale, -depth, np.ones_like(depth)], -1).reshape(-1, 4)
    seen = (depth < 1e9).ravel()
    weight = passes["Diffuse Color"].mean(-1).ravel() / np.pi * seen
    return Places((local @ scene.camera.matrix.T)[:, :3] * seen[:, None], passes["Normal"].reshape(-1, 3).astype(float), weight)


def photons_of(scene: Scene, paths: int) -> Photons:
    settings = RenderSettings(passes=1, photons_per_pass=paths, caustics=False, fallback=False)
    renderer = load().Renderer(0)
    fill_renderer(renderer, scene, settings)
    renderer.build()
    renderer.trace_camera(0)
    renderer.make_points(0)
    renderer.trace_photons(0, 0, paths)
    got = renderer.photons()
    return Photons(got["position"] + world_bounds(scene).mean(0), got["normal"].astype(float), got["power"].mean(-1).astype(float))


class Surfaces:
    """Points spread over all meshes; patch: triangles joined across edges flatter than 25 degrees."""

    def __init__(self, meshes: list[Mesh]) -> None:
        corners, patches, first = [], [], 0
        for mesh in meshes:
            _, same = np.unique(np.round(mesh.positions, 6), axis=0, return_inverse=True)
            triangles = mesh.positions[mesh.triangles].astype(float)
            normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
            normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
            ids = same.reshape(-1)[mesh.triangles]
            edges = np.sort(np.concatenate([ids[:, [0, 1]], ids[:, [1, 2]], ids[:, [2, 0]]]), axis=1)
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
        area = np.linalg.norm(np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]), axis=1) / 2
        random = np.random.default_rng(1)
        pick = random.choice(len(area), SAMPLES, p=area / area.sum())
        u, v = random.random((2, SAMPLES))
        u, v = np.where(u + v > 1, (1 - u, 1 - v), (u, v))
        t = triangle[pick]
        self.point = t[:, 0] + u[:, None] * (t[:, 1] - t[:, 0]) + v[:, None] * (t[:, 2] - t[:, 0])
        self.patch, self.area = patch[pick], area.sum() / SAMPLES
        normals = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
        self.normal = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        self.far = 10 * np.ptp(self.point, axis=0).max()
        self.tree = cKDTree(np.concatenate([self.point, 0.1 * self.far * self.normal / 10], axis=1))

    def key(self, position: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Patch of each place, and its side in the sign of the last bit."""
        both = [self.tree.query(np.concatenate([position, 0.01 * self.far * s * normal], axis=1)) for s in (1, -1)]
        back = both[1][0] < both[0][0]
        return 2 * self.patch[np.where(back, both[1][1], both[0][1])] + back

    def area_within(self, position: np.ndarray, patch: np.ndarray, radius: float) -> np.ndarray:
        spread = cKDTree(np.column_stack([self.point, self.far * self.patch]))
        counts = spread.query_ball_point(np.column_stack([position, self.far * patch]), radius, return_length=True, workers=-1)
        return np.maximum(counts, 1) * self.area


def _within(tree: cKDTree, places: Places, radius: float, values: np.ndarray) -> np.ndarray:
    """Sum of values of the photons within the radius of each place."""
    lists = tree.query_ball_point(places.position, radius, workers=-1)
    return np.array([values[found].sum() for found in lists])


def fixed_radius(places: Places, photons: Photons, radius: float, _: Surfaces) -> np.ndarray:
    return _within(cKDTree(photons.position), places, radius, photons.power) / (np.pi * radius**2)


def nearest(places: Places, photons: Photons, _: float, __: Surfaces) -> np.ndarray:
    distance, index = cKDTree(photons.position).query(places.position, PER_DISC, workers=-1)
    index = np.minimum(index, len(photons.power) - 1)
    facing = (photons.normal[index] * places.normal[:, None]).sum(-1) > 0
    reach = np.where(np.isfinite(distance[:, -1]), distance[:, -1], np.inf)
    return (photons.power[index] * facing).sum(1) / (np.pi * reach**2)


def progressive(places: Places, photons: Photons, radius: float, _: Surfaces) -> np.ndarray:
    """Knaus and Zwicker 2011: each pass its photons, radii shrinking as pass^(-1/6)."""
    turn = np.arange(len(photons.power)) % PASSES
    total = np.zeros(len(places.weight))
    for i in range(PASSES):
        mine = turn == i
        r = 2 * radius * (i + 1) ** (-1 / 6)
        total += _within(cKDTree(photons.position[mine]), places, r, photons.power[mine]) / (np.pi * r**2)
    return total


def seeds(places: Places, photons: Photons, radius: float, surfaces: Surfaces) -> np.ndarray:
    key, own = surfaces.key(photons.position, photons.normal), surfaces.key(places.position, places.normal)
    density = photons.power / surfaces.area_within(photons.position, key // 2, radius)
    tree = cKDTree(np.column_stack([photons.position, surfaces.far * key]))
    lists = tree.query_ball_point(np.column_stack([places.position, surfaces.far * own]), radius, workers=-1)
    return np.array([density[found].sum() for found in lists])


METHODS = {
    "fixed radius, no ids": fixed_radius,
    "k nearest photons": nearest,
    "progressive radius only": progressive,
    "seed's method (2003)": seeds,
}


def errors_of(case: Case) -> dict[str, float]:
    """Worst block of the bounced light by each method, relative to the truth's mean (or the case's unit)."""
    truth = np.full((PIXELS, PIXELS), 0.5) if case.name == "furnace" else truth_of(case)
    unit = truth.mean() if truth.mean() > 0 else case.unit

    def worst(picture: np.ndarray) -> float:
        return float(np.abs(block_means((picture - truth)[..., None], BLOCK)).max() / unit)

    scene = case.make()
    if case.name == "furnace":
        result = render(scene, RenderSettings(passes=case.passes, photons_per_pass=case.photons, max_bounces=64), started=time.monotonic())
        out = {"Photon Splat": worst(bounced(result.passes))}
    else:
        out = {"Photon Splat": worst(shoot(case))}
    places, photons = places_of(scene), photons_of(scene, case.passes * case.photons)
    if len(photons.power) == 0:
        return out | dict.fromkeys(METHODS, worst(np.zeros((PIXELS, PIXELS))))
    if len(photons.power) > MOST_PHOTONS:
        kept = np.random.default_rng(2).choice(len(photons.power), MOST_PHOTONS, replace=False)
        share = len(photons.power) / MOST_PHOTONS
        photons = Photons(photons.position[kept], photons.normal[kept], photons.power[kept] * share)
    seen = places.weight > 0
    distance, _ = cKDTree(photons.position).query(places.position[seen], PER_DISC, workers=-1)
    finite = distance[:, -1][np.isfinite(distance[:, -1])]
    radius = float(np.median(finite)) if len(finite) else float(np.ptp(photons.position, axis=0).max())
    surfaces = Surfaces(scene.meshes)
    for name, method in METHODS.items():
        light = (method(places, photons, radius, surfaces) * places.weight).reshape(PIXELS, FINE, PIXELS, FINE)
        out[name] = worst(light.mean((1, 3)))
    return out


def table(rows: dict[str, dict[str, float]]) -> str:
    tolerances = {case.name: case.tolerance for case in CASES}
    names = ["Photon Splat", *METHODS]
    lines = [
        "# Where photon density estimation fails, by method",
        "",
        "Error of the worst block of 4x4 pixels, relative to the mean of the bounced light; bold where the case's tolerance is exceeded.",
        "The same photon paths for all (at most 100,000 photons of them for the plain methods). Made by `make stability`.",
        "",
        "| case | tolerance | " + " | ".join(names) + " |",
        "|---|---|" + "---|" * len(names),
    ]
    for case, errors in rows.items():
        cells = [f"{errors[name]:.3f}" if errors[name] <= tolerances[case] else f"**{errors[name]:.3f}**" for name in names]
        lines.append(f"| {case} | {tolerances[case]:g} | " + " | ".join(cells) + " |")
    broken = [sum(errors[name] > tolerances[case] for case, errors in rows.items()) for name in names]
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
    axis.set_xticks(range(len(names)), labels=[name.replace(" ", "\n", 1) for name in names], fontsize=8)
    axis.set_yticks(range(len(rows)), labels=list(rows), fontsize=8)
    axis.set_title("error of the worst block; green: within the tolerance", fontsize=9)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def compare(names: list[str]) -> dict[str, dict[str, float]]:
    """Cases in which no mirror or glass is seen: the plain methods know diffuse surfaces only."""
    rows = {}
    for case in CASES:
        if (case.whole and case.name != "furnace") or (names and case.name not in names):
            continue
        rows[case.name] = errors_of(case)
        print(case.name, {k: round(v, 3) for k, v in rows[case.name].items()}, flush=True)
    return rows


def main(names: list[str]) -> None:
    rows = compare(names)
    print(table(rows))
    if not names:
        (HERE / "methods.md").write_text(table(rows))
        chart(rows, HERE / "methods.png")
