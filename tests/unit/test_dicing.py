"""Adaptive subdivision: surfaces, edges and what comes along, without Blender."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from photon_splat.core.dicing.catmull_clark import Surface
from photon_splat.core.dicing.dice import diced
from photon_splat.core.dicing.eye import Eye
from photon_splat.core.dicing.values import Faces
from photon_splat.core.dicing.wanted import Wanted
from photon_splat.core.native.library import load
from photon_splat.core.scene import Camera, Mesh
from photon_splat.core.scene.shading import Domain, MeshAttribute, MeshShading

CUBE = np.array(
    [(x, y, z) for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)], np.float64
)
CUBE_FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
SQUARE = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)


def _surface(
    positions: NDArray[np.float64], faces: list[tuple[int, ...]], sharp: float = 0.0
) -> Surface:
    pairs = {tuple(sorted((f[k], f[(k + 1) % len(f)]))) for f in faces for k in range(len(f))}
    ends = np.array(sorted(pairs), np.int64)
    return Surface(
        positions,
        np.concatenate([np.array(face, np.int64) for face in faces]),
        np.cumsum([0, *map(len, faces)]),
        ends,
        np.full(len(ends), sharp),
        np.zeros(len(positions)),
    )


def _square() -> tuple[Mesh, Faces]:
    """With UV coordinates like its positions, and a number for each of its two triangles."""
    triangles = np.array([(0, 1, 2), (0, 2, 3)], np.uint32)
    shading = MeshShading([MeshAttribute(7, Domain.FACE, np.array([[1.0], [2.0]], np.float32))])
    mesh = Mesh("square", SQUARE, triangles, uv=SQUARE[triangles][..., :2], shading=shading)
    return mesh, Faces(None, triangles.astype(np.int32), None)


def _edges(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Ends of the edges (E, 2), and how many triangles have each."""
    pairs = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64), axis=1)
    return np.unique(pairs, axis=0, return_counts=True)


def _camera(height: float) -> Camera:
    """It looks straight down."""
    matrix = np.eye(4)
    matrix[2, 3] = height
    return Camera(matrix, (-0.5, 0.5, -0.5, 0.5))


def test_a_cube_ends_where_theory_has_it() -> None:
    """Corners of a cube have three neighbours, and faces' centres four, whose limits follow from
    the weights of Halstead et al. (1993) by hand.
    """
    once = _surface(CUBE, CUBE_FACES).refined()
    # Points of faces are at 1, of edges at 3/4, and a corner goes to 5/9.
    assert np.abs(once.positions[:8]) == pytest.approx(5 / 9)
    assert sorted(np.abs(once.positions[8])) == pytest.approx([0, 0.75, 0.75])
    limits = once.limits()
    corner, edge, face = 5 / 9, 0.75, 1.0
    # (n^2 v + 4 sum of edges + sum of faces) / (n (n + 5))
    expected = (9 * corner + 4 * 2 * edge + face) / 24
    assert np.abs(limits[:8]) == pytest.approx(expected)
    up = limits[20:][np.argmax(limits[20:, 2])]
    assert up == pytest.approx([0, 0, (16 * face + 4 * 4 * edge + 4 * corner) / 36])


def test_limits_stay_when_a_surface_is_refined() -> None:
    surface = _surface(CUBE, CUBE_FACES).refined()
    limits = surface.limits()
    for _ in range(3):
        surface = surface.refined()
        assert surface.limits()[: len(limits)] == pytest.approx(limits, abs=1e-12)


def test_sharp_edges_keep_a_cube() -> None:
    surface = _surface(CUBE, CUBE_FACES, np.inf).refined()
    assert np.abs(surface.limits()).max(axis=1) == pytest.approx(1.0)
    assert np.abs(surface.positions[:8]) == pytest.approx(1.0)


def test_a_sheet_s_border_is_a_cubic_spline() -> None:
    grid = np.array([(x, y, 0.0) for y in range(3) for x in range(3)])
    faces = [
        (3 * y + x, 3 * y + x + 1, 3 * y + x + 4, 3 * y + x + 3) for y in (0, 1) for x in (0, 1)
    ]
    grid[1] = (1.0, -1.0, 0.0)
    limits = _surface(grid, faces).limits()
    assert limits[1] == pytest.approx((4 * grid[1] + grid[0] + grid[2]) / 6)


@pytest.mark.parametrize("sharp", [0.0, np.inf])
def test_a_surface_is_found_from_where_it_ends(sharp: float) -> None:
    surface = _surface(CUBE, CUBE_FACES, sharp).refined().refined()
    places = surface.limits()
    surface.positions = surface.positions + 0.05 * np.sin(7 * surface.positions[:, [1, 2, 0]])
    bent = surface.limits()
    assert not np.allclose(bent, places, atol=1e-3)
    assert surface.through(bent).limits() == pytest.approx(bent, abs=1e-5)


def test_edges_are_as_long_as_wanted() -> None:
    """A camera that looks straight down on a square, from 4 m: a pixel of 100 is 4 cm wide."""
    mesh, faces = _square()
    eye = Eye(_camera(4.0), 100, 100)
    fine, _, coarse = diced(mesh, faces, Wanted(1.0, 12, eye), np.eye(4))
    ends, uses = _edges(fine)
    lengths = np.linalg.norm(fine.positions[ends[:, 0]] - fine.positions[ends[:, 1]], axis=1)
    assert not coarse
    assert lengths.max() <= 0.04 * 1.15 * 2**0.5  # places at the rim are farther away
    assert 0.5 < lengths.mean() / 0.04 < 1.1
    assert uses.max() == 2


@pytest.mark.parametrize("levels", [0, 1, 3])
def test_levels_bound_it(levels: int) -> None:
    mesh, faces = _square()
    fine, _, coarse = diced(mesh, faces, Wanted(1e-3, levels, None), np.eye(4))
    assert len(fine.triangles) == 2 * 4**levels
    assert not coarse


def test_memory_bounds_it() -> None:
    mesh, faces = _square()
    fine, _, coarse = diced(mesh, faces, Wanted(1e-3, 12, None), np.eye(4), 1000)
    assert coarse
    assert 500 < len(fine.triangles) <= 1000
    assert _edges(fine)[1].max() == 2


def test_no_crack_opens_and_nothing_is_lost() -> None:
    """From near a corner, where edges next to each other are halved differently often."""
    mesh, faces = _square()
    camera = Camera(np.eye(4), (-0.5, 0.5, -0.5, 0.5))
    camera.matrix[:3, 3] = (-0.9, -0.9, 0.2)
    fine, _, _ = diced(mesh, faces, Wanted(2.0, 12, Eye(camera, 64, 64, 4.0)), np.eye(4))
    ends, uses = _edges(fine)
    rim = ends[uses == 1]
    assert len(np.unique(ends[:, 0])) > 100
    across = fine.positions[rim]
    on_rim = (np.abs(across[..., :2]) == 1.0).any(axis=(1, 2))
    assert on_rim.all()
    assert np.linalg.norm(across[:, 0] - across[:, 1], axis=1).sum() == pytest.approx(8.0)
    a, b, c = (fine.positions[fine.triangles[:, k]] for k in range(3))
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(4.0, rel=1e-5)
    assert fine.uv == pytest.approx(fine.positions[fine.triangles][..., :2], abs=1e-5)
    (number,) = fine.shading.attributes
    middle = fine.positions[fine.triangles].mean(axis=1)
    assert np.array_equal(number.values[:, 0], np.where(middle[:, 0] > middle[:, 1], 1.0, 2.0))


def test_out_of_view_pixels_are_larger() -> None:
    places = np.array([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (0.0, 0.0, 5.0)])
    near, beside, behind = Eye(_camera(4.0), 100, 100, 4.0).pixel_sizes(places)
    plain = Eye(_camera(4.0), 100, 100).pixel_sizes(places)
    assert near == plain[0] == pytest.approx(0.04, rel=1e-3)
    out = (3.0 - 2.0) / np.hypot(1.0, 0.5)  # m from the side of the pyramid that is seen
    assert beside == pytest.approx(plain[1] + 3.0 * 0.01 * out, rel=1e-3)
    assert behind == pytest.approx(4.0 * plain[2], rel=1e-3)


def test_orthographic_pixels_are_the_same_all_over() -> None:
    camera = Camera(np.eye(4), (-2.0, 2.0, -1.0, 1.0), orthographic=True)
    places = np.array([(0.0, 0.0, -1.0), (1.0, 1.0, -9.0)])
    assert Eye(camera, 40, 20, 4.0).pixel_sizes(places) == pytest.approx(0.1)


def test_values_go_with_a_smooth_surface() -> None:
    """Linear between the corners of a face, as UV maps are without smoothing."""
    triangles = np.array([t for f in CUBE_FACES for t in (f[:3], (f[0], *f[2:]))], np.uint32)
    corners = np.array(
        [(4 * k + i, 4 * k + j, 4 * k + m) for k in range(6) for i, j, m in ((0, 1, 2), (0, 2, 3))],
        np.int32,
    )
    values = CUBE.astype(np.float32)
    shading = MeshShading([MeshAttribute(3, Domain.POINT, values)])
    mesh = Mesh("cube", values, triangles, shading=shading)
    faces = Faces(_surface(CUBE, CUBE_FACES), corners, None)
    fine, normals, _ = diced(mesh, faces, Wanted(0.1, 12, None), np.eye(4))
    cage = fine.shading.attributes[0].values
    assert np.abs(cage).max(axis=1) == pytest.approx(1.0, abs=1e-5)
    assert np.linalg.norm(fine.positions, axis=1).max() < 0.9
    assert normals.vertices is not None
    outward = np.einsum("ij,ij->i", normals.vertices, fine.positions)
    assert outward.min() > 0
    assert (np.sign(cage[np.abs(cage) > 0.2]) == np.sign(fine.positions[np.abs(cage) > 0.2])).all()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"triangles": np.array([(0, 1, 4)], np.uint32)}, "vertex that does not exist"),
        ({"source": np.zeros(2, np.uint32)}, "do not fit their triangles"),
        ({"places": np.zeros((2, 3, 2), np.float32)}, "do not fit their triangles"),
    ],
)
def test_pieces_that_do_not_fit_are_refused(changed: dict[str, NDArray], said: str) -> None:
    given = {
        "positions": SQUARE.astype(np.float64),
        "triangles": np.array([(0, 1, 2)], np.uint32),
        "source": np.zeros(1, np.uint32),
        "places": np.zeros((1, 3, 2), np.float32),
    }
    with pytest.raises(ValueError, match=said):
        load().Pieces(**{**given, **changed})


def test_what_go_on_raises_ends_it() -> None:
    """The render was stopped, say."""
    mesh, faces = _square()
    asked = []

    def go_on() -> None:
        asked.append(1)
        if len(asked) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        diced(mesh, faces, Wanted(1e-4, 12, None), np.eye(4), go_on=go_on)
    assert len(asked) == 3
