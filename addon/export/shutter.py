"""When the shutter is open, and Blender's scene at those times, as Cycles sees to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .geometry.instance_attributes import NO_LEVEL
from .kept import identity

FrameSet = Callable[[int, float], None]
"""Takes Blender's scene, and the dependency graph that is exported, to a frame and a subframe."""

MOST_STEPS = 129
CURVE_POINTS = 257
ROLLING = "TOP"
NOT_ROLLING = -1.0


@dataclass(slots=True)
class Blur:
    """The settings of a scene, times in frames: `centre` of the opening after the frame itself.
    `vectors`: nothing is blurred, a pass asks for the frames before and after, of all things.
    """

    shutter: float
    centre: float
    rolling: float
    frame_seconds: float
    vectors: bool = False


def blur_of(depsgraph: Any) -> Blur | None:
    """None: nothing is blurred, and no pass asks for motion."""
    scene = depsgraph.scene_eval
    render, cycles = scene.render, getattr(scene, "cycles", None)
    seconds = float(render.fps_base) / max(float(render.fps), 1e-6)
    layer = depsgraph.view_layer_eval
    if not render.use_motion_blur or not getattr(layer, "use_motion_blur", True):
        wanted = layer.use_pass_vector
        return Blur(2.0, 0.0, NOT_ROLLING, seconds, vectors=True) if wanted else None
    shutter = max(float(render.motion_blur_shutter), 0.0)
    # before Blender 4.2 a property of Cycles
    position = getattr(
        render, "motion_blur_position", getattr(cycles, "motion_blur_position", "CENTER")
    )
    centre = {"START": 0.5, "END": -0.5}.get(position, 0.0) * shutter
    rolling = NOT_ROLLING
    if cycles is not None and cycles.rolling_shutter_type == ROLLING:
        rolling = float(cycles.rolling_shutter_duration)
    return Blur(shutter, centre, rolling, seconds)


def shutter_curve(render: Any) -> NDArray[np.float32]:
    """How far the shutter is open at equal steps, of original settings."""
    mapping = render.motion_blur_shutter_curve
    mapping.initialize()
    curve = mapping.curves[0]
    return np.array(
        [mapping.evaluate(curve, i / (CURVE_POINTS - 1)) for i in range(CURVE_POINTS)], np.float32
    )


@contextmanager
def other_times(depsgraph: Any, frame_set: FrameSet) -> Iterator[Callable[[float], None]]:
    """Gives a function that goes to a time, in frames after the present one; returns at the end,
    however that comes.
    """
    scene = depsgraph.scene
    frame, subframe = int(scene.frame_current), float(scene.frame_subframe)
    moved = False

    def go(after: float) -> None:
        nonlocal moved
        time = frame + subframe + after
        moved = True
        frame_set(floor(time), time - floor(time))

    try:
        yield go
    finally:
        if moved:
            frame_set(frame, subframe)


Key = tuple[int, ...]


def key_of(instance: Any) -> Key:
    """What an instance of the graph has in common with itself at other times."""
    own = identity(instance.object)
    if not instance.is_instance:
        return (own,)
    levels = (number for number in instance.persistent_id if number != NO_LEVEL)
    return (own, identity(instance.parent), *levels)


def steps_of(ob: Any, parent: Any = None) -> int:
    """At how many steps Cycles looks at an object while the shutter is open; 0: it stands still."""
    asked = [getattr(one, "cycles", None) for one in (ob, parent) if one is not None]
    if not all(getattr(one, "use_motion_blur", True) for one in asked):
        return 0
    most = max([1, *(int(getattr(one, "motion_steps", 1)) for one in asked)])
    return min((2 << (most - 1)) + 1, MOST_STEPS)


VECTOR_STEPS = 3


def times_of(steps: int) -> list[float]:
    """-1 where the shutter opens, 1 where it closes."""
    return [2.0 * step / (steps - 1) - 1.0 for step in range(steps)]
