"""Cases like those of cases.py: where shadow rays start on coarse meshes with smooth normals."""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.cases import Case


def _coarse(name: str, *, splat: bool = False, **options: Any) -> Case:
    return Case(f"terminator_{name}", "terminator", options, samples=512, splat=splat)


TERMINATOR = (
    _coarse("sun", splat=True),
    _coarse("point", lamp="point"),
    _coarse("area", lamp="area"),
    _coarse("off", offset=0.0),
    _coarse("wide", offset=0.6),
    _coarse("saddle", shape="saddle"),
    _coarse("bowl", shape="bowl", lamp="point"),
    _coarse("half_flat", shape="half"),
    _coarse("leaf", material="leaf"),
    _coarse("leaf_bowl", material="leaf", shape="bowl", lamp="area"),
    _coarse("gloss", material="gloss", lamp="area"),
    _coarse("stretched", scale=(1.3, 0.7, 0.9)),
    _coarse("mirrored", scale=(-1.0, 1.0, 1.2)),
    _coarse("copies", copies=2, splat=True),
    _coarse("dented", bumps=0.2, splat=True),
    _coarse("dented_gloss", bumps=0.2, material="gloss"),
    _coarse("dented_leaf", bumps=0.2, material="leaf"),
)
