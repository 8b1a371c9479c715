"""Shadow catchers: which arrays of the film a picture with them is made of, and how. The native
film/shadow_catcher.h does the same for pictures that are not denoised.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..scene import Scene
from .result import SHADOW_PASS, Passes

OF_PASS = ("matte", "shadow_catcher")
OF_PARTS = ("matte", "shadow_catcher", "backdrop")
"""The picture without catchers, the share of their light that they keep, the world behind them."""


def has_catchers(scene: Scene) -> bool:
    return scene.instances.catcher is not None


def shadow_arrays(scene: Scene, denoise: bool) -> tuple[str, ...]:
    """Arrays of the film beside those of the wanted passes."""
    if denoise and has_catchers(scene):
        return OF_PARTS
    return OF_PASS if scene.shadow_pass else ()


def split_off_shadow(passes: Passes, film: dict[str, Any], scene: Scene) -> None:
    """Where a pass of its own is wanted for it."""
    if scene.shadow_pass:
        passes["Combined"], passes[SHADOW_PASS.name] = film["matte"], film["shadow_catcher"]


def with_shadow(
    matte: NDArray[np.float32],
    shadow: NDArray[np.float32],
    backdrop: NDArray[np.float32],
    transparent: bool,
) -> NDArray[np.float32]:
    """(height, width, 4) from OF_PARTS. `transparent`: the world is not seen."""
    shown = np.clip(shadow.mean(axis=2, keepdims=True), 0.0, 1.0)
    color, alpha = matte[..., :3], np.clip(matte[..., 3:], 0.0, 1.0)
    if transparent:
        return np.concatenate([color, (1.0 - alpha) * (1.0 - shown) + alpha], axis=2)
    return np.concatenate([color + backdrop * shown, np.ones_like(alpha)], axis=2)
