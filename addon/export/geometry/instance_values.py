"""What programs read from the graph's instances: Object Info, Particle Info, Texture Coordinate,
and attributes of the instancer or the object.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from ..nodes.inputs import property_value
from ..nodes.node import Want
from ..nodes.random_numbers import name_random, number_random
from .instance_attributes import InstanceAttributes

PARTICLE_VECTORS = {
    "Location": "location",
    "Velocity": "velocity",
    "Angular Velocity": "angular_velocity",
}

Reader = Callable[[Any], Any]
"""A number or tuple of an instance; 0 where it has nothing of the kind."""


def width_of(want: Want) -> int:
    """Components of an attribute of instances."""
    if want.kind in {"object", "instancer"}:
        return 4
    if want.kind == "particle":
        return 3 if want.name in PARTICLE_VECTORS else 1
    return _INFO_WIDTHS.get(want.name, 1) if want.kind == "info" else 1


def reader_of(want: Want, depsgraph: Any, of_nodes: InstanceAttributes) -> Reader:
    if want.kind == "info":
        return _INFO[want.name]
    if want.kind == "particle":
        return partial(_particle, name=want.name, depsgraph=depsgraph)
    if want.kind == "object" and want.name == "color":
        return _color
    return partial(_property, want=want, of_nodes=of_nodes)


def is_of_kind(want: Want) -> bool:
    """Whether repeats (see Rows) have what the first of them has; or is_random()."""
    return want.kind == "object" or (want.kind == "info" and want.name in _OF_KIND)


def is_random(want: Want) -> bool:
    """The number that instances have each for itself, by their random_id."""
    return (want.kind, want.name) == ("info", "random")


def random_of(ids: Any) -> Any:
    """0..1, of numbers or arrays of them."""
    return (ids & 0xFFFFFFFF) / 0xFFFFFFFF


def _property(instance: Any, want: Want, of_nodes: InstanceAttributes) -> Any:
    ob = instance.object
    owners = [ob, ob.data]
    if want.kind == "instancer" and instance.is_instance and instance.parent is not None:
        owners = [instance.parent, instance.parent.data, *owners]
        if instance.particle_system is not None:
            owners = [instance.particle_system.settings, *owners]
        found = of_nodes.find(instance, want.name)
        if found is not None:
            return found
    return property_value(owners, want.name) or (0.0, 0.0, 0.0, 0.0)


def _random(instance: Any) -> float:
    if not instance.is_instance:
        return name_random(instance.object.name)
    return float(random_of(instance.random_id))


def _color(instance: Any) -> Any:
    """Instances have the colour of what makes them, the outermost of all."""
    return tuple((instance.parent or instance.object).color)


def _generated(instance: Any) -> Any:
    return tuple(0.5 * v - 0.5 for v in instance.orco) if instance.is_instance else (0.0,) * 3


_INFO: dict[str, Reader] = {
    "color": _color,
    "index": lambda instance: float(instance.object.pass_index),
    "random": _random,
    "generated": _generated,
    "uv": lambda instance: (*instance.uv, 0.0) if instance.is_instance else (0.0,) * 3,
}
_OF_KIND = {"color", "index", "random"}
_INFO_WIDTHS = {"color": 4, "generated": 3, "uv": 3}


def _particle(instance: Any, name: str, depsgraph: Any) -> Any:
    system = instance.particle_system
    index = -1 if system is None else instance.persistent_id[0]
    if system is None and name == "Random":
        return number_random(0)
    if system is None or not 0 <= index < len(system.particles):
        return (0.0,) * 3 if name in PARTICLE_VECTORS else 0.0
    particle = system.particles[index]
    if name in PARTICLE_VECTORS:
        return tuple(getattr(particle, PARTICLE_VECTORS[name]))
    if name == "Index":
        return float(index)
    if name == "Random":
        return number_random(index)
    if name == "Age":
        return depsgraph.scene.frame_current_final - particle.birth_time
    return particle.lifetime if name == "Lifetime" else particle.size
