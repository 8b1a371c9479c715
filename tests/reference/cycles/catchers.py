"""Cases like those of cases.py: shadow catchers, and objects that Simplify culls."""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.cases import Case

SHADOW = "Shadow Catcher"


def _catcher(name: str, **options: Any) -> Case:
    """The shadow's own pass is compared where nothing else is asked for: what is too bright is not
    cut off there, which makes noise darker.
    """
    picture = options.pop("picture", False)
    alpha = bool(picture and options.get("transparent"))
    return Case(
        f"catcher_{name}",
        "shadow_catcher",
        options | {"shadow_pass": not picture},
        samples=1024,
        alpha=alpha,
        render_pass="" if picture else SHADOW,
        passes=128,
        photons_per_pass=2_000,
    )


def _culled(name: str, **options: Any) -> Case:
    return Case(f"culled_{name}", "culled", options, samples=256, splat=False)


CATCHERS = (
    _catcher("floor"),
    _catcher("sky", light="sky"),
    _catcher("mirror", floor="glossy"),
    _catcher("emitter", light="emitter"),
    _catcher("shining", light="shining"),
    _catcher("glass", things="glass"),
    _catcher("fog", things="fog"),
    _catcher("leaf", floor="leaf"),
    _catcher("instance", on="instance"),
    _catcher("focus", transparent=True, focus=True),
    _catcher("film", picture=True, transparent=True),
    _catcher("film_opaque", picture=True, things="unseen"),
    Case("catcher_matte", "shadow_catcher", {"shadow_pass": True}, samples=512, alpha=True),
    _culled("by_view", margin=0.02),
    _culled("by_view_margin", margin=0.3),
    _culled("by_view_orthographic", margin=0.02, orthographic=True),
    _culled("by_distance", distance=5.2),
    _culled("by_both", margin=0.02, distance=5.2),
)
