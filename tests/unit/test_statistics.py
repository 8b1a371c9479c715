"""The statistics of a render are what their types say: no key more, none less, and of its type."""

from __future__ import annotations

from typing import Any, get_type_hints, is_typeddict

import pytest
from photon_splat.core.render.settings import Integrator
from photon_splat.core.render.statistics import Statistics
from photon_splat.core.scene import Material, Scene, Side

from tests.robustness.test_degenerate import room
from tests.support import corescene as c
from tests.support.programs import closure


def differences(value: Any, kind: Any, name: str) -> list[str]:
    """Where `value` is not of the type `kind`, by names."""
    if is_typeddict(kind):
        hints = get_type_hints(kind)
        found = [f"{name}: unknown key {key}" for key in sorted(set(value) - set(hints))]
        found += [f"{name}: no {key}" for key in sorted(kind.__required_keys__ - set(value))]
        for key in sorted(set(hints) & set(value)):
            found += differences(value[key], hints[key], f"{name}.{key}")
        return found
    plain = getattr(kind, "__origin__", kind)
    return [] if type(value) is plain else [f"{name}: {value!r} is no {plain.__name__}"]


def mirrored() -> Scene:
    """With caustics."""
    what = room(pixels=16)
    what.programs = [closure("Glossy", color=0.9, roughness=0.0)]
    what.materials[1] = Material("mirror", Side(), Side(), program=0)
    return what


@pytest.mark.parametrize(
    ("what", "settings"),
    [
        (room(pixels=16), {}),
        (room(pixels=16), {"denoise": True, "passes": 8}),
        (room(pixels=16), {"integrator": Integrator.REFERENCE}),
        (room(pixels=16), {"photons_per_pass": 0}),
        (mirrored(), {}),
    ],
    ids=["plain", "denoised", "reference", "no photons", "caustics"],
)
def test_every_key_is_documented(what: Scene, settings: dict[str, Any]) -> None:
    said = c.shoot(what, **({"passes": 2, "photons_per_pass": 2000} | settings)).statistics
    assert differences(said, Statistics, "statistics") == []
    assert ("caustic" in said["photons"]) == bool(what.programs)


def test_a_difference_is_found() -> None:
    said: Any = c.shoot(room(pixels=8), passes=1, photons_per_pass=100).statistics
    del said["error"]["bias"]
    said["photons"]["caustic"] = {"traced": 1, "stored": 1.0, "guided": False, "more": 1}
    assert differences(said, Statistics, "statistics") == [
        "statistics.error: no bias",
        "statistics.photons.caustic: unknown key more",
        "statistics.photons.caustic.stored: 1.0 is no int",
    ]


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"time_limit": 0.01, "passes": 100_000}, True),
        ({"time_limit": 0.01, "passes": 100_000, "denoise": True}, False),
        ({"passes": 1}, False),
        ({"time_limit": 60.0, "passes": 1}, False),
    ],
    ids=["ended by time", "denoised", "passes", "ended by passes"],
)
def test_a_picture_that_the_time_limit_leaves_noisy_is_named(
    settings: dict[str, Any], named: bool
) -> None:
    """One path a pixel: the light's noise is some 100 %."""
    said = c.shoot(room(pixels=32), **({"integrator": Integrator.REFERENCE} | settings)).statistics
    assert said["error"]["relative_rmse"] > 0.2
    words = [warning for warning in said["warnings"] if "is noisy" in warning]
    assert len(words) == named
    if named:
        assert "time limit of 0.01 s has ended it at an estimated error of " in words[0]
