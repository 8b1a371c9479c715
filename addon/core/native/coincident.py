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


def coincident_surfaces(renderer: Renderer, scene: Scene) -> list[str]:
    """One warning about doubled surfaces, in view or beside it, the largest of them named: here
    light reaches them, in Cycles they shade each other. lights_in_surfaces() names those that
    shine.
    """
    found = renderer.coincident_surfaces()
    if not found:
        return []
    added = instance_order(scene)
    lights = {frozenset(pair) for _, *pair in renderer.lights_in_surfaces}
    shares: dict[tuple[str, ...], float] = {}
    for instance, other, share in found:
        if frozenset((instance, other)) in lights:
            continue
        names = {name_of(scene, int(added[k])) for k in (instance, other)}
        pair = tuple(sorted(names))
        shares[pair] = shares.get(pair, 0.0) + share
    if sum(shares.values()) < SHARE:
        return []
    pairs = [
        f"'{names[0]}' in '{names[-1]}'" if len(names) > 1 else f"'{names[0]}' in itself"
        for names in sorted(shares, key=lambda pair: -shares[pair])
    ]
    return [
        f"Surfaces lie exactly in each other ({first_of(pairs)}). They are lit here, while "
        "in Cycles they shade each other, wholly or by chance: delete one, or move it."
    ]
