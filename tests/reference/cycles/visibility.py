"""Cases like those of cases.py: what some kinds of ray do not see, lamps without shadow, and other
things that are said of lamps.
"""

from __future__ import annotations

from math import radians
from typing import Any

from tests.reference.cycles.cases import Case

ALL_BUT_CAMERA = ("diffuse", "glossy", "transmission", "shadow")


def _hidden(name: str, on: str, *off: str, samples: int = 1024, **more: Any) -> Case:
    options = {"on": on, "off": list(off), **more}
    alpha = bool(more.get("transparent"))
    # samples that are many say that some light is found seldom
    passes = 400 if samples > 1024 else 32
    return Case(
        f"rays_{name}", "ray_visibility", options, samples=samples, alpha=alpha, passes=passes
    )


def _shadowless(kind: str, energy: float, *, samples: int = 1024, **options: Any) -> Case:
    name = f"shadowless_{kind.lower()}"
    given = {"kind": kind, "energy": energy, **options}
    passes = 2000 if samples > 1024 else 256
    return Case(name, "lamp_without_shadow", given, samples=samples, reference_passes=passes)


def _squeezed(name: str, kind: str, energy: float, **options: Any) -> Case:
    return Case(f"squeezed_{name}", "lamp_on_stage", {"kind": kind, "energy": energy, **options})


VISIBILITY = (
    *(_hidden(f"box_{kind}", "box", kind) for kind in ("camera", *ALL_BUT_CAMERA)),
    _hidden("box_scattered", "box", "diffuse", "glossy", "transmission"),
    _hidden("box_seen_only", "box", *ALL_BUT_CAMERA),
    _hidden("box_holdout", "box", "holdout", transparent=True),
    _hidden("instance_camera", "instance", "camera"),
    _hidden("instance_diffuse_shadow", "instance", "diffuse", "shadow"),
    _hidden("instance_of_holdout", "instanced", "holdout", transparent=True),
    _hidden("translucent_box_diffuse", "box", "diffuse", translucent=True),
    _hidden("translucent_box_transmission", "box", "transmission", translucent=True),
    _hidden("translucent_lamp_transmission", "lamp", "transmission", translucent=True),
    _hidden("translucent_world_diffuse", "world", "diffuse", translucent=True),
    _hidden("collection_indirect", "collection", "indirect_only"),
    _hidden("collection_holdout", "collection", "holdout", transparent=True),
    *(
        _hidden(f"emitter_{kind}", "emitter", kind, samples=16384 if kind == "diffuse" else 1024)
        for kind in ("camera", "diffuse", "glossy", "shadow")
    ),
    *(_hidden(f"lamp_{kind}", "lamp", kind) for kind in ("diffuse", "glossy", "transmission")),
    *(_hidden(f"world_{kind}", "world", kind) for kind in ("camera", "diffuse", "glossy")),
    *(
        _hidden(f"{on}_{kind}_plastic", on, kind, plastic=True)
        for on in ("world", "sky", "lamp")
        for kind in ("diffuse", "glossy")
    ),
    _hidden("world_camera_asked", "world", "camera", asked=True),
    _shadowless("POINT", 30.0, shadow_soft_size=0.05),
    _shadowless("SPOT", 60.0, aim=(0.0, 0.0, 0.0), spot_size=radians(70.0), shadow_soft_size=0.05),
    _shadowless("SUN", 1.0, samples=16384, aim=(-0.3, -0.6, 1.0), angle=0.1),
    _shadowless("AREA", 30.0, aim=(0.0, 0.0, 0.0), size=0.2),
    Case("lamp_bounces_0", "lamp_of_few_bounces", {"most": 0}),
    Case("lamp_bounces_1", "lamp_of_few_bounces", {"most": 1}),
    Case("lamp_without_mis", "lamp_without_mis", {}),
    Case("shade_in_lamp", "shade_in_lamp", {}),
    _squeezed("point", "POINT", 30.0, scale=(1.0, 0.0, 1.0), shadow_soft_size=0.1),
    _squeezed("sun", "SUN", 1.0, aim=(-0.3, -0.6, 1.0), angle=0.1, scale=(0.0, 1.0, 1.0)),
    _squeezed("sun_line", "SUN", 1.0, aim=(-0.3, -0.6, 1.0), angle=0.1, scale=(0.0, 0.0, 1.0)),
)
