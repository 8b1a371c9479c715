"""Ray visibility: which rays see objects, lamps and the world, and what the camera sees as a
hole.
"""

from __future__ import annotations

from typing import Any

from ..core.scene import ALL_RAYS, Ray
from .report import Report

FLAGS = {
    "camera": Ray.CAMERA,
    "shadow": Ray.SHADOW,
    "diffuse": Ray.DIFFUSE,
    "glossy": Ray.GLOSSY,
    "transmission": Ray.TRANSMISSION,
    "volume_scatter": Ray.VOLUME,
}


class Visibility:
    """What seen_by(), is_holdout() and is_catcher() say of instances, asked once for each object
    and what makes its instances.
    """

    def __init__(self, view_layer: Any) -> None:
        self._view_layer = view_layer
        self._known: dict[tuple[int, int], tuple[int, bool, bool]] = {}

    def of(self, instance: Any) -> tuple[int, bool, bool]:
        maker = instance.parent if instance.is_instance else None
        key = (
            instance.object.original.as_pointer(),
            0 if maker is None else maker.original.as_pointer(),
        )
        if key not in self._known:
            self._known[key] = (
                seen_by(instance, self._view_layer),
                is_holdout(instance, self._view_layer),
                is_catcher(instance),
            )
        return self._known[key]


def seen_by(instance: Any, view_layer: Any) -> int:
    """The rays that meet an instance of the graph. The object that makes it and the collections of
    that have a say.
    """
    ob = instance.object
    mask = _own(ob)
    maker = ob
    if instance.is_instance and instance.parent is not None:
        maker = instance.parent
        mask &= _own(maker)
    if maker.original.indirect_only_get(view_layer=view_layer) and not _held_out(maker, view_layer):
        mask &= ~int(Ray.CAMERA)
    return mask


def is_holdout(instance: Any, view_layer: Any) -> bool:
    """What makes the instance says so, as in Cycles: instances of a held-out object are shown."""
    maker = (
        instance.parent if instance.is_instance and instance.parent is not None else instance.object
    )
    return _held_out(maker, view_layer)


def is_catcher(instance: Any) -> bool:
    maker = instance.parent if instance.is_instance else None
    return bool(
        instance.object.is_shadow_catcher or (maker is not None and maker.is_shadow_catcher)
    )


def wants_shadow_pass(view_layer: Any) -> bool:
    """Whether a bpy.types.ViewLayer asks for Cycles' Shadow Catcher pass."""
    cycles = getattr(view_layer, "cycles", None)
    return bool(cycles is not None and cycles.use_pass_shadow_catcher)


def lamp_seen_by(rays: int) -> int:
    """The rays that bring a lamp's light, of those that seen_by() says: shadow rays always do, and
    of the camera Light.camera_visible tells.
    """
    return rays | Ray.SHADOW | Ray.CAMERA


def world_seen_by(world: Any) -> int:
    """The same for the world: Blender up to 5.2 keeps it among the settings of Cycles."""
    kept = getattr(world, "cycles_visibility", None)
    mask = ALL_RAYS
    for name, ray in FLAGS.items():
        seen = getattr(world, f"visible_{name}", getattr(kept, name.removeprefix("volume_"), True))
        if not seen and ray is not Ray.SHADOW:
            mask &= ~int(ray)
    return mask


def terminator_offset(ob: Any, which: str) -> float:
    """Shadow Terminator's offset of an object: "geometry" or "shading". Blender 4.3 and older keep
    them among Cycles' properties.
    """
    name = f"shadow_terminator_{which}_offset"
    if hasattr(ob.original, name):
        return float(getattr(ob.original, name))
    older, default = {"geometry": (name, 0.1), "shading": ("shadow_terminator_offset", 0.0)}[which]
    return float(getattr(getattr(ob.original, "cycles", None), older, default))


def report_unsupported(ob: Any, report: Report) -> None:
    if terminator_offset(ob, "shading") > 0.0:
        report.warn("Shadow Terminator's Shading Offset is not supported; ignored: {}", ob.name)


def _own(ob: Any) -> int:
    mask = ALL_RAYS
    for name, ray in FLAGS.items():
        if not getattr(ob, f"visible_{name}"):
            mask &= ~int(ray)
    return mask


def _held_out(ob: Any, view_layer: Any) -> bool:
    return bool(ob.is_holdout) or bool(ob.original.holdout_get(view_layer=view_layer))
