"""Curves and point clouds of Blender -> core.scene.Strands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.scene import Mesh, Strands, StrandShape
from ...core.scene.shading import Domain, MeshAttribute, MeshShading
from ..arrays import read, read_copy
from ..nodes.node import Want
from ..report import Report
from .attribute_values import finite, numbers_of

STRANDS = {"CURVES", "POINTCLOUD"}
SHAPES = {
    "RIBBONS": StrandShape.RIBBON,
    "THICK": StrandShape.THICK,
    "THICK_LINEAR": StrandShape.LINEAR,
}
CURVE_RADIUS, POINT_RADIUS = np.float32(0.005), np.float32(0.01)
POLY = 1  # of Blender's types of curves


@dataclass(frozen=True, slots=True)
class Look:
    """How the scene shows curves: settings of Cycles, its defaults without it."""

    shape: StrandShape = StrandShape.RIBBON
    subdivisions: int = 4
    poly_is_linear: bool = False  # since Blender 5.1, whatever the shape


def look_of(scene: Any) -> Look:
    settings = getattr(scene, "cycles_curves", None)
    if settings is None:
        return Look()
    known = settings.bl_rna.properties["shape"].enum_items
    return Look(
        SHAPES.get(settings.shape, StrandShape.RIBBON),
        1 << min(max(int(settings.subdivisions), 0), 16),
        "THICK_LINEAR" in known,
    )


@dataclass(slots=True)
class Sound:
    """Which of the curves and keys of some data are rendered; None: all."""

    curves: NDArray[np.bool_] | None = None
    keys: NDArray[np.bool_] | None = None

    def of(self, values: NDArray, domain: Domain) -> NDArray:
        mask = self.keys if domain == Domain.POINT else self.curves
        return values if mask is None else values[mask]


def export_strands(data: Any, kind: str, name: str, look: Look, report: Report) -> Mesh | None:
    """Curves or points, or None where there are none. `name` is the object that warnings name."""
    keys = _keys(data, CURVE_RADIUS if kind == "CURVES" else POINT_RADIUS)
    first = _first(data) if kind == "CURVES" else None
    sound = _sound(keys, first, name, report)
    keys = sound.of(keys, Domain.POINT)
    shape = StrandShape.POINT if first is None else look.shape
    if first is not None:
        if sound.curves is not None:
            counts = np.diff(first)[sound.curves]
            first = np.concatenate(([0], np.cumsum(counts)))
        if look.poly_is_linear and _is_poly(data):
            shape = StrandShape.LINEAR
    if not len(keys) or (first is not None and len(first) < 2):
        return None
    uv = None
    if (layer := uv_layer(data)) is not None:
        uv = sound.of(finite(read_copy(layer.data, "vector", np.float32, 2)), Domain.FACE)
    own = None if first is None else first.astype(np.uint32)
    return Mesh.of_strands(data.name, Strands(keys, own, shape, look.subdivisions, uv))


def keys_now(data: Any, kind: str) -> NDArray[np.float32]:
    """(K, 4) of all curves or points, for their motion."""
    return _keys(data, CURVE_RADIUS if kind == "CURVES" else POINT_RADIUS)


def uv_layer(data: Any) -> Any:
    """What Cycles takes for the UV map of curves: the first of their vectors of two numbers."""
    return next(
        (
            one
            for one in data.attributes
            if one.domain == "CURVE" and one.data_type == "FLOAT2" and len(one.data)
        ),
        None,
    )


def strand_shading(data: Any, kind: str, name: str, wants: dict[int, Want]) -> MeshShading:
    """What `wants` (by id) of curves or points; what they do not have is left out."""
    keys = _keys(data, CURVE_RADIUS)
    sound = _sound(keys, _first(data) if kind == "CURVES" else None, name, Report())
    shading = MeshShading()
    for number, want in wants.items():
        if want.kind == "curve normal" and kind == "CURVES":
            at_keys = sound.of(_normals(data), Domain.POINT)
            shading.attributes.append(MeshAttribute(number, Domain.POINT, at_keys))
        if want.kind not in {"uv", "attribute", "color"} or not want.name:
            continue
        found = _values(data.attributes.get(want.name))
        if found is not None:
            domain, values = found
            shading.attributes.append(MeshAttribute(number, domain, sound.of(values, domain)))
    return shading


def _keys(data: Any, default_radius: np.float32) -> NDArray[np.float32]:
    positions = data.attributes.get("position")
    count = 0 if positions is None else len(positions.data)
    keys = np.empty((count, 4), np.float32)
    if count and positions is not None:
        keys[:, :3] = read(positions.data, "vector", np.float32, 3)
        radius = data.attributes.get("radius")
        known = radius is not None and radius.data_type == "FLOAT" and len(radius.data) == count
        keys[:, 3] = read(radius.data, "value", np.float32) if known else default_radius
    with np.errstate(invalid="ignore"):
        np.maximum(keys[:, 3], 0.0, out=keys[:, 3])  # NaN stays
    return keys


def _first(data: Any) -> NDArray[np.int64]:
    if not len(data.curves):
        return np.zeros(1, np.int64)
    return read(data.curve_offset_data, "value", np.int32).astype(np.int64)


def _sound(
    keys: NDArray[np.float32], first: NDArray[np.int64] | None, name: str, report: Report
) -> Sound:
    """Curves of one key are no curves; those with a key that is not finite are reported."""
    finite = np.isfinite(keys).all(axis=1)
    if first is None:
        lost = len(keys) - int(np.count_nonzero(finite))
        if lost:
            report.warn(f"Object {{}}: points left out: {lost} that are not finite numbers", name)
        return Sound(None, None if not lost else finite)
    counts = np.diff(first)
    left = counts >= 2
    if not finite.all():
        owner = np.repeat(np.arange(len(counts)), counts)
        broken = np.zeros(len(counts), bool)
        broken[owner[~finite]] = True
        report.warn(
            f"Object {{}}: curves left out: {int(np.count_nonzero(broken))} with a key that is "
            "not a finite number",
            name,
        )
        left &= ~broken
    if left.all():
        return Sound()
    return Sound(left, np.repeat(left, counts))


def _is_poly(data: Any) -> bool:
    types = data.attributes.get("curve_type")
    return types is not None and len(types.data) > 0 and types.data[0].value == POLY


def _values(attribute: Any) -> tuple[Domain, NDArray] | None:
    if attribute is None or len(attribute.data) == 0:
        return None
    values = numbers_of(attribute)
    if values is None:
        return None
    return Domain.FACE if attribute.domain == "CURVE" else Domain.POINT, values


def _normals(data: Any) -> NDArray[np.float32]:
    """(K, 3) of the keys of curves. One by one: foreach_get reads memory that Blender has freed."""
    numbers = [one.vector[:] for one in data.normals]
    return finite(np.array(numbers, np.float32).reshape(-1, 3))
