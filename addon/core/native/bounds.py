"""Where a scene's things are: boxes around them, and the origin that coordinates count from."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..scene import Mesh, Scene

FAR = 100.0
"""Objects within 1 / FAR of the scene's size around the camera count as near, all others as far."""


def world_bounds(scene: Scene) -> NDArray[np.float64]:
    """(2, 3) lower and upper corner, m, of boxes around all instances; the camera's place for an
    empty scene.
    """
    return _around(_instance_boxes(scene), scene)


def _around(boxes: NDArray[np.float64], scene: Scene) -> NDArray[np.float64]:
    if not len(boxes):
        return np.stack([scene.camera.matrix[:3, 3]] * 2)
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def _instance_boxes(scene: Scene) -> NDArray[np.float64]:
    """(I, 2, 3) lower and upper corner in the world, m; instances without a triangle are left
    out.
    """
    instances = scene.instances
    filled = np.array(
        [len(mesh.triangles) > 0 or mesh.strands is not None for mesh in scene.meshes], bool
    )
    boxes = np.zeros((len(scene.meshes), 2, 3))
    for i in np.flatnonzero(filled):
        boxes[i] = _box(scene.meshes[i])
    shown = filled[instances.mesh] if len(instances.mesh) else np.zeros(0, bool)
    matrices, local = instances.matrix[shown], boxes[instances.mesh[shown]]
    # What turns a box: it reaches as far from its middle as its half sides do together.
    turns = matrices[:, :3, :3]
    middle = (turns @ local.mean(axis=1)[:, :, None])[..., 0] + matrices[:, :3, 3]
    half = (np.abs(turns) @ (0.5 * (local[:, 1] - local[:, 0]))[:, :, None])[..., 0]
    return np.stack([middle - half, middle + half], axis=1)


def _box(mesh: Mesh) -> NDArray[np.float64]:
    """(2, 3) lower and upper corner of the triangles; vertices that none of them uses do not
    count.
    """
    if mesh.strands is not None:
        keys = mesh.strands.keys
        return np.stack(
            [(keys[:, :3] - keys[:, 3:]).min(axis=0), (keys[:, :3] + keys[:, 3:]).max(axis=0)]
        ).astype(np.float64)
    axes = mesh.positions.T  # one at a time: numpy takes twenty times as long over axis 0
    ends = [int(at) for axis in axes for at in (axis.argmin(), axis.argmax())]
    if not all((mesh.triangles == end).any() for end in set(ends)):
        used = np.zeros(len(mesh.positions), bool)
        used[mesh.triangles] = True
        axes = mesh.positions[used].T
    return np.array([[axis.min() for axis in axes], [axis.max() for axis in axes]], np.float64)


def focus(scene: Scene) -> tuple[NDArray[np.float64], float]:
    """The origin of the renderer's coordinates, and the radius of the near objects (0: there are no
    far ones).

    Rounding errors grow with the distance from the origin. It is the middle of the scene, or of the
    near objects where others are very far away.
    """
    boxes = _instance_boxes(scene)
    bounds = _around(boxes, scene)
    origin, near = bounds.mean(axis=0), 0.0
    eye = scene.camera.matrix[:3, 3]
    reach = np.abs(boxes - eye).max(axis=(1, 2)) if len(boxes) else np.zeros(0)
    size = 0.5 * float(np.linalg.norm(bounds[1] - bounds[0]))
    while np.isfinite(size):
        close = boxes[reach < size / FAR]
        if not len(close):
            break
        low, high = close[:, 0].min(axis=0), close[:, 1].max(axis=0)
        origin, near = 0.5 * (low + high), max(0.5 * float(np.linalg.norm(high - low)), 1e-6 * size)
        size = near
    return origin, near
