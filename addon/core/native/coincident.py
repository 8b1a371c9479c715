"""Names surfaces that lie exactly in each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..scene import Scene
from .convert import first_of
from .instances import instance_order, name_of

if TYPE_CHECKING:
    from photon_splat_native import Renderer

SHARE = 0.004
"""Of the picture, and of light that comes from beside it: below that no one sees it."""

OPAQUE = (
    "Surfaces lie exactly in each other ({}). They are lit here, while in Cycles they shade each "
    "other, wholly or by chance: delete one, or move it."
)
PASSED = (
    "What light passes lies exactly in other surfaces ({}). They show through it here, while in "
    "Cycles rays miss them, wholly or by chance: move one by a millimetre."
)


def coincident_surfaces(renderer: Renderer, scene: Scene) -> list[str]:
    """A warning about doubled surfaces, and one about panes, decals and fog in others, in view or
    beside it, the largest of them named. lights_in_surfaces() names those that shine.
    """
    found = renderer.coincident_surfaces()
    if not found:
        return []
    added = instance_order(scene)
    lights = {frozenset(pair) for _, *pair in renderer.lights_in_surfaces}
    shares: dict[bool, dict[tuple[str, str], float]] = {False: {}, True: {}}
    for instance, other, share, passed in found:
        if frozenset((instance, other)) in lights:
            continue
        pair = name_of(scene, int(added[instance])), name_of(scene, int(added[other]))
        if not passed:  # neither comes first
            pair = min(pair), max(pair)
        of_kind = shares[passed]
        of_kind[pair] = of_kind.get(pair, 0.0) + share
    return [
        text.format(first_of([_said(*pair) for pair in sorted(of, key=lambda pair: -of[pair])]))
        for text, of in ((OPAQUE, shares[False]), (PASSED, shares[True]))
        if sum(of.values()) >= SHARE
    ]


def _said(name: str, other: str) -> str:
    return f"'{name}' in itself" if name == other else f"'{name}' in '{other}'"
