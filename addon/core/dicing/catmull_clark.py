"""Subdivision surfaces of Catmull and Clark (1978), with the creases of DeRose et al. (1998)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

INVERSION_STEPS = 40


@dataclass(slots=True)
class Surface:
    """The control mesh of a surface.

    positions  (V, 3) float64
    corners    (L,) vertex of each corner, face by face; starts (F + 1,) first corner of each face
    ends       (E, 2) vertices of the edges, in order; sharpness (E,) levels that they stay sharp
    pinned     (V,) levels that a vertex stays where it is
    """

    positions: NDArray[np.float64]
    corners: NDArray[np.int64]
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]
    sharpness: NDArray[np.float64]
    pinned: NDArray[np.float64]
    edge_of: NDArray[np.int64] = field(init=False)  # of each corner: to the next
    next: NDArray[np.int64] = field(init=False)  # corner of the same face
    previous: NDArray[np.int64] = field(init=False)
    face_of: NDArray[np.int64] = field(init=False)
    boundary: NDArray[np.bool_] = field(init=False)  # (E,) edges that have not two faces

    def __post_init__(self) -> None:
        count = len(self.corners)
        self.next = np.arange(1, count + 1)
        self.next[self.starts[1:] - 1] = self.starts[:-1]
        self.previous = np.empty(count, np.int64)
        self.previous[self.next] = np.arange(count)
        self.face_of = np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))
        keys = self._keys(np.stack([self.corners, self.corners[self.next]], axis=1))
        known = self._keys(self.ends)
        order = np.argsort(known)
        found = np.searchsorted(known, keys, sorter=order)
        self.edge_of = order[np.minimum(found, max(len(order) - 1, 0))]
        if not np.array_equal(known[self.edge_of], keys):
            raise ValueError("a face of a subdivision surface has an edge that is not listed")
        self.boundary = np.bincount(self.edge_of, minlength=len(self.ends)) != 2

    @property
    def half_sharp(self) -> bool:
        """Whether it has edges or vertices that are not sharp for ever, where limits() is not yet
        right.
        """
        levels = np.concatenate([self.sharpness, self.pinned])
        return bool(((levels > 0) & np.isfinite(levels)).any())

    def _keys(self, pairs: NDArray[np.int64]) -> NDArray[np.int64]:
        low, high = pairs.min(axis=1), pairs.max(axis=1)
        return low * np.int64(len(self.positions)) + high

    def _summed(self, at: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of `values` (N, 3) those at each vertex."""
        count = len(self.positions)
        return np.stack([np.bincount(at, values[:, i], count) for i in range(3)], axis=1)

    def _sharp_ends(self) -> tuple[NDArray, NDArray, NDArray]:
        """Of each vertex: number of its sharp edges, sum of their other ends, mean sharpness."""
        sharp = self.boundary | (self.sharpness > 0)
        a, b = self.ends[sharp].T
        at, other = np.concatenate([a, b]), np.concatenate([b, a])
        hard = np.where(self.boundary[sharp], np.inf, self.sharpness[sharp])
        number = np.bincount(at, minlength=len(self.positions))
        total = np.bincount(at, np.tile(np.minimum(hard, 1e3), 2), len(self.positions))
        mean = total / np.maximum(number, 1)
        return number, self._summed(at, self.positions[other]), mean

    def refined(self) -> Surface:
        """The next control mesh: the vertices, then a vertex of each edge, then one of each face;
        a face for each corner: its vertex, the edge after it, the face, the edge before it.
        """
        p, count, edges = self.positions, len(self.positions), len(self.ends)
        sizes = np.diff(self.starts)
        faces = np.add.reduceat(p[self.corners], self.starts[:-1]) / sizes[:, None]
        a, b = self.ends.T
        middle = 0.5 * (p[a] + p[b])
        around = np.stack(
            [np.bincount(self.edge_of, faces[self.face_of, i], edges) for i in range(3)],
            axis=1,
        )
        rounded = 0.25 * (p[a] + p[b] + around)
        share = np.where(self.boundary, 1.0, np.minimum(self.sharpness, 1.0))[:, None]
        of_edges = np.where(share < 1.0, rounded, middle) * (1 - share) + middle * share
        moved = np.concatenate([self._moved_vertices(faces), of_edges, faces])

        corner = np.arange(len(self.corners))
        quads = np.stack(
            [
                self.corners,
                count + self.edge_of,
                count + edges + self.face_of,
                count + self.edge_of[self.previous],
            ],
            axis=1,
        )
        middles = count + np.arange(edges)
        spokes = np.stack([count + self.edge_of, count + edges + self.face_of], axis=1)
        ends = np.concatenate(
            [np.stack([a, middles], axis=1), np.stack([b, middles], axis=1), spokes]
        )
        left = np.maximum(self.sharpness - 1.0, 0.0)
        pinned = np.zeros(len(moved))
        pinned[:count] = np.maximum(self.pinned - 1.0, 0.0)
        return Surface(
            moved,
            quads.ravel(),
            4 * np.arange(len(corner) + 1),
            ends,
            np.concatenate([left, left, np.zeros(len(spokes))]),
            pinned,
        )

    def _moved_vertices(self, faces: NDArray[np.float64]) -> NDArray[np.float64]:
        p = self.positions
        number, others, sharpness = self._sharp_ends()
        valence = np.bincount(self.corners, minlength=len(p))[:, None]
        a, b = self.ends.T
        neighbours = self._summed(np.concatenate([a, b]), p[np.concatenate([b, a])])
        centres = self._summed(self.corners, faces[self.face_of])
        n = np.maximum(valence, 1)
        rounded = p * (n - 2) / n + (neighbours + centres) / n**2
        creased = 0.75 * p + 0.125 * others
        return self._by_rule(rounded, creased, number, np.minimum(sharpness, 1.0))

    def limits(self) -> NDArray[np.float64]:
        """(V, 3), where the vertices end up; of a mesh of quads."""
        p = self.positions
        number, others, _ = self._sharp_ends()
        valence = np.bincount(self.corners, minlength=len(p))[:, None]
        a, b = self.ends.T
        neighbours = self._summed(np.concatenate([a, b]), p[np.concatenate([b, a])])
        opposite = self.corners.reshape(-1, 4)[:, [2, 3, 0, 1]].ravel()
        corners = self._summed(self.corners, p[opposite])
        n = np.maximum(valence, 1)
        rounded = (n**2 * p + 4 * neighbours + corners) / (n * (n + 5))
        creased = (4 * p + others) / 6
        return self._by_rule(rounded, creased, number, np.ones(len(p)))

    def _by_rule(
        self,
        rounded: NDArray[np.float64],
        creased: NDArray[np.float64],
        number: NDArray[np.int64],
        share: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Smooth where fewer than two sharp edges meet, on the crease of two, else fixed; `share`:
        how far the sharp rule holds.
        """
        share = np.where(number < 2, 0.0, share)[:, None]
        ruled = np.where((number == 2)[:, None], creased, self.positions)
        moved = np.where(share > 0, rounded * (1 - share) + ruled * share, rounded)
        pinned = np.minimum(self.pinned, 1.0)[:, None]
        loose = np.bincount(self.corners, minlength=len(self.positions)) == 0
        moved = np.where(pinned > 0, moved * (1 - pinned) + self.positions * pinned, moved)
        return np.where(loose[:, None], self.positions, moved)

    def through(self, places: NDArray[np.float64]) -> Surface:
        """The surface of this mesh of quads whose vertices end up at `places`: Richardson's
        iteration; limits() shrinks the roughest change of position to a ninth and no change of
        sign.
        """
        control = Surface(
            places.copy(), self.corners, self.starts, self.ends, self.sharpness, self.pinned
        )
        size = float(np.ptp(places)) if len(places) else 0.0
        for _ in range(INVERSION_STEPS):
            missing = places - control.limits()
            control.positions += 1.6 * missing
            if float(np.abs(missing).max(initial=0.0)) <= 1e-7 * size:
                break
        return control
