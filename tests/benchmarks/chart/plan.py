"""What is compared: scenes, methods, budgets of time, seeds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from tests.support.paths import ROOT

BUDGETS = (1.0, 3.0, 10.0, 30.0)
"""Seconds of the render call that each method is given."""

BETWEEN = 5.0
"""Seconds that only our methods are given as well: their whole call keeps to a limit, whereas
Cycles counts neither start-up nor denoising and has taken 4 to 7 s with a limit of 1 or 3. At equal
time the two are compared where ours would have no picture near.
"""

LONG = 900.0
"""Seconds that Cycles gets for scenes of which it hardly finds the light, one seed. From this
budget on it is given the samples that it makes in that time with the machine to itself, and its
seconds are processor time over threads: a quarter of an hour need not be quiet.
"""


class Method(StrEnum):
    """Cycles solves the same problem (no clamp, no end of paths before 64 bounces); DEFAULT is what
    a click gives, of either engine (defaults.py).
    """

    SPLAT = "Photon Splat"
    SPLAT_DENOISED = "Photon Splat, denoised"
    SPLAT_DEFAULT = "Photon Splat, defaults"
    CYCLES = "Cycles"
    CYCLES_DENOISED = "Cycles, denoised"
    CYCLES_DEFAULT = "Cycles, defaults"
    CYCLES_CARD = "Cycles on a graphics card"
    CYCLES_CARD_DENOISED = "Cycles on a graphics card, denoised"
    MITSUBA = "Mitsuba"
    MITSUBA_PARTICLES = "Mitsuba, particle tracer"
    LUXCORE = "LuxCore"
    LUXCORE_BIDIRECTIONAL = "LuxCore, bidirectional"
    LUXCORE_PHOTONS = "LuxCore, PhotonGI"


RIVALS = tuple(method for method in Method if method.startswith(("Mitsuba", "LuxCore")))
MEAN_TOLERANCE, MEAN_CASE, MEAN_SECONDS = 0.02, "cornell_box", 30.0
"""A rival whose picture of that scene has another mean solves another problem, and is not charted.
"""


@dataclass(frozen=True)
class Case:
    """reference: "paths" = the unbiased path tracer of this module; "photons" = long renders by
    photons with final gathering, where hardly a path finds some of the light; "cycles-card" =
    Cycles on a graphics card, for large pictures.
    """

    scene: str
    width: int
    height: int
    kind: str
    reference: str = "paths"
    reference_seconds: float = 75.0  # of each half
    file: Path | None = None  # elsewhere than in blend_scenes

    def sized(self, size: tuple[int, int] | None, reference_seconds: float | None = None) -> Case:
        """At another size. The mean error of a picture of n times as many pixels is known as well
        against a reference of the square root of n times the seconds.
        """
        width, height = size or (self.width, self.height)
        longer = max(width * height / (self.width * self.height), 0.25) ** 0.5
        seconds = reference_seconds or self.reference_seconds * longer
        return replace(self, width=width, height=height, reference_seconds=round(seconds, 1))

    @property
    def blend(self) -> Path:
        return self.file or ROOT / "blend_scenes" / f"{self.scene}.blend"


CASES = (
    # long, for the pictures that it is to judge have little noise
    Case("cornell_box", 512, 512, "diffuse", reference_seconds=200.0),
    Case("interior", 400, 250, "interior"),
    # the sun in its pans: on the wall paths find it once in 10,000
    Case("kitchen", 360, 240, "textured", "photons", 120.0),
    # lamps all but touch surfaces: a few pixels have most of the noise
    Case("many_lights", 400, 266, "many lights", reference_seconds=300.0),
    Case("street", 360, 240, "outdoors", "photons", 150.0),  # the sun in its windows: as rare
    Case("car", 384, 216, "car in a hall", "photons", 120.0),  # the sun in glass and chrome
    # the sun in its panes, as in street
    Case("village", 384, 216, "village, sun and sky", "photons", 150.0),
    Case("staircase", 384, 216, "glossy interior", "photons", 150.0),  # the sun in its floor
    Case("classroom", 384, 216, "classroom", reference_seconds=150.0),
    Case("caustic_glass", 400, 300, "caustic", "photons"),
    Case("caustic_pool", 400, 300, "pool", "photons"),
    # light gathered by glass and waves, in what scatters it
    Case("fog_lens", 320, 200, "caustic in fog", "photons", 90.0),
    Case("cloudy_pool", 320, 200, "cloudy water", "photons", 150.0),
    Case("chapel", 320, 180, "haze behind panes", "photons", 120.0),
)


def seeds(seconds: float, most: int, method: Method) -> range:
    """Fewer of the long renders: their errors scatter less; and of the rivals."""
    if method in RIVALS:
        return range(1, 1 + (min(most, 2) if seconds <= 3 else 1))
    return range(1, 1 + (most if seconds <= 3 else min(most, 3) if seconds <= 10 else 1))
