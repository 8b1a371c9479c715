"""A render as one of several whose sums make a picture: on one of many machines (a part), or after
an interruption (a generation).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..native.library import load

if TYPE_CHECKING:
    from photon_splat_native import Renderer

FEWEST_PASSES = 16
"""Of a part, below which parts do not pay: each exports the scene, traces a pilot, and the passes
that all have in common (kCommonPasses, native/src/render/renderer.cpp).
"""


def too_small(passes: int) -> str:
    """A sentence for who asks for parts of so few passes; else none."""
    if passes >= FEWEST_PASSES:
        return ""
    return (
        f"a part of {passes} passes does little beside its export and its pilot: fewer parts of "
        f"{FEWEST_PASSES} passes or more take less time"
    )


@dataclass(frozen=True, slots=True)
class Part:
    """number: from 1 on; one beyond `count` is one more. count: parts that the picture is planned
    for; photon discs are as small as those of the whole. generation: how often the part has been
    interrupted. before: passes, and photon paths by photon map, of the generations before, in
    whose sequences of random numbers this one goes on.
    """

    number: int = 1
    count: int = 1
    generation: int = 0
    passes_before: int = 0
    paths_before: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if not 1 <= self.number < 2**16 or not 1 <= self.count < 2**16:
            raise ValueError(f"part {self.number}/{self.count} is none: both are 1 to 65,535")

    @property
    def whole(self) -> bool:
        """Whether this is a render like any other."""
        return (self.number, self.count, self.generation) == (1, 1, 0)

    def tell(self, renderer: Renderer) -> None:
        """Before it is built."""
        part = load().RenderPart()
        part.number, part.count, part.generation = self.number, self.count, self.generation
        part.passes_before, part.paths_before = self.passes_before, list(self.paths_before)
        renderer.options.part = part

    def error_of_whole(self, error: dict[str, Any], passes: int) -> float:
        """relative_rmse of the picture when all parts have done what this one has, if `error` is
        that of its last `passes` passes: noise falls with the root of all passes, and bias is that
        of the whole already.
        """
        if self.whole:
            return float(error["relative_rmse"])
        share = passes / (self.count * (self.passes_before + passes))
        return math.sqrt(share * error["standard_error"] ** 2 + error["bias"] ** 2)
