"""Triangles halved at their edges until these are short: every edge is judged by itself, so that
neighbours agree and no crack opens.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .measure import Measure

HALVED_ABOVE = 2.0**0.5
"""Edges that are longer than this times the wanted length: the half is then nearer to it."""


@dataclass(slots=True)
class Pieces:
    """Parts of the triangles of a mesh.

    positions  (V, 3) float64; triangles (T, 3)
    source     (T,) the triangle, or quad, that each is part of
    places     (T, 3, 2) float32, where in it the corners are
    """

    positions: NDArray[np.float64]
    triangles: NDArray[np.int32]
    source: NDArray[np.int32]
    places: NDArray[np.float32]


def halved(
    pieces: Pieces,
    measure: Measure,
    rounds: int,
    limit: int,
    go_on: Callable[[], None],
) -> tuple[Pieces, bool]:
    """`pieces` with edges of about the wanted length, halved at most `rounds` times, and whether
    they are short enough by then or `rounds` are used up: no more than `limit` triangles are made,
    where the longest edges are halved first. `measure` has no vertices yet.
    """
    known, done = 0, 0  # vertices that are measured; triangles with short edges alone come first
    for _ in range(rounds):
        go_on()
        measure.add(pieces.positions[known:])
        known = len(pieces.positions)
        starts = pieces.triangles[done:]
        ends = starts[:, [1, 2, 0]]
        low, high = np.minimum(starts, ends).ravel(), np.maximum(starts, ends).ravel()
        found = measure.lengths(low, high)
        bound, room = HALVED_ABOVE, limit - len(pieces.triangles)
        complete = int(np.count_nonzero(found > bound)) <= room
        if not complete:
            if room < 1:
                return pieces, False
            bound = max(bound, float(np.partition(found, len(found) - room)[len(found) - room]))
        long = found > bound
        if not long.any():
            return pieces, complete
        pieces, done = _halve(pieces, low, high, long, done)
        if not complete:
            return pieces, False
    return pieces, True


def _halve(
    pieces: Pieces,
    low: NDArray[np.int32],
    high: NDArray[np.int32],
    long: NDArray[np.bool_],
    done: int,
) -> tuple[Pieces, int]:
    """`long`: which half-edges (from each corner to the next, of the triangles from `done` on) are
    halved. Those that stay whole come first; how many they are.
    """
    count = len(pieces.positions)
    keys = low[long].astype(np.int64) * count + high[long]
    unique, of_edge = np.unique(keys, return_inverse=True)
    a, b = np.divmod(unique, count)
    positions = np.concatenate(
        [pieces.positions, 0.5 * (pieces.positions[a] + pieces.positions[b])]
    )
    middle = np.full(len(long), -1, np.int32)
    middle[long] = (count + of_edge).astype(np.int32)
    middles = middle.reshape(-1, 3)
    number = np.count_nonzero(middles >= 0, axis=1)

    whole = done + np.flatnonzero(number == 0)
    triangles = [pieces.triangles[:done], pieces.triangles[whole]]
    places = [pieces.places[:done], pieces.places[whole]]
    source = [pieces.source[:done], pieces.source[whole]]
    for cuts in (1, 2, 3):
        chosen = np.flatnonzero(number == cuts)
        if not len(chosen):
            continue
        parts = _cut(pieces, positions, middles, chosen, cuts, done)
        # Parts of a triangle stay beside each other, also in memory.
        triangles.append(np.stack([v for v, _ in parts], axis=1).reshape(-1, 3))
        places.append(np.stack([p for _, p in parts], axis=1).reshape(-1, 3, 2))
        source.append(np.repeat(pieces.source[done + chosen], len(parts)))
    made = Pieces(
        positions, np.concatenate(triangles), np.concatenate(source), np.concatenate(places)
    )
    return made, done + len(whole)


def _cut(
    pieces: Pieces,
    positions: NDArray[np.float64],
    middle: NDArray[np.int32],
    chosen: NDArray[np.int64],
    cuts: int,
    done: int,
) -> list[tuple[NDArray[np.int32], NDArray[np.float32]]]:
    """The parts of triangles that have so many halved edges."""
    mids = middle[chosen]
    # The first corner is turned to where the pattern begins: the halved edge, or the one after
    # the whole one.
    if cuts == 1:
        first = np.argmax(mids >= 0, axis=1)
    elif cuts == 2:
        first = (np.argmin(mids >= 0, axis=1) + 1) % 3
    else:
        first = np.zeros(len(chosen), np.int64)
    turn = (first[:, None] + np.arange(3)) % 3
    corner = np.take_along_axis(pieces.triangles[done + chosen], turn, axis=1)
    mids = np.take_along_axis(mids, turn, axis=1)
    place = np.take_along_axis(pieces.places[done + chosen], turn[:, :, None], axis=1)
    between = 0.5 * (place + place[:, [1, 2, 0]])
    vertices = np.concatenate([corner, mids], axis=1)  # 0, 1, 2, and the middles 01, 12, 20
    where = np.concatenate([place, between], axis=1)

    def parts(*patterns: tuple[int, int, int]) -> list[tuple[NDArray, NDArray]]:
        return [(vertices[:, list(one)], where[:, list(one)]) for one in patterns]

    if cuts == 1:
        return parts((0, 3, 2), (3, 1, 2))
    if cuts == 3:
        return parts((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))
    # The four-sided rest is cut along its shorter diagonal.
    own = positions[vertices[:, [0, 4, 3, 2]]]
    one = np.linalg.norm(own[:, 0] - own[:, 1], axis=1)
    other = np.linalg.norm(own[:, 2] - own[:, 3], axis=1)
    straight = (one <= other)[:, None]
    top = parts((3, 1, 4))
    first_half = np.where(straight, vertices[:, [0, 3, 4]], vertices[:, [0, 3, 2]])
    second_half = np.where(straight, vertices[:, [0, 4, 2]], vertices[:, [3, 4, 2]])
    first_place = np.where(straight[:, :, None], where[:, [0, 3, 4]], where[:, [0, 3, 2]])
    second_place = np.where(straight[:, :, None], where[:, [0, 4, 2]], where[:, [3, 4, 2]])
    return [*top, (first_half, first_place), (second_half, second_place)]
