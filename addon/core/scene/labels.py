"""What compositors call the things of a scene."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(slots=True)
class Neighbours:
    """Where things are a frame earlier and a frame later.

    moves           by row of Scene.instances: (2, 4, 4) float64, from where a point of it is in the
                    world
    shapes          by mesh: (2, V, 3) float32, how far its vertices or keys are from where they
                    are, in its own coordinates
    camera          (2, 4, 4) float64, to the world
    zoom            size of its frame over that of now
    """

    moves: dict[int, NDArray[np.float64]]
    shapes: dict[int, NDArray[np.float32]]
    camera: NDArray[np.float64]
    zoom: tuple[float, float] = (1.0, 1.0)


@dataclass(slots=True)
class Labels:
    """Names and numbers for passes that tell what is seen.

    passes          names of those that are wanted
    levels          ids of a pixel that each of the mattes among them keeps
    object_index    (I,) int32 by instance
    objects, assets  names by instance: of the object and of what it hangs on at last
    material_index  (M,) int32 by material of Scene.materials
    materials       names by material
    aovs            names of the passes that materials themselves fill, and whether each is a colour
    aov_programs    by pass and material: index into Scene.programs, or NO_PROGRAM
    alpha_threshold  what is less opaque is no first surface
    ambient_distance  how far the Ambient Occlusion pass looks, m
    neighbours      where things are a frame earlier and later, for the Vector pass; None: nowhere
                    else
    mist            start and depth, m, and the power of the distance's share
    """

    passes: list[str]
    levels: int = 0
    object_index: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    objects: list[str] = field(default_factory=list)
    assets: list[str] = field(default_factory=list)
    material_index: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    materials: list[str] = field(default_factory=list)
    aovs: list[tuple[str, bool]] = field(default_factory=list)
    aov_programs: list[list[int]] = field(default_factory=list)
    alpha_threshold: float = 0.5
    ambient_distance: float = np.inf
    neighbours: Neighbours | None = None
    mist: tuple[float, float, float] = (0.0, 100.0, 1.0)
