"""Hair of particle systems -> core.scene.Strands, as Cycles reads it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.scene import Mesh, Strands
from ...core.scene.shading import GENERATED, Domain, MeshAttribute, MeshShading
from ..kept import identity
from ..nodes.node import Want
from ..report import Report
from .strands import Look

AT_ONCE = 4096
"""Strands that are read before they become arrays: lists of numbers take eight times the memory."""


@dataclass(frozen=True, slots=True)
class System:
    """A system of hair that is rendered: strands `begin` to `end`, of so many keys each."""

    modifier: Any
    system: Any
    begin: int
    end: int
    keys: int


def hair_of(ob: Any, rendered: bool) -> list[System]:
    """The systems of an evaluated object whose hair is shown as strands. rendered: for a picture,
    not for the viewport.
    """
    if ob.mode in {"PARTICLE_EDIT", "EDIT"}:
        return []
    found = []
    for modifier in ob.modifiers:
        if modifier.type != "PARTICLE_SYSTEM":
            continue
        if not (modifier.show_render if rendered else modifier.show_viewport):
            continue
        system = modifier.particle_system
        settings = None if system is None else system.settings
        if settings is None or settings.type != "HAIR" or settings.render_type != "PATH":
            continue
        parents, children = len(system.particles), len(system.child_particles)
        if not rendered:
            children = int(children * settings.display_percentage / 100)
        begin = parents if settings.child_type != "NONE" and children else 0
        if begin == parents + children:
            continue
        keys = (1 << (settings.render_step if rendered else settings.display_step)) + 1
        if settings.kink == "SPIRAL":
            keys += settings.kink_extra_steps
        found.append(System(modifier, system, begin, parents + children, keys))
    return found


def known_as(systems: list[System]) -> tuple[int, ...]:
    return tuple(
        number
        for one in systems
        for number in (identity(one.system.settings), one.begin, one.end, one.keys)
    )


def made_of(systems: list[System]) -> tuple[int, ...]:
    return tuple(identity(one.system.settings) for one in systems)


def export_hair(
    ob: Any, systems: list[System], look: Look, report: Report, go_on: Callable[[], None]
) -> Mesh | None:
    """All hair of an object, in its coordinates. go_on: raises where the export is to stop."""
    keys, counts, slots = [], [], []
    to_object = _to_object(ob)
    if to_object is None:
        return None
    last_slot = max(len(ob.material_slots) - 1, 0)
    for one in systems:
        settings = one.system.settings
        positions = _positions(ob, one, go_on)
        positions = positions @ to_object[:3, :3].T + to_object[:3, 3]
        own = np.empty((*positions.shape[:2], 4), np.float32)
        own[:, :, :3] = positions
        own[:, :, 3] = _radii(positions, settings)
        keys.append(own.reshape(-1, 4))
        counts.append(np.full(len(own), one.keys))
        slots.append(np.full(len(own), min(max(settings.material - 1, 0), last_slot), np.uint16))
    all_keys, all_counts, all_slots = (np.concatenate(x) for x in (keys, counts, slots))
    active = [i for i, one in enumerate(ob.data.uv_layers) if one.active_render]
    uv = _uv(systems, active[0]) if active else None
    left = _whole(all_keys, all_counts)
    if not left.all():
        report.warn(
            "Strands of hair left out, as they are not where a finite number says: {}", ob.name
        )
        all_keys = all_keys[np.repeat(left, all_counts)]
        all_counts, all_slots = all_counts[left], all_slots[left]
        uv = None if uv is None else uv[left]
    if not len(all_counts):
        return None
    first = np.concatenate(([0], np.cumsum(all_counts))).astype(np.uint32)
    strands = Strands(all_keys, first, look.shape, look.subdivisions, uv)
    strands.slots = all_slots if all_slots.any() else None
    return Mesh.of_strands(f"{ob.data.name} (hair)", strands)


def hair_shading(
    ob: Any, systems: list[System], exported: Strands, wants: dict[int, Want]
) -> MeshShading:
    """What `wants` (by id) of the surface that hair grows on; what there is not is left out."""
    mesh, shading = ob.data, MeshShading()
    colors = [
        one.name
        for one in mesh.attributes
        if one.data_type == "BYTE_COLOR" and one.domain == "CORNER"
    ]
    assert exported.first is not None
    for number, want in wants.items():
        values: NDArray | None = None
        if number == GENERATED:
            size = np.array(mesh.texspace_size, np.float64)
            scale = 0.5 / np.where(size != 0.0, size, 1.0)
            roots = exported.keys[exported.first[:-1], :3]
            values = (roots - np.array(mesh.texspace_location)) * scale + 0.5
        elif want.kind in {"uv", "attribute"} and want.name in mesh.uv_layers:
            values = _uv(systems, mesh.uv_layers.find(want.name))
        elif want.kind in {"attribute", "color"} and want.name in colors:
            values = _colors(systems, colors.index(want.name))
        if values is not None and len(values) == exported.count:
            rows = np.nan_to_num(values.astype(np.float32), posinf=0.0, neginf=0.0)
            shading.attributes.append(MeshAttribute(number, Domain.FACE, rows))
    return shading


def hair_keys(
    ob: Any, systems: list[System], go_on: Callable[[], None]
) -> NDArray[np.float32] | None:
    """(K, 4), for their motion."""
    found = export_hair(ob, systems, Look(), Report(), go_on)
    return None if found is None or found.strands is None else found.strands.keys


def _to_object(ob: Any) -> NDArray[np.float64] | None:
    try:
        matrix = np.linalg.inv(np.array(ob.matrix_world, np.float64))
    except np.linalg.LinAlgError:
        return None
    return matrix if np.isfinite(matrix).all() else None


def _positions(ob: Any, one: System, go_on: Callable[[], None]) -> NDArray[np.float64]:
    """(C, K, 3) in the world."""
    place, steps = one.system.co_hair, range(one.keys)
    out = np.empty((one.end - one.begin, one.keys, 3), np.float64)
    for start in range(one.begin, one.end, AT_ONCE):
        go_on()
        numbers: list[float] = []
        end = min(start + AT_ONCE, one.end)
        for strand in range(start, end):
            for step in steps:
                numbers.extend(place(ob, particle_no=strand, step=step))
        out[start - one.begin : end - one.begin] = np.array(numbers).reshape(-1, one.keys, 3)
    return _held_at_the_end(out)


def _held_at_the_end(keys: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where a strand has fewer keys than there could be, Blender says 0: its last one stays."""
    none = ~keys.any(axis=2)
    if not none[:, -1].any():
        return keys
    for step in range(1, keys.shape[1]):
        ended = none[:, step:].all(axis=1)
        keys[ended, step] = keys[ended, step - 1]
    return keys


def _radii(positions: NDArray[np.float64], settings: Any) -> NDArray[np.float64]:
    """(C, K): from root to tip by the length on the way."""
    steps = np.linalg.norm(np.diff(positions, axis=1), axis=2)
    way = np.concatenate((np.zeros((len(steps), 1)), np.cumsum(steps, axis=1)), axis=1)
    whole = way[:, -1:]
    time = np.divide(way, whole, out=np.zeros_like(way), where=whole > 0.0)
    shape = settings.shape
    left = np.clip(1.0 - time, 0.0, 1.0)
    if shape < 0.0:
        left = left ** (1.0 + shape)
    elif shape > 0.0:
        left = left ** (1.0 / max(1.0 - shape, 1e-6))
    scale = 0.5 * settings.radius_scale
    root, tip = scale * settings.root_radius, scale * settings.tip_radius
    radii: NDArray[np.float64] = np.maximum(left * (root - tip) + tip, 0.0)
    if settings.use_close_tip:
        radii[:, -1] = 0.0
    return radii


def _whole(keys: NDArray[np.float32], counts: NDArray) -> NDArray[np.bool_]:
    first = np.concatenate(([0], np.cumsum(counts)[:-1]))
    finite: NDArray[np.bool_] = np.logical_and.reduceat(np.isfinite(keys).all(axis=1), first)
    return finite


def _uv(systems: list[System], layer: int) -> NDArray[np.float32]:
    """(C, 2) of the place that each strand grows at."""
    return _on_emitter(
        systems,
        2,
        lambda one, particle, strand: one.system.uv_on_emitter(
            one.modifier, particle=particle, particle_no=strand, uv_no=layer
        ),
    )


def _colors(systems: list[System], layer: int) -> NDArray[np.float32]:
    """(C, 4), linear."""
    found = _on_emitter(
        systems,
        3,
        lambda one, particle, strand: one.system.mcol_on_emitter(
            one.modifier, particle=particle, particle_no=strand, vcol_no=layer
        ),
    )
    linear = np.where(
        found <= 0.04045, found / 12.92, ((np.maximum(found, 0) + 0.055) / 1.055) ** 2.4
    )
    return np.concatenate((linear, np.ones((len(found), 1))), axis=1).astype(np.float32)


def _on_emitter(
    systems: list[System], width: int, value: Callable[[System, Any, int], Any]
) -> NDArray[np.float32]:
    rows: list[float] = []
    for one in systems:
        particles = list(one.system.particles)
        none = particles[0] if particles else None
        for strand in range(one.begin, one.end):
            particle = particles[strand] if strand < len(particles) else none
            rows.extend(value(one, particle, strand))
    return np.array(rows, np.float32).reshape(-1, width)
